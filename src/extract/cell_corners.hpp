#pragma once
// What a cell holds by each method: the definition that both the plain loops and the engine's tables use.

#include "hyperiso/extract.hpp"
#include "hyperiso/table.hpp"
#include "table/hull_entry.hpp"
#include "table/simplex_cut.hpp"

#include <algorithm>
#include <numeric>
#include <utility>

namespace hyperiso {

// Calls use(edges) with the cube edges of the corners of each simplex, by hull table.
template <int D, class Use>
void with_hull_entry(const LabelSet<D>& labels, Use&& use) {
  if constexpr (D <= 4) {
    use(hull_table<D>().simplices(labels));
  } else {
    HullEntryMaker<D> maker;
    use(maker.make(labels));
  }
}

// Calls use(lower, upper) for the cube vertices that end the edge of each corner of each simplex, given by
// its cube edges.
template <int D, class Use>
void for_each_edge_end(std::span<const std::uint8_t> edges, Use&& use) {
  for (const std::uint8_t edge : edges) {
    const CubeEdge ends = cube_edge_ends<D>(edge);
    use(static_cast<unsigned>(ends.lower), static_cast<unsigned>(ends.lower) | 1u << ends.axis);
  }
}

// The same by hull table.
template <int D, class Use>
void for_each_hull_corner(const LabelSet<D>& labels, Use&& use) {
  with_hull_entry<D>(labels, [&](std::span<const std::uint8_t> edges) { for_each_edge_end<D>(edges, use); });
}

// The same by paper 002: for each connected component of the + vertices, the facets that part it from the
// others of the hull of the midpoints of the edges that leave it.
//
// A hyperplane that carries such a facet has only vertices of that component beyond it, since the vertices of
// a cube in an open half-space are connected. So it is also a facet of the hull of the midpoints and all -
// vertices, and the facets of all components together are those of that hull: of the entry of the opposite
// labels. The midpoints are thought to be moved along their edges to the - side, each far less than the next
// in lexicographic order. That makes the hull of every component simplicial, and cuts its facets as placing
// the points in that order does; it depends on the midpoints only, so neighbours agree.
template <int D, class Use>
void for_each_component_corner(const LabelSet<D>& labels, Use&& use) {
  constexpr auto all = static_cast<LabelSet<D>>(((LabelSet<D>{1} << ((1 << D) - 1)) << 1) - 1);
  with_hull_entry<D>(labels ^ all, [&](std::span<const std::uint8_t> edges) {
    std::array<std::uint8_t, D> simplex;
    for (; !edges.empty(); edges = edges.subspan(D)) {
      std::copy_n(edges.begin(), D, simplex.begin());
      std::swap(simplex[0], simplex[1]);
      for_each_edge_end<D>(simplex, use);
    }
  });
}

// The same for the cuts of the D! Kuhn simplices, each along a monotone path from vertex 0 to the last, in
// the lexicographic order of their permutations of the axes. Samples ascend along every path, so the
// staircases of neighbours agree.
template <int D, class Use>
void for_each_simplicial_corner(const LabelSet<D>& labels, Use&& use) {
  std::array<int, D> axes;
  std::iota(axes.begin(), axes.end(), 0);
  do {
    std::array<unsigned, D + 1> path{};
    unsigned positive = label_of<D>(labels, 0);
    for (int step = 0; step < D; ++step) {
      path[step + 1] = path[step] | 1u << axes[step];
      positive |= static_cast<unsigned>(label_of<D>(labels, path[step + 1])) << (step + 1);
    }
    unsigned inversions = 0;
    for (int i = 0; i < D; ++i)
      for (int j = 0; j < i; ++j) inversions += axes[j] > axes[i];
    for (auto simplex : simplex_cut<D>().simplices(positive)) {
      if (inversions % 2 == 1) std::swap(simplex[0], simplex[1]); // a path turned inside out
      for (const CornerPair pair : simplex) use(path[pair.lower], path[pair.upper]);
    }
  } while (std::ranges::next_permutation(axes).found);
}

// The dimensions up to which each method works.
constexpr int highest_hull_dimension = 6, highest_simplicial_dimension = 8;

// The same by any of these methods, in the dimensions that it has: D calls for each simplex of the cell,
// oriented for axes that all increase.
template <int D, class Use>
void for_each_cell_corner(Method method, const LabelSet<D>& labels, Use&& use) {
  if constexpr (D <= highest_hull_dimension) {
    if (method == Method::hull) return for_each_hull_corner<D>(labels, use);
    if (method == Method::component) return for_each_component_corner<D>(labels, use);
  }
  for_each_simplicial_corner<D>(labels, use);
}

} // namespace hyperiso
