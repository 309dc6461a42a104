#include "table/verify.hpp"

#include "table/cube.hpp"
#include "table/cube_facet.hpp"
#include "table/hull_facet.hpp"

#include <algorithm>
#include <bit>
#include <compare>
#include <utility>
#include <vector>

namespace hyperiso {

namespace {

using EdgeSet = std::uint32_t; // bit e: cube edge e; also the vertices of a face of the surface

template <int D>
CubeLabels ends_of_all(EdgeSet edges) {
  CubeLabels ends = 0;
  for (; edges != 0; edges &= edges - 1) ends |= ends_of<D>(std::countr_zero(edges));
  return ends;
}

template <int D>
EdgeSet crossed_edges(CubeLabels labels) {
  EdgeSet crossed = 0;
  for (int edge = 0; edge < cube_edge_count<D>; ++edge)
    if (std::popcount(labels & ends_of<D>(edge)) == 1) crossed |= bit(edge);
  return crossed;
}

template <int D>
std::vector<EdgeSimplex<D>> split_simplices(std::span<const std::uint8_t> edges) {
  std::vector<EdgeSimplex<D>> simplices(edges.size() / D);
  for (std::size_t i = 0; i < edges.size(); ++i) simplices[i / D][i % D] = edges[i];
  return simplices;
}

template <std::size_t N>
EdgeSet edge_set(const std::array<std::uint8_t, N>& edges) {
  EdgeSet set = 0;
  for (const int edge : edges) set |= bit(edge);
  return set;
}

// An oriented simplex as a sorted list of vertices and a sign.
template <std::size_t N>
struct OrientedFace {
  std::array<std::uint8_t, N> vertices;
  bool positive;

