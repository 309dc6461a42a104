#pragma once
// What is no plane.

#include "hyperiso/slice.hpp"

#include <cmath>

namespace hyperiso {

template <int D>
Status check_plane(const Hyperplane<D>& plane) {
  bool finite = std::isfinite(plane.offset), zero = true;
  for (const double component : plane.normal) {
    finite &= std::isfinite(component);
    zero &= component == 0;
  }
  if (!finite || zero)
    return Error{Code::invalid_argument, "a hyperplane needs a normal that is not 0, and finite numbers"};
  return {};
}

} // namespace hyperiso
