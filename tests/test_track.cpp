// Fields whose history can be computed by hand.

#include "track_fields.hpp"

namespace hyperiso {
namespace {

using check::count_events;
using check::expect_history;
using check::make_field;
using check::space_time_grid;
using check::time_field;
using check::track_field;
using Point = std::array<double, 4>;

double squared(double x) { return x * x; }
double distance_squared(const Point& p, double x, double y, double z) {
  return squared(p[0] - x) + squared(p[1] - y) + squared(p[2] - z);
}

Field two_gaussians(bool reversed) {
  return time_field<double, 4>(make_field<double, 4>(space_time_grid<4>(24, 16), [=](const Point& p) {
    const double t = reversed ? 15 - p[3] : p[3];
    const double a = 13 - 0.8 * t;
    return std::exp(-distance_squared(p, a, 0, 0) / 32) + std::exp(-distance_squared(p, -a, 0, 0) / 32);
  }));
}

TEST(Track, two_gaussians_merge_once_at_the_origin) {
  const auto graph = track_field(two_gaussians(false), 0.5);
  expect_history(graph, {{EventType::merge, 7.916247}});
  for (const auto& event : graph.events)
    if (event.type == EventType::merge) {
      EXPECT_EQ(event.position, (std::vector<double>{0, 0, 0}));
      EXPECT_EQ(event.delta_euler, -2);
    }
}

TEST(Track, time_reversed_gaussians_split_once) {
  expect_history(track_field(two_gaussians(true), 0.5), {{EventType::split, 7.083753}});
}

TEST(Track, a_ball_is_born_and_dies) {
  const auto field = time_field<double, 4>(make_field<double, 4>(space_time_grid<4>(10, 15), [](auto p) {
    return (0.5 + 0.02 * (p[3] - 2) * (12 - p[3])) * std::exp(-distance_squared(p, 0, 0, 0) / 32);
  }));
  const auto graph = track_field(field, 0.5);
  expect_history(graph, {{EventType::birth, 2}, {EventType::death, 12}});
}

TEST(Track, of_concentric_surfaces_the_inner_one_dies_and_nothing_merges) {
  const double R = 9, s = 4;
  const auto field = time_field<double, 4>(make_field<double, 4>(space_time_grid<4>(20, 12), [=](auto p) {
    const double r = std::sqrt(distance_squared(p, 0, 0, 0));
    return (0.8 + 0.5 * p[3]) * std::exp(-squared(r - R) / (2 * s * s));
  }));
  expect_history(track_field(field, 0.4), {{EventType::death, 8.455366}});
}

TEST(Track, a_ball_leaves_through_a_wall) {
  Grid<4> grid = space_time_grid<4>(8, 18);
  grid.axes[0].origin = -6;
  grid.axes[0].count = 27;
  const auto field = time_field<double, 4>(make_field<double, 4>(
      grid, [](auto p) { return 6 - std::sqrt(distance_squared(p, 2 + 1.5 * p[3], 0, 0)); }));
  const auto graph = track_field(field, 0);
  expect_history(graph, {{EventType::touch, 8}, {EventType::exit, 16}});
}

TEST(Track, a_ring_closes_and_its_hole_fills) {
  const double R = 9, s = 4;
  const auto field = time_field<double, 4>(make_field<double, 4>(space_time_grid<4>(20, 28), [=](auto p) {
    const double rho = std::hypot(p[0], p[1]);
    return (1 + 0.3 * p[0] / R) * std::exp(-(squared(rho - R) + squared(p[2])) / (2 * s * s)) +
           0.05 * (p[3] - 10);
  }));
  const auto graph = track_field(field, 0.9);
  expect_history(graph, {{EventType::birth, 2}, {EventType::genus, 13.78458}, {EventType::genus, 26.40881}});
}

TEST(Track, three_gaussians_make_a_hole_that_fills) {
  const double h = std::sqrt(3.0);
  const auto field = time_field<double, 4>(make_field<double, 4>(space_time_grid<4>(20, 10), [=](auto p) {
    double sum = 0;
    for (const auto& [x, y] : {std::pair{6.0, -2 * h}, {-6.0, -2 * h}, {0.0, 4 * h}})
      sum += std::exp(-distance_squared(p, x, y, 0) / (2 * 3.5 * 3.5));
    return (0.6 + 0.08 * p[3]) * sum;
  }));
  const auto graph = track_field(field, 0.5);
  expect_history(graph, {{EventType::merge, 5.299301},
                         {EventType::merge, 5.685652},
                         {EventType::genus, 5.724993},
                         {EventType::genus, 7.278196}});
  std::int64_t sum = 0;
  for (const auto& event : graph.events) sum += event.delta_euler;
  EXPECT_EQ(sum, -4);
}

TEST(Track, a_moving_plane_has_no_history) {
  const auto field = time_field<double, 4>(
      make_field<double, 4>(space_time_grid<4>(6, 9), [](auto p) { return p[0] + 3.3 - 0.7 * p[3]; }));
  const auto graph = track_field(field, 0);
  expect_history(graph, {});
  EXPECT_EQ(graph.arcs.size(), 1u);
}

TEST(Track, two_planes_are_born_as_one_node) {
  const auto field = time_field<double, 4>(make_field<double, 4>(
      space_time_grid<4>(5, 8), [](auto p) { return std::abs(p[0]) - 0.5 * (p[3] - 2.5); }));
  const auto graph = track_field(field, 0);
  expect_history(graph, {{EventType::compound, 2.5}});
}

// A careless vertex rule calls these regular or sees two births.
TEST(Track, small_fields_with_ties) {
  const auto small = check::make_field<double, 3>(unit_grid<3>({3, 2, 2}), [i = 0](auto) mutable {
    return std::array{3, -1, -3, -1, 1, 1, -1, 1, -1, -1, -1, -1}[static_cast<std::size_t>(i++)];
  });
  expect_history(track_field(time_field<double, 3>(small), 0), {{EventType::merge, 0.5}});
}

} // namespace
} // namespace hyperiso
