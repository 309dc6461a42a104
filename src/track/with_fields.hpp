#pragma once
// Other fields on the same grid, summed over the components.

#include "hyperiso/track.hpp"

#include <span>

namespace hyperiso::track_detail {

// Each has as many samples along each axis as the tracked one.
Status check_with(const FieldInfo& tracked, const std::vector<FieldBeside>& with);

// The samples of a step by owner, each by its share of the cells; missing ones do not count. `owners`: of
// each sample, in memory order, less than `count`, or UINT32_MAX for nobody.
Result<std::vector<FieldSum>> sums_by_owner(StepSource& source, std::int64_t step,
                                            std::span<const std::uint32_t> owners, std::size_t count);

void add(FieldSum& sum, const FieldSum& part);

} // namespace hyperiso::track_detail
