#include "core/sign.hpp"
#include "core/text.hpp"
#include "hyperiso/field.hpp"
#include "hyperiso/number_array.hpp"

#include <cmath>
#include <cstdint>
#include <gtest/gtest.h>
#include <limits>

using namespace hyperiso;

namespace {

// Every value of an 8-bit type against real isovalues between, on and beyond them.
template <class T>
void expect_rule_matches_real_comparison(double isovalue) {
  const SignRule<T, true> above(isovalue);
  const SignRule<T, false> below(isovalue);
  for (int v = std::numeric_limits<T>::lowest(); v <= std::numeric_limits<T>::max(); ++v) {
    ASSERT_EQ(above.inside(static_cast<T>(v)), v >= isovalue) << v << " " << isovalue;
    ASSERT_EQ(below.inside(static_cast<T>(v)), v <= isovalue) << v << " " << isovalue;
  }
}

} // namespace

TEST(SignRule, isovalue_between_or_beyond_integer_samples) {
  for (const double isovalue :
       {-1e9, -128.5, -128., -127.5, -0.5, -0.0, 0.0, 0.5, 3.0, 127.0, 127.5, 255., 255.5, 1e9}) {
    expect_rule_matches_real_comparison<std::uint8_t>(isovalue);
    expect_rule_matches_real_comparison<std::int8_t>(isovalue);
  }
}

// 0.1 lies between two floats; rounding it to either would put one of them on the wrong side.
TEST(SignRule, isovalue_that_no_float_equals) {
  const float under = std::nextafter(0.1f, 0.f), nearest = 0.1f, over = std::nextafter(0.1f, 1.f);
  for (const double isovalue : {0.1, -0.1, 1e-46, 1e39, -1e39})
    for (const float v :
         {under, nearest, over, -under, -nearest, -over, 0.f, 1e-45f, 3e38f, -3e38f, HUGE_VALF, -HUGE_VALF}) {
      EXPECT_EQ((SignRule<float, true>(isovalue).inside(v)), static_cast<double>(v) >= isovalue) << v;
      EXPECT_EQ((SignRule<float, false>(isovalue).inside(v)), static_cast<double>(v) <= isovalue) << v;
    }
  EXPECT_FALSE((SignRule<float, true>(0).inside(NAN)));
  EXPECT_FALSE((SignRule<float, false>(0).inside(NAN)));
}

TEST(Crossing, infinite_and_huge_ends) {
  EXPECT_EQ(crossing(-HUGE_VAL, 1, 0), 1);
  EXPECT_EQ(crossing(1, HUGE_VAL, 2), 0);
  EXPECT_EQ(crossing(-HUGE_VAL, HUGE_VAL, 2), 0.5);
  EXPECT_EQ(crossing(-1e308, 1e308, 0), 0.5);
  EXPECT_EQ(crossing(1, 3, 3), 1);
}

TEST(GridEdge, number_decodes_to_its_ends_and_ascends_with_the_samples) {
  const std::array<std::int64_t, 3> dims{3, 4, 5};
  GridEdge previous = 0;
  for (std::int64_t z = 1; z < 5; ++z)
    for (std::int64_t y = 1; y < 4; ++y)
      for (unsigned direction = 1; direction < 8; ++direction)
        for (std::int64_t x = 1; x < 3; ++x) {
          const GridEdge edge = grid_edge<3>(dims, {x, y, z}, direction);
          EXPECT_GT(edge, previous);
          previous = edge;
          const auto ends = grid_edge_ends<3>(dims, edge);
          EXPECT_EQ(ends.upper, (std::array<std::int64_t, 3>{x, y, z}));
          EXPECT_EQ(ends.direction, direction);
          EXPECT_EQ(ends.lower[1], y - (direction >> 1 & 1));
        }
}

TEST(Field, sizes_that_overflow_are_an_error) {
  FieldInfo info;
  info.axes.resize(3);
  for (Axis& axis : info.axes) axis.count = std::int64_t{1} << 31;
  const auto field = allocate_field(info);
  ASSERT_FALSE(field);
  EXPECT_EQ(field.error().code, Code::invalid_argument);
}

TEST(Field, memory_limit_is_kept_and_named) {
  FieldInfo info;
  info.axes.resize(2);
  for (Axis& axis : info.axes) axis.count = 32;
  EXPECT_TRUE(allocate_field(info, 4096));
  const auto field = allocate_field(info, 2000);
  ASSERT_FALSE(field);
  EXPECT_EQ(field.error().code, Code::out_of_memory);
  EXPECT_EQ(field.error().message, "the field takes 4 KiB, the memory limit is 2 KiB");
}

TEST(Text, numbers_read_back_and_sizes_are_for_people) {
  EXPECT_EQ(text("at ", 0.1, " of ", 3, ' ', 0.25f), "at 0.1 of 3 0.25");
  EXPECT_EQ(byte_size(1023), "1023 B");
  EXPECT_EQ(byte_size(1153434), "1.1 MiB");
  EXPECT_EQ(byte_size(UINT64_MAX), "16 EiB");
}

// Past a few MiB the memory comes from elsewhere, and grows by moving pages.
TEST(Array, keeps_its_elements_as_it_grows) {
  Array<std::uint64_t> array;
  EXPECT_TRUE(array.empty());
  for (std::uint64_t i = 0; i < 3'000'000; ++i) array.push_back(i * i);
  ASSERT_EQ(array.size(), 3'000'000u);
  for (std::uint64_t i = 0; i < array.size(); ++i) ASSERT_EQ(array[i], i * i);
  array.resize(10);
  Array<std::uint64_t> copy = array;
  EXPECT_EQ(copy, array);
  copy[3] = 0;
  EXPECT_FALSE(copy == array);
  array.clear();
  EXPECT_EQ(array.begin(), array.end());
}
