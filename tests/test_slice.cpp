// Slices at and between the stored steps: at a step, the surface of that step.

#include "slice_fields.hpp"

#include <limits>
#include <numbers>

using namespace hyperiso;
using namespace hyperiso::check;

TEST(Slice, moving_ball_between_and_at_steps) {
  const auto field = moving_ball();
  const auto surface = extracted(field, 0, {.precision = Precision::f64});
  for (const double time : {2.0, 2.1, 2.25, 2.4999, 2.5, 2.9, 3.0}) {
    const auto cut = sliced(surface, Hyperplane<4>::at(3, time), {.precision = Precision::f64});
    const auto found = measure(cut);
    EXPECT_TRUE(found->closed) << time;
    EXPECT_EQ(found->bad_facets, 0u);
    EXPECT_EQ(found->euler_characteristic, 2);
    EXPECT_NEAR(found->content / (4 * std::numbers::pi * 1.21), 1, 0.01) << time;
    EXPECT_NEAR(enclosed_volume(cut) / (4. / 3 * std::numbers::pi * 1.331), 1, 0.02) << time;
    for (const double component : found->vector_area) EXPECT_NEAR(component, 0, 1e-12);
  }
}

// The promise that lets a movie pass through the stored steps: all steps, first and last too, with ties.
TEST(Slice, at_a_stored_step_it_is_the_extraction_of_that_step) {
  for (unsigned seed = 0; seed < 4; ++seed)
    for (const int range : {1, 2, 1000}) {
      const auto field = random_field<float, 4>({4, 5, 3, 4}, range, seed);
      const auto surface = extracted(field, 0);
      for (int axis = 0; axis < 4; ++axis)
        for (std::int64_t step = 0; step < field.view.dims()[axis]; ++step) {
          const auto plane = Hyperplane<4>::at(axis, static_cast<double>(step));
          const auto expected = extract(field.view.at_index(axis, step), 0);
          const auto cut = sliced(surface, plane);
          expect_same_mesh(cut, *expected);
          EXPECT_EQ(cut.edges, expected->edges);
          expect_same_mesh(*slice(field.view, 0, plane), *expected);
        }
    }
}

TEST(Slice, at_a_stored_step_by_the_simplicial_method) {
  const auto field = random_field<float, 4>({4, 3, 5, 3}, 2, 8);
  const ExtractOptions simplicial{.method = Method::simplicial};
  const auto surface = extracted(field, 0, simplicial);
  for (int axis = 0; axis < 4; ++axis)
    for (std::int64_t step = 0; step < field.view.dims()[axis]; ++step)
      expect_same_mesh(sliced(surface, Hyperplane<4>::at(axis, static_cast<double>(step))),
                       *extract(field.view.at_index(axis, step), 0, simplicial));
}

TEST(Slice, at_a_stored_plane_of_a_3d_field) {
  const auto field = random_field<std::int16_t, 3>({5, 4, 6}, 2, 9);
  const auto surface = extracted(field, 0, {.inside = Inside::below});
  for (int axis = 0; axis < 3; ++axis)
    for (std::int64_t layer = 0; layer < field.view.dims()[axis]; ++layer)
      expect_same_mesh(sliced(surface, Hyperplane<3>::at(axis, static_cast<double>(layer))),
                       *extract(field.view.at_index(axis, layer), 0, {.inside = Inside::below}));
}

// Cells around NaN are left out of the surface, on one side of a step or on both; the trace takes what is
// there.
TEST(Slice, at_a_stored_step_beside_missing_data) {
  auto field = random_field<float, 4>({4, 4, 4, 3}, 1000, 5);
  field.samples[3] = field.samples[70] = std::numeric_limits<float>::quiet_NaN(); // steps 0 and 1
  const auto cut = sliced(extracted(field, 0), Hyperplane<4>::at(3, 2));
  const auto whole = simplex_set(*extract(field.view.at_index(3, 2), 0));
  const auto part = simplex_set(cut);
  EXPECT_TRUE(std::ranges::includes(whole, part));
  EXPECT_LT(part.size(), whole.size());
  expect_same_mesh(*slice(field.view, 0, Hyperplane<4>::at(3, 2)), *extract(field.view.at_index(3, 2), 0));
}

TEST(Slice, between_steps_the_field_and_the_mesh_give_the_same) {
  for (unsigned seed = 0; seed < 4; ++seed)
    for (const int range : {1, 1000}) {
      const auto field = random_field<float, 4>({4, 3, 5, 4}, range, seed);
      const auto surface = extracted(field, 0);
      for (int axis = 0; axis < 4; ++axis)
        for (const double value : {0.25, 1.5, 1 + 1e-12, 2 - 1e-12}) {
          const auto plane = Hyperplane<4>::at(axis, value);
          const auto cut = sliced(surface, plane);
          expect_same_mesh(*slice(field.view, 0, plane), cut);
          EXPECT_EQ(measure(cut)->bad_facets, 0u);
          EXPECT_GT(cut.simplex_count(), 0u);
        }
    }
}

// Rounding a time to f32 moves it past the plane: the vertices of a step must stay on their side of it.
TEST(Slice, a_time_that_rounding_would_move_across_the_plane) {
  auto field = moving_ball();
  for (const double time : {2.25 + 1e-12, 2.5 - 1e-12}) {
    const auto found = measure(sliced(extracted(field, 0), Hyperplane<4>::at(3, time)));
    EXPECT_EQ(found->euler_characteristic, 2);
    EXPECT_TRUE(found->closed);
  }
}

// A turned space and a time in other units: the steps must still be found, where they are now.
TEST(Slice, at_a_stored_step_of_a_transformed_mesh) {
  const auto field = random_island(5, 3);
  const Affine map{{0.8, -0.6, 0, 0, 0.6, 0.8, 0, 0, 0, 0, -2, 0, 0, 0, 0, 0.3}, {1, 2, 3, 0.1}};
  const Affine map_of_space{{0.8, -0.6, 0, 0.6, 0.8, 0, 0, 0, -2}, {1, 2, 3}};
  for (const Precision precision : {Precision::f32, Precision::f64}) {
    auto surface = extracted(field, 0, {.precision = precision});
    transform(surface, map);
    for (std::int64_t step = 0; step < 4; ++step) {
      auto expected = *extract(field.view.at_index(3, step), 0, {.precision = precision});
      transform(expected, map_of_space);
      const auto cut =
          sliced(surface, Hyperplane<4>::at(3, surface.grid_axes[3].coordinate(step)), {precision});
      EXPECT_NEAR(surface.grid_axes[3].coordinate(step), 0.1 + 0.3 * static_cast<double>(step), 1e-6);
      EXPECT_EQ(simplex_set(cut), simplex_set(expected)) << step;
      EXPECT_EQ(cut.edges, expected.edges);
    }
    // Planes across axes that are no longer axes of the grid are planes like any other.
    for (const double x : {0.0, 1.0, 2.0, 0.25}) {
      const auto cut = sliced(surface, Hyperplane<4>::at(0, x), {precision});
      EXPECT_GT(cut.simplex_count(), 0u);
      EXPECT_EQ(measure(cut)->bad_facets, 0u);
    }
  }
}
