#pragma once
// What every extraction asks of its arguments.

#include "core/text.hpp"
#include "hyperiso/extract.hpp"

#include <cmath>

namespace hyperiso {

inline Status check_arguments(double isovalue, int threads) {
  if (!std::isfinite(isovalue))
    return Error{Code::invalid_isovalue, text("the isovalue is ", isovalue, "; it must be a finite number")};
  if (threads < 0)
    return Error{Code::invalid_argument,
                 text("the number of threads is ", threads, "; it must be positive, or 0 for all")};
  return {};
}

} // namespace hyperiso
