// Slices of interval volumes: those of steps at steps, and what is between two levels anywhere else.

#include "check.hpp"
#include "hyperiso/interval.hpp"
#include "hyperiso/slice.hpp"

#include <cmath>
#include <numbers>

using namespace hyperiso;
using namespace hyperiso::check;

namespace {

IntervalOptions options_of(Method method, Inside inside, LevelAxis place) {
  IntervalOptions options;
  options.method = method;
  options.inside = inside;
  options.level_axis = place;
  return options;
}

// A slice across any axis at any of its samples, at the ends too, is the volume of these samples alone, with
// its attributes and its own grid edges.
template <int D>
void expect_volumes_of_the_layers(const OwnedField<float, D>& field, const std::vector<double>& levels) {
  for (const Method method : {Method::hull, Method::component, Method::simplicial})
    for (const Inside inside : {Inside::above, Inside::below})
      for (const LevelAxis place : {LevelAxis::last, LevelAxis::first}) {
        const auto options = options_of(method, inside, place);
        const auto volume = *interval(field.view, std::span<const double>(levels), options);
        for (int axis = 0; axis < D; ++axis)
          for (std::int64_t index = 0; index < field.view.grid.axes[axis].count; ++index) {
            const double value = field.view.grid.axes[axis].coordinate(index);
            const auto cut = *slice(volume, Hyperplane<D>::at(axis, value));
            const auto layer =
                *interval(field.view.at_index(axis, index), std::span<const double>(levels), options);
            expect_same_mesh(cut, layer);
            EXPECT_TRUE(std::ranges::equal(cut.edges, layer.edges));
            ASSERT_EQ(cut.attributes.size(), 2u);
            for (std::size_t k = 0; k < 2; ++k) {
              EXPECT_EQ(cut.attributes[k].name, layer.attributes[k].name);
              EXPECT_TRUE(cut.attributes[k].values == layer.attributes[k].values);
            }
          }
      }
}

} // namespace

TEST(SliceOfInterval, at_stored_samples_it_is_the_volume_of_those_samples) {
  expect_volumes_of_the_layers(random_field<float, 3>({5, 4, 6}, 4, 1), {-2, 1});
  expect_volumes_of_the_layers(random_field<float, 3>({4, 5, 4}, 3, 2), {-1, 0, 2});
  expect_volumes_of_the_layers(random_field<float, 4>({3, 4, 3, 4}, 4, 3), {-2, 1});
  expect_volumes_of_the_layers(random_field<float, 4>({3, 3, 3, 3}, 3, 4), {-1, 0, 2});
}

TEST(SliceOfInterval, at_stored_samples_of_falling_and_uneven_axes) {
  auto field = random_field<float, 4>({4, 3, 3, 3}, 4, 5);
  field.view.grid.axes[1].spacing = -0.3;
  field.view.grid.axes[3].coordinates = {0.1, 0.7, 4};
  expect_volumes_of_the_layers(field, {-2, 1});
}

// Between steps: sound, oriented, with levels between those of its corners, and by the simplicial method
// exactly as large as the share of the box that the interpolated field says.
TEST(SliceOfInterval, between_steps_of_random_values) {
  const auto field = random_field<double, 4>({4, 5, 4, 3}, 5, 6);
  for (const Method method : {Method::hull, Method::component, Method::simplicial}) {
    auto options = options_of(method, Inside::above, LevelAxis::last);
    options.precision = Precision::f64;
    const std::vector<double> levels{-6, -1, 0, 6};
    const auto volume = *interval(field.view, std::span<const double>(levels), options);
    for (const double time : {0.25, 0.5, 1.9}) {
      const auto cut = *slice(volume, Hyperplane<4>::at(3, time), {Precision::f64});
      const auto found = *measure(cut);
      EXPECT_EQ(found.bad_facets, 0u);
      EXPECT_EQ(found.euler_characteristic, 1) << "the whole box";
      const auto& isovalue = std::get<std::vector<double>>(cut.attributes.at(1).values);
      EXPECT_GE(std::ranges::min(isovalue), -6);
      EXPECT_LE(std::ranges::max(isovalue), 6);
      if (method != Method::simplicial) continue;
      EXPECT_NEAR(found.content, 3 * 4 * 3, 1e-9) << "nothing folded: no piece counted twice";
    }
  }
}

// A shell whose radii grow with time, cut at a moment between two steps.
TEST(SliceOfInterval, between_steps_of_a_growing_shell) {
  Grid<4> grid;
  for (int axis = 0; axis < 3; ++axis) grid.axes[axis] = box_grid<3>(25, -1.5, 1.5).axes[axis];
  grid.axes[3].count = 3;
  const auto field = make_field<double, 4>(
      grid, [](const auto& p) { return std::sqrt(p[0] * p[0] + p[1] * p[1] + p[2] * p[2]) - 0.2 * p[3]; });
  const auto volume = *interval(field.view, 0.6, 0.9);
  for (const double time : {0.0, 0.4, 1.0, 1.7, 2.0}) {
    const auto found = *measure(*slice(volume, Hyperplane<4>::at(3, time)));
    const double inner = 0.6 + 0.2 * time, outer = 0.9 + 0.2 * time;
    EXPECT_NEAR(found.content / (4. / 3 * std::numbers::pi * (std::pow(outer, 3) - std::pow(inner, 3))), 1,
                0.02)
        << time;
    EXPECT_EQ(found.bad_facets, 0u);
    EXPECT_EQ(found.euler_characteristic, 2);
  }
}
