// Slices of random and of known surfaces: sound on every plane, and the field's own surface at a stored step.

#include "check.hpp"
#include "hyperiso/interpolate.hpp"
#include "hyperiso/interval.hpp"
#include "hyperiso/slice.hpp"

#include <cmath>
#include <limits>
#include <numbers>

using namespace hyperiso;
using namespace hyperiso::check;

namespace {

template <int D, int K>
SimplexMesh<D - 1, K - 1> sliced(const SimplexMesh<D, K>& mesh, const Hyperplane<D>& plane,
                                 const SliceOptions& options = {}) {
  auto cut = slice(mesh, plane, options);
  EXPECT_TRUE(cut) << cut.error().message;
  return *std::move(cut);
}

// A ball of radius 1.1 that moves along x; its surface in R^4 is a tube, open at the first and last step.
OwnedField<double, 4> moving_ball() {
  Grid<4> grid = box_grid<4>(25, -1.7, 1.7);
  grid.axes[3] = Axis{.count = 5, .origin = 2, .spacing = 0.25};
  return make_field<double, 4>(grid, [](const auto& p) {
    const double x = p[0] - 0.4 * (p[3] - 2.5);
    return 1.1 - std::sqrt(x * x + p[1] * p[1] + p[2] * p[2]);
  });
}

// Random with a constant layer on the walls of all axes but the last: open at the first and the last step
// only.
OwnedField<float, 4> random_island(unsigned seed, int range) {
  const std::array<std::int64_t, 4> dims{6, 5, 5, 4};
  auto field = random_field<float, 4>(dims, range, seed);
  std::size_t sample = 0;
  for_each_index<4>(dims, [&](const auto& index) {
    for (int axis = 0; axis < 3; ++axis)
      if (index[axis] == 0 || index[axis] == dims[axis] - 1)
        field.samples[sample] = static_cast<float>(-range);
    ++sample;
  });
  return field;
}

} // namespace

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

// Planes in general position, through vertices, and along whole simplices: no cracks, no clashing neighbours.
TEST(Slice, any_plane_of_an_island_is_open_at_the_first_and_last_step_only) {
  const std::vector<Hyperplane<4>> planes{
      {{1, 0, 0, 0}, 2.5},      {{0.3, -0.2, 0.5, 0.1}, 1.2}, {{1, 1, 0, 0}, 4},   {{1, 1, 1, 0}, 6},
      {{1, 0, 0, 1}, 3},        {{0, -1, 0, 0}, -2},          {{0, 0, 0, 1}, 1.5}, {{0, 0, 0, -2}, -2},
      {{1, -1, 0.5, -0.25}, 0}, {{1e-3, 0, 1e-3, 1}, 1.5}};
  for (unsigned seed = 0; seed < 3; ++seed)
    for (const int range : {1, 1000}) {
      auto surface = extracted(random_island(seed, range), 0, {.precision = Precision::f64});
      std::vector<double> times;
      for (std::size_t vertex = 0; vertex < surface.vertex_count(); ++vertex)
        times.push_back(surface.positions[4 * vertex + 3]);
      surface.attributes.push_back({"t", Attribute::Location::vertex, 1, times});
      for (const bool with_edges : {true, false}) {
        if (!with_edges) surface.edges.clear();
        for (const auto& plane : planes) {
          const auto cut = sliced(surface, plane, {.precision = Precision::f64});
          EXPECT_EQ(measure(cut)->bad_facets, 0u);
          EXPECT_GT(cut.simplex_count(), 0u);
          const auto& cut_times = std::get<std::vector<double>>(cut.attributes[0].values);
          for (const auto& facet : boundary_facets(cut))
            for (const double end : {0., 3.}) {
              if (cut_times[facet[0]] != end) continue;
              EXPECT_TRUE(std::ranges::all_of(facet, [&](auto vertex) { return cut_times[vertex] == end; }));
            }
          for (const auto& facet : boundary_facets(cut))
            EXPECT_TRUE(cut_times[facet[0]] == 0 || cut_times[facet[0]] == 3);
        }
      }
    }
}

