// Interval volumes: against the lifted field made real, against known numbers, and by what their users rely
// on.

#include "check.hpp"
#include "extract/reference.hpp"
#include "hyperiso/interval.hpp"

#include <cmath>
#include <limits>
#include <numbers>

using namespace hyperiso;
using namespace hyperiso::check;

namespace {

template <class T, int D>
VolumeMesh<D> filled(const OwnedField<T, D>& field, std::vector<double> levels,
                     const IntervalOptions& options = {}) {
  auto volume = interval(field.view, std::span<const double>(levels), options);
  EXPECT_TRUE(volume) << volume.error().message;
  return *std::move(volume);
}

// paper 000 section 6
OwnedField<double, 3> paper_sphere() {
  return make_field<double, 3>(box_grid<3>(14, 0, 1), [](const auto& p) {
    double sum = 0;
    for (const double x : p) sum += (x - 0.5) * (x - 0.5);
    return sum;
  });
}

IntervalOptions options_of(Method method, Inside inside = Inside::above, LevelAxis axis = LevelAxis::last) {
  IntervalOptions options;
  options.method = method;
  options.inside = inside;
  options.level_axis = axis;
  options.precision = Precision::f64;
  return options;
}

// The field with an axis of levels before or behind its own, each sample less its level.
template <int D>
OwnedField<double, D + 1> lifted(const FieldView<const float, D>& field, const std::vector<double>& levels,
                                 LevelAxis place) {
  std::array<std::int64_t, D + 1> dims;
  const int shift = place == LevelAxis::first ? 1 : 0, level_axis = place == LevelAxis::first ? 0 : D;
  for (int axis = 0; axis < D; ++axis) dims[axis + shift] = field.grid.axes[axis].count;
  dims[level_axis] = static_cast<std::int64_t>(levels.size());
  return make_field<double, D + 1>(unit_grid<D + 1>(dims), [&](const auto& point) {
    std::array<std::int64_t, D> index;
    for (int axis = 0; axis < D; ++axis) index[axis] = static_cast<std::int64_t>(point[axis + shift]);
    return static_cast<double>(field.at(index)) - levels[static_cast<std::size_t>(point[level_axis])];
  });
}

// The positions of each simplex' corners, without regard to orientation, the level axis left out.
template <int D>
std::multiset<std::multiset<std::vector<double>>> projected(const Mesh& mesh, int left_out) {
  std::multiset<std::multiset<std::vector<double>>> all;
  const auto dimension = static_cast<std::size_t>(mesh.dimension);
  for (std::size_t simplex = 0; simplex < mesh.simplex_count(); ++simplex) {
    std::multiset<std::vector<double>> corners;
    for (std::size_t corner = 0; corner <= D; ++corner) {
      std::vector<double> point;
      for (std::size_t k = 0; k < dimension; ++k)
        if (static_cast<int>(k) != left_out)
          point.push_back(mesh.positions[mesh.simplices[simplex * (D + 1) + corner] * dimension + k]);
      corners.insert(point);
    }
    all.insert(corners);
  }
  return all;
}

template <int D>
void expect_the_lifted_surface(const OwnedField<float, D>& field, const std::vector<double>& levels) {
  for (const Method method : {Method::hull, Method::component, Method::simplicial})
    for (const Inside inside : {Inside::above, Inside::below})
      for (const LevelAxis place : {LevelAxis::last, LevelAxis::first}) {
        const auto options = options_of(method, inside, place);
        const auto volume = filled(field, levels, options);
        const auto real = lifted<D>(field.view, levels, place);
        const auto surface = extract_reference(real.view, 0, options);
        EXPECT_EQ(volume.vertex_count(), surface.vertex_count());
        EXPECT_TRUE(projected<D>(volume, -1) == projected<D>(surface, place == LevelAxis::first ? 0 : D));
      }
}

} // namespace

