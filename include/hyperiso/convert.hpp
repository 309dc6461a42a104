#pragma once
/// \file
/// Fields of one sample type made from those of another.

#include "hyperiso/field.hpp"
#include "hyperiso/progress.hpp"

#include <cstdint>
#include <optional>

namespace hyperiso {

struct ConvertOptions {
  SampleType type = SampleType::f32;
  struct Range {
    double low, high;
  };
  std::optional<Range> rescale = {}; ///< [low, high] becomes the range of an integer type, [0, 1] of a float
  std::uint64_t memory_limit = UINT64_MAX; ///< bytes of the new samples
  Progress progress = {};
};

struct Converted {
  Field field;
  std::uint64_t clamped = 0; ///< finite samples that lay outside the range of the type, by more than rounding
};

/// Converts the samples, after rescaling where that is asked for, to the nearest number of the new type,
/// halves to even. What lies outside the range of the type is clamped to it; +-Inf stays in a floating-point
/// type and is clamped in others. Axes and all else stay; the samples lie one after the other.
///
/// Errors: invalid_argument if a NaN (no data) meets an integer type, which cannot hold it, or if
/// rescale's low and high are equal or not finite; out_of_memory; cancelled.
Result<Converted> convert(const Field& field, const ConvertOptions& options);

} // namespace hyperiso
