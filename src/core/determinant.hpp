#pragma once
// Determinants of small matrices.

#include <cmath>
#include <cstddef>
#include <utility>
#include <vector>

namespace hyperiso {

// Of a matrix of n rows of n, by elimination with partial pivoting.
inline double determinant(std::vector<double> rows, int n) {
  const auto size = static_cast<std::size_t>(n);
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

} // namespace hyperiso