TEST(Slice, does_not_depend_on_the_order_of_simplices) {
  const auto surface = extracted(random_field<float, 4>({4, 4, 4, 4}, 3, 2), 0);
  auto shuffled = surface;
  std::vector<std::size_t> order(surface.simplex_count());
  std::iota(order.begin(), order.end(), 0u);
  std::shuffle(order.begin(), order.end(), std::mt19937(4));
  for (std::size_t simplex = 0; simplex < order.size(); ++simplex)
    for (std::size_t corner = 0; corner < 4; ++corner)
      shuffled.simplices.set(simplex * 4 + corner, surface.simplices[order[simplex] * 4 + corner]);
  for (const Hyperplane<4>& plane :
       {Hyperplane<4>{{1, 2, 3, 4}, 13.3}, Hyperplane<4>::at(3, 2), Hyperplane<4>::at(1, 1.1)})
    expect_same_mesh(sliced(surface, plane), sliced(shuffled, plane));
}

// Normals stay outward and lengths stay true on oblique planes, whichever way the normal points.
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

TEST(Slice, oblique_planes_of_a_ball_are_balls_of_their_own) {
  const auto field = make_field<double, 4>(box_grid<4>(21, -1.5, 1.5), [](const auto& p) {
    return 1.2 - std::sqrt(p[0] * p[0] + p[1] * p[1] + p[2] * p[2] + p[3] * p[3]);
  });
  const auto surface = extracted(field, 0, {.precision = Precision::f64});
  for (const Hyperplane<4>& plane : {Hyperplane<4>{{1, 0, 0, 0}, 0.4}, Hyperplane<4>{{0, -1, 0, 0}, -0.4},
                                     Hyperplane<4>{{1, 1, 1, 1}, 0.8}, Hyperplane<4>{{-1, 1, -1, 1}, 0.8},
                                     Hyperplane<4>{{0, 0, 3, 4}, 2}, Hyperplane<4>{{1e-9, 0, 0, -1}, 0.4}}) {
    const auto cut = sliced(surface, plane, {.precision = Precision::f64});
    const double radius = std::sqrt(1.2 * 1.2 - 0.4 * 0.4);
    EXPECT_NEAR(enclosed_volume(cut) / (4. / 3 * std::numbers::pi * std::pow(radius, 3)), 1, 0.03);
    const auto found = measure(cut);
    EXPECT_TRUE(found->closed);
    EXPECT_EQ(found->euler_characteristic, 2);
  }
}

TEST(Slice, falling_axes_keep_normals_outward) {
  for (unsigned reversed = 0; reversed < 16; ++reversed) {
    Grid<4> grid = box_grid<4>(9, -1.5, 1.5);
    for (int axis = 0; axis < 4; ++axis)
      if (reversed >> axis & 1) grid.axes[axis].origin *= -1, grid.axes[axis].spacing *= -1;
    const auto field = make_field<float, 4>(grid, [](const auto& p) {
      return 1.2 - std::sqrt(p[0] * p[0] + p[1] * p[1] + p[2] * p[2] + p[3] * p[3]);
    });
    const auto surface = extracted(field, 0);
    for (int axis = 0; axis < 4; ++axis)
      for (const double value : {0.0, 0.1, 0.375, -0.375}) { // sample, between, sample, sample
        const auto cut = sliced(surface, Hyperplane<4>::at(axis, value));
        EXPECT_GT(enclosed_volume(cut), 4);
        expect_same_mesh(cut, *slice(field.view, 0, Hyperplane<4>::at(axis, value)));
      }
  }
}

TEST(Slice, planes_that_miss_or_mean_nothing) {
  const auto field = random_field<float, 3>({4, 4, 4}, 5, 1);
  const auto surface = extracted(field, 0);
  EXPECT_EQ(sliced(surface, Hyperplane<3>::at(0, 99)).simplex_count(), 0u);
  const auto missed = slice(field.view, 0, Hyperplane<3>::at(2, 3.01));
  ASSERT_FALSE(missed);
  EXPECT_EQ(missed.error().code, Code::outside_domain);
  for (const Hyperplane<3>& bad :
       {Hyperplane<3>{}, Hyperplane<3>{{0, 0, 1}, std::nan("")}, Hyperplane<3>{{0, HUGE_VAL, 1}, 0}}) {
    const auto cut = slice(surface, bad);
    ASSERT_FALSE(cut);
    EXPECT_EQ(cut.error().code, Code::invalid_argument);
  }
}

