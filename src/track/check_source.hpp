#pragma once
// What tracking asks of a field and of the method.

#include "core/text.hpp"
#include "hyperiso/extract.hpp"

namespace hyperiso::track_detail {

inline Status check_source(const FieldInfo& info, Method method) {
  if (info.dimension() != 3 && info.dimension() != 4)
    return Error{Code::unsupported_dimension,
                 text("tracking needs a field of 3 or 4 axes, the last of them time; this one has ",
                      info.dimension())};
  const Axis& steps = info.axes.back();
  if (steps.count < 2)
    return Error{Code::invalid_argument,
                 text("tracking needs at least 2 steps; the field has ", steps.count)};
  if (!steps.increasing())
    return Error{Code::invalid_argument, "tracking needs times that increase from step to step"};
  if (method == Method::barycentric)
    return Error{Code::invalid_argument,
                 "tracking works with the methods hull, component and simplicial, not with barycentric"};
  return {};
}

} // namespace hyperiso::track_detail
