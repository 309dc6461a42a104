#pragma once
// Axes of a grid that a world transform moves; in the writer and in the page.

#include "core/affine.hpp"

namespace hyperiso {

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