// An index leaves out what the plane does not meet and nothing else, on every kind of plane.
TEST(SliceIndex, gives_what_a_plain_slice_gives) {
  Grid<4> grid = unit_grid<4>({7, 6, 8, 5});
  for (Axis& axis : grid.axes) axis.origin = 0.1, axis.spacing = 0.3; // not representable: stored rounded
  std::mt19937 random(3);
  const auto field =
      make_field<float, 4>(grid, [&](const auto&) { return static_cast<double>(random() % 100); });
  for (const Precision precision : {Precision::f32, Precision::f64}) {
    const auto surface = extracted(field, 50, {.precision = precision});
    const SliceIndex<4> index(surface);
    std::vector<Hyperplane<4>> planes{{{1, 2, 3, 4}, 8}, {{1, -1, 0.5, -0.25}, 0.1}, {{0, 0, 0, 1}, 99}};
    for (int axis = 0; axis < 4; ++axis)
      for (const double place : {0., 1., 1.3, 2., 3.9999999999, 4.}) {
        const double step = std::floor(place);
        const double low = grid.axes[axis].coordinate(static_cast<std::int64_t>(step));
        planes.push_back(Hyperplane<4>::at(axis, low + (place - step) * 0.3));
      }
    for (const auto& plane : planes) {
      const auto expected = sliced(surface, plane);
      const auto cut = index.slice(surface, plane);
      ASSERT_TRUE(cut);
      expect_same_mesh(*cut, expected);
      EXPECT_EQ(measure(*cut)->bad_facets, 0u);
    }
  }
}

// The same for what is not a surface in space and time: volumes, surfaces in space, soups, attributes, chunks
// of all sizes.
TEST(SliceIndex, volumes_soups_and_attributes) {
  const auto check = [](auto mesh, const auto& planes) {
    std::vector<double> heights;
    const auto D = static_cast<std::size_t>(mesh.dimension);
    for (std::size_t vertex = 0; vertex < mesh.vertex_count(); ++vertex)
      heights.push_back(mesh.positions[vertex * D] - 3 * mesh.positions[vertex * D + 1]);
    std::vector<std::int32_t> numbers(mesh.simplex_count());
    std::iota(numbers.begin(), numbers.end(), 0);
    mesh.attributes = {{"height", Attribute::Location::vertex, 1, heights},
                       {"number", Attribute::Location::simplex, 1, numbers}};
    const SliceIndex index(mesh);
    auto reused = *index.slice(mesh, planes.back());
    for (const auto& plane : planes)
      for (const bool welded : {true, false}) {
        const SliceOptions options{.precision = Precision::f64, .welded = welded};
        const auto expected = slice(mesh, plane, options);
        ASSERT_TRUE(expected);
        ASSERT_TRUE(index.slice_into(mesh, plane, options, reused));
        EXPECT_GT(reused.simplex_count(), 0u);
        EXPECT_TRUE(simplex_set(reused) == simplex_set(*expected));
        EXPECT_EQ(measure(reused)->bad_facets, 0u);
        if (!welded) continue; // the numbers of vertices differ
        EXPECT_TRUE(vertex_set(reused) == vertex_set(*expected));
        for (std::size_t number = 0; number < 2; ++number)
          std::visit(
              [&]<class Values>(Values values) {
                auto others = std::get<Values>(expected->attributes[number].values);
                std::ranges::sort(values);
                std::ranges::sort(others);
                EXPECT_TRUE(values == others);
              },
              reused.attributes[number].values);
      }
  };
  const auto in_space = random_field<float, 3>({9, 8, 9}, 1000, 4);
  const auto in_time = random_field<float, 4>({6, 6, 6, 5}, 1000, 4);
  check(extracted(in_space, 0),
        std::vector<Hyperplane<3>>{{{1, 2, -1}, 3.3}, {{0, 1, 0}, 2.5}, {{0, 0, 1}, 2.25}});
  check(extracted(in_time, 0), std::vector<Hyperplane<4>>{{{1, 2, -1, 1}, 3.3}, {{0, 0, 0, 1}, 2.5}});
  check(*interval(in_space.view, -300, 400),
        std::vector<Hyperplane<3>>{{{1, 2, -1}, 3.3}, {{0, 1, 0}, 2.5}, {{0, 0, 1}, 2.25}});
  const SimplexMesh<4> nothing;
  EXPECT_EQ(SliceIndex<4>(nothing).slice(nothing, Hyperplane<4>::at(3, 0))->simplex_count(), 0u);
}

