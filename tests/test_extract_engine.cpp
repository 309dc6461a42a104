// The engine gives exactly what the reference loop gives: the same vertices, simplices and edges, in the same
// order, to the bit; on shapes, values and types that its bit masks, ranks and units could get wrong.

#include "check.hpp"
#include "core/text.hpp"
#include "extract/extract_with.hpp"
#include "extract/reference.hpp"

#include <cstring>
#include <gtest/gtest.h>

using namespace hyperiso;
using check::OwnedField;

namespace {

template <class Numbers>
bool same_bytes(const Numbers& a, const Numbers& b) {
  return a.wide() == b.wide() && a.bytes() == b.bytes() &&
         (a.bytes() == 0 || std::memcmp(a.data(), b.data(), a.bytes()) == 0);
}

template <int D>
void expect_same(const SimplexMesh<D>& mesh, const SimplexMesh<D>& expected) {
  EXPECT_EQ(mesh.active_cells, expected.active_cells);
  EXPECT_EQ(mesh.vertex_count(), expected.vertex_count());
  EXPECT_EQ(mesh.simplex_count(), expected.simplex_count());
  EXPECT_TRUE(mesh.edges == expected.edges);
  EXPECT_TRUE(same_bytes(mesh.positions, expected.positions));
  EXPECT_TRUE(same_bytes(mesh.simplices, expected.simplices));
}

template <class T, int D>
void expect_reference(const FieldView<const T, D>& field, double isovalue, const ExtractOptions& options = {},
                      const EngineOptions& engine_options = {}) {
  SimplexMesh<D> mesh;
  const Status status = extract_with(field, isovalue, options, engine_options, mesh);
  ASSERT_TRUE(status) << status.error().message;
  expect_same(mesh, extract_reference(field, isovalue, options));
}

std::vector<Instructions> instructions_here() {
  std::vector<Instructions> here;
  for (const auto instructions : {Instructions::baseline, Instructions::avx2, Instructions::avx512})
    if (has_instructions(instructions)) here.push_back(instructions);
  return here;
}

// By all methods, with all instructions, on one thread and on several with units as small as they get; by one
// also in the memory of the extraction before and with the ranges it noted down.
template <class T, int D>
void expect_reference_on_every_path(const FieldView<const T, D>& field, double isovalue,
                                    ExtractOptions options = {}) {
  for (const Method method : {Method::hull, Method::component, Method::simplicial}) {
    options.method = method;
    const SimplexMesh<D> expected = extract_reference(field, isovalue, options);
    for (const Instructions instructions : instructions_here()) {
      Workspace workspace;
      FieldRanges ranges;
      for (const int threads : {1, 3}) {
        SCOPED_TRACE(testing::Message() << "method " << static_cast<int>(method) << ", instructions "
                                        << static_cast<int>(instructions) << ", threads " << threads);
        options.threads = threads;
        SimplexMesh<D> mesh;
        const EngineOptions engine_options{instructions, false, threads == 1 ? 0 : 1};
        const Status status = extract_with(field, isovalue, options, engine_options, mesh);
        ASSERT_TRUE(status) << status.error().message;
        expect_same(mesh, expected);
        if (method == Method::hull) {
          ExtractOptions again = options;
          again.workspace = &workspace;
          again.ranges = &ranges;
          for (int times = 0; times < 2; ++times) {
            ASSERT_TRUE(extract_with(field, isovalue, again, engine_options, mesh));
            expect_same(mesh, expected);
          }
        }
        if (testing::Test::HasFailure()) return;
      }
    }
  }
}

template <class T, int D>
OwnedField<T, D> noise(const std::array<std::int64_t, D>& dims, unsigned seed = 1) {
  return check::random_field<T, D>(dims, 100, seed);
}

// Half of the samples lie at the isovalue.
template <class T, int D>
OwnedField<T, D> ties(const std::array<std::int64_t, D>& dims) {
  return check::random_field<T, D>(dims, 1, 2);
}

template <int D>
OwnedField<float, D> noise_with_missing(const std::array<std::int64_t, D>& dims, double share) {
  auto field = noise<float, D>(dims, 3);
  std::mt19937 random(4);
  std::bernoulli_distribution missing(share);
  for (float& sample : field.samples)
    if (missing(random)) sample = std::numeric_limits<float>::quiet_NaN();
  return field;
}

} // namespace