// The samples are whole numbers and the levels too, so both ways compute the same bits.
TEST(Interval, is_the_projected_surface_of_the_lifted_field) {
  for (unsigned seed = 0; seed < 3; ++seed) {
    expect_the_lifted_surface(random_field<float, 2>({9, 7}, 6, seed), {-2, 3});
    expect_the_lifted_surface(random_field<float, 2>({6, 70}, 6, seed), {-3, -1, 0, 4});
    expect_the_lifted_surface(random_field<float, 3>({5, 4, 6}, 6, seed), {-2, 3});
    expect_the_lifted_surface(random_field<float, 3>({4, 5, 3}, 3, seed), {-1, 0, 2});
    expect_the_lifted_surface(random_field<float, 4>({3, 3, 2, 3}, 4, seed), {-2, 3});
    expect_the_lifted_surface(random_field<float, 4>({2, 3, 3, 2}, 3, seed), {-1, 0, 2});
  }
}

TEST(Interval, sphere_of_paper_000) {
  const auto field = paper_sphere();
  const std::vector<double> levels{0.35, 0.37};
  const auto paper = filled(field, levels, options_of(Method::hull, Inside::below, LevelAxis::first));
  EXPECT_EQ(paper.vertex_count(), 1496u);
  EXPECT_EQ(paper.simplex_count(), 4204u);
  for (const Inside inside : {Inside::above, Inside::below})
    for (const LevelAxis axis : {LevelAxis::last, LevelAxis::first}) {
      const auto variant = filled(field, levels, options_of(Method::hull, inside, axis));
      EXPECT_EQ(variant.vertex_count(), 1496u);
      EXPECT_GE(variant.simplex_count(), 4048u);
      EXPECT_LE(variant.simplex_count(), 4236u);
    }
  const auto simplicial = filled(field, levels, options_of(Method::simplicial));
  EXPECT_EQ(simplicial.simplex_count(), 21108u);
  EXPECT_EQ(simplicial.vertex_count(), 5762u);
  const auto found = measure(paper);
  EXPECT_EQ(found->bad_facets, 0u);
  EXPECT_EQ(found->inverted_simplices, 0u);
}

// Of the sphere, and of random values with ties.
TEST(Interval, barycentric_volumes_are_sound_and_never_fold) {
  IntervalOptions options = options_of(Method::barycentric);
  options.cut = Cut::staircase;
  const auto sphere = filled(paper_sphere(), {0.35, 0.37}, options);
  EXPECT_EQ(sphere.simplex_count(), 92544u);
  EXPECT_EQ(sphere.vertex_count(), 21340u);
  for (const Cut cut : {Cut::staircase, Cut::midpoints})
    for (const int range : {3, 1000}) {
      options.cut = cut;
      double content = 0;
      for (const auto& [low, high] : {std::pair{-4. * range, 0.}, {0., 4. * range}}) {
        const auto found =
            measure(filled(random_field<double, 3>({4, 3, 4}, range, 8), {low, high}, options));
        EXPECT_EQ(found->bad_facets, 0u);
        if (range > 3) { // where samples equal levels there are simplices without content, up to rounding
          EXPECT_EQ(found->inverted_simplices, 0u);
        }
        content += found->content;
      }
      EXPECT_NEAR(content, 3 * 2 * 3, 1e-9) << "the whole box";
    }
}

// The volume between two spheres, at second order in the grid.
template <int D>
void expect_shell(double unit_ball, std::array<std::int64_t, 2> cells, std::int64_t euler_characteristic) {
  for (const Method method : {Method::hull, Method::simplicial}) {
    std::array<double, 2> error;
    for (std::size_t grid = 0; grid < 2; ++grid) {
      const auto field = make_field<double, D>(box_grid<D>(cells[grid] + 1, -1, 1), [](const auto& p) {
        return std::sqrt(std::inner_product(p.begin(), p.end(), p.begin(), 0.));
      });
      const auto found = measure(filled(field, {0.5, 0.8}, options_of(method)));
      EXPECT_EQ(found->bad_facets, 0u);
      EXPECT_EQ(found->euler_characteristic, euler_characteristic);
      error[grid] = std::abs(found->content - unit_ball * (std::pow(0.8, D) - std::pow(0.5, D)));
    }
    const double refined = static_cast<double>(cells[1]) / static_cast<double>(cells[0]);
    EXPECT_GT(std::log(error[0] / error[1]) / std::log(refined), 1.7);
  }
}

