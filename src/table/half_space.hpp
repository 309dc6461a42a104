#pragma once
// The hyperplanes spanned by given points.

#include "table/exact.hpp"

#include <algorithm>
#include <compare>
#include <cstdint>
#include <numeric>
#include <span>
#include <vector>

namespace hyperiso {

// The points x with dot(outward, x) <= offset; coprime coefficients.
template <int D>
struct HalfSpace {
  IntegerVector<D> outward;
  std::int64_t offset;

  std::int64_t height(const IntegerVector<D>& point) const { return dot(outward, point) - offset; }
  HalfSpace opposite() const { return {difference({}, outward), -offset}; }
  friend std::strong_ordering operator<=>(const HalfSpace&, const HalfSpace&) = default;
};

// One of the half-spaces of the hyperplane through D points, the same whichever points give it: the one with
// the greater outward normal. All 0 if the points do not span a hyperplane.
template <int D>
HalfSpace<D> half_space_through(const std::array<IntegerVector<D>, D>& points) {
  std::array<IntegerVector<D>, D - 1> sides;
  for (std::size_t i = 1; i < D; ++i) sides[i - 1] = difference(points[i], points[0]);
  IntegerVector<D> normal = cross_product<D>(sides);
  std::int64_t divisor = 0;
  for (const std::int64_t x : normal) divisor = std::gcd(divisor, x);
  if (divisor == 0) return {};
  if (normal < IntegerVector<D>{}) divisor = -divisor;
  for (std::int64_t& x : normal) x /= divisor;
  return {normal, dot(normal, points[0])};
}

// One half-space of each hyperplane that D of the points span, sorted.
template <int D>
std::vector<HalfSpace<D>> spanned_hyperplanes(std::span<const IntegerVector<D>> points) {
  std::vector<HalfSpace<D>> half_spaces;
  std::vector<bool> chosen(points.size(), false);
  std::fill_n(chosen.begin(), D, true);
  do {
    std::array<IntegerVector<D>, D> corners;
    auto corner = corners.begin();
    for (std::size_t i = 0; i < points.size(); ++i)
      if (chosen[i]) *corner++ = points[i];
    const HalfSpace<D> half_space = half_space_through<D>(corners);
    if (half_space != HalfSpace<D>{}) half_spaces.push_back(half_space);
  } while (std::prev_permutation(chosen.begin(), chosen.end()));
  std::sort(half_spaces.begin(), half_spaces.end());
  half_spaces.erase(std::unique(half_spaces.begin(), half_spaces.end()), half_spaces.end());
  return half_spaces;
}

} // namespace hyperiso