TEST(Slice, unwelded_simplices_are_the_welded_ones) {
  const auto surface = extracted(random_field<float, 4>({5, 5, 5, 5}, 9, 6), 0.5);
  const Hyperplane<4> plane{{1, 1, 2, 3}, 12};
  const auto welded = sliced(surface, plane), soup = sliced(surface, plane, {.welded = false});
  EXPECT_GT(soup.vertex_count(), 2 * welded.vertex_count());
  EXPECT_EQ(measure(soup)->bad_facets, 0u);
  EXPECT_TRUE(simplex_set(soup) == simplex_set(welded));
}

// Attributes that are affine in the position stay so; those of simplices follow their simplex.
TEST(Slice, attributes_come_along) {
  auto surface = extracted(random_field<double, 3>({5, 6, 7}, 9, 6), 0.5, {.precision = Precision::f64});
  std::vector<double> affine;
  for (std::size_t vertex = 0; vertex < surface.vertex_count(); ++vertex)
    for (const double factor : {1., -3.})
      affine.push_back(factor * (surface.positions[vertex * 3] + 10 * surface.positions[vertex * 3 + 1]));
  std::vector<std::int32_t> number(surface.simplex_count());
  std::iota(number.begin(), number.end(), 0);
  surface.attributes = {{"affine", Attribute::Location::vertex, 2, affine},
                        {"number", Attribute::Location::simplex, 1, number}};
  for (const double z : {2.0, 2.4}) { // along samples and between
    const auto cut = sliced(surface, Hyperplane<3>::at(2, z), {.precision = Precision::f64});
    ASSERT_EQ(cut.attributes.size(), 2u);
    const auto& carried = std::get<std::vector<double>>(cut.attributes[0].values);
    ASSERT_EQ(carried.size(), 2 * cut.vertex_count());
    for (std::size_t vertex = 0; vertex < cut.vertex_count(); ++vertex)
      EXPECT_NEAR(carried[2 * vertex + 1],
                  -3 * (cut.positions[2 * vertex] + 10 * cut.positions[2 * vertex + 1]), 1e-12);
    const auto& sources = std::get<std::vector<std::int32_t>>(cut.attributes[1].values);
    ASSERT_EQ(sources.size(), cut.simplex_count());
    for (const auto source : sources) ASSERT_LT(static_cast<std::size_t>(source), surface.simplex_count());
  }
}

// A cube of six tetrahedra: its cut fills the square, every triangle turned the same way.
TEST(Slice, volumes_give_volumes) {
  VolumeMesh<3> cube;
  cube.positions.reset(24, true);
  for (unsigned vertex = 0; vertex < 8; ++vertex)
    for (unsigned k = 0; k < 3; ++k) cube.positions.set(vertex * 3 + k, vertex >> k & 1);
  const std::vector<std::uint64_t> corners{0, 1, 3, 7, 0, 3, 2, 7, 0, 2, 6, 7,
                                           0, 6, 4, 7, 0, 4, 5, 7, 0, 5, 1, 7};
  cube.simplices.reset(corners.size(), false);
  for (std::size_t i = 0; i < corners.size(); ++i) cube.simplices.set(i, corners[i]);
  ASSERT_EQ(measure(cube)->inverted_simplices, 0u);
  for (const auto& [plane, area] :
       std::vector<std::pair<Hyperplane<3>, double>>{{Hyperplane<3>::at(0, 0.5), 1},
                                                     {Hyperplane<3>::at(1, 0.25), 1},
                                                     {Hyperplane<3>{{0, 0, -2}, -0.5}, 1},
                                                     {Hyperplane<3>{{1, 1, 1}, 1.5}, 0.75 * std::sqrt(3)},
                                                     {Hyperplane<3>{{1, -1, 0}, 0}, std::sqrt(2)}}) {
    const auto found = measure(sliced(cube, plane, {.precision = Precision::f64}));
    EXPECT_NEAR(found->content, area, 1e-12);
    EXPECT_EQ(found->inverted_simplices, 0u);
    EXPECT_EQ(found->bad_facets, 0u);
    EXPECT_EQ(found->euler_characteristic, 1);
  }
}

// The coefficients c with least sum of squares of row . c - value.
std::vector<double> least_squares(const std::vector<std::vector<double>>& rows,
                                  const std::vector<double>& values) {
  const std::size_t n = rows[0].size();
  std::vector<double> matrix(n * n), right(n), solution(n);
  for (std::size_t row = 0; row < rows.size(); ++row)
    for (std::size_t i = 0; i < n; ++i) {
      right[i] += rows[row][i] * values[row];
      for (std::size_t k = 0; k < n; ++k) matrix[i * n + k] += rows[row][i] * rows[row][k];
    }
  const double whole = determinant(matrix, static_cast<int>(n)); // Cramer's rule
  for (std::size_t k = 0; k < n; ++k) {
    auto replaced = matrix;
    for (std::size_t i = 0; i < n; ++i) replaced[i * n + k] = right[i];
    solution[k] = determinant(replaced, static_cast<int>(n)) / whole;
  }
  return solution;
}