TEST(Interval, volume_of_a_shell) {
  using std::numbers::pi;
  expect_shell<2>(pi, {8, 64}, 0);
  expect_shell<3>(4. / 3 * pi, {10, 20}, 2);
  expect_shell<4>(pi * pi / 2, {6, 9}, 0);
}

// `box` is the content of the grid. The last field has many samples equal to the levels.
template <int D>
void expect_sums(const std::array<std::int64_t, D>& dims, double box) {
  for (const int range : {1000, 3}) {
    const auto field = random_field<double, D>(dims, range, 4);
    const auto content = [&](std::vector<double> levels) {
      const auto found = measure(filled(field, std::move(levels), options_of(Method::simplicial)));
      EXPECT_EQ(found->inverted_simplices, 0u);
      EXPECT_EQ(found->bad_facets, 0u);
      return found->content;
    };
    const double low = -range / 3, middle = 0, high = range * 2 / 3;
    EXPECT_NEAR(content({low, middle}) + content({middle, high}), content({low, high}), 1e-12 * box);
    EXPECT_NEAR(content({low, middle, middle + 1, high}), content({low, high}), 1e-12 * box);
    EXPECT_NEAR(content({-2. * range, 2. * range}), box, 1e-12 * box) << "the whole box";
  }
}

TEST(Interval, simplicial_volumes_add_up_and_never_fold) {
  expect_sums<2>({9, 8}, 8 * 7);
  expect_sums<3>({6, 5, 6}, 5 * 4 * 5);
  expect_sums<4>({3, 4, 3, 4}, 2 * 3 * 2 * 3);
}

// The boundary of a volume is the two surfaces and the walls: without walls, the levels' own surfaces.
template <int D>
void expect_bounded_by_its_levels(const std::array<std::int64_t, D>& dims) {
  for (const Method method : {Method::hull, Method::component, Method::simplicial})
    for (const int range : {3, 1000}) {
      auto field = random_field<float, D>(dims, range, 11);
      std::size_t sample = 0;
      for_each_index<D>(dims, [&](const auto& index) {
        for (int axis = 0; axis < D; ++axis)
          if (index[axis] == 0 || index[axis] == dims[axis] - 1) field.samples[sample] = -5.f * range;
        ++sample;
      });
      const double low = -range / 3, high = range / 3;
      const auto volume = filled(field, {low, high}, options_of(method));
      const auto found = measure(volume);
      EXPECT_EQ(found->bad_facets, 0u);
      const ExtractOptions options = options_of(method);
      EXPECT_EQ(found->boundary_facets, extracted(field, low, options).simplex_count() +
                                            extracted(field, high, options).simplex_count());
    }
}

TEST(Interval, is_bounded_by_the_surfaces_of_its_levels) {
  expect_bounded_by_its_levels<2>({11, 9});
  expect_bounded_by_its_levels<3>({6, 7, 6});
  expect_bounded_by_its_levels<4>({5, 5, 4, 5});
}

// On random values the hull table folds a few simplices; on falling axes, in 2D and 3D and by both labels the
// others must still be positive.
template <int D>
void expect_positive(const std::array<std::int64_t, D>& dims) {
  for (const Inside inside : {Inside::above, Inside::below})
    for (const LevelAxis axis : {LevelAxis::last, LevelAxis::first})
      for (unsigned reversed = 0; reversed < 1u << D; ++reversed) {
        auto field = random_field<double, D>(dims, 1000, reversed);
        for (int k = 0; k < D; ++k)
          if (reversed >> k & 1) field.view.grid.axes[k].spacing = -1;
        const auto found = measure(filled(field, {-200.5, 300.5}, options_of(Method::hull, inside, axis)));
        EXPECT_EQ(found->bad_facets, 0u);
        EXPECT_LT(
            static_cast<double>(found->inverted_simplices),
            0.03 *
                static_cast<double>(
                    filled(field, {-200.5, 300.5}, options_of(Method::hull, inside, axis)).simplex_count()));
      }
}

TEST(Interval, simplices_are_positive) {
  expect_positive<2>({14, 13});
  expect_positive<3>({6, 7, 6});
  expect_positive<4>({4, 4, 3, 4});
}

