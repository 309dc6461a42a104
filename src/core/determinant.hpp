#pragma once
// Determinants of small matrices.

#include <array>
#include <cmath>
#include <cstddef>
#include <utility>
#include <vector>

namespace hyperiso {

// Of `size` rows of `size`, by elimination with partial pivoting, in place.
inline double eliminate(double* rows, std::size_t size) {
  double product = 1;
  for (std::size_t column = 0; column < size; ++column) {
    std::size_t pivot = column;
    for (std::size_t row = column + 1; row < size; ++row)
      if (std::abs(rows[row * size + column]) > std::abs(rows[pivot * size + column])) pivot = row;
    if (rows[pivot * size + column] == 0) return 0;
    if (pivot != column) {
      for (std::size_t k = 0; k < size; ++k) std::swap(rows[pivot * size + k], rows[column * size + k]);
      product = -product;
    }
    product *= rows[column * size + column];
    for (std::size_t row = column + 1; row < size; ++row) {
      const double factor = rows[row * size + column] / rows[column * size + column];
      for (std::size_t k = column + 1; k < size; ++k)
        rows[row * size + k] -= factor * rows[column * size + k];
    }
  }
  return product;
}

// Of a matrix of n rows of n.
inline double determinant(std::vector<double> rows, int n) {
  return eliminate(rows.data(), static_cast<std::size_t>(n));
}
template <std::size_t N>
double determinant(const std::array<std::array<double, N>, N>& rows) {
  std::array<double, N * N> copy;
  for (std::size_t i = 0; i < N * N; ++i) copy[i] = rows[i / N][i % N];
  return eliminate(copy.data(), N);
}

} // namespace hyperiso
