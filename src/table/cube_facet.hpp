#pragma once
// The facets of the cube, as cubes of one dimension less.

#include "hyperiso/table.hpp"

#include <array>
#include <cstddef>
#include <cstdint>

namespace hyperiso {

// The facet of the cube on which the coordinate along `axis` is `side`.
template <int D>
struct CubeFacet {
  int axis, side;

  bool contains(int edge) const {
    const CubeEdge ends = cube_edge_ends<D>(edge);
    return ends.axis != axis && (ends.lower >> axis & 1) == side;
  }
  // The number of an edge on the (D-1)-cube of the other axes, and back.
  std::uint8_t edge_within(int edge) const {
    const CubeEdge ends = cube_edge_ends<D>(edge);
    const int lower = (ends.lower >> (axis + 1) << axis) | (ends.lower & ((1 << axis) - 1));
    return static_cast<std::uint8_t>(cube_edge<D - 1>(lower, ends.axis - (ends.axis > axis)));
  }
  std::uint8_t edge_of_cube(int edge_within) const {
    const CubeEdge ends = cube_edge_ends<D - 1>(edge_within);
    return static_cast<std::uint8_t>(
        cube_edge<D>(vertex_of_cube(ends.lower), ends.axis + (ends.axis >= axis)));
  }
  LabelSet<D - 1> labels_within(LabelSet<D> labels) const {
    LabelSet<D - 1> within = 0;
    for (int vertex = 0; vertex < 1 << (D - 1); ++vertex)
      within |= static_cast<LabelSet<D - 1>>(labels >> vertex_of_cube(vertex) & 1) << vertex;
    return within;
  }
  // W+ lies on the inner side of the surface and of the cube facet, so the surface's boundary runs against
  // the boundary of the part of the facet in W+; and the other axes, in their order, are oriented as the
  // boundary of the cube or not.
  bool trace_keeps_orientation() const { return (axis + side) % 2 == 0; }

 private:
  int vertex_of_cube(int vertex_within) const {
    return (vertex_within >> axis << (axis + 1)) | side << axis | (vertex_within & ((1 << axis) - 1));
  }
};

template <int D>
constexpr std::array<CubeFacet<D>, 2 * D> cube_facets = [] {
  std::array<CubeFacet<D>, 2 * D> facets{};
  for (std::size_t i = 0; i < facets.size(); ++i)
    facets[i] = {static_cast<int>(i) / 2, static_cast<int>(i) % 2};
  return facets;
}();

} // namespace hyperiso
