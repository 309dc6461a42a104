#include "hyperiso/sample.hpp"

#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>

namespace hyperiso {
namespace {

std::vector<double> values(const Field& field) {
  std::vector<double> all(static_cast<std::size_t>(field.info.samples()));
  visit_sample_type(field.info.type, [&](auto sample) {
    const auto* samples = reinterpret_cast<const decltype(sample)*>(field.samples.get());
    std::copy_n(samples, all.size(), all.begin());
  });
  return all;
}

Field make(const std::string& name, SampleOptions options) {
  auto field = make_sample(name, options);
  EXPECT_TRUE(field) << (field ? "" : field.error().message);
  return *field;
}

std::vector<std::string> names() {
  std::vector<std::string> all;
  for (const SampleField& field : sample_fields()) all.push_back(field.name);
  return all;
}

constexpr SampleType types[] = {SampleType::u8,  SampleType::i8,  SampleType::u16, SampleType::i16,
                                SampleType::u32, SampleType::i32, SampleType::f32, SampleType::f64};

// Counts how often `values` and their neighbours `step` further lie on two sides of the isovalue.
int changes_of_side(const std::vector<double>& line, double isovalue) {
  int changes = 0;
  for (std::size_t i = 1; i < line.size(); ++i) changes += (line[i - 1] >= isovalue) != (line[i] >= isovalue);
  return changes;
}

// The suggested isovalue must show something, in every dimension and type.
TEST(Sample, suggested_isovalue_lies_among_the_values_of_every_field) {
  for (const std::string& name : names())
    for (std::size_t dimension = 2; dimension <= 8; ++dimension)
      for (const SampleType type : types) {
        SampleOptions options{.dims = std::vector<std::int64_t>(dimension, 3), .type = type};
        std::fill_n(options.dims.begin(), std::min<std::size_t>(dimension, 3), 7);
        const auto all = values(make(name, options));
        const auto [lowest, highest] = std::ranges::minmax(all);
        EXPECT_LT(lowest, sample_isovalue(name, options)) << name << dimension << name_of(type);
        EXPECT_GT(highest, sample_isovalue(name, options)) << name << dimension << name_of(type);
      }
}

// A scaled field must have the same surface: the same samples inside as the field in f64.
TEST(Sample, integer_types_keep_the_side_of_the_isovalue) {
  for (const std::string& name : names()) {
    SampleOptions exact{.dims = {12, 11, 10, 5}, .type = SampleType::f64};
    const auto expected = values(make(name, exact));
    const double isovalue = sample_isovalue(name, exact);
    for (const SampleType type : types) {
      SampleOptions options = exact;
      options.type = type;
      const auto found = values(make(name, options));
      const double step = 2.0 / 255;
      for (std::size_t i = 0; i < found.size(); ++i) {
        if (std::abs(expected[i] - isovalue) > step) {
          ASSERT_EQ(found[i] > sample_isovalue(name, options), expected[i] > isovalue)
              << name << name_of(type);
        }
      }
    }
  }
}

TEST(Sample, same_options_same_samples_and_the_seed_counts) {
  for (const std::string& name : names()) {
    const SampleOptions options{.dims = {7, 6, 5, 4}, .blobs = 5, .seed = 3};
    EXPECT_EQ(values(make(name, options)), values(make(name, options)));
  }
  EXPECT_NE(values(make("noise", {.dims = {9, 9}, .seed = 1})),
            values(make("noise", {.dims = {9, 9}, .seed = 2})));
}

TEST(Sample, axes_are_named_and_cover_the_domain_to_the_last_sample) {
  const FieldInfo info = make("torus-morph", {.dims = {5, 5, 5, 9}}).info;
  EXPECT_TRUE(info.has_time);
  EXPECT_EQ(info.axes[0].name, "x");
  EXPECT_EQ(info.axes[3].name, "t");
  EXPECT_EQ(info.axes[0].coordinate(0), -1);
  EXPECT_EQ(info.axes[0].coordinate(4), 1);
  EXPECT_EQ(info.axes[3].coordinate(8), 2);
  EXPECT_FALSE(make("ball", {.dims = {5, 5, 5}}).info.has_time);
  EXPECT_FALSE(make("ball", {.dims = {5, 5, 5, 5}, .time = false}).info.has_time);
}

// Checked against the definition of a ball, not against the code's own formula.
TEST(Sample, ball_has_radius_one_half_in_every_dimension) {
  for (std::size_t dimension = 2; dimension <= 5; ++dimension) {
    const Field field = make("ball", {.dims = std::vector<std::int64_t>(dimension, 9), .time = false});
    const auto all = values(field);
    for (std::size_t i = 0; i < all.size(); ++i) {
      double squares = 0;
      for (std::size_t axis = 0, rest = i; axis < dimension; ++axis, rest /= 9)
        squares += std::pow(-1 + 0.25 * static_cast<double>(rest % 9), 2);
      if (squares != 0.25) {
        EXPECT_EQ(all[i] > 0.5, squares < 0.25) << dimension;
      }
    }
  }
}

TEST(Sample, moving_ball_is_where_it_should_be_at_each_time) {
  const auto all = values(make("ball", {.dims = {401, 3, 3, 5}, .type = SampleType::f64}));
  for (std::size_t step = 0; step < 5; ++step) {
    const auto* line = all.data() + (step * 9 + 4) * 401; // y = z = 0
    const auto peak = std::max_element(line, line + 401) - line;
    EXPECT_EQ(peak, 120 + 40 * static_cast<std::ptrdiff_t>(step)); // x from -0.4 to 0.4
    EXPECT_NEAR(line[peak], 1, 1e-12);
  }
}

// The story of the figure: along x through the middle, one piece, then two with a hole between, then two.
TEST(Sample, torus_morph_goes_from_sphere_by_torus_to_two_spheres) {
  const auto all = values(make("torus-morph", {.dims = {65, 65, 3, 3}}));
  const auto line = [&](std::size_t step, bool along_y) {
    std::vector<double> samples(65);
    for (std::size_t i = 0; i < 65; ++i)
      samples[i] = all[(step * 3 + 1) * 65 * 65 + (along_y ? i * 65 + 32 : 32 * 65 + i)];
    return samples;
  };
  EXPECT_EQ(changes_of_side(line(0, false), 0.5), 2);
  EXPECT_EQ(changes_of_side(line(0, true), 0.5), 2);
  EXPECT_EQ(changes_of_side(line(1, false), 0.5), 4);
  EXPECT_EQ(changes_of_side(line(1, true), 0.5), 4);
  EXPECT_EQ(changes_of_side(line(2, false), 0.5), 4);
  EXPECT_EQ(changes_of_side(line(2, true), 0.5), 0);
}

TEST(Sample, two_gaussians_merge) {
  const auto all = values(make("gaussians", {.dims = {65, 3, 3, 2}}));
  const auto line = [&](std::size_t step) {
    const auto* first = all.data() + (step * 9 + 4) * 65;
    return std::vector<double>(first, first + 65);
  };
  EXPECT_EQ(changes_of_side(line(0), 0.5), 4);
  EXPECT_EQ(changes_of_side(line(1), 0.5), 2);
}

TEST(Sample, noise_is_uniform) {
  const auto all = values(make("noise", {.dims = {100, 100}, .type = SampleType::f64}));
  double sum = 0;
  for (const double value : all) {
    EXPECT_GE(value, 0);
    EXPECT_LT(value, 1);
    sum += value;
  }
  EXPECT_NEAR(sum / 10000, 0.5, 0.02); // 7 standard deviations
}

TEST(Sample, bad_options_are_errors) {
  EXPECT_EQ(make_sample("cube", {.dims = {4, 4}}).error().code, Code::invalid_argument);
  EXPECT_NE(make_sample("cube", {.dims = {4, 4}}).error().message.find("torus-morph"), std::string::npos);
  EXPECT_EQ(make_sample("ball", {.dims = {4}}).error().code, Code::invalid_argument);
  EXPECT_EQ(make_sample("ball", {.dims = std::vector<std::int64_t>(9, 2)}).error().code,
            Code::invalid_argument);
  EXPECT_EQ(make_sample("ball", {.dims = {4, 0}}).error().code, Code::invalid_argument);
  EXPECT_EQ(make_sample("gaussians", {.dims = {4, 4}, .blobs = 0}).error().code, Code::invalid_argument);
  EXPECT_EQ(make_sample("ball", {.dims = {4, 4}, .memory_limit = 63}).error().code, Code::out_of_memory);
  EXPECT_EQ(make_sample("ball", {.dims = {4, 4}, .progress = [](double) { return false; }}).error().code,
            Code::cancelled);
}

TEST(Sample, an_axis_of_one_sample_is_allowed) {
  EXPECT_EQ(values(make("gyroid", {.dims = {5, 1, 1, 1}})).size(), 5);
}

} // namespace
} // namespace hyperiso
