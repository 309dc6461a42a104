#pragma once
// The sign rule: which samples are inside. The only place that compares a sample with the isovalue.

#include <cmath>
#include <limits>
#include <type_traits>

namespace hyperiso {

// Inside above: value >= isovalue; below: value <= isovalue; compared in T, yet exactly as with the real
// isovalue, by rounding the isovalue to the nearest T on the inside.
template <class T, bool Above>
class SignRule {
 public:
  explicit SignRule(double isovalue) {
    if constexpr (std::is_integral_v<T>) {
      const double rounded = Above ? std::ceil(isovalue) : std::floor(isovalue);
      constexpr double lowest = std::numeric_limits<T>::lowest(), highest = std::numeric_limits<T>::max();
      never_ = Above ? rounded > highest : rounded < lowest;
      threshold_ = rounded > highest  ? std::numeric_limits<T>::max()
                   : rounded < lowest ? std::numeric_limits<T>::lowest()
                                      : static_cast<T>(rounded);
    } else {
      constexpr T infinity = std::numeric_limits<T>::infinity();
      threshold_ = static_cast<T>(isovalue);
      if (Above && static_cast<double>(threshold_) < isovalue)
        threshold_ = std::nextafter(threshold_, infinity);
      if (!Above && static_cast<double>(threshold_) > isovalue)
        threshold_ = std::nextafter(threshold_, -infinity);
    }
  }
  // False for NaN.
  bool inside(T value) const { return !never_ && (Above ? value >= threshold_ : value <= threshold_); }

  T threshold() const { return threshold_; }
  bool never() const { return never_; } // no value of T is inside

 private:
  T threshold_{};
  bool never_ = false;
};

template <class T>
bool is_missing(T value) {
  if constexpr (std::is_floating_point_v<T>)
    return std::isnan(value);
  else
    return (void)value, false;
}

// Where the surface crosses an edge with values a and b at its lower and upper end, from 0 to 1. Requires
// that exactly one is inside and the isovalue is finite.
inline double crossing(double a, double b, double isovalue) {
  const bool a_infinite = std::isinf(a), b_infinite = std::isinf(b);
  if (a_infinite || b_infinite) return a_infinite && b_infinite ? 0.5 : a_infinite ? 1.0 : 0.0;
  const double difference = b - a;
  if (std::isinf(difference)) return (isovalue / 2 - a / 2) / (b / 2 - a / 2);
  return (isovalue - a) / difference;
}

} // namespace hyperiso
