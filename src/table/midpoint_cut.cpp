#include "table/midpoint_cut.hpp"

#include <algorithm>
#include <bit>
#include <utility>

namespace hyperiso {

namespace {

struct OrientedSimplex {
  std::vector<std::uint8_t> vertices;
  bool positive;
};

// The surface in one face, whose boundary is the sum over its corners i of (-1)^(i+1) times the surface in
// the facet opposite (see simplex_cut.hpp).
std::vector<OrientedSimplex> surface_in(unsigned face, unsigned positive) {
  const int inside = std::popcount(face & positive), outside = std::popcount(face & ~positive);
  if (inside == 0 || outside == 0) return {};
  if (inside + outside == 2) // from + to -, or against it
    return {{{static_cast<std::uint8_t>(face)}, (positive >> std::countr_zero(face) & 1) == 1}};
  const bool has_middle = inside > 1 && outside > 1;
  std::vector<OrientedSimplex> surface;
  bool even_place = true;
  for (unsigned rest = face; rest != 0; rest &= rest - 1, even_place = !even_place) {
    const unsigned corner = rest & (~rest + 1);
    for (OrientedSimplex& simplex : surface_in(face ^ corner, positive)) {
      // Without a middle, all but one corner have an edge to that one; the first of these is the apex.
      const unsigned apex = has_middle ? face : corner | (inside == 1 ? face & positive : face & ~positive);
      simplex.vertices.insert(simplex.vertices.begin(), static_cast<std::uint8_t>(apex));
      simplex.positive = simplex.positive != even_place;
      surface.push_back(std::move(simplex));
    }
    if (!has_middle && !surface.empty()) break;
  }
  return surface;
}

} // namespace

template <int K>
MidpointCut<K>::MidpointCut() {
  for (unsigned positive = 0; positive < simplices_.size(); ++positive)
    for (OrientedSimplex& oriented : surface_in(simplices_.size() - 1, positive)) {
      if (!oriented.positive) std::swap(oriented.vertices[K - 2], oriented.vertices[K - 1]);
      std::copy_n(oriented.vertices.begin(), K, simplices_[positive].emplace_back().begin());
    }
}

template <int K>
const MidpointCut<K>& midpoint_cut() {
  static const MidpointCut<K> cut;
  return cut;
}

template class MidpointCut<2>;
template class MidpointCut<3>;
template class MidpointCut<4>;
template class MidpointCut<5>;
template const MidpointCut<2>& midpoint_cut<2>();
template const MidpointCut<3>& midpoint_cut<3>();
template const MidpointCut<4>& midpoint_cut<4>();
template const MidpointCut<5>& midpoint_cut<5>();

} // namespace hyperiso
