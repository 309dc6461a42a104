#pragma once
/// \file
/// What the samples of a field are like, found in one pass over it.

#include "hyperiso/field.hpp"

#include <cstdint>
#include <vector>

namespace hyperiso {

struct Statistics {
  std::uint64_t samples = 0;
  std::uint64_t missing = 0;  ///< NaN: no data
  std::uint64_t infinite = 0; ///< +-Inf
  double minimum = 0;         ///< of the finite samples; 0 if there is none
  double maximum = 0;
  /// Finite samples, ascending: all of them up to 2^20, above that as many drawn at random (the same ones
  /// each time), so that quantiles are right to about a thousandth of the samples.
  std::vector<double> drawn;

  std::uint64_t finite() const { return samples - missing - infinite; }
  /// The value that `share` (0 to 1) of the finite samples do not pass. Requires a finite sample.
  double quantile(double share) const;
};

/// An isovalue that may show something, and why.
struct SuggestedIsovalue {
  double isovalue;
  const char* reason;
};

/// First the value that best separates the samples into two classes (Otsu 1979: the greatest variance between
/// the classes), then the middle of the range; rounded to about a thousandth of the range, the same one once.
/// None for a field with fewer than two different finite samples.
std::vector<SuggestedIsovalue> suggest_isovalues(const Statistics& statistics);

/// Collects Statistics of a field that comes in pieces, for example step by step.
class StatisticsCollector {
 public:
  /// Throws std::bad_alloc.
  void add(const Field& piece);
  Statistics finish() &&;

 private:
  template <class T>
  void add_row(const T* samples, std::int64_t count, std::int64_t stride);

  Statistics statistics_;
  std::uint64_t random_ = 0;
};

} // namespace hyperiso