// Paper 000, figure 5: f = (x-1/2)^2 + (y-1/2)^2 + (z-1/2)^2 - c w - d has a sphere for w = const and a
// paraboloid for x = const. Fitted to the vertices; what is left falls with the square of the grid's spacing.
TEST(Slice, sphere_and_paraboloid_of_figure_5) {
  constexpr double c = 0.1, d = 0.02, w = 0.437, x = 0.413;
  std::array<double, 2> sphere_residual{}, paraboloid_residual{};
  for (std::size_t fine = 0; fine < 2; ++fine) {
    const auto field = make_field<double, 4>(box_grid<4>(fine ? 25 : 13, 0, 1), [&](const auto& p) {
      double squared = 0;
      for (std::size_t k = 0; k < 3; ++k) squared += (p[k] - 0.5) * (p[k] - 0.5);
      return squared - c * p[3] - d;
    });
    const auto surface = extracted(field, 0, {.precision = Precision::f64});
    const double h = fine ? 1. / 24 : 1. / 12;

    const auto sphere = sliced(surface, Hyperplane<4>::at(3, w), {.precision = Precision::f64});
    EXPECT_TRUE(measure(sphere)->closed);
    std::vector<std::vector<double>> rows;
    std::vector<double> values;
    for (std::size_t vertex = 0; vertex < sphere.vertex_count(); ++vertex) {
      const double* p = static_cast<const double*>(sphere.positions.data()) + vertex * 3;
      rows.push_back({2 * p[0], 2 * p[1], 2 * p[2], 1});
      values.push_back(p[0] * p[0] + p[1] * p[1] + p[2] * p[2]);
    }
    auto fit = least_squares(rows, values); // centre, radius^2 - centre^2
    for (std::size_t k = 0; k < 3; ++k) EXPECT_NEAR(fit[k], 0.5, h * h);
    EXPECT_NEAR(fit[3] + fit[0] * fit[0] + fit[1] * fit[1] + fit[2] * fit[2], c * w + d, h * h);
    for (std::size_t row = 0; row < rows.size(); ++row)
      sphere_residual[fine] =
          std::max(sphere_residual[fine],
                   std::abs(std::inner_product(fit.begin(), fit.end(), rows[row].begin(), -values[row])));

    const auto paraboloid = sliced(surface, Hyperplane<4>::at(0, x), {.precision = Precision::f64});
    rows.clear(), values.clear();
    for (std::size_t vertex = 0; vertex < paraboloid.vertex_count(); ++vertex) {
      const double* p = static_cast<const double*>(paraboloid.positions.data()) + vertex * 3;
      rows.push_back({p[0] * p[0] + p[1] * p[1], p[0], p[1], 1});
      values.push_back(c * p[2]);
    }
    fit = least_squares(rows, values);
    EXPECT_NEAR(fit[0], 1, 20 * h * h);
    EXPECT_NEAR(fit[1], -1, 20 * h * h);
    EXPECT_NEAR(fit[2], -1, 20 * h * h);
    EXPECT_NEAR(fit[3], 0.5 + (x - 0.5) * (x - 0.5) - d, 20 * h * h);
    for (std::size_t row = 0; row < rows.size(); ++row)
      paraboloid_residual[fine] =
          std::max(paraboloid_residual[fine],
                   std::abs(std::inner_product(fit.begin(), fit.end(), rows[row].begin(), -values[row])));
  }
  // Linear interpolation along an axis misses a unit quadratic by up to h^2 / 4.
  for (std::size_t fine = 0; fine < 2; ++fine) {
    const double h = fine ? 1. / 24 : 1. / 12;
    EXPECT_LT(sphere_residual[fine], 0.75 * h * h);
    EXPECT_LT(paraboloid_residual[fine], 0.75 * h * h);
  }
}

