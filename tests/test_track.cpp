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

TrackOptions simplicial() {
  TrackOptions options;
  options.extraction.method = Method::simplicial;
  return options;
}

Field two_gaussians(bool reversed) {
  return time_field<double, 4>(make_field<double, 4>(space_time_grid<4>(24, 16), [=](const Point& p) {
    const double t = reversed ? 15 - p[3] : p[3];
    const double a = 13 - 0.8 * t;
    return std::exp(-distance_squared(p, a, 0, 0) / 32) + std::exp(-distance_squared(p, -a, 0, 0) / 32);
  }));
}

TEST(Track, two_gaussians_merge_once_at_the_origin) {
  expect_history(track_field(two_gaussians(false), 0.5, simplicial()), {{EventType::merge, 7.916247}});
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
  expect_history(track_field(two_gaussians(true), 0.5, simplicial()), {{EventType::split, 7.083753}});
}

TEST(Track, a_ball_is_born_and_dies) {
  const auto field = time_field<double, 4>(make_field<double, 4>(space_time_grid<4>(10, 15), [](auto p) {
    return (0.5 + 0.02 * (p[3] - 2) * (12 - p[3])) * std::exp(-distance_squared(p, 0, 0, 0) / 32);
  }));
  const auto graph = track_field(field, 0.5);
  expect_history(graph, {{EventType::birth, 2}, {EventType::death, 12}});
  expect_history(track_field(field, 0.5, simplicial()), {{EventType::birth, 2}, {EventType::death, 12}});
  ASSERT_EQ(graph.tracks.size(), 1u);
  EXPECT_FALSE(graph.tracks[0].clipped);
  for (const Feature& row : graph.features) {
    const double A = 0.5 + 0.02 * (row.time - 2) * (12 - row.time);
    const double r = 4 * std::sqrt(2 * std::log(A / 0.5));
    if (r < 3) continue;
    EXPECT_NEAR(row.volume / (4.0 / 3 * M_PI * r * r * r), 1, 0.08) << row.time;
    EXPECT_NEAR(row.cell_volume, row.volume, 0.1 * row.volume) << row.time;
    EXPECT_NEAR(row.surface_area / (4 * M_PI * r * r), 1, 0.05) << row.time;
    EXPECT_EQ(row.euler_characteristic, 2);
    EXPECT_EQ(row.genus(), 0);
    EXPECT_EQ(row.maximum, A);
    EXPECT_GE(row.minimum, 0.5);
    for (std::size_t axis = 0; axis < 3; ++axis) {
      EXPECT_NEAR(row.centroid[axis], 0, 1e-9);
      EXPECT_NEAR(row.high[axis], r, 0.1);
      EXPECT_NEAR(row.low[axis], -row.high[axis], 1e-9);
    }
  }
}

TEST(Track, of_concentric_surfaces_the_inner_one_dies_and_nothing_merges) {
  const double R = 9, s = 4;
  const auto field = time_field<double, 4>(make_field<double, 4>(space_time_grid<4>(20, 12), [=](auto p) {
    const double r = std::sqrt(distance_squared(p, 0, 0, 0));
    return (0.8 + 0.5 * p[3]) * std::exp(-squared(r - R) / (2 * s * s));
  }));
  expect_history(track_field(field, 0.4, simplicial()), {{EventType::death, 8.455366}});
  const auto graph = track_field(field, 0.4);
  expect_history(graph, {{EventType::death, 8.455366}});
  // The outer surface's inside is the shell, the inner one encloses what is outside of it.
  const double r1 = R - s * std::sqrt(2 * std::log(0.8 / 0.4)),
               r2 = R + s * std::sqrt(2 * std::log(0.8 / 0.4));
  const auto ball = [](double r) { return 4.0 / 3 * M_PI * r * r * r; };
  EXPECT_NEAR(graph.features[0].volume, ball(r2) - ball(r1), 0.02 * ball(r2));
  EXPECT_NEAR(graph.features[1].volume, ball(r1), 0.05 * ball(r1));
}

