#pragma once
// One facet of the convex hull of W+: the midpoints of cube edges on one of its hyperplanes, triangulated.
// What the full tables and tables made on demand have in common.

#include "hyperiso/table.hpp"
#include "table/cube.hpp"
#include "table/exact.hpp"

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace hyperiso {

// The cube edges in the lexicographic order of their midpoints, axis 0 first: the order of placing.
template <int D>
std::array<std::uint8_t, cube_edge_count<D>> edges_in_placing_order();

// The vertices of a simplex of the surface: cube edges.
template <int D>
using EdgeSimplex = std::array<std::uint8_t, D>;

// The placing triangulation (paper 000 Appendix II) of the convex hull of midpoints of cube edges that lie on
// one hyperplane and are given in placing order. Empty if they do not span the hyperplane.
//
// The order in which a table keeps them: the vertices of a simplex are in placing order, but for the last two
// where det[outward; v1-v0; ...] > 0 asks for it; simplices ascend by their vertices' places.
template <int D>
std::vector<EdgeSimplex<D>> triangulate_facet(const IntegerVector<D>& outward,
                                              std::span<const std::uint8_t> edges);

} // namespace hyperiso