TEST(Engine, row_lengths_around_words) {
  for (const std::int64_t length : {2, 3, 9, 63, 64, 65, 127, 128, 130}) {
    SCOPED_TRACE(length);
    expect_reference_on_every_path(noise<float, 2>({length, 5}).view, 0);
    expect_reference_on_every_path(noise<float, 3>({length, 4, 3}).view, 0.5);
    expect_reference_on_every_path(noise<float, 4>({length, 3, 2, 3}).view, -3);
  }
}

TEST(Engine, one_cell) {
  for (unsigned seed = 0; seed < 30; ++seed) {
    expect_reference_on_every_path(noise<float, 2>({2, 2}, seed).view, 0);
    expect_reference_on_every_path(noise<float, 3>({2, 2, 2}, seed).view, 0);
    expect_reference_on_every_path(noise<float, 4>({2, 2, 2, 2}, seed).view, 0);
  }
}

// The table is made as it is used, by several threads at once.
TEST(Engine, five_dimensions) {
  expect_reference_on_every_path(noise<float, 5>({2, 2, 2, 2, 2}).view, 0);
  expect_reference_on_every_path(noise<std::int16_t, 5>({5, 3, 2, 3, 3}).view, 0.5);
  const auto ball = check::make_field<float, 5>(check::box_grid<5>(5, -1, 1), [](const auto& p) {
    return 0.7 - std::inner_product(p.begin(), p.end(), p.begin(), 0.0);
  });
  expect_reference_on_every_path(ball.view, 0);
  expect_reference_on_every_path(noise_with_missing<5>({67, 2, 3, 2, 2}, 0.02).view, 0);
}

TEST(Engine, no_surface) {
  const auto field = noise<float, 3>({70, 5, 4});
  for (const double isovalue : {-1000., 1000.}) expect_reference_on_every_path(field.view, isovalue);
  const auto flat = noise<float, 3>({70, 1, 4});
  SimplexMesh<3> mesh;
  ASSERT_TRUE(extract_with(flat.view, 0, {}, {}, mesh));
  EXPECT_EQ(mesh.vertex_count() + mesh.simplex_count(), 0u);
}

// Few cells are active: words, rows and layers without any are skipped.
TEST(Engine, sparse_surface) {
  const auto ball = check::make_field<float, 4>(check::box_grid<4>(20, -1, 1), [](const auto& p) {
    return 0.1 - (p[0] * p[0] + p[1] * p[1] + p[2] * p[2] + p[3] * p[3]);
  });
  expect_reference_on_every_path(ball.view, 0);
  auto spikes = check::make_field<float, 3>(unit_grid<3>({200, 30, 30}), [](const auto&) { return 0; });
  for (const std::size_t at : {0u, 63u, 199u, 200u * 31 + 64, 200u * 900 - 1}) spikes.samples[at] = 1;
  expect_reference_on_every_path(spikes.view, 0.5);
}

TEST(Engine, samples_at_the_isovalue) {
  expect_reference_on_every_path(ties<float, 2>({67, 40}).view, 0);
  expect_reference_on_every_path(ties<float, 3>({67, 7, 6}).view, 0);
  expect_reference_on_every_path(ties<std::int8_t, 4>({9, 5, 4, 5}).view, 0);
}