// No popping between steps: the area of a moving ball's slices, and its change, go on steadily.
TEST(SliceIndex, area_of_a_moving_ball_is_smooth_in_time) {
  const auto surface = extracted(moving_ball(), 0, {.precision = Precision::f64});
  const SliceIndex<4> index(surface);
  std::vector<double> areas;
  constexpr int moments = 100;
  for (int moment = 0; moment <= moments; ++moment)
    areas.push_back(
        measure(*index.slice(surface, Hyperplane<4>::at(3, 2 + static_cast<double>(moment) / moments)))
            ->content);
  for (std::size_t i = 1; i < areas.size(); ++i) {
    EXPECT_NEAR(areas[i] / areas[i - 1], 1, 1e-3) << i;
    if (i == 1) continue;
    EXPECT_NEAR((areas[i] - 2 * areas[i - 1] + areas[i - 2]) / areas[i], 0, 1e-3) << i;
  }
}

// Coarea: the content of the slices, summed over all offsets, is that of the surface weighed by its slope.
TEST(Slice, contents_of_all_slices_add_up_to_the_surface) {
  const auto surface =
      extracted(random_field<double, 4>({3, 3, 3, 3}, 1000, 2), 0.5, {.precision = Precision::f64});
  for (const std::array<double, 4>& normal :
       {std::array<double, 4>{0, 0, 0, 1}, {0.5, 0.5, -0.5, 0.5}, {0.6, 0, 0.8, 0}}) {
    double weighed = 0;
    for (std::size_t simplex = 0; simplex < surface.simplex_count(); ++simplex) {
      Mesh one(4, 3); // its content and unit normal
      one.positions = surface.positions;
      one.simplices.reset(4, false);
      for (std::size_t corner = 0; corner < 4; ++corner)
        one.simplices.set(corner, surface.simplices[simplex * 4 + corner]);
      const auto found = measure(one);
      double along = 0;
      for (std::size_t k = 0; k < 4; ++k) along += found->vector_area[k] * normal[k];
      weighed += std::sqrt(std::max(0.0, found->content * found->content - along * along));
    }
    double sum = 0;
    const int steps = 1000;
    const double low = -2.1, high = 4.1, width = (high - low) / steps;
    for (int step = 0; step < steps; ++step)
      sum += measure(sliced(surface, {normal, low + (step + 0.5) * width}, {.precision = Precision::f64}))
                 ->content *
             width;
    EXPECT_NEAR(sum / weighed, 1, 2e-3);
  }
}

// A field that is read slab by slab must give what its whole mesh gives, to the bit: on planes in general
// position, through samples, along faces of cells, and where rounding decides.
TEST(FieldSlicer, any_plane_gives_what_the_whole_mesh_gives) {
  const std::vector<Hyperplane<4>> planes{
      {{0.3, -0.2, 0.5, 0.1}, 1.2}, {{1, 1, 0, 0}, 4},         {{1, 1, 1, 0}, 6},  {{1, 0, 0, 1}, 3},
      {{1, -1, 0.5, -0.25}, 0},     {{1e-3, 0, 1e-3, 1}, 1.5}, {{0, 0, 1, -1}, 0}, {{1, 2, 3, 40}, 90},
      {{0, 1, 0, 0}, 1.5},          {{0, 0, -2, 0}, 2.000001}, {{1, 1, 1, 1}, 99}, {{1, 1, 1, 1}, 0}};
  for (unsigned seed = 0; seed < 2; ++seed)
    for (const int range : {1, 1000})
      for (const Method method : {Method::hull, Method::simplicial, Method::barycentric}) {
        if (method == Method::barycentric && seed > 0) continue;
        auto field = random_field<float, 4>({5, 4, 5, 4}, range, seed);
        field.view.grid.axes[0].origin = -0.3;
        field.view.grid.axes[2].spacing = -0.7;
        field.view.grid.axes[3].coordinates = {0, 0.9, 2.1, 3};
        FieldSliceOptions options;
        options.method = method;
        const auto surface = extracted(field, 0.5, options);
        FieldSteps steps(unowned_field(field.view));
        FieldSlicer<4> slicer(steps, 0.5, options);
        for (const auto& plane : planes) {
          const auto cut = slicer.slice(plane);
          ASSERT_TRUE(cut) << cut.error().message;
          expect_same_mesh(*cut, sliced(surface, plane));
        }
      }
}

