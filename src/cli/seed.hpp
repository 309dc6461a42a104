#pragma once
// --seed: points, by coordinates along the axes of a field.

#include "hyperiso/grid.hpp"

#include <cstdint>
#include <string>
#include <vector>

namespace hyperiso::cli {

// The cell that a point "x,y,..." lies in, by the indices of its lowest corner, and the sample that is
// nearest to it. Fail if the point is not on the grid.
std::vector<std::int64_t> cell_at(const std::string& point, const std::vector<Axis>& axes);
std::vector<std::int64_t> sample_at(const std::string& point, const std::vector<Axis>& axes);

} // namespace hyperiso::cli
