#pragma once
/// \file
/// Lookup tables: the labels of a cube's vertices -> the simplices of the isosurface inside it.
/// A table never sees a field; it is generated in exact integer arithmetic in the process that uses it.

#include <array>
#include <bitset>
#include <cstdint>
#include <span>
#include <type_traits>
#include <vector>

namespace hyperiso {

/// The + and - labels of the 2^D vertices of a D-cube: bit i set iff vertex i is +. Vertex i stands at
/// coordinate (bit k of i) along axis k.
using CubeLabels = std::uint32_t; ///< D <= 5
template <int D>
using LabelSet =
    std::conditional_t<(D <= 5), CubeLabels,
                       std::conditional_t<D == 6, std::uint64_t, std::bitset<(std::size_t{1} << D)>>>;
template <int D>
bool label_of(const LabelSet<D>& labels, unsigned vertex) {
  if constexpr (D <= 6)
    return labels >> vertex & 1;
  else
    return labels[vertex];
}

/// Number of the cube edge along `axis` whose lower vertex is `lower` (bit `axis` of it is 0).
template <int D>
constexpr int cube_edge(int lower, int axis) {
  return (axis << (D - 1)) | (lower >> (axis + 1) << axis) | (lower & ((1 << axis) - 1));
}
template <int D>
constexpr int cube_edge_count = D << (D - 1);

struct CubeEdge {
  int lower; ///< vertex
  int axis;
};
template <int D>
constexpr CubeEdge cube_edge_ends(int edge) {
  const int axis = edge >> (D - 1);
  const int rest = edge & ((1 << (D - 1)) - 1);
  return {(rest >> axis << (axis + 1)) | (rest & ((1 << axis) - 1)), axis};
}

/// The table of paper 000 section 2.1 for D = 2, 3, 4: for each labelling L, the facets of the convex hull of
/// W+(L) (the + vertices and the midpoints of the crossed edges) that do not lie on the boundary of the cube,
/// each triangulated by placing its points in lexicographic order (axis 0 first).
///
/// Guarantees (recomputed by `verify_hull_table`): used edges = crossed edges; the trace of an entry on a
/// facet of the cube is the entry of the (D-1)-table for that facet's labels, so that neighbours always
/// match; each entry is a manifold with boundary on the boundary of the cube; normals point from + to -.
template <int D>
class HullTable {
 public:
  /// Generates the table: exact, about 30 ms for D = 4 on one core.
  HullTable();

  /// The simplices of one entry: D cube edge numbers each, oriented so that det[n; v1-v0; ...] > 0 for a
  /// normal n that points from + to -. Always in the same order: facets ascend by their outward normals
  /// (coprime integers, axis 0 first), the simplices of a facet by their vertices in lexicographic order; a
  /// simplex lists its vertices in that order too, but for the last two where its orientation asks for it.
  std::span<const std::uint8_t> simplices(CubeLabels labels) const {
    return std::span(edges_).subspan(first_[labels], first_[labels + 1] - first_[labels]);
  }
  std::size_t simplex_count(CubeLabels labels) const { return simplices(labels).size() / D; }

  static constexpr std::size_t entries = std::size_t{1} << (1 << D);

 private:
  std::vector<std::uint32_t> first_; ///< entries + 1 positions in edges_
  std::vector<std::uint8_t> edges_;
};

/// The table, generated at the first call in the process; thread-safe, immutable.
template <int D>
const HullTable<D>& hull_table();

/// What `verify_hull_table` counted; every `..._failures` and `..._mismatches` must be 0.
struct TableVerification {
  std::uint64_t entries = 0;
  std::uint64_t facet_checks = 0; ///< entries x 2D cube facets, each compared with the (D-1)-table
  std::uint64_t facet_mismatches = 0;
  std::uint64_t interior_faces = 0;    ///< (D-2)-faces inside the cube
  std::uint64_t manifold_failures = 0; ///< of those, not in exactly two simplices with opposite orientation
  std::uint64_t vertex_links = 0;      ///< links of entry vertices
  std::uint64_t vertex_link_failures = 0; ///< links that are not a ball
  std::uint64_t edge_use_failures = 0;    ///< entries whose used edges differ from their crossed edges
  std::uint64_t orientation_checks = 0;   ///< (simplex, its edges): normal along the edge from + to -
  std::uint64_t orientation_failures = 0;
  std::uint64_t face_pairs = 0; ///< pairs of disjoint faces of an entry, of at most D+2 vertices together
  std::uint64_t face_intersections = 0; ///< pairs that meet for some interpolants strictly within their edges
};

/// Recomputes the guarantees of a table from its simplices alone (docs/tables.md); some 3 s for D = 4.
template <int D>
TableVerification verify_hull_table(const HullTable<D>& table);

} // namespace hyperiso