TEST(Interval, attributes_tell_level_and_isovalue) {
  const auto field = make_field<double, 2>(unit_grid<2>({5, 3}), [](const auto& p) { return p[0]; });
  const auto volume = filled(field, {0.25, 2.25, 2.75}, options_of(Method::hull));
  const auto& level = std::get<std::vector<double>>(volume.attributes.at(0).values);
  const auto& isovalue = std::get<std::vector<double>>(volume.attributes.at(1).values);
  ASSERT_EQ(level.size(), volume.vertex_count());
  for (std::size_t vertex = 0; vertex < level.size(); ++vertex) {
    EXPECT_DOUBLE_EQ(isovalue[vertex], volume.positions[vertex * 2]); // the field is x
    EXPECT_GE(level[vertex], 0);
    EXPECT_LE(level[vertex], 2);
  }
  EXPECT_DOUBLE_EQ(measure(volume)->content, 2.5 * 2);
}

TEST(Interval, missing_data_and_levels_beyond_the_type) {
  auto field = random_field<float, 3>({5, 5, 5}, 9, 2);
  field.samples[62] = std::numeric_limits<float>::quiet_NaN();
  const auto found = measure(filled(field, {-100, 100}, options_of(Method::simplicial)));
  EXPECT_NEAR(found->content, 64 - 8, 1e-9);
  const auto bytes = random_field<std::int8_t, 3>({5, 5, 5}, 9, 2);
  EXPECT_NEAR(measure(filled(bytes, {-1000, 1000}, options_of(Method::simplicial)))->content, 64, 1e-9);
  EXPECT_EQ(filled(bytes, {500, 1000}).simplex_count(), 0u);
}

// What the lifted surface takes, and the two attributes of its vertices.
TEST(Interval, memory_limit_counts_the_attributes) {
  const auto field = check::random_field<float, 3>({12, 11, 10}, 1000, 1);
  for (const Precision precision : {Precision::f32, Precision::f64}) {
    IntervalOptions options;
    options.precision = precision;
    const auto volume = interval(field.view, -200, 200, options);
    ASSERT_TRUE(volume);
    const std::size_t number = precision == Precision::f64 ? 8 : 4;
    options.memory_limit = volume->vertex_count() * (4 * number + 8 + 16) + volume->simplices.bytes();
    EXPECT_TRUE(interval(field.view, -200, 200, options));
    --options.memory_limit;
    const auto too_large = interval(field.view, -200, 200, options);
    ASSERT_FALSE(too_large);
    EXPECT_EQ(too_large.error().code, Code::out_of_memory);
  }
}

// Where the field is flat at a level it belongs to one of the volumes on its two sides.
TEST(Interval, flat_at_a_level) {
  const auto flat = check::make_field<float, 2>(check::box_grid<2>(3, 0, 2), [](const auto&) { return 1.0; });
  for (const Inside inside : {Inside::above, Inside::below}) {
    IntervalOptions options;
    options.inside = inside;
    const auto ends_there = interval(flat.view, 0, 1, options),
               begins_there = interval(flat.view, 1, 2, options);
    ASSERT_TRUE(ends_there && begins_there);
    const auto &full = inside == Inside::above ? *begins_there : *ends_there,
               &empty = inside == Inside::above ? *ends_there : *begins_there;
    EXPECT_EQ(empty.simplex_count(), 0u);
    EXPECT_DOUBLE_EQ(measure_contents(full)->content, 4);
  }
}

TEST(Interval, levels_that_make_no_range) {
  const auto field = random_field<float, 2>({3, 3}, 9, 2);
  for (const std::vector<double>& bad :
       {std::vector<double>{}, {1}, {1, 1}, {2, 1}, {0, NAN}, {0, HUGE_VAL}}) {
    const auto volume = interval(field.view, std::span<const double>(bad));
    ASSERT_FALSE(volume);
    EXPECT_EQ(volume.error().code, Code::invalid_isovalue);
  }
  EXPECT_EQ(filled(random_field<float, 2>({3, 1}, 9, 2), {0, 1}).simplex_count(), 0u);
}
