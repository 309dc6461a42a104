#pragma once
/// \file
/// Cuts of isosurfaces by hyperplanes: the surface at a moment, or on any plane.

#include "hyperiso/extract.hpp"

#include <array>

namespace hyperiso {

/// The points x with normal . x = offset.
template <int D>
struct Hyperplane {
  std::array<double, D> normal{}; ///< not 0; need not be a unit vector
  double offset = 0;

  /// x[axis] = value; `axis` D-1 is usually time.
  static Hyperplane at(int axis, double value) {
    Hyperplane plane;
    plane.normal[static_cast<std::size_t>(axis)] = 1;
    plane.offset = value;
    return plane;
  }
};

} // namespace hyperiso
