#include "core/memory.hpp"
#include "hyperiso/statistics.hpp"

#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>
#include <limits>

namespace hyperiso {
namespace {

template <class T>
Field field_of(const std::vector<T>& samples, std::vector<std::int64_t> dims) {
  FieldInfo info;
  info.type = sample_type_of<T>();
  for (const std::int64_t count : dims) info.axes.emplace_back().count = count;
  NewField made = *allocate_field(info);
  std::ranges::copy(samples, reinterpret_cast<T*>(made.samples));
  return made.field;
}

Statistics statistics_of(const Field& field) {
  StatisticsCollector collector;
  collector.add(field);
  return std::move(collector).finish();
}

TEST(Statistics, missing_and_infinite_samples_are_set_aside) {
  constexpr float infinity = std::numeric_limits<float>::infinity(),
                  nan = std::numeric_limits<float>::quiet_NaN();
  const Statistics found = statistics_of(field_of<float>({3, nan, infinity, -1, -infinity, nan}, {3, 2}));
  EXPECT_EQ(found.samples, 6);
  EXPECT_EQ(found.missing, 2);
  EXPECT_EQ(found.infinite, 2);
  EXPECT_EQ(found.minimum, -1);
  EXPECT_EQ(found.maximum, 3);
}

TEST(Statistics, no_finite_sample_suggests_nothing) {
  const Statistics found = statistics_of(field_of<double>(std::vector<double>(4, std::nan("")), {2, 2}));
  EXPECT_EQ(found.finite(), 0);
  EXPECT_TRUE(suggest_isovalues(found).empty());
  EXPECT_TRUE(suggest_isovalues(statistics_of(field_of<std::uint8_t>({7, 7, 7, 7}, {2, 2}))).empty());
}

TEST(Statistics, quantiles_are_order_statistics) {
  std::vector<std::int16_t> samples(100);
  for (std::size_t i = 0; i < samples.size(); ++i) samples[i] = static_cast<std::int16_t>((i * 37) % 100 + 1);
  const Statistics found = statistics_of(field_of(samples, {10, 10}));
  EXPECT_EQ(found.quantile(0), 1);
  EXPECT_EQ(found.quantile(0.25), 25);
  EXPECT_EQ(found.quantile(0.5), 50);
  EXPECT_EQ(found.quantile(1), 100);
}

TEST(Statistics, pieces_and_crops_count_only_their_samples) {
  std::vector<std::uint8_t> samples(60);
  for (std::size_t i = 0; i < samples.size(); ++i) samples[i] = static_cast<std::uint8_t>(i);
  const Field whole = field_of(samples, {5, 4, 3});
  StatisticsCollector collector;
  for (int z = 0; z < 3; ++z) collector.add(whole.cropped(2, z, z + 1));
  EXPECT_EQ(std::move(collector).finish().drawn, statistics_of(whole).drawn);
  const Statistics crop = statistics_of(whole.cropped(0, 1, 3).cropped(1, 1, 2));
  EXPECT_EQ(crop.drawn, (std::vector<double>{6, 7, 26, 27, 46, 47}));
}

// Above the limit a random choice stands for all: its quantiles must still be near.
TEST(Statistics, quantiles_of_many_samples_are_near) {
  std::vector<float> samples(3 << 20);
  for (std::size_t i = 0; i < samples.size(); ++i) samples[i] = static_cast<float>(i % 1024);
  const Statistics found = statistics_of(field_of(samples, {3 << 10, 1 << 10}));
  EXPECT_EQ(found.drawn.size(), std::size_t{1} << 20);
  EXPECT_EQ(found.maximum, 1023);
  EXPECT_NEAR(found.quantile(0.5), 512, 5);
  EXPECT_NEAR(found.quantile(0.99), 1014, 5);
}

TEST(Statistics, suggestions_part_two_classes_and_name_the_middle) {
  const auto found = suggest_isovalues(statistics_of(field_of<double>({0, 0.1, 0.2, 0.1, 0.9, 10}, {3, 2})));
  ASSERT_EQ(found.size(), 2);
  EXPECT_EQ(found[0].isovalue, 5.45);
  EXPECT_EQ(found[1].isovalue, 5);
}

TEST(Statistics, huge_values_do_not_overflow) {
  const auto found =
      suggest_isovalues(statistics_of(field_of<double>({-1.7e308, -1.6e308, 1.7e308, 1.5e308}, {2, 2})));
  ASSERT_FALSE(found.empty());
  for (const auto& suggestion : found) EXPECT_LT(std::abs(suggestion.isovalue), 1.7e308);
}

TEST(Memory, what_a_process_holds_counts) {
  EXPECT_GT(available_memory(), 1u << 20);
  const std::uint64_t before = held_memory();
  const std::vector<char> block(32 << 20, 1);
  EXPECT_GE(held_memory(), before + block.size() / 2);
  EXPECT_GE(peak_memory(), block.size());
}

} // namespace
} // namespace hyperiso
