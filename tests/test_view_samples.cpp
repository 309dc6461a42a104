// Pages that hold samples: what is left out and rounded must not change the surface.

#include "core/random.hpp"
#include "hyperiso/extract.hpp"
#include "view/pack_field.hpp"
#include "view/surface_of_codes.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace hyperiso {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

// Random samples of a few values, some of them the isovalue; with NaN and infinities if the type has them.
template <class T, int D>
Field random_field(std::array<std::int64_t, D> dims, std::uint64_t seed, bool special) {
  FieldInfo info;
  info.type = sample_type_of<T>();
  for (int axis = 0; axis < D; ++axis)
    info.axes.push_back({.count = dims[axis], .spacing = axis == 1 ? -0.5 : 2.0});
  NewField made = *allocate_field(info);
  auto* samples = reinterpret_cast<T*>(made.samples);
  const std::int64_t count = info.samples();
  for (std::int64_t i = 0; i < count; ++i) {
    const std::uint64_t number = scramble(seed, static_cast<std::uint64_t>(i));
    // Long runs on one side, so that a band leaves something out.
    double value = (i / 37) % 3 == 0 ? static_cast<double>(number % 7) : i / 500 % 2 ? 7 : 0;
    if (std::is_floating_point_v<T>) value = value * 0.731 + static_cast<double>(number % 1000) * 1e-5;
    if (special && number % 41 == 0) value = std::numeric_limits<double>::quiet_NaN();
    if (special && number % 43 == 0) value = number % 2 ? infinity : -infinity;
    samples[i] = static_cast<T>(value);
  }
  return made.field;
}

template <int D>
Grid<D> grid_of(const Field& field) {
  Grid<D> grid;
  std::copy(field.info.axes.begin(), field.info.axes.end(), grid.axes.begin());
  return grid;
}

template <int D>
SimplexMesh<D> surface(const SampleLayers& layers, const Field& field, Inside inside) {
  ExtractOptions options;
  options.inside = inside;
  SimplexMesh<D> mesh;
  EXPECT_TRUE(surface_of_codes(layers, grid_of<D>(field), layers.scale().isovalue, options, mesh));
  return mesh;
}

// Through the bytes of blocks of three layers.
SampleLayers decoded(const SampleLayers& layers, const std::vector<std::int64_t>& dims) {
  SampleLayers result(dims, layers.scale(), layers.first_class());
  for (std::int64_t done = 0; done < layers.layers(); done += 3) {
    const std::int64_t count = std::min<std::int64_t>(3, layers.layers() - done);
    EXPECT_TRUE(result.decode(count, layers.encode(done, count)));
  }
  return result;
}

template <class Indices>
bool same(const Indices& a, const Indices& b) {
  if (a.size() != b.size()) return false;
  for (std::size_t i = 0; i < a.size(); ++i)
    if (a[i] != b[i]) return false;
  return true;
}

// Two samples that are rounded, by half a step or to the other side of the isovalue, move the point between
// them by less than two steps of the difference between them.
template <class T, int D>
void expect_near(const Mesh& mesh, const Mesh& wanted, const FieldView<const T, D>& field, double step,
                 bool rounded) {
  for (std::size_t vertex = 0; vertex < mesh.vertex_count(); ++vertex) {
    const auto ends = grid_edge_ends<D>(field.dims(), mesh.edges[vertex]);
    const double difference =
        std::abs(static_cast<double>(field.at(ends.upper)) - static_cast<double>(field.at(ends.lower)));
    const double most = rounded ? std::min(1.0, 2 * step / difference) : 0;
    for (int axis = 0; axis < D; ++axis) {
      const std::size_t i = vertex * D + static_cast<std::size_t>(axis);
      EXPECT_LE(std::abs(mesh.positions[i] - wanted.positions[i]), most * 2.0 + most * 1e-6) << difference;
    }
  }
}

template <class T, int D>
void check(std::array<std::int64_t, D> dims, double isovalue, bool special, bool rounded) {
  for (const Inside inside : {Inside::above, Inside::below})
    for (const bool band : {true, false})
      for (std::uint64_t seed = 1; seed < 4; ++seed) {
        const Field field = random_field<T, D>(dims, seed, special);
        ExtractOptions options;
        options.inside = inside;
        const SimplexMesh<D> wanted = *extract(field.view<T, D>(), isovalue, options);
        const SampleLayers packed = pack_field(field, isovalue, inside, band);
        const SampleLayers layers = decoded(packed, {dims.begin(), dims.end()});
        EXPECT_EQ(layers.codes, packed.codes);
        EXPECT_EQ(layers.kept, packed.kept);
        const SimplexMesh<D> mesh = surface<D>(layers, field, inside);
        ASSERT_TRUE(same(mesh.edges, wanted.edges)) << "band " << band << ", seed " << seed;
        ASSERT_TRUE(same(mesh.simplices, wanted.simplices));
        expect_near(mesh, wanted, field.view<T, D>(), layers.scale().step, rounded);
      }
}

