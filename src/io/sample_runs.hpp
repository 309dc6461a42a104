#pragma once
// The samples of a field in their order, as runs of bytes.

#include "hyperiso/field.hpp"

#include <cstddef>
#include <cstring>
#include <span>
#include <vector>

namespace hyperiso {

// Calls `use(std::span<const std::byte>)` with the samples of `field`, axis 0 fastest, one run after the
// other. Where samples lie one after the other in memory they come as they lie, in runs as long as that
// lasts; else they are gathered, a row along axis 0 at a time.
template <class Use>
void for_each_run(const Field& field, Use&& use) {
  const auto& axes = field.info.axes;
  const std::size_t sample_bytes = size_of(field.info.type);
  if (field.info.samples() == 0) return;

  std::size_t inner = 0; // axes that one run spans
  std::int64_t run = 1;
  while (inner < axes.size() && (field.strides[inner] == run || axes[inner].count == 1))
    run *= axes[inner++].count;
  const bool gathered = inner == 0;
  std::vector<std::byte> row;
  if (gathered) {
    run = axes[0].count;
    inner = 1;
    row.resize(static_cast<std::size_t>(run) * sample_bytes);
  }

  std::vector<std::int64_t> index(axes.size(), 0);
  while (true) {
    std::int64_t offset = 0;
    for (std::size_t axis = inner; axis < axes.size(); ++axis) offset += index[axis] * field.strides[axis];
    const std::byte* start = field.samples.get() + offset * static_cast<std::int64_t>(sample_bytes);
    if (gathered) {
      const auto step = field.strides[0] * static_cast<std::int64_t>(sample_bytes);
      for (std::int64_t i = 0; i < run; ++i)
        std::memcpy(row.data() + static_cast<std::size_t>(i) * sample_bytes, start + i * step, sample_bytes);
      start = row.data();
    }
    use(std::span<const std::byte>(start, static_cast<std::size_t>(run) * sample_bytes));
    std::size_t axis = inner;
    while (axis < axes.size() && ++index[axis] == axes[axis].count) index[axis++] = 0;
    if (axis >= axes.size()) return;
  }
}

} // namespace hyperiso