// The same for volumes, whose grid edges are those of the lifted field.
TEST(FieldSlicer, any_plane_of_a_volume_gives_what_the_whole_volume_gives) {
  const std::vector<Hyperplane<4>> planes{{{0.3, -0.2, 0.5, 0.1}, 1.2},
                                          {{1, 1, 0, 0}, 4},
                                          {{1, 0, 0, 1}, 3},
                                          {{1, -1, 0.5, -0.25}, 0},
                                          {{0, 1, 0, 0}, 1.5},
                                          {{0, 0, 0, 1}, 1.5},
                                          {{0, 0, 0, 1}, 2},
                                          {{0, 0, 1, 0}, 2},
                                          {{1, 1, 1, 1}, 99}};
  const auto field = random_field<float, 4>({4, 4, 4, 4}, 1000, 7);
  for (const std::vector<double>& levels : {std::vector<double>{-200, 300}, {-500, 0, 100}})
    for (const Method method : {Method::hull, Method::simplicial}) {
      IntervalOptions filling;
      filling.method = method;
      const auto volume = *interval(field.view, std::span<const double>(levels), filling);
      FieldSliceOptions options;
      options.method = method;
      FieldSteps steps(unowned_field(field.view));
      FieldSlicer<4, 4> slicer(steps, levels, options);
      for (const auto& plane : planes) {
        const auto cut = slicer.slice(plane);
        ASSERT_TRUE(cut) << cut.error().message;
        expect_same_mesh(*cut, sliced(volume, plane));
        EXPECT_EQ(cut->attributes.size(), cut->simplex_count() > 0 ? 2u : cut->attributes.size());
      }
    }
}

// A series of moments shares the surface of each slab.
TEST(FieldSlicer, many_moments_in_any_order) {
  const auto field = random_field<float, 4>({5, 4, 5, 4}, 9, 3);
  const auto surface = extracted(field, 0.5);
  FieldSteps steps(unowned_field(field.view));
  FieldSlicer<4> slicer(steps, 0.5);
  for (const double time : {0., 0.25, 0.5, 0.75, 1., 1.5, 0.3, 0.4, 2.9, 3.}) {
    const auto cut = slicer.slice(Hyperplane<4>::at(3, time));
    ASSERT_TRUE(cut);
    expect_same_mesh(*cut, sliced(surface, Hyperplane<4>::at(3, time)));
  }
}

// The same places in both frames; lengths are true in one of them.
TEST(Slice, frames_of_an_oblique_plane) {
  const auto surface =
      extracted(random_field<double, 4>({4, 4, 4, 4}, 9, 1), 0.5, {.precision = Precision::f64});
  const Hyperplane<4> plane{{1, -2, 0.5, 1.5}, 0.3};
  const auto true_lengths = sliced(surface, plane, {.precision = Precision::f64}),
             in_axes = sliced(surface, plane, {.precision = Precision::f64, .frame = SliceFrame::axes});
  const auto directions = plane_coordinates(plane, SliceFrame::orthonormal).directions;
  ASSERT_EQ(true_lengths.vertex_count(), in_axes.vertex_count());
  ASSERT_GT(in_axes.vertex_count(), 0u);
  double squared = 0;
  for (const double component : plane.normal) squared += component * component;
  for (std::size_t vertex = 0; vertex < in_axes.vertex_count(); ++vertex) {
    std::vector<double> point;
    for (std::size_t k = 0; k < 4; ++k) {
      point.push_back(plane.offset / squared * plane.normal[k]);
      for (std::size_t row = 0; row < 3; ++row)
        point[k] += true_lengths.positions[vertex * 3 + row] * directions[row][k];
    }
    EXPECT_NEAR(point[0], in_axes.positions[vertex * 3], 1e-12); // axis 1 is the most aligned
    EXPECT_NEAR(point[2], in_axes.positions[vertex * 3 + 1], 1e-12);
    EXPECT_NEAR(point[3], in_axes.positions[vertex * 3 + 2], 1e-12);
  }
  EXPECT_EQ(measure(in_axes)->bad_facets, 0u);
}

