#pragma once
// Maps from the axes of a grid to the world.

#include "hyperiso/grid.hpp"

#include <cstddef>

namespace hyperiso {

// Whether the image of an axis depends on it alone, and nothing else does: time does as a rule.
inline bool stands_alone(const Affine& map, std::size_t axis) {
  const std::size_t D = map.offset.size();
  for (std::size_t other = 0; other < D; ++other)
    if (other != axis && (map.linear[axis * D + other] != 0 || map.linear[other * D + axis] != 0))
      return false;
  return true;
}

} // namespace hyperiso
