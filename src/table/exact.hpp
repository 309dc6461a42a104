#pragma once
// Exact linear algebra on small integers.

#include <array>
#include <cstddef>
#include <cstdint>
#include <utility>

namespace hyperiso {

template <std::size_t N>
using IntegerVector = std::array<std::int64_t, N>;
template <std::size_t N>
using IntegerMatrix = std::array<IntegerVector<N>, N>; // rows

// By fraction-free elimination (Bareiss): every intermediate number is itself a minor of the matrix, so that
// nothing overflows as long as the minors, and products of two of them, fit 64 bits.
template <std::size_t N>
std::int64_t determinant(IntegerMatrix<N> rows) {
  std::int64_t previous = 1, sign = 1;
  for (std::size_t k = 0; k < N; ++k) {
    std::size_t pivot = k;
    while (pivot < N && rows[pivot][k] == 0) ++pivot;
    if (pivot == N) return 0;
    if (pivot != k) {
      std::swap(rows[pivot], rows[k]);
      sign = -sign;
    }
    for (std::size_t i = k + 1; i < N; ++i)
      for (std::size_t j = k + 1; j < N; ++j)
        rows[i][j] = (rows[k][k] * rows[i][j] - rows[i][k] * rows[k][j]) / previous;
    previous = rows[k][k];
  }
  return sign * rows[N - 1][N - 1];
}

} // namespace hyperiso
