#include "mesh/exact_integer.hpp"

#include <cstdint>
#include <gtest/gtest.h>
#include <limits>
#include <random>

using namespace hyperiso;

namespace {

ExactInteger integer(double value) { return ExactInteger(value, 0); }

} // namespace

TEST(ExactInteger, agrees_with_small_integers) {
  std::mt19937_64 random(1);
  for (int i = 0; i < 2000; ++i) {
    const auto draw = [&] { return static_cast<std::int64_t>(random()) >> (random() % 64); };
    const std::int64_t a = draw() >> 12, b = draw() >> 12; // exact in a double
    ExactInteger sum = integer(static_cast<double>(a)), difference = sum, expected = sum;
    sum += integer(static_cast<double>(b));
    difference -= integer(static_cast<double>(b));
    EXPECT_EQ(sum.sign(), a + b > 0 ? 1 : a + b < 0 ? -1 : 0);
    EXPECT_EQ(difference.sign(), a > b ? 1 : a < b ? -1 : 0);
    // a^2 - b^2 - (a + b)(a - b) = 0
    ExactInteger zero = integer(static_cast<double>(a)) * integer(static_cast<double>(a));
    zero -= integer(static_cast<double>(b)) * integer(static_cast<double>(b));
    zero -= sum * difference;
    EXPECT_EQ(zero.sign(), 0) << a << ", " << b;
  }
}

// A bit far below, and one far above, all others count.
TEST(ExactInteger, nothing_is_rounded) {
  const double smallest = std::numeric_limits<double>::denorm_min(),
               largest = std::numeric_limits<double>::max();
  EXPECT_EQ(lowest_bit(smallest), -1074);
  EXPECT_EQ(lowest_bit(12), 2);
  EXPECT_EQ(lowest_bit(-0.75), -2);
  ExactInteger sum(largest, 1074);
  sum += ExactInteger(-smallest, 1074);
  ExactInteger rest = sum;
  rest -= ExactInteger(largest, 1074);
  EXPECT_EQ(rest.sign(), -1);
  rest += ExactInteger(smallest, 1074);
  EXPECT_EQ(rest.sign(), 0);
  ExactInteger square = sum * sum; // (x - e)^2 = x^2 - 2xe + e^2
  square -= ExactInteger(largest, 1074) * ExactInteger(largest, 1074);
  square += ExactInteger(largest, 1074) * integer(2);
  EXPECT_EQ(square.sign(), 1);
  square -= integer(1);
  EXPECT_EQ(square.sign(), 0);
}
