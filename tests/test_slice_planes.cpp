// Slices by any plane: sound, turned the right way, and the same however the mesh is stored.

#include "slice_fields.hpp"

#include <numbers>

using namespace hyperiso;
using namespace hyperiso::check;

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

TEST(Slice, unwelded_simplices_are_the_welded_ones) {
  const auto surface = extracted(random_field<float, 4>({5, 5, 5, 5}, 9, 6), 0.5);
  const Hyperplane<4> plane{{1, 1, 2, 3}, 12};
  const auto welded = sliced(surface, plane), soup = sliced(surface, plane, {.welded = false});
  EXPECT_GT(soup.vertex_count(), 2 * welded.vertex_count());
  EXPECT_EQ(measure(soup)->bad_facets, 0u);
  EXPECT_TRUE(simplex_set(soup) == simplex_set(welded));
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