  OrientedFace(const std::array<std::uint8_t, N>& vertices_, bool positive_)
      : vertices(vertices_), positive(positive_) {
    for (std::size_t i = 1; i < N; ++i)
      for (std::size_t j = i; j > 0 && vertices[j] < vertices[j - 1]; --j) {
        std::swap(vertices[j], vertices[j - 1]);
        positive = !positive;
      }
  }
  friend auto operator<=>(const OrientedFace&, const OrientedFace&) = default;
};

template <int D>
using Faces = std::vector<OrientedFace<D - 1>>;

// The (D-2)-faces of all simplices, each as often as it occurs, with the orientation that they induce,
// sorted.
template <int D>
Faces<D> oriented_faces(const std::vector<EdgeSimplex<D>>& simplices) {
  Faces<D> faces;
  for (const EdgeSimplex<D>& simplex : simplices)
    for (std::size_t left_out = 0; left_out < D; ++left_out) {
      std::array<std::uint8_t, D - 1> face;
      std::copy_n(simplex.begin(), left_out, face.begin());
      std::copy(simplex.begin() + left_out + 1, simplex.end(), face.begin() + left_out);
      faces.emplace_back(face, left_out % 2 == 0);
    }
  std::sort(faces.begin(), faces.end());
  return faces;
}

// The edges of each facet of the cube.
template <int D>
const std::array<EdgeSet, 2 * D>& edges_of_facets() {
  static const auto edges = [] {
    std::array<EdgeSet, 2 * D> sets{};
    for (std::size_t facet = 0; facet < sets.size(); ++facet)
      for (int edge = 0; edge < cube_edge_count<D>; ++edge)
        if (cube_facets<D>[facet].contains(edge)) sets[facet] |= bit(edge);
    return sets;
  }();
  return edges;
}

// The entry of the (D-1)-table as oriented faces; on an edge, a point that is + if the edge runs from + to -.
template <int D>
Faces<D> lower_entry(CubeLabels labels) {
  Faces<D> faces;
  if constexpr (D == 2) {
    if (labels == 1 || labels == 2) faces.emplace_back(std::array<std::uint8_t, 1>{0}, labels == 1);
  } else {
    for (const auto& simplex : split_simplices<D - 1>(hull_table<D - 1>().simplices(labels)))
      faces.emplace_back(simplex, true);
  }
  return faces;
}

template <int D>
void verify_restriction(CubeLabels labels, const Faces<D>& faces, TableVerification& counts) {
  for (std::size_t i = 0; i < cube_facets<D>.size(); ++i) {
    const CubeFacet<D>& facet = cube_facets<D>[i];
    Faces<D> trace, expected = lower_entry<D>(facet.labels_within(labels));
    for (OrientedFace<D - 1> face : faces) {
      if (edge_set(face.vertices) & ~edges_of_facets<D>()[i]) continue;
      for (std::uint8_t& vertex : face.vertices) vertex = facet.edge_within(vertex);
      trace.emplace_back(face.vertices, face.positive == facet.trace_keeps_orientation());
    }
    std::sort(trace.begin(), trace.end());
    std::sort(expected.begin(), expected.end());
    ++counts.facet_checks;
    counts.facet_mismatches += trace != expected;
  }
}

template <int D>
void verify_interior_faces(const Faces<D>& faces, TableVerification& counts) {
  for (std::size_t begin = 0, end; begin < faces.size(); begin = end) {
    for (end = begin + 1; end < faces.size() && faces[end].vertices == faces[begin].vertices;) ++end;
    const EdgeSet face = edge_set(faces[begin].vertices);
    if (std::ranges::any_of(edges_of_facets<D>(), [&](EdgeSet edges) { return (face & ~edges) == 0; }))
      continue;
    ++counts.interior_faces;
    counts.manifold_failures += end - begin != 2 || faces[begin].positive == faces[begin + 1].positive;
  }
}

EdgeSet union_of(std::span<const EdgeSet> sets) {
  EdgeSet all = 0;
  for (const EdgeSet set : sets) all |= set;
  return all;
}

// All faces of all dimensions, each once.
std::vector<EdgeSet> all_faces(std::span<const EdgeSet> simplices) {
  std::vector<EdgeSet> faces;
  for (const EdgeSet simplex : simplices)
    for (EdgeSet face = simplex; face != 0; face = (face - 1) & simplex) faces.push_back(face);
  std::sort(faces.begin(), faces.end());
  faces.erase(std::unique(faces.begin(), faces.end()), faces.end());
  return faces;
}

std::vector<EdgeSet> link_of(int vertex, std::span<const EdgeSet> simplices) {
  std::vector<EdgeSet> link;
  for (const EdgeSet simplex : simplices)
    if (simplex & bit(vertex)) link.push_back(simplex ^ bit(vertex));
  return link;
}

bool is_connected(std::span<const EdgeSet> simplices) {
  EdgeSet reached = simplices[0], before = 0;
  while (reached != before) {
    before = reached;
    for (const EdgeSet simplex : simplices)
      if (simplex & reached) reached |= simplex;
  }
  return reached == union_of(simplices);
}

enum class Shape { ball, sphere, neither };

// Curves and surfaces are known by their vertex links, connectedness and Euler characteristic.
template <int Dimension>
Shape shape_of(std::span<const EdgeSet> simplices) {
  static_assert(Dimension <= 2, "3-manifolds are not known by these invariants");
  if constexpr (Dimension == 0) {
    if (simplices.size() == 1) return Shape::ball;
    return simplices.size() == 2 && simplices[0] != simplices[1] ? Shape::sphere : Shape::neither;
  } else {
    bool has_boundary = false;
    for (EdgeSet rest = union_of(simplices); rest != 0; rest &= rest - 1) {
      const Shape link = shape_of<Dimension - 1>(link_of(std::countr_zero(rest), simplices));
      if (link == Shape::neither) return Shape::neither;
      has_boundary |= link == Shape::ball;
    }
    int euler_characteristic = 0;
    for (const EdgeSet face : all_faces(simplices))
      euler_characteristic += std::popcount(face) % 2 == 1 ? 1 : -1;
    const int expected = has_boundary ? 1 : Dimension == 1 ? 0 : 2;
    if (euler_characteristic != expected || !is_connected(simplices)) return Shape::neither;
    return has_boundary ? Shape::ball : Shape::sphere;
  }
}

template <int D>
void verify_vertex_links(std::span<const EdgeSet> simplices, TableVerification& counts) {
  for (EdgeSet rest = union_of(simplices); rest != 0; rest &= rest - 1) {
    ++counts.vertex_links;
    counts.vertex_link_failures += shape_of<D - 2>(link_of(std::countr_zero(rest), simplices)) != Shape::ball;
  }
}

// With all vertices at the midpoints of their edges.
template <int D>
void verify_orientation(CubeLabels labels, const std::vector<EdgeSimplex<D>>& simplices,
                        TableVerification& counts) {
  for (const EdgeSimplex<D>& simplex : simplices) {
    std::array<IntegerVector<D>, D - 1> sides;
    for (std::size_t i = 1; i < D; ++i)
      sides[i - 1] = difference(edge_midpoint<D>(simplex[i]), edge_midpoint<D>(simplex[0]));
    const IntegerVector<D> normal = cross_product<D>(sides);
    for (const int edge : simplex) {
      const auto [lower, axis] = cube_edge_ends<D>(edge);
      const std::int64_t rise = normal[static_cast<std::size_t>(axis)];
      ++counts.orientation_checks;
      counts.orientation_failures += labels >> lower & 1 ? rise <= 0 : rise >= 0;
    }
  }
}

// Two disjoint faces meet for some interpolants iff the relative interiors of the hulls of the cube vertices
// that end their edges meet: all points of these come from interpolants strictly within their edges. Where
// faces of more than D + 2 vertices together meet, their vertices' affine dependence is a sum of smaller ones
// of the same signs, so that faces of theirs meet which have no more.
template <int D>
void verify_embedding(const VertexHulls<D>& hulls, std::span<const EdgeSet> simplices,
                      TableVerification& counts) {
  struct Face {
    EdgeSet vertices;
    int size;
    typename VertexHulls<D>::Sides sides;
  };
  std::vector<Face> faces;
  for (const EdgeSet face : all_faces(simplices))
    faces.push_back({face, std::popcount(face), hulls.sides(ends_of_all<D>(face))});
  for (std::size_t i = 0; i < faces.size(); ++i)
    for (std::size_t j = 0; j < i; ++j) {
      if (faces[i].vertices & faces[j].vertices || faces[i].size + faces[j].size > D + 2) continue;
      ++counts.face_pairs;
      counts.face_intersections += VertexHulls<D>::meet(faces[i].sides, faces[j].sides);
    }
}

} // namespace

template <int D>
void EntryVerifier<D>::verify(CubeLabels labels, std::span<const std::uint8_t> edges,
                              TableVerification& counts) {
  const std::vector<EdgeSimplex<D>> simplices = split_simplices<D>(edges);
  const Faces<D> faces = oriented_faces<D>(simplices);
  std::vector<EdgeSet> simplex_sets;
  for (const EdgeSimplex<D>& simplex : simplices) simplex_sets.push_back(edge_set(simplex));

  ++counts.entries;
  counts.edge_use_failures += union_of(simplex_sets) != crossed_edges<D>(labels);
  verify_restriction<D>(labels, faces, counts);
  verify_interior_faces<D>(faces, counts);
  verify_vertex_links<D>(simplex_sets, counts);
  verify_orientation<D>(labels, simplices, counts);
  verify_embedding<D>(hulls_, simplex_sets, counts);
}

template <int D>
TableVerification verify_hull_table(const HullTable<D>& table) {
  EntryVerifier<D> verifier;
  TableVerification counts;
  for (std::size_t labels = 0; labels < HullTable<D>::entries; ++labels)
    verifier.verify(static_cast<CubeLabels>(labels), table.simplices(static_cast<CubeLabels>(labels)),
                    counts);
  return counts;
}

template class EntryVerifier<2>;
template class EntryVerifier<3>;
template class EntryVerifier<4>;
template TableVerification verify_hull_table<2>(const HullTable<2>&);
template TableVerification verify_hull_table<3>(const HullTable<3>&);
template TableVerification verify_hull_table<4>(const HullTable<4>&);

} // namespace hyperiso
