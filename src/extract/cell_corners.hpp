#pragma once
// What a cell holds by each method: the definition that both the reference loop and the engine's tables use.

#include "hyperiso/extract.hpp"
#include "hyperiso/table.hpp"
#include "table/simplex_cut.hpp"

#include <algorithm>
#include <numeric>

namespace hyperiso {

// Calls use(lower, upper) for the cube vertices that end the edge of each corner of each simplex, by hull
// table.
template <int D, class Use>
void for_each_hull_corner(CubeLabels labels, Use&& use) {
  for (const std::uint8_t edge : hull_table<D>().simplices(labels)) {
    const CubeEdge ends = cube_edge_ends<D>(edge);
    use(static_cast<unsigned>(ends.lower), static_cast<unsigned>(ends.lower) | 1u << ends.axis);
  }
}

// The same for the cuts of the D! Kuhn simplices, each along a monotone path from vertex 0 to the last, in
// the lexicographic order of their permutations of the axes. Samples ascend along every path, so the
// staircases of neighbours agree.
template <int D, class Use>
void for_each_simplicial_corner(CubeLabels labels, Use&& use) {
  std::array<int, D> axes;
  std::iota(axes.begin(), axes.end(), 0);
  do {
    std::array<unsigned, D + 1> path{};
    unsigned positive = labels & 1;
    for (int step = 0; step < D; ++step) {
      path[step + 1] = path[step] | 1u << axes[step];
      positive |= (labels >> path[step + 1] & 1) << (step + 1);
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

// The same by `method`: D calls for each simplex of the cell, oriented for axes that all increase.
template <int D, class Use>
void for_each_cell_corner(Method method, CubeLabels labels, Use&& use) {
  if (method == Method::hull)
    for_each_hull_corner<D>(labels, use);
  else
    for_each_simplicial_corner<D>(labels, use);
}

} // namespace hyperiso
