#pragma once
// Doubles as samples of any type.

#include <algorithm>
#include <cmath>
#include <limits>
#include <type_traits>

namespace hyperiso {

// The nearest number of type T, halves to even; what lies outside its range is clamped to it. Infinities and
// NaN stay in floating-point types; NaN must not be given to others.
template <class T>
T nearest(double value) {
  constexpr double lowest = std::numeric_limits<T>::lowest(), highest = std::numeric_limits<T>::max();
  if constexpr (std::is_floating_point_v<T>)
    return std::isfinite(value) ? static_cast<T>(std::clamp(value, lowest, highest)) : static_cast<T>(value);
  else
    return static_cast<T>(std::clamp(std::nearbyint(value), lowest, highest));
}

// A linear map that takes `low` and `high` to the ends of the range of an integer type, or to 0 and 1 for
// floating-point types.
template <class T>
double scaled_to(double value, double low, double high) {
  const double share = (value - low) / (high - low);
  if constexpr (std::is_floating_point_v<T>) return share;
  constexpr double lowest = std::numeric_limits<T>::lowest(), highest = std::numeric_limits<T>::max();
  return lowest + share * (highest - lowest);
}

} // namespace hyperiso