TEST(Engine, missing_samples) {
  for (const double share : {0.001, 0.02, 0.3}) {
    SCOPED_TRACE(share);
    expect_reference_on_every_path(noise_with_missing<2>({130, 30}, share).view, 0);
    expect_reference_on_every_path(noise_with_missing<3>({70, 9, 8}, share).view, 0);
    expect_reference_on_every_path(noise_with_missing<4>({66, 4, 5, 4}, share).view, 0);
  }
  auto rows = noise<float, 3>({65, 8, 6});
  for (const std::size_t row : {0u, 13u, 14u, 30u, 47u})
    std::fill_n(rows.samples.begin() + static_cast<std::ptrdiff_t>(65 * row), 65, NAN);
  expect_reference_on_every_path(rows.view, 0);
  auto doubles = noise<double, 3>({10, 6, 6});
  doubles.samples[77] = NAN;
  expect_reference_on_every_path(doubles.view, 0);
}

TEST(Engine, infinite_samples) {
  auto field = noise<float, 3>({40, 7, 6});
  for (std::size_t i = 0; i < field.samples.size(); i += 3)
    field.samples[i] = i % 2 == 0 ? HUGE_VALF : -HUGE_VALF;
  expect_reference_on_every_path(field.view, 0);
  auto huge = noise<double, 3>({10, 7, 6});
  for (double& sample : huge.samples) sample *= 1e306;
  expect_reference_on_every_path(huge.view, 0);
}

template <class T>
class EngineOf : public testing::Test {};
using SampleTypes = testing::Types<std::uint8_t, std::int8_t, std::uint16_t, std::int16_t, std::uint32_t,
                                   std::int32_t, float, double>;
TYPED_TEST_SUITE(EngineOf, SampleTypes);

TYPED_TEST(EngineOf, inside_above_and_below) {
  using T = TypeParam;
  // Values spread over the type: comparisons that are signed where they should not be would show.
  constexpr double low = std::is_integral_v<T> ? static_cast<double>(std::numeric_limits<T>::lowest()) : -1e3;
  constexpr double high = std::is_integral_v<T> ? static_cast<double>(std::numeric_limits<T>::max()) : 1e3;
  std::mt19937 random(5);
  std::uniform_real_distribution<double> value(low, high);
  const auto field =
      check::make_field<T, 3>(unit_grid<3>({131, 5, 4}), [&](const auto&) { return value(random); });
  for (const Inside inside : {Inside::above, Inside::below})
    for (const double isovalue : {low, low + 0.5, (low + high) / 2, std::floor(high / 3), high, high + 1}) {
      ExtractOptions options;
      options.inside = inside;
      SCOPED_TRACE(isovalue);
      expect_reference_on_every_path(field.view, isovalue, options);
    }
}

TEST(Engine, wide_numbers) {
  const auto field = noise<float, 4>({20, 5, 6, 5});
  for (const Method method : {Method::hull, Method::simplicial})
    for (const Instructions instructions : instructions_here()) {
      ExtractOptions options;
      options.method = method;
      options.precision = Precision::f64;
      options.threads = 2;
      SimplexMesh<4> mesh;
      ASSERT_TRUE(extract_with(field.view, 0, options, EngineOptions{instructions, true}, mesh));
      ASSERT_TRUE(mesh.simplices.wide());
      auto expected = extract_reference(field.view, 0, options);
      ASSERT_TRUE(same_bytes(mesh.positions, expected.positions));
      ASSERT_EQ(mesh.simplices.size(), expected.simplices.size());
      for (std::size_t i = 0; i < mesh.simplices.size(); ++i)
        ASSERT_EQ(mesh.simplices[i], expected.simplices[i]);
    }
}

TEST(Engine, without_edges) {
  const auto field = noise<float, 3>({20, 5, 6});
  ExtractOptions options;
  options.keep_edges = false;
  expect_reference_on_every_path(field.view, 0, options);
}

