#pragma once
// Coordinates on a hyperplane.

#include "core/determinant.hpp"
#include "hyperiso/slice.hpp"

#include <algorithm>
#include <cmath>

namespace hyperiso {

// The axis that the plane lies across, if its normal runs along one.
template <int D>
std::optional<int> axis_across(const Hyperplane<D>& plane) {
  std::optional<int> across;
  for (int axis = 0; axis < D; ++axis) {
    if (plane.normal[axis] == 0) continue;
    if (across) return std::nullopt;
    across = axis;
  }
  return across;
}

// Coordinates on the plane, and whether the unit normal followed by their directions is positively oriented.
template <int D>
struct Frame {
  // Row k takes a point to its coordinate k; direction k is that of the plane along which it grows by one
  // while the others stay.
  std::array<std::array<double, D>, D - 1> rows{}, directions{};
  std::array<double, D> foot{}; // where all coordinates are 0
  bool positive = true;

  Frame(const Hyperplane<D>& plane, SliceFrame kind) {
    const auto larger = [](double a, double b) { return std::abs(a) < std::abs(b); };
    const auto across = std::ranges::max_element(plane.normal, larger) - plane.normal.begin();
    const std::array<double, D> normal = unit(plane.normal);
    std::vector<double> oriented(normal.begin(), normal.end());
    for (int axis = 0, row = 0; axis < D; ++axis) {
      if (axis == across) continue;
      std::array<double, D>&direction = directions[row], &along = rows[row];
      along[axis] = direction[axis] = 1;
      if (kind == SliceFrame::axes) {
        direction[across] = 0 - normal[axis] / normal[across];
      } else {
        remove(direction, normal);
        for (int done = 0; done < row; ++done) remove(direction, directions[done]);
        along = direction = unit(direction);
      }
      oriented.insert(oriented.end(), direction.begin(), direction.end());
      ++row;
    }
    positive = determinant(oriented, D) > 0;
    if (kind == SliceFrame::axes || axis_across(plane)) {
      foot[across] = plane.offset / plane.normal[across];
    } else {
      double along = 0; // of the unit normal
      for (int k = 0; k < D; ++k) along += plane.normal[k] * normal[k];
      for (int k = 0; k < D; ++k) foot[k] = plane.offset / along * normal[k];
    }
  }

  std::array<double, D - 1> coordinates(const std::array<double, D>& point) const {
    std::array<double, D - 1> result{};
    for (int row = 0; row < D - 1; ++row)
      for (int k = 0; k < D; ++k) result[row] += rows[row][k] * point[k];
    return result;
  }

 private:
  static std::array<double, D> unit(std::array<double, D> vector) {
    const double largest = std::abs(*std::ranges::max_element(
        vector, [](double a, double b) { return std::abs(a) < std::abs(b); })); // keeps squares in range
    double squared = 0;
    for (double& component : vector) component /= largest, squared += component * component;
    for (double& component : vector) component /= std::sqrt(squared);
    return vector;
  }
  static void remove(std::array<double, D>& vector, const std::array<double, D>& direction) {
    double along = 0;
    for (int k = 0; k < D; ++k) along += vector[k] * direction[k];
    for (int k = 0; k < D; ++k) vector[k] -= along * direction[k];
  }
};

} // namespace hyperiso
