#pragma once
// The cut of a simplex between its + and its - corners.

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace hyperiso {

// The edge of a simplex that a vertex of its cut lies on: two of its corners, lower < upper, of which one is
// + and one is -.
struct CornerPair {
  std::uint8_t lower, upper;
  friend bool operator==(const CornerPair&, const CornerPair&) = default;
};

// For a K-simplex (K = 2..8), a label for each of its corners 0..K, and one point on every edge between a +
// and a - corner: the (K-1)-simplices of the surface through these points that parts the + from the -
// corners.
//
// The cut is combinatorially the product of the simplex of the a+1 + corners with that of the b+1 - corners;
// it is triangulated into C(a+b, a) simplices by the staircases of that product in the order of the corner
// numbers. A staircase restricted to fewer corners is the staircase of those, so wherever the corners are
// numbered in one global order of vertices, simplices that share a face cut it alike.
//
// Orientation: if the K-simplex is positively oriented in R^K, det[v1-v0; ...; vK-v0] > 0, every simplex of
// the cut has det[n; s1-s0; ...] > 0 for the normal n from + to -, where the points are those of a
// hyperplane; if it is negatively oriented, < 0. As chains, boundary(cut) = sum over corners i of (-1)^(i+1)
// times the cut of the facet opposite i, its corners in ascending order.
template <int K>
class SimplexCut {
 public:
  using Simplex = std::array<CornerPair, K>;

  SimplexCut();

  // Bit i of `positive`: corner i is +. Empty if all are alike. Sorted by their staircases: the one that
  // exhausts the + corners first comes first.
  std::span<const Simplex> simplices(unsigned positive) const {
    return std::span(simplices_).subspan(first_[positive], first_[positive + 1] - first_[positive]);
  }

  static constexpr unsigned patterns = 1u << (K + 1);

 private:
  std::array<std::uint32_t, patterns + 1> first_;
  std::vector<Simplex> simplices_;
};

// The table, built at the first call in the process; thread-safe, immutable.
template <int K>
const SimplexCut<K>& simplex_cut();

} // namespace hyperiso
