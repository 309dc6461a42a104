#include "hyperiso/slice.hpp"

#include "core/text.hpp"

#include <algorithm>

namespace hyperiso {

Result<SampleRange> samples_around(const Axis& axis, double value) {
  const auto name = axis.name.empty() ? std::string("the axis") : "axis " + axis.name;
  if (axis.count < 1) return Error{Code::outside_domain, text(name, " has no samples")};
  const double first = axis.coordinate(0), last = axis.coordinate(axis.count - 1);
  if (!(value >= std::min(first, last) && value <= std::max(first, last)))
    return Error{Code::outside_domain,
                 text(value, " is not on ", name, ", which runs from ", first, " to ", last)};

  // The last sample at or before the value, in the direction of the axis.
  std::int64_t low = 0, high = axis.count;
  while (high - low > 1) {
    const std::int64_t middle = low + (high - low) / 2;
    const double coordinate = axis.coordinate(middle);
    (axis.increasing() ? coordinate <= value : coordinate >= value) ? low = middle : high = middle;
  }
  return SampleRange{low, axis.coordinate(low) == value ? low + 1 : low + 2};
}

} // namespace hyperiso
