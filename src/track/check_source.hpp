#pragma once
// What tracking asks of a field and of the method.

#include "core/text.hpp"
#include "hyperiso/track.hpp"

#include <cmath>

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

// What `track` is asked to follow.
inline Status check_tracked(double isovalue, const TrackOptions& options) {
  if (options.tracked == Tracked::surface) {
    if (options.upper_isovalue)
      return Error{Code::invalid_argument,
                   "between two isovalues lies a region; surfaces are tracked at one isovalue"};
    return {};
  }
  if (options.extraction.method == Method::component)
    return Error{Code::invalid_argument, "regions are tracked with the methods hull and simplicial"};
  if (!std::isfinite(isovalue) || !std::isfinite(options.upper_isovalue.value_or(isovalue)))
    return Error{Code::invalid_isovalue, "the isovalues of a region must be finite numbers"};
  if (options.upper_isovalue && !(isovalue < *options.upper_isovalue))
    return Error{Code::invalid_isovalue, text("a region lies between two isovalues, the lower one first; ",
                                              isovalue, " is not below ", *options.upper_isovalue)};
  return {};
}

} // namespace hyperiso::track_detail
