#pragma once
// Integers of any size: as much arithmetic as determinants take.

#include <compare>
#include <cstdint>
#include <vector>

namespace hyperiso {

class ExactInteger {
 public:
  ExactInteger() = default;
  // value * 2^shift. Requires that this is an integer: `value` is finite, with no bit set below 2^-shift.
  ExactInteger(double value, int shift);

  int sign() const { return limbs_.empty() ? 0 : negative_ ? -1 : 1; }
  ExactInteger& operator+=(const ExactInteger& other) { return add(other, other.negative_); }
  ExactInteger& operator-=(const ExactInteger& other) { return add(other, !other.negative_); }
  friend ExactInteger operator*(const ExactInteger& a, const ExactInteger& b);

 private:
  ExactInteger& add(const ExactInteger& other, bool negative);
  static std::strong_ordering compare_sizes(const ExactInteger& a, const ExactInteger& b);
  void drop_leading_zeros();

  std::vector<std::uint32_t> limbs_; // of the absolute value, the lowest first, the highest not 0
  bool negative_ = false;
};

// The exponent of the lowest bit set in a finite value that is not 0.
int lowest_bit(double value);

} // namespace hyperiso
