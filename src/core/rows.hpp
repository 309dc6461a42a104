#pragma once
// Fields row by row.

#include "hyperiso/field.hpp"

#include <vector>

namespace hyperiso {

// Calls use(offset) for each row of samples along axis 0, axis 1 fastest; `offset` is that of its first
// sample from sample 0 of the field.
template <class Use>
void for_each_row(const Field& field, Use&& use) {
  const auto& axes = field.info.axes;
  if (field.info.samples() == 0) return;
  std::vector<std::int64_t> index(axes.size(), 0);
  for (;;) {
    std::int64_t offset = 0;
    for (std::size_t axis = 1; axis < axes.size(); ++axis) offset += index[axis] * field.strides[axis];
    use(offset);
    std::size_t axis = 1;
    while (axis < axes.size() && ++index[axis] == axes[axis].count) index[axis++] = 0;
    if (axis >= axes.size()) return;
  }
}

} // namespace hyperiso
