#pragma once
// The cut of a simplex between its + and its - corners by recursive contour meshing (Weigle and Banks,
// Complex-valued contour meshing, Visualization 1996), the way of the baseline that papers 000 and 004
// compare with.

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace hyperiso {

// For a K-simplex (K = 2..5) and a label for each of its corners 0..K: the (K-1)-simplices of a surface that
// parts the + from the - corners.
//
// The surface in a face of the simplex is a point on an edge, a simplex where one corner differs from all
// others, and else the cone over the surfaces in its facets, from a new point in the middle. A face alone
// decides on its surface, so simplices that share one agree. A tetrahedron gets up to 4 triangles, a
// 4-simplex up to 14 tetrahedra (5 facets, of which 3 have 4 triangles each).
//
// Orientation as in simplex_cut.hpp.
template <int K>
class MidpointCut {
 public:
  // A vertex is named by the corners of the face that it belongs to: the point on an edge, or the middle of
  // the surface in a larger face.
  using Vertex = std::uint8_t; // bit i: corner i
  using Simplex = std::array<Vertex, K>;

  MidpointCut();

  // Bit i of `positive`: corner i is +. Empty if all are alike.
  std::span<const Simplex> simplices(unsigned positive) const { return simplices_[positive]; }

 private:
  std::array<std::vector<Simplex>, 1u << (K + 1)> simplices_;
};

// The table, built at the first call in the process; thread-safe, immutable.
template <int K>
const MidpointCut<K>& midpoint_cut();

} // namespace hyperiso
