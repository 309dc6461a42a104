#pragma once
// Cells of a grid and their edges.

#include "hyperiso/grid.hpp"

namespace hyperiso {

// The sample at a corner of the cell whose lowest one is `cell`; bit k of `corner`: the upper one along axis
// k.
template <std::size_t D>
std::array<std::int64_t, D> corner_of(std::array<std::int64_t, D> cell, unsigned corner) {
  for (std::size_t axis = 0; axis < D; ++axis) cell[axis] += corner >> axis & 1;
  return cell;
}

// The point so much of the way from the lower end of an edge to the upper one.
template <int D>
std::array<double, D> point_between(const Grid<D>& grid, const GridEdgeEnds<D>& ends, double weight) {
  std::array<double, D> point;
  for (int axis = 0; axis < D; ++axis) {
    const double lower = grid.axes[axis].coordinate(ends.lower[axis]);
    const double upper = grid.axes[axis].coordinate(ends.upper[axis]);
    point[axis] = ends.direction >> axis & 1 ? lower + weight * (upper - lower) : lower;
  }
  return point;
}

} // namespace hyperiso
