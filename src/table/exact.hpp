#pragma once
// Exact linear algebra on small integers.

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>

namespace hyperiso {

template <std::size_t N>
using IntegerVector = std::array<std::int64_t, N>;

template <std::size_t N>
constexpr std::int64_t dot(const IntegerVector<N>& a, const IntegerVector<N>& b) {
  std::int64_t sum = 0;
  for (std::size_t k = 0; k < N; ++k) sum += a[k] * b[k];
  return sum;
}

template <std::size_t N>
constexpr IntegerVector<N> difference(IntegerVector<N> a, const IntegerVector<N>& b) {
  for (std::size_t k = 0; k < N; ++k) a[k] -= b[k];
  return a;
}

// How many bits each number below 2^N has set.
template <std::size_t N>
constexpr std::array<std::uint8_t, std::size_t{1} << N> bit_counts = [] {
  std::array<std::uint8_t, std::size_t{1} << N> counts{};
  for (std::size_t set = 1; set < counts.size(); ++set)
    counts[set] = static_cast<std::uint8_t>(std::popcount(set));
  return counts;
}();

// The vector c with dot(x, c) = det[x; rows] for all x: orthogonal to the rows, 0 iff they are dependent.
// Expands the minors of the first 1, 2, ... rows, each in terms of the ones before.
template <std::size_t N>
constexpr IntegerVector<N> cross_product(const std::array<IntegerVector<N>, N - 1>& rows) {
  constexpr unsigned all = (1u << N) - 1;
  std::array<std::int64_t, all + 1> minor{1}; // of the columns in a set and as many rows
  for (unsigned columns = 1; columns < all; ++columns) {
    const auto& row = rows[bit_counts<N>[columns] - 1u];
    bool positive = true; // the last column of the last row
    for (std::size_t k = N; k-- > 0;) {
      if (!(columns >> k & 1)) continue;
      const std::int64_t term = row[k] * minor[columns ^ 1u << k];
      minor[columns] += positive ? term : -term;
      positive = !positive;
    }
  }
  IntegerVector<N> product;
  for (std::size_t k = 0; k < N; ++k) product[k] = k % 2 == 0 ? minor[all ^ 1u << k] : -minor[all ^ 1u << k];
  return product;
}

// det[first; rows].
template <std::size_t N>
constexpr std::int64_t determinant(const IntegerVector<N>& first,
                                   const std::array<IntegerVector<N>, N - 1>& rows) {
  return dot(first, cross_product<N>(rows));
}

} // namespace hyperiso