TEST(Track, a_ball_leaves_through_a_wall) {
  Grid<4> grid = space_time_grid<4>(8, 18);
  grid.axes[0].origin = -6;
  grid.axes[0].count = 27;
  const auto field = time_field<double, 4>(make_field<double, 4>(
      grid, [](auto p) { return 6 - std::sqrt(distance_squared(p, 2 + 1.5 * p[3], 0, 0)); }));
  const auto graph = track_field(field, 0);
  expect_history(graph, {{EventType::touch, 8}, {EventType::exit, 16}});
  expect_history(track_field(field, 0, simplicial()), {{EventType::touch, 8}, {EventType::exit, 16}});
  ASSERT_EQ(graph.tracks.size(), 1u);
  EXPECT_TRUE(graph.tracks[0].clipped);
  EXPECT_EQ(graph.tracks[0].start_type, "open_start");
  for (const Feature& row : graph.features) {
    EXPECT_EQ(row.on_wall, row.time >= 8) << row.time;
    EXPECT_EQ(row.wall_curves, row.time >= 8 ? 1 : 0) << row.time;
    const double h = std::min(12.0, 20 - (2 + 1.5 * row.time) + 6); // of the cap that is left
    EXPECT_NEAR(row.volume, M_PI * h * h * (18 - h) / 3, 18) << row.time;
  }
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
  // The linear interpolant of the Kuhn simplices has an island that is not there with the hull's edges.
  expect_history(track_field(field, 0.9, simplicial()), {{EventType::birth, 2},
                                                         {EventType::birth, 3.370459},
                                                         {EventType::merge, 3.446091},
                                                         {EventType::genus, 13.784579},
                                                         {EventType::genus, 26.408810}});
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
  sum = 0;
  for (const auto& event : track_field(field, 0.5, simplicial()).events) sum += event.delta_euler;
  EXPECT_EQ(sum, -4);
}

TEST(Track, a_moving_plane_has_no_history) {
  const auto field = time_field<double, 4>(
      make_field<double, 4>(space_time_grid<4>(6, 9), [](auto p) { return p[0] + 3.3 - 0.7 * p[3]; }));
  const auto graph = track_field(field, 0);
  expect_history(graph, {});
  for (const Feature& row : graph.features) EXPECT_NEAR(row.volume, 144 * (6 + 3.3 - 0.7 * row.time), 1e-6);
  expect_history(track_field(field, 0, simplicial()), {});
  EXPECT_EQ(graph.arcs.size(), 1u);
}

TEST(Track, two_planes_are_born_as_one_node) {
  const auto field = time_field<double, 4>(make_field<double, 4>(
      space_time_grid<4>(5, 8), [](auto p) { return std::abs(p[0]) - 0.5 * (p[3] - 2.5); }));
  expect_history(track_field(field, 0, simplicial()), {{EventType::compound, 2.5}});
  const auto graph = track_field(field, 0);
  expect_history(graph, {{EventType::compound, 2.5}});
  for (const auto& event : graph.events)
    if (event.type == EventType::compound) {
      EXPECT_EQ(event.arcs_in.size(), 0u);
      EXPECT_EQ(event.arcs_out.size(), 2u);
    }
}

// A box of ones, n cells long, that is somewhere else at the second step.
TrackingGraph shifted_boxes(int shift, Method method, std::optional<double> threshold = {}) {
  const int n = 20;
  Grid<4> grid = unit_grid<4>({70, 8, 8, 2});
  const auto field = make_field<float, 4>(grid, [=](const auto& p) {
    const double start = (shift < 0 ? 46.5 : 2.5) + shift * p[3];
    return p[0] > start && p[0] < start + n && p[1] > 2 && p[1] < 6 && p[2] > 2 && p[2] < 6 ? 1.0 : 0.0;
  });
  TrackOptions options;
  options.extraction.method = method;
  options.overlap_threshold = threshold;
  return track_field(time_field<float, 4>(field), 0.5, options);
}

