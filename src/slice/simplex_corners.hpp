#pragma once
// Corners of the simplices of a mesh.

#include "hyperiso/mesh.hpp"

#include <array>

namespace hyperiso {

// The corners of a simplex in ascending order, and whether that is an even permutation of the order they are
// in.
template <class Index, std::size_t Corners>
struct SortedSimplex {
  std::array<Index, Corners> corners;
  std::array<unsigned, Corners> from;
  bool even = true;

  template <class Stored>
  explicit SortedSimplex(const Stored* simplex) {
    for (std::size_t corner = 0; corner < Corners; ++corner) {
      std::size_t place = corner;
      const auto vertex = static_cast<Index>(simplex[corner]);
      for (; place > 0 && corners[place - 1] > vertex; --place) {
        corners[place] = corners[place - 1];
        from[place] = from[place - 1];
        even = !even;
      }
      corners[place] = vertex;
      from[place] = static_cast<unsigned>(corner);
    }
  }
};

template <int D>
std::array<double, D> position_of(const Mesh& mesh, std::uint64_t vertex) {
  std::array<double, D> position;
  for (std::size_t k = 0; k < D; ++k) position[k] = mesh.positions[vertex * D + k];
  return position;
}

template <std::size_t N>
std::array<double, N - 1> without(const std::array<double, N>& point, int axis) {
  std::array<double, N - 1> rest;
  for (int from = 0, to = 0; from < static_cast<int>(N); ++from)
    if (from != axis) rest[to++] = point[from];
  return rest;
}

} // namespace hyperiso
