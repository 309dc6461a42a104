// The full tables, made hyperplane by hyperplane instead of labelling by labelling: in 4D, 65,536 hulls share
// 9,272 facets on 600 hyperplanes.
#include "hyperiso/table.hpp"

#include "table/cube.hpp"
#include "table/half_space.hpp"
#include "table/hull_facet.hpp"

#include <algorithm>
#include <cstdint>
#include <numeric>
#include <span>
#include <utility>
#include <vector>

namespace hyperiso {

namespace {

// Both half-spaces of every hyperplane that can carry a facet of the surface, sorted. The hull of W+ contains
// a neighbourhood in the cube of each of its + vertices, so such a facet has midpoints only, and they span
// it.
template <int D>
std::vector<HalfSpace<D>> candidate_half_spaces() {
  std::vector<IntegerVector<D>> midpoints;
  for (int edge = 0; edge < cube_edge_count<D>; ++edge) midpoints.push_back(edge_midpoint<D>(edge));
  std::vector<HalfSpace<D>> half_spaces = spanned_hyperplanes<D>(midpoints);
  for (std::size_t i = half_spaces.size(); i-- > 0;) half_spaces.push_back(half_spaces[i].opposite());
  std::sort(half_spaces.begin(), half_spaces.end());
  return half_spaces;
}

// The labellings whose W+ a half-space contains, and the midpoints that it then may touch.
template <int D>
struct Support {
  struct Touch {
    std::uint8_t edge;
    CubeLabels inner; // the bit of the edge's end inside; the edge is crossed iff it is +
  };
  CubeLabels negative = 0;    // vertices that must be -
  CubeLabels touching = 0;    // inner ends of the edges touched
  std::vector<Touch> touches; // in placing order

  Support(const HalfSpace<D>& half_space, std::span<const std::uint8_t> placing_order) {
    // A + vertex on the hyperplane would make it one of the cube's own facets.
    for (int vertex = 0; vertex < 1 << D; ++vertex)
      if (half_space.height(cube_vertex<D>(vertex)) >= 0) negative |= bit(vertex);
    for (const std::uint8_t edge : placing_order)
      if (half_space.height(edge_midpoint<D>(edge)) > 0) negative |= ends_of<D>(edge);
    for (const std::uint8_t edge : placing_order) {
      const CubeLabels inner = ends_of<D>(edge) & ~negative;
      if (half_space.height(edge_midpoint<D>(edge)) != 0 || inner == 0) continue;
      touches.push_back({edge, inner});
      touching |= inner;
    }
  }
};

// Calls `use` with every subset of `set`.
template <class Use>
void for_each_subset(CubeLabels set, Use&& use) {
  CubeLabels subset = 0;
  do {
    use(subset);
    subset = (subset - set) & set;
  } while (subset != 0);
}

// A facet and the labellings that have it: + on `positive`, anything on `free`, - elsewhere.
template <int D>
struct Facet {
  CubeLabels positive, free;
  std::vector<EdgeSimplex<D>> simplices;
};

// All facets of all labellings, ascending by their half-spaces.
template <int D>
std::vector<Facet<D>> all_facets() {
  constexpr auto all = static_cast<CubeLabels>((std::uint64_t{1} << (1 << D)) - 1);
  const auto placing_order = edges_in_placing_order<D>();
  std::vector<Facet<D>> facets;
  std::vector<std::uint8_t> crossed;
  for (const HalfSpace<D>& half_space : candidate_half_spaces<D>()) {
    const Support<D> support(half_space, placing_order);
    const CubeLabels free = all & ~support.negative & ~support.touching;
    for_each_subset(support.touching, [&](CubeLabels positive) {
      crossed.clear();
      for (const auto& touch : support.touches)
        if (touch.inner & positive) crossed.push_back(touch.edge);
      if (crossed.size() < D) return;
      auto simplices = triangulate_facet<D>(half_space.outward, crossed);
      if (!simplices.empty()) facets.push_back({positive, free, std::move(simplices)});
    });
  }
  return facets;
}

} // namespace

template <int D>
HullTable<D>::HullTable() : first_(entries + 1, 0) {
  const std::vector<Facet<D>> facets = all_facets<D>();
  for (const Facet<D>& facet : facets)
    for_each_subset(facet.free, [&](CubeLabels others) {
      first_[(facet.positive | others) + 1] += static_cast<std::uint32_t>(facet.simplices.size() * D);
    });
  std::partial_sum(first_.begin(), first_.end(), first_.begin());
  edges_.resize(first_.back());
  std::vector<std::uint32_t> next(first_.begin(), first_.end() - 1);
  for (const Facet<D>& facet : facets)
    for_each_subset(facet.free, [&](CubeLabels others) {
      std::uint32_t& position = next[facet.positive | others];
      for (const EdgeSimplex<D>& simplex : facet.simplices) {
        std::copy(simplex.begin(), simplex.end(), edges_.begin() + position);
        position += D;
      }
    });
}

template <int D>
const HullTable<D>& hull_table() {
  static const HullTable<D> table;
  return table;
}

template class HullTable<2>;
template class HullTable<3>;
template class HullTable<4>;
template const HullTable<2>& hull_table<2>();
template const HullTable<3>& hull_table<3>();
template const HullTable<4>& hull_table<4>();

} // namespace hyperiso
