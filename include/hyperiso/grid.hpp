#pragma once
/// \file
/// Where the samples of a field lie.

#include <array>
#include <cstdint>
#include <string>
#include <vector>

namespace hyperiso {

/// One axis of a grid: evenly spaced, or with a coordinate for every sample (rectilinear).
struct Axis {
  std::int64_t count = 0; ///< samples along the axis
  std::int64_t first = 0; ///< number of sample 0 on the grid this one was cropped from
  double origin = 0;      ///< coordinate of that grid's sample 0
  double spacing = 1;     ///< not 0; negative where coordinates fall with the index
  std::vector<double> coordinates =
      {};                ///< empty, or `count` strictly monotone coordinates that replace the above
  std::string name = {}; ///< "x", "y", "z", "t", ... ; empty if unknown
  std::string unit = {}; ///< "mm", "s", ... ; empty if unknown

  /// Coordinate of sample `index`. A crop of an axis gives the same bits as the whole axis.
  double coordinate(std::int64_t index) const {
    return coordinates.empty() ? origin + static_cast<double>(first + index) * spacing
                               : coordinates[static_cast<std::size_t>(index)];
  }
  bool increasing() const { return coordinates.size() < 2 ? spacing > 0 : coordinates[1] > coordinates[0]; }
  /// The same axis, samples [begin, end) only. Requires 0 <= begin <= end <= count.
  Axis cropped(std::int64_t begin, std::int64_t end) const;
};

/// An affine map of the axis coordinates of a D-dimensional grid to world coordinates:
/// `world = linear * axis + offset`. Fields carry it as it stands in their file; `transform` in mesh.hpp
/// applies it to a finished mesh. Samples are never moved.
struct Affine {
  std::vector<double> linear; ///< D rows of D, invertible
  std::vector<double> offset; ///< D
};

/// A regular grid of samples in R^D. Axis 0 varies fastest in the order of samples.
template <int D>
struct Grid {
  std::array<Axis, D> axes;

  std::int64_t samples() const {
    std::int64_t product = 1;
    for (const Axis& axis : axes) product *= axis.count;
    return product;
  }
};

/// The samples on the two ends of a grid edge differ along the axes in `direction` (bit k: axis k); the edge
/// ends at its upper sample. A cube edge has one bit, a Kuhn edge one or more.
///
/// Number of the edge: ((row << D) | direction) * dims[0] + x, where x and row = (sample - x) / dims[0]
/// belong to the upper sample. Ascending numbers follow the order of the samples, so the vertices of a mesh
/// keep their order when a slab of the field is extracted instead of the whole.
using GridEdge = std::uint64_t;

template <int D>
struct GridEdgeEnds {
  std::array<std::int64_t, D> lower, upper; ///< indices of the two samples
  unsigned direction;
};

template <int D>
GridEdge grid_edge(const std::array<std::int64_t, D>& dims, const std::array<std::int64_t, D>& upper,
                   unsigned direction) {
  std::int64_t row = 0;
  for (int axis = D - 1; axis > 0; --axis) row = row * dims[axis] + upper[axis];
  const auto row_and_direction = (static_cast<std::uint64_t>(row) << D) | direction;
  return row_and_direction * static_cast<std::uint64_t>(dims[0]) + static_cast<std::uint64_t>(upper[0]);
}

template <int D>
GridEdgeEnds<D> grid_edge_ends(const std::array<std::int64_t, D>& dims, GridEdge edge) {
  GridEdgeEnds<D> ends{};
  const auto nx = static_cast<std::uint64_t>(dims[0]);
  ends.upper[0] = static_cast<std::int64_t>(edge % nx);
  const std::uint64_t row_and_direction = edge / nx;
  ends.direction = static_cast<unsigned>(row_and_direction & ((1u << D) - 1));
  auto row = static_cast<std::int64_t>(row_and_direction >> D);
  for (int axis = 1; axis < D; ++axis) {
    ends.upper[axis] = row % dims[axis];
    row /= dims[axis];
  }
  for (int axis = 0; axis < D; ++axis) ends.lower[axis] = ends.upper[axis] - (ends.direction >> axis & 1);
  return ends;
}

} // namespace hyperiso