TEST(PageSamples, small_integers_give_the_same_surface_to_the_bit) {
  check<std::uint8_t, 3>({17, 9, 8}, 3, false, false);
  check<std::int8_t, 4>({9, 5, 4, 7}, 2.5, false, false);
  check<std::uint16_t, 4>({8, 2, 6, 5}, 4, false, false);
  check<std::int16_t, 3>({70, 3, 2}, 0.5, false, false);
}

TEST(PageSamples, rounded_samples_give_the_same_simplices) {
  check<float, 3>({17, 9, 8}, 2.2, false, true);
  check<double, 4>({9, 5, 4, 7}, 1.4625, false, true);
  check<std::int32_t, 3>({12, 11, 5}, 3, false, true);
}

TEST(PageSamples, missing_and_infinite_samples_stay_what_they_are) {
  check<float, 3>({17, 9, 8}, 2.2, true, true);
  check<double, 4>({9, 5, 4, 7}, 0.75, true, true);
}

// A sample that equals the isovalue is on its side by the rule, not by rounding.
TEST(PageSamples, the_isovalue_of_a_sample_is_a_code) {
  for (const Inside inside : {Inside::above, Inside::below}) {
    const Field field = random_field<float, 3>({17, 9, 8}, 5, false);
    const double isovalue = static_cast<double>(field.view<float, 3>().samples[0]);
    const SampleLayers layers = pack_field(field, isovalue, inside, false);
    EXPECT_EQ(layers.scale().isovalue, layers.codes[0]);
    EXPECT_TRUE(layers.scale().is_inside(layers.codes[0]));
  }
}

TEST(PageSamples, a_band_keeps_little_of_a_smooth_field) {
  FieldInfo info;
  for (int axis = 0; axis < 3; ++axis) info.axes.push_back({.count = 40});
  NewField made = *allocate_field(info);
  for (int z = 0, i = 0; z < 40; ++z)
    for (int y = 0; y < 40; ++y)
      for (int x = 0; x < 40; ++x, ++i)
        reinterpret_cast<float*>(made.samples)[i] = static_cast<float>(std::hypot(x - 20, y - 20, z - 20));
  const SampleLayers layers = pack_field(made.field, 10.3, Inside::below, true);
  const auto kept = std::count(layers.kept.begin(), layers.kept.end(), 1);
  EXPECT_GT(kept, 1000);
  EXPECT_LT(kept, 6000);
  // All of its codes are spent on what is kept.
  EXPECT_LT(layers.scale().step * 65535, 8);
}

TEST(PageSamples, nothing_crosses_gives_nothing) {
  const Field field = random_field<float, 3>({9, 9, 9}, 1, false);
  for (const double isovalue : {-5.0, 50.0})
    for (const bool band : {true, false}) {
      const SampleLayers layers = decoded(pack_field(field, isovalue, Inside::above, band), {9, 9, 9});
      EXPECT_EQ(surface<3>(layers, field, Inside::above).simplex_count(), 0u);
    }
}

// The step of codes must be a number whatever the range of the samples.
TEST(PageSamples, extreme_ranges) {
  for (const auto& [low, high] : {std::pair{-1.7e308, 1.7e308}, std::pair{5e-324, 1e-323}}) {
    FieldInfo info;
    info.type = SampleType::f64;
    for (int axis = 0; axis < 3; ++axis) info.axes.push_back({.count = 3});
    NewField made = *allocate_field(info);
    auto* samples = reinterpret_cast<double*>(made.samples);
    for (int i = 0; i < 27; ++i) samples[i] = i % 2 ? low : high;
    const double isovalue = low / 2 + high / 2;
    const SimplexMesh<3> wanted = *extract(made.field.view<double, 3>(), isovalue);
    const SampleLayers layers = decoded(pack_field(made.field, isovalue, Inside::above, false), {3, 3, 3});
    EXPECT_TRUE(same(surface<3>(layers, made.field, Inside::above).simplices, wanted.simplices));
    EXPECT_TRUE(std::isfinite(layers.scale().origin));
  }
}

// A damaged page must say so, not read past its bytes.
TEST(PageSamples, bytes_of_another_length_are_refused) {
  const Field field = random_field<float, 3>({17, 9, 8}, 1, false);
  const SampleLayers packed = pack_field(field, 2.2, Inside::above, true);
  std::vector<unsigned char> bytes = packed.encode(0, 8);
  for (const int change : {-1, 1}) {
    SampleLayers layers({17, 9, 8}, packed.scale(), packed.first_class());
    std::vector<unsigned char> other = bytes;
    other.resize(static_cast<std::size_t>(static_cast<std::ptrdiff_t>(bytes.size()) + change));
    EXPECT_FALSE(layers.decode(8, other));
  }
  SampleLayers layers({17, 9, 8}, packed.scale(), packed.first_class());
  EXPECT_FALSE(layers.decode(9, bytes));
  EXPECT_FALSE(layers.decode(-1, {}));
  EXPECT_FALSE(layers.decode(8, {}));
}

} // namespace
} // namespace hyperiso