// Axis 0 of the view is not the one that varies fastest; samples lie apart; axes run backwards in memory.
TEST(Engine, strided_views) {
  const auto field = noise<float, 4>({6, 7, 70, 5});
  FieldView<const float, 4> permuted = field.view;
  std::swap(permuted.grid.axes[0], permuted.grid.axes[2]);
  std::swap(permuted.strides[0], permuted.strides[2]);
  expect_reference_on_every_path(permuted, 0);

  FieldView<const float, 3> every_second = field.view.at_index(3, 2);
  every_second.grid.axes[2].count /= 2;
  every_second.strides[2] *= 2;
  expect_reference_on_every_path(every_second, 0);

  FieldView<const float, 3> backwards = field.view.at_index(0, 1);
  for (const int axis : {0, 1}) {
    backwards.samples += (backwards.grid.axes[axis].count - 1) * backwards.strides[axis];
    backwards.strides[axis] *= -1;
  }
  expect_reference_on_every_path(backwards, 0);
  expect_reference_on_every_path(field.view.cropped(2, 3, 69).cropped(0, 1, 5), 0);
}

TEST(Engine, rectilinear_and_falling_axes) {
  auto field = noise<float, 4>({20, 6, 5, 4});
  auto& axes = field.view.grid.axes;
  axes[0].origin = 0.1, axes[0].spacing = 0.3;
  axes[1].spacing = -0.7;
  axes[3].coordinates = {0, 0.1, 1, 17};
  expect_reference_on_every_path(field.view, 0);
  axes[2].coordinates = {5, 4, 1, 0.25, -3};
  expect_reference_on_every_path(field.view, 0);
}

// Large enough that units are linked layer by layer, and batches wait for those of other threads.
TEST(Engine, any_number_of_threads) {
  const auto field = check::make_field<float, 4>(check::box_grid<4>(40, 0, 6), [](const auto& p) {
    return std::sin(p[0]) * std::cos(p[1]) + std::sin(p[1]) * std::cos(p[2]) + std::sin(p[2] + p[3]);
  });
  SimplexMesh<4> one, mesh;
  ExtractOptions options;
  options.threads = 1;
  ASSERT_TRUE(extract_into(field.view, 0.3, options, one));
  expect_same(one, extract_reference(field.view, 0.3, options));
  for (const int threads : {2, 3, 8})
    for (const std::int64_t unit_samples : {0, 4000, 100}) {
      options.threads = threads;
      ASSERT_TRUE(extract_with(field.view, 0.3, options,
                               EngineOptions{best_instructions(), false, unit_samples}, mesh));
      expect_same(mesh, one);
    }
}

// What a mesh held before does not show.
TEST(Engine, into_a_used_mesh) {
  SimplexMesh<3> mesh;
  const auto large = noise<float, 3>({70, 20, 20}), small = noise<float, 3>({9, 5, 4});
  ExtractOptions options;
  for (const auto* field : {&large, &small, &large}) {
    options.precision = options.precision == Precision::f32 ? Precision::f64 : Precision::f32;
    options.keep_edges = !options.keep_edges;
    ASSERT_TRUE(extract_into(field->view, 0, options, mesh));
    expect_same(mesh, extract_reference(field->view, 0, options));
    EXPECT_EQ(mesh.grid_axes.empty(), !options.keep_edges);
  }
  ASSERT_TRUE(extract_into(large.view, 1e9, options, mesh));
  EXPECT_EQ(mesh.simplex_count(), 0u);
}