// What vertices carry, from the field and from the mesh: an affine field stays affine, normals of the cut are
// perpendicular to it, and both ways give the same.
TEST(FieldSlicer, other_fields_and_normals) {
  const auto ball = make_field<double, 4>(box_grid<4>(13, -1.5, 1.5), [](const auto& p) {
    return 1.2 - std::sqrt(p[0] * p[0] + p[1] * p[1] + p[2] * p[2] + p[3] * p[3]);
  });
  const auto affine = make_field<float, 4>(
      box_grid<4>(13, -1.5, 1.5), [](const auto& p) { return 2 * p[0] - p[1] + 4 * p[2] + 8 * p[3]; });
  FieldSteps steps(unowned_field(ball.view)), other(unowned_field(affine.view));
  FieldSliceOptions options;
  options.precision = Precision::f64;
  options.with_normals = true;
  options.others.push_back({"affine", &other});
  FieldSlicer<4> slicer(steps, 0, options);
  auto surface = extracted(ball, 0, options);
  const NamedField named{"affine", unowned_field(affine.view)};
  ASSERT_TRUE(add_point_data(surface, unowned_field(ball.view), 0, Inside::above, {&named, 1}, true));
  for (const Hyperplane<4>& plane :
       {Hyperplane<4>::at(3, 0.3), Hyperplane<4>::at(3, -0.5), Hyperplane<4>::at(1, 0.3),
        Hyperplane<4>::at(0, 0.25), Hyperplane<4>{{1, 1, -1, 1}, 0.4}, Hyperplane<4>{{0.1, 0, 0, -1}, 0.4}}) {
    const auto cut = slicer.slice(plane);
    ASSERT_TRUE(cut) << cut.error().message;
    const auto of_mesh = sliced(surface, plane, {.precision = Precision::f64});
    expect_same_mesh(*cut, of_mesh);
    ASSERT_EQ(cut->attributes.size(), 2u);
    const auto& normals = std::get<std::vector<double>>(cut->attributes[0].values);
    const auto& values = std::get<std::vector<double>>(cut->attributes[1].values);
    ASSERT_EQ(normals.size(), cut->vertex_count() * 3);

    // The same data at the same places, whichever way.
    std::multiset<std::vector<double>> from_field, from_mesh;
    for (const auto& [mesh, set] : {std::pair{&*cut, &from_field}, std::pair{&of_mesh, &from_mesh}})
      for (std::size_t vertex = 0; vertex < mesh->vertex_count(); ++vertex) {
        std::vector<double> row{std::get<std::vector<double>>(mesh->attributes[1].values)[vertex]};
        for (std::size_t k = 0; k < 3; ++k) {
          row.push_back(mesh->positions[vertex * 3 + k]);
          const double component = std::get<std::vector<double>>(mesh->attributes[0].values)[vertex * 3 + k];
          row.push_back(std::round(component * 1e9)); // at a stored step rounded once less
        }
        set->insert(row);
      }
    EXPECT_TRUE(from_field == from_mesh);

    // The cut is a ball around the foot of the origin, and the field is affine on it.
    const auto directions = plane_coordinates(plane, SliceFrame::orthonormal).directions;
    double squared = 0;
    for (const double component : plane.normal) squared += component * component;
    for (std::size_t vertex = 0; vertex < cut->vertex_count(); ++vertex) {
      double expected = 0, along = 0, length = 0;
      constexpr double factors[] = {2, -1, 4, 8};
      for (std::size_t k = 0; k < 4; ++k) {
        double coordinate = plane.offset / squared * plane.normal[k];
        for (std::size_t row = 0; row < 3; ++row)
          coordinate += cut->positions[vertex * 3 + row] * directions[row][k];
        expected += factors[k] * coordinate;
      }
      EXPECT_NEAR(values[vertex], expected, 1e-5);
      for (std::size_t row = 0; row < 3; ++row) {
        along += normals[vertex * 3 + row] * cut->positions[vertex * 3 + row];
        length = std::hypot(length, cut->positions[vertex * 3 + row]);
      }
      EXPECT_GT(along / length, 0.995); // outward
    }
  }
}

TEST(SamplesAround, every_coordinate_of_even_uneven_and_falling_axes) {
  Axis even{.count = 40, .first = 3, .origin = 0.1, .spacing = 1.0 / 3}, falling = even, uneven;
  falling.spacing = -0.7;
  uneven.count = 4;
  uneven.coordinates = {-1, 0, 5, 5.5};
  for (const Axis& axis : {even, falling, uneven})
    for (std::int64_t i = 0; i < axis.count; ++i) {
      const auto at = samples_around(axis, axis.coordinate(i));
      ASSERT_TRUE(at);
      EXPECT_EQ(at->begin, i);
      EXPECT_EQ(at->end, i + 1);
      if (i + 1 == axis.count) break;
      const auto between = samples_around(axis, (axis.coordinate(i) + axis.coordinate(i + 1)) / 2);
      EXPECT_EQ(between->begin, i);
      EXPECT_EQ(between->end, i + 2);
    }
  EXPECT_FALSE(samples_around(even, 0));
  EXPECT_FALSE(samples_around(even, std::nan("")));
}