TEST(Track, overlap_of_shifted_boxes) {
  for (const Method method : {Method::hull, Method::simplicial}) {
    for (const int shift : {0, 5, 12, 13, 19}) {
      const auto graph = shifted_boxes(shift, method);
      expect_history(graph, {});
      ASSERT_EQ(graph.links.size(), 1u);
      EXPECT_DOUBLE_EQ(graph.links[0].overlap, (20 - shift) / 20.0);
      EXPECT_EQ(graph.tracks.size(), 1u);
    }
    EXPECT_EQ(shifted_boxes(12, method, 0.35).tracks.size(), 1u);
    const auto cut = shifted_boxes(13, method, 0.35);
    EXPECT_TRUE(cut.links[0].weak);
    ASSERT_EQ(cut.tracks.size(), 2u);
    EXPECT_EQ(cut.tracks[0].end_type, "weak");
    EXPECT_EQ(cut.tracks[1].start_type, "weak");
    expect_history(shifted_boxes(21, method), {{EventType::death, 0.5}, {EventType::birth, 0.5}});
  }
  // Boxes that just touch: the hull joins all that is inside of a cell, a Kuhn diagonal only one direction.
  expect_history(shifted_boxes(20, Method::hull), {});
  expect_history(shifted_boxes(-20, Method::hull), {});
  const auto right = shifted_boxes(20, Method::simplicial), left = shifted_boxes(-20, Method::simplicial);
  EXPECT_NE(right.links.empty(), left.links.empty());
}

TEST(Track, overlap_of_shifted_balls) {
  const double r = 12;
  for (const double d : {4.0, 8.0, 11.0}) {
    Grid<4> grid = space_time_grid<4>(26, 2);
    const auto field = make_field<float, 4>(
        grid, [=](const auto& p) { return r - std::sqrt(distance_squared(p, -d / 2 + d * p[3], 0, 0)); });
    const auto graph = track_field(time_field<float, 4>(field), 0);
    const double u = d / (2 * r);
    ASSERT_EQ(graph.links.size(), 1u);
    EXPECT_NEAR(graph.links[0].overlap, (2 + u) * (1 - u) * (1 - u) / 2, 0.02);
  }
}

TEST(Track, the_largest_goes_on_through_merges_and_splits) {
  // A small blob meets a large one and leaves it again.
  const auto field = make_field<double, 3>(space_time_grid<3>(20, 21), [](const std::array<double, 3>& p) {
    const double x = std::abs(p[2] - 10) * 1.4 + 3;
    return std::exp(-(squared(p[0] + 5) + squared(p[1])) / 18) +
           std::exp(-(squared(p[0] + 5 - x) + squared(p[1])) / 6);
  });
  const auto graph = track_field(time_field<double, 3>(field), 0.5);
  ASSERT_EQ(graph.tracks.size(), 3u);
  EXPECT_EQ(count_events(graph, EventType::merge), 1);
  EXPECT_EQ(count_events(graph, EventType::split), 1);
  const auto large =
      std::ranges::max_element(graph.tracks, {}, &hyperiso::Track::steps) - graph.tracks.begin();
  EXPECT_EQ(graph.tracks[static_cast<std::size_t>(large)].start_type, "open_start");
  EXPECT_EQ(graph.tracks[static_cast<std::size_t>(large)].end_type, "open_end");
  EXPECT_EQ(graph.tracks[static_cast<std::size_t>(large)].steps, 21);
  for (const auto& track : graph.tracks) EXPECT_EQ(track.family, 0);
  EXPECT_EQ(graph.tracks[2].parents, std::vector<std::int64_t>{large});
}

// A careless vertex rule calls these regular or sees two births.
TEST(Track, small_fields_with_ties) {
  const auto small = check::make_field<double, 3>(unit_grid<3>({3, 2, 2}), [i = 0](auto) mutable {
    return std::array{3, -1, -3, -1, 1, 1, -1, 1, -1, -1, -1, -1}[static_cast<std::size_t>(i++)];
  });
  expect_history(track_field(time_field<double, 3>(small), 0), {{EventType::merge, 0.5}});
  const auto smaller = check::make_field<double, 3>(unit_grid<3>({2, 2, 2}), [i = 0](auto) mutable {
    return std::array{3, -1, 3, -1, -1, -1, -3, 3}[static_cast<std::size_t>(i++)];
  });
  expect_history(track_field(time_field<double, 3>(smaller), 0, simplicial()),
                 {{EventType::enter, 0.5}, {EventType::merge, 0.75}});
}

} // namespace
} // namespace hyperiso