// Ranges noted down at one isovalue serve others; those of another field do not.
TEST(Engine, ranges_of_the_same_field_only) {
  FieldRanges ranges;
  Workspace workspace;
  ExtractOptions options;
  options.ranges = &ranges;
  options.workspace = &workspace;
  const auto smooth = check::make_field<float, 3>(
      check::box_grid<3>(70, -1, 1), [](const auto& p) { return p[0] * p[0] + 2 * p[1] * p[1] - p[2]; });
  auto other = smooth;
  other.view.samples = other.samples.data();
  for (float& sample : other.samples) sample = -sample;
  for (const Inside inside : {Inside::above, Inside::below})
    for (const auto& view : {smooth.view, other.view, smooth.view})
      for (const double isovalue : {0.5, -0.25, 0.0, 0.75, 100.0}) {
        options.inside = inside;
        SimplexMesh<3> mesh;
        ASSERT_TRUE(extract_into(view, isovalue, options, mesh));
        expect_same(mesh, extract_reference(view, isovalue, options));
      }
  // Changed samples are seen after `clear`; a field of another type or dimension in the same memory at once.
  other.samples[70 * 70 * 35 + 70 * 35 + 35] = 9;
  ranges.clear();
  SimplexMesh<3> mesh;
  ASSERT_TRUE(extract_into(other.view, 0.5, options, mesh));
  expect_same(mesh, extract_reference(other.view, 0.5, options));
  const auto slice = other.view.at_index(2, 35);
  SimplexMesh<2> lines;
  ASSERT_TRUE(extract_into(slice, 0.5, options, lines));
  expect_same(lines, extract_reference(slice, 0.5, options));
}

TEST(Engine, several_isovalues_at_once) {
  const auto field = noise<float, 3>({70, 9, 8});
  const std::vector<double> isovalues{-10, 0, 0, 30, 1e9};
  const auto meshes = extract(field.view, std::span<const double>(isovalues));
  ASSERT_TRUE(meshes);
  ASSERT_EQ(meshes->size(), isovalues.size());
  std::uint64_t bytes = 0;
  for (std::size_t i = 0; i < isovalues.size(); ++i) {
    expect_same((*meshes)[i], extract_reference(field.view, isovalues[i]));
    bytes += (*meshes)[i].positions.bytes() + (*meshes)[i].edges.size() * 8 + (*meshes)[i].simplices.bytes();
  }
  ExtractOptions options;
  options.memory_limit = bytes;
  EXPECT_TRUE(extract(field.view, std::span<const double>(isovalues), options));
  options.memory_limit = bytes - 1;
  const auto too_large = extract(field.view, std::span<const double>(isovalues), options);
  ASSERT_FALSE(too_large);
  EXPECT_EQ(too_large.error().code, Code::out_of_memory);
}

TEST(Engine, memory_limit_says_what_is_needed) {
  const auto field = noise<float, 3>({70, 20, 20});
  const auto whole = extract_reference(field.view, 0);
  const std::size_t bytes = whole.positions.bytes() + whole.edges.size() * 8 + whole.simplices.bytes();
  ExtractOptions options;
  options.memory_limit = bytes;
  EXPECT_TRUE(extract(field.view, 0, options));
  for (const std::size_t limit : {bytes - 1, bytes / 2, bytes / 100, std::size_t{0}}) {
    options.memory_limit = limit;
    const auto mesh = extract(field.view, 0, options);
    ASSERT_FALSE(mesh);
    EXPECT_EQ(mesh.error().code, Code::out_of_memory);
    EXPECT_NE(mesh.error().message.find(byte_size(bytes)), std::string::npos) << mesh.error().message;
  }
}

TEST(Engine, progress_rises_and_cancels) {
  const auto field = noise<float, 3>({70, 40, 60});
  for (const int threads : {1, 3}) {
    ExtractOptions options;
    options.threads = threads;
    double last = 0;
    options.progress = [&](double share) {
      EXPECT_GE(share, last);
      EXPECT_LE(share, 1);
      last = share;
      return true;
    };
    ASSERT_TRUE(extract(field.view, 0, options));
    EXPECT_GT(last, 0);
    options.progress = [](double) { return false; };
    const auto mesh = extract(field.view, 0, options);
    ASSERT_FALSE(mesh);
    EXPECT_EQ(mesh.error().code, Code::cancelled);
  }
}
