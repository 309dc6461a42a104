#pragma once
// Axes of a grid that a world transform moves; in the writer and in the page.

#include "hyperiso/grid.hpp"

#include <cstddef>
#include <vector>

namespace hyperiso {

// Whether the image of an axis depends on it alone, and nothing else does: time does as a rule.
inline bool stands_alone(const Affine& world, std::size_t axis) {
  const std::size_t D = world.offset.size();
  for (std::size_t other = 0; other < D; ++other)
    if (other != axis && (world.linear[axis * D + other] != 0 || world.linear[other * D + axis] != 0))
      return false;
  return true;
}

// The axis in the world; without samples where the transform mixes it with others.
inline Axis world_axis(Axis axis, const Affine& world, std::size_t number) {
  if (!stands_alone(world, number)) {
    axis.count = 0;
    axis.coordinates.clear();
    return axis;
  }
  const double scale = world.linear[number * world.offset.size() + number], offset = world.offset[number];
  axis.origin = offset + scale * axis.origin;
  axis.spacing *= scale;
  for (double& coordinate : axis.coordinates) coordinate = offset + scale * coordinate;
  return axis;
}

} // namespace hyperiso
