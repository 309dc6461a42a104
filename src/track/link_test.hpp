#pragma once
// The common case, quickly: a vertex at which nothing happens.

#include "track/slab.hpp"

#include <bit>

namespace hyperiso::track_detail {

// Tells for most vertices that their lower and upper links have one component each and the same Euler
// characteristic, in bits: SideFinder decides what it leaves open.
template <int C>
class LinkTest {
 public:
  // Of neighbours with the same time those on smaller edges count as earlier (candidates.hpp says why). False
  // also if the link is too large.
  bool is_regular(Slab<C>& slab, Vertex vertex) {
    if constexpr (C > 4) return false; // links of 4-simplices have faces that are not counted here
    std::uint64_t below = 0, above = 0;
    int count = 0, simplices_below = 0, simplices_above = 0;
    const auto star = slab.star(vertex);
    if (seen_from_.size() < slab.vertex_count()) {
      seen_from_.resize(slab.vertex_count(), UINT32_MAX);
      number_.resize(slab.vertex_count());
    }
    for (const SimplexNumber simplex : star) {
      std::uint64_t bits = 0;
      for (const Vertex other : slab.simplex(simplex)) {
        if (other == vertex) continue;
        if (seen_from_[other] != vertex) {
          if (count == 64) return false;
          seen_from_[other] = vertex;
          number_[other] = static_cast<std::uint8_t>(count);
          neighbours_[static_cast<std::size_t>(count)] = 0;
          (slab.is_earlier(other, vertex) ? below : above) |= std::uint64_t{1} << count++;
        }
        bits |= std::uint64_t{1} << number_[other];
      }
      for (std::uint64_t rest = bits; rest != 0; rest &= rest - 1)
        neighbours_[static_cast<std::size_t>(std::countr_zero(rest))] |= bits;
      simplices_below += (bits & above) == 0;
      simplices_above += (bits & below) == 0;
    }
    return is_connected(below) && is_connected(above) &&
           euler(below, simplices_below) == euler(above, simplices_above);
  }

 private:
  bool is_connected(std::uint64_t vertices) const {
    std::uint64_t reached = vertices & -vertices;
    for (std::uint64_t next = reached; next != 0;) {
      const auto vertex = static_cast<std::size_t>(std::countr_zero(next));
      next &= next - 1;
      const std::uint64_t found = neighbours_[vertex] & vertices & ~reached;
      reached |= found;
      next |= found;
    }
    return vertices != 0 && reached == vertices;
  }

  // Of a part of the link, which has the dimension C - 2: 1 or 2.
  int euler(std::uint64_t vertices, int simplices) const {
    int corners_of_edges = 0;
    for (std::uint64_t rest = vertices; rest != 0; rest &= rest - 1)
      corners_of_edges +=
          std::popcount(neighbours_[static_cast<std::size_t>(std::countr_zero(rest))] & vertices) - 1;
    return std::popcount(vertices) - corners_of_edges / 2 + (C == 4 ? simplices : 0);
  }

  std::vector<std::uint8_t> number_; // of each vertex of the slab in the link
  std::vector<Vertex> seen_from_;
  std::array<std::uint64_t, 64> neighbours_{}; // of each vertex of the link, itself included
};

} // namespace hyperiso::track_detail
