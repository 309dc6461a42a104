#include "table/simplex_cut.hpp"

#include "table/exact.hpp"

#include <algorithm>
#include <bit>
#include <cassert>

namespace hyperiso {

namespace {

// In doubled coordinates of the positively oriented simplex 0, e1, ..., eK.
template <std::size_t K>
IntegerVector<K> midpoint(CornerPair pair) {
  IntegerVector<K> point{};
  for (const std::size_t corner : {pair.lower, pair.upper})
    if (corner > 0) ++point[corner - 1];
  return point;
}

// Sign of det[n; s1-s0; ...]. The midpoints lie on one hyperplane with the + corners on one side and the -
// corners on the other, so any edge from a + to a - corner may stand for the normal n.
template <std::size_t K>
bool points_from_positive_to_negative(const std::array<CornerPair, K>& simplex, unsigned positive) {
  const auto [lower, upper] = simplex[0];
  IntegerVector<K> normal{};
  ++normal[upper - 1u];
  if (lower > 0) --normal[lower - 1u];
  std::array<IntegerVector<K>, K - 1> sides;
  for (std::size_t k = 1; k < K; ++k)
    sides[k - 1] = difference(midpoint<K>(simplex[k]), midpoint<K>(simplex[0]));
  const std::int64_t volume = determinant(normal, sides);
  assert(volume != 0);
  return (volume > 0) == (positive >> lower & 1);
}

// The staircase that starts at the first + and the first - corner and whose step k goes on to the next +
// corner if `to_next_positive[k]`, else to the next - corner.
template <std::size_t K>
std::array<CornerPair, K> staircase(const std::array<bool, K - 1>& to_next_positive, unsigned positive) {
  const auto next = [](unsigned corner, unsigned among) {
    do ++corner;
    while (!(among >> corner & 1));
    return corner;
  };
  const unsigned negative = ~positive;
  unsigned p = positive & 1 ? 0 : next(0, positive);
  unsigned q = negative & 1 ? 0 : next(0, negative);
  std::array<CornerPair, K> simplex;
  for (std::size_t k = 0;; ++k) {
    simplex[k] = {static_cast<std::uint8_t>(std::min(p, q)), static_cast<std::uint8_t>(std::max(p, q))};
    if (k == K - 1) return simplex;
    if (to_next_positive[k])
      p = next(p, positive);
    else
      q = next(q, negative);
  }
}

} // namespace

template <int K>
SimplexCut<K>::SimplexCut() {
  for (unsigned positive = 0; positive < patterns; ++positive) {
    first_[positive] = static_cast<std::uint32_t>(simplices_.size());
    if (positive == 0 || positive == patterns - 1) continue;
    std::array<bool, K - 1> to_next_positive{};
    std::fill_n(to_next_positive.begin(), std::popcount(positive) - 1, true);
    do {
      Simplex simplex = staircase<K>(to_next_positive, positive);
      if (!points_from_positive_to_negative(simplex, positive)) std::swap(simplex[K - 2], simplex[K - 1]);
      simplices_.push_back(simplex);
    } while (std::prev_permutation(to_next_positive.begin(), to_next_positive.end()));
  }
  first_[patterns] = static_cast<std::uint32_t>(simplices_.size());
}

template <int K>
const SimplexCut<K>& simplex_cut() {
  static const SimplexCut<K> cut;
  return cut;
}

template class SimplexCut<2>;
template class SimplexCut<3>;
template class SimplexCut<4>;
template class SimplexCut<5>;
template class SimplexCut<6>;
template class SimplexCut<7>;
template class SimplexCut<8>;
template const SimplexCut<2>& simplex_cut<2>();
template const SimplexCut<3>& simplex_cut<3>();
template const SimplexCut<4>& simplex_cut<4>();
template const SimplexCut<5>& simplex_cut<5>();
template const SimplexCut<6>& simplex_cut<6>();
template const SimplexCut<7>& simplex_cut<7>();
template const SimplexCut<8>& simplex_cut<8>();

} // namespace hyperiso
