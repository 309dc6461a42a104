#include "hyperiso/convert.hpp"

#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>
#include <limits>

namespace hyperiso {
namespace {

template <class T>
Field field_of(const std::vector<T>& samples) {
  FieldInfo info;
  info.type = sample_type_of<T>();
  info.axes.resize(2);
  info.axes[0].count = static_cast<std::int64_t>(samples.size());
  info.axes[1].count = 1;
  NewField made = *allocate_field(info);
  std::ranges::copy(samples, reinterpret_cast<T*>(made.samples));
  return made.field;
}

template <class To, class From>
std::vector<To> converted(const std::vector<From>& samples, ConvertOptions options = {}) {
  options.type = sample_type_of<To>();
  const Converted result = *convert(field_of(samples), options);
  const auto* first = reinterpret_cast<const To*>(result.field.samples.get());
  return {first, first + samples.size()};
}

constexpr double infinity = std::numeric_limits<double>::infinity();

TEST(Convert, to_integers_rounds_halves_to_even_and_clamps) {
  EXPECT_EQ((converted<std::uint8_t, double>(
                {-3, -0.5, 0.5, 1.5, 254.4, 254.5, 255.5, 1e300, infinity, -infinity})),
            (std::vector<std::uint8_t>{0, 0, 0, 2, 254, 254, 255, 255, 255, 0}));
  EXPECT_EQ((converted<std::int32_t, double>({-1e10, 1e10})),
            (std::vector<std::int32_t>{INT32_MIN, INT32_MAX}));
}

// Neighbours of the largest u32 and i32 are exact in double: clamping must not lose them.
TEST(Convert, every_integer_comes_back_from_f64) {
  const std::vector<std::uint32_t> samples{0, 1, UINT32_MAX - 1, UINT32_MAX};
  EXPECT_EQ((converted<std::uint32_t, double>(converted<double>(samples))), samples);
}

TEST(Convert, to_f32_keeps_infinities_and_nan_and_clamps_finite_values) {
  const auto found = converted<float, double>({1e300, -1e300, infinity, -infinity, std::nan(""), 0.1});
  EXPECT_EQ(found[0], std::numeric_limits<float>::max());
  EXPECT_EQ(found[1], std::numeric_limits<float>::lowest());
  EXPECT_EQ(found[2], std::numeric_limits<float>::infinity());
  EXPECT_EQ(found[3], -std::numeric_limits<float>::infinity());
  EXPECT_TRUE(std::isnan(found[4]));
  EXPECT_EQ(found[5], 0.1f);
}

TEST(Convert, counts_what_it_clamps_but_not_what_it_rounds) {
  const Field field = field_of<double>({-1, -0.1, 255, 255.4, 256, infinity});
  EXPECT_EQ(convert(field, {.type = SampleType::u8})->clamped, 2);
}

TEST(Convert, rescaling_reaches_both_ends_of_the_range) {
  const ConvertOptions options{.rescale = {{-1, 1}}};
  EXPECT_EQ((converted<std::uint8_t, float>({-1, 0, 1, 2}, options)),
            (std::vector<std::uint8_t>{0, 128, 255, 255}));
  EXPECT_EQ((converted<std::int16_t, float>({-1, 1}, options)), (std::vector<std::int16_t>{-32768, 32767}));
  EXPECT_EQ((converted<float, float>({-1, 0, 1, 2}, options)), (std::vector<float>{0, 0.5, 1, 1.5}));
  EXPECT_FALSE(convert(field_of<float>({1}), {.rescale = {{1, 1}}}));
  EXPECT_FALSE(convert(field_of<float>({1}), {.rescale = {{1, NAN}}}));
}

TEST(Convert, nan_cannot_become_an_integer) {
  const auto result = convert(field_of<float>({1, NAN, NAN}), {.type = SampleType::i16});
  ASSERT_FALSE(result);
  EXPECT_EQ(result.error().code, Code::invalid_argument);
  EXPECT_NE(result.error().message.find("2 samples are NaN"), std::string::npos);
}

TEST(Convert, a_cropped_field_gives_only_its_samples) {
  const Field whole = field_of<std::uint8_t>({5, 6, 7, 8});
  const Converted result = *convert(whole.cropped(0, 1, 3), {.type = SampleType::f64});
  EXPECT_EQ(result.field.info.axes[0].first, 1);
  const auto* samples = reinterpret_cast<const double*>(result.field.samples.get());
  EXPECT_EQ(samples[0], 6);
  EXPECT_EQ(samples[1], 7);
}

TEST(Convert, stops_when_told) {
  EXPECT_EQ(convert(field_of<float>({1}), {.progress = [](double) { return false; }}).error().code,
            Code::cancelled);
}

} // namespace
} // namespace hyperiso
