// Fields whose history can be computed by hand, as surfaces and as regions, with both methods that have a
// region. Each test takes one field: all four must tell its history.

#include "known_histories.hpp"

namespace hyperiso {
namespace {

using check::expect_history;
using check::track_field;

struct Way {
  Tracked tracked;
  Method method;
};

class TrackHistories : public ::testing::TestWithParam<Way> {
 protected:
  bool surface() const { return GetParam().tracked == Tracked::surface; }
  bool hull() const { return GetParam().method == Method::hull; }

  TrackingGraph history(const Field& field, double isovalue) const {
    TrackOptions options;
    options.tracked = GetParam().tracked;
    options.extraction.method = GetParam().method;
    return track_field(field, isovalue, options);
  }
  // A body's Euler characteristic, as that of its closed surface is counted.
  std::int64_t euler(std::int64_t of_body) const { return surface() ? 2 * of_body : of_body; }
};

std::string name_of_way(const ::testing::TestParamInfo<Way>& way) {
  return std::string(way.param.tracked == Tracked::surface ? "surface" : "region") +
         (way.param.method == Method::hull ? "_hull" : "_simplicial");
}
INSTANTIATE_TEST_SUITE_P(, TrackHistories,
                         ::testing::Values(Way{Tracked::surface, Method::hull},
                                           Way{Tracked::surface, Method::simplicial},
                                           Way{Tracked::region, Method::hull},
                                           Way{Tracked::region, Method::simplicial}),
                         name_of_way);

std::int64_t sum_of_euler_jumps(const TrackingGraph& graph) {
  std::int64_t sum = 0;
  for (const TrackingEvent& event : graph.events) sum += event.delta_euler;
  return sum;
}

// Where the only event of this type is.
std::vector<double> place_of(const TrackingGraph& graph, EventType type) {
  const auto event = std::ranges::find(graph.events, type, &TrackingEvent::type);
  EXPECT_NE(event, graph.events.end());
  return event == graph.events.end() ? std::vector<double>{} : event->position;
}

TEST_P(TrackHistories, two_gaussians_merge_once_at_the_origin) {
  const auto graph = history(check::two_gaussians(), 0.5);
  expect_history(graph, {{EventType::merge, 7.916247, euler(-1)}});
  EXPECT_EQ(place_of(graph, EventType::merge), (std::vector<double>{0, 0, 0}));
  EXPECT_EQ(graph.tracks.size(), 2u);
}

TEST_P(TrackHistories, time_reversed_gaussians_split_once) {
  const auto graph = history(check::two_gaussians(true), 0.5);
  expect_history(graph, {{EventType::split, 7.083753, euler(1)}});
  EXPECT_EQ(place_of(graph, EventType::split), (std::vector<double>{0, 0, 0}));
}

TEST_P(TrackHistories, a_ball_is_born_and_dies) {
  const auto graph = history(check::growing_ball(), 0.5);
  expect_history(graph, {{EventType::birth, 2, euler(1)}, {EventType::death, 12, euler(-1)}});
  ASSERT_EQ(graph.tracks.size(), 1u);
  EXPECT_FALSE(graph.tracks[0].clipped);
  EXPECT_EQ(graph.features.size(), 11u);
  for (const Feature& row : graph.features) {
    const double r = check::growing_ball_radius(row.time);
    EXPECT_EQ(row.euler_characteristic, euler(1));
    EXPECT_EQ(row.maximum, check::growing_ball_amplitude(row.time));
    EXPECT_GE(row.minimum, 0.5);
    if (surface()) {
      EXPECT_EQ(row.genus(), 0);
    }
    if (r < 3) continue;
    EXPECT_NEAR(row.volume / check::ball_volume(r), 1, 0.08) << row.time;
    EXPECT_NEAR(row.cell_volume, row.volume, 0.1 * row.volume) << row.time;
    EXPECT_NEAR(row.surface_area / (4 * M_PI * r * r), 1, 0.05) << row.time;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      EXPECT_NEAR(row.centroid[axis], 0, surface() ? 1e-9 : 1e-5);
      EXPECT_NEAR(row.high[axis], r, 0.1);
      EXPECT_NEAR(row.low[axis], -row.high[axis], 1e-9);
    }
  }
}

// As surfaces two tracks, of which the inner one dies and nothing merges; as a region one whose cavity fills.
TEST_P(TrackHistories, the_inner_of_two_concentric_spheres_vanishes) {
  // To fill the shell takes time: as a region in the part of time where something happens.
  const auto graph = history(surface() ? check::shell()
                             : hull()  ? check::shell(5, 5)
                                       : check::shell(8, 2),
                             0.4);
  expect_history(graph, {{surface() ? EventType::death : EventType::genus, 8.455366, surface() ? -2 : -1}});
  EXPECT_EQ(place_of(graph, surface() ? EventType::death : EventType::genus), (std::vector<double>{0, 0, 0}));
  EXPECT_EQ(graph.tracks.size(), surface() ? 2u : 1u);
  for (const Feature& row : graph.features) {
    const auto [inner, outer] = check::shell_radii(row.time);
    const bool is_inner = surface() && row.high[0] < 9;
    if (!is_inner) {
      EXPECT_NEAR(row.volume, check::ball_volume(outer) - check::ball_volume(inner),
                  0.02 * check::ball_volume(outer))
          << row.time;
      EXPECT_NEAR(row.cell_volume, row.volume, 0.03 * row.volume) << row.time;
    } else if (inner > 3) {
      EXPECT_NEAR(row.volume, check::ball_volume(inner), 0.05 * check::ball_volume(inner)) << row.time;
    }
    EXPECT_EQ(row.euler_characteristic, surface() || row.time < 8.4 ? 2 : 1) << row.time;
    EXPECT_NEAR(row.centroid[0], 0, 1e-3);
  }
}

// What is left of a ball behind a wall is a ball: only its surface is cut.
TEST_P(TrackHistories, a_ball_leaves_through_a_wall) {
  const auto graph = history(surface() ? check::leaving_ball() : check::leaving_ball(7, 11), 0);
  if (surface())
    expect_history(graph, {{EventType::touch, 8, -1}, {EventType::exit, 16, -1}});
  else
    expect_history(graph, {{EventType::exit, 16, -1}});
  EXPECT_EQ(place_of(graph, EventType::exit), (std::vector<double>{20, 0, 0}));
  ASSERT_EQ(graph.tracks.size(), 1u);
  EXPECT_TRUE(graph.tracks[0].clipped);
  EXPECT_EQ(graph.tracks[0].start_type, "open_start");
  for (const Feature& row : graph.features) {
    const bool cut = row.time >= 8;
    EXPECT_EQ(row.on_wall, cut) << row.time;
    EXPECT_EQ(row.wall_curves, surface() && cut ? 1 : 0) << row.time;
    EXPECT_EQ(row.euler_characteristic, surface() && !cut ? 2 : 1) << row.time;
    const double h = std::min(12.0, 20 - (2 + 1.5 * row.time) + 6); // of the cap that is left
    EXPECT_NEAR(row.volume, M_PI * h * h * (18 - h) / 3, 18) << row.time;
  }
}

TEST_P(TrackHistories, a_ring_closes_and_its_hole_fills) {
  using enum EventType;
  // The interpolant on Kuhn simplices has an island that is not there with the hull's edges.
  if (surface() && hull())
    expect_history(history(check::ring(), 0.9),
                   {{birth, 2, 2}, {genus, 13.784579, -2}, {genus, 26.408810, 2}});
  else if (surface())
    expect_history(history(check::ring(), 0.9), {{birth, 2, 2},
                                                 {birth, 3.370459, 2},
                                                 {merge, 3.446091, -2},
                                                 {genus, 13.784579, -2},
                                                 {genus, 26.408810, 2}});
  else {
    // As bodies, in the parts of time where something happens.
    if (hull())
      expect_history(history(check::ring(0, 6), 0.9), {{birth, 2, 1}});
    else
      expect_history(history(check::ring(0, 6), 0.9),
                     {{birth, 2, 1}, {birth, 3.370459, 1}, {merge, 3.446091, -1}});
    const auto closing = history(check::ring(13, 2), 0.9);
    expect_history(closing, {{genus, 13.784579, -1}});
    const auto filling = history(check::ring(26, 2), 0.9);
    expect_history(filling, {{genus, 26.408810, 1}});
    for (const auto* graph : {&closing, &filling})
      for (const Feature& row : graph->features)
        EXPECT_EQ(row.euler_characteristic, row.time < 13.7 || row.time > 26.4 ? 1 : 0) << row.time;
  }
}

TEST_P(TrackHistories, three_gaussians_make_a_hole_that_fills) {
  using enum EventType;
  const auto graph = history(check::three_gaussians(), 0.5);
  expect_history(graph, {{merge, 5.299301, euler(-1)},
                         {merge, 5.685652, euler(-1)},
                         {genus, 5.724993, euler(-1)},
                         {genus, 7.278196, euler(1)}});
  EXPECT_EQ(sum_of_euler_jumps(graph), euler(-2));
}

TEST_P(TrackHistories, a_moving_plane_has_no_history) {
  const auto graph = history(check::moving_plane(), 0);
  expect_history(graph, {});
  EXPECT_EQ(graph.arcs.size(), 1u);
  EXPECT_EQ(graph.features.size(), 9u);
  for (const Feature& row : graph.features) {
    EXPECT_NEAR(row.volume, 144 * (6 + 3.3 - 0.7 * row.time), 1e-6) << row.time;
    EXPECT_NEAR(row.surface_area, 144, 1e-9) << row.time;
    EXPECT_EQ(row.euler_characteristic, 1) << row.time;
  }
}

// All is inside until then: as a surface nothing becomes two, as a region one becomes two.
TEST_P(TrackHistories, two_planes_part) {
  const auto graph = history(check::parting_planes(), 0);
  expect_history(graph, {{surface() ? EventType::compound : EventType::split, 2.5, surface() ? 2 : 1}});
  EXPECT_EQ(graph.arcs.size(), surface() ? 2u : 3u);
}

} // namespace
} // namespace hyperiso
