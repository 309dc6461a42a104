#pragma once
// Vertices and edges of the cube, as points and as sets.

#include "hyperiso/table.hpp"
#include "table/exact.hpp"

#include <cstddef>
#include <cstdint>

namespace hyperiso {

// Points of the cube in doubled coordinates: vertices have coordinates 0 and 2, midpoints of edges one 1.
template <int D>
constexpr IntegerVector<D> cube_vertex(int vertex) {
  IntegerVector<D> point;
  for (std::size_t axis = 0; axis < D; ++axis) point[axis] = 2 * (vertex >> axis & 1);
  return point;
}
template <int D>
constexpr IntegerVector<D> edge_midpoint(int edge) {
  const auto [lower, axis] = cube_edge_ends<D>(edge);
  IntegerVector<D> point = cube_vertex<D>(lower);
  point[static_cast<std::size_t>(axis)] = 1;
  return point;
}

constexpr std::uint32_t bit(int i) { return std::uint32_t{1} << i; }

// The two vertices of an edge as a set.
template <int D>
constexpr CubeLabels ends_of(int edge) {
  const auto [lower, axis] = cube_edge_ends<D>(edge);
  return bit(lower) | bit(lower | 1 << axis);
}

} // namespace hyperiso
