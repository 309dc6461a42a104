// Which name goes on through events, and small fields that a careless rule gets wrong.

#include "track_fields.hpp"

namespace hyperiso {
namespace {

using check::count_events;
using check::expect_history;
using check::make_field;
using check::signature;
using check::space_time_grid;
using check::time_field;
using check::track_field;

double squared(double x) { return x * x; }

TrackOptions simplicial() {
  TrackOptions options;
  options.extraction.method = Method::simplicial;
  return options;
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

// At the middle step all samples are inside, some of them by being equal to the isovalue: there is no
// surface, but a level set where one track ends and another begins.
TEST(Track, tracks_end_and_begin_somewhere_at_a_step_without_a_surface) {
  const auto field = make_field<double, 3>(unit_grid<3>({5, 3, 3}), [](const auto& p) {
    return p[2] == 1 ? std::max(0.0, p[0] - 2) : p[0] - 1.5;
  });
  const auto graph = track_field(time_field<double, 3>(field), 0);
  expect_history(graph, {{EventType::birth, 1}, {EventType::death, 1}});
  ASSERT_EQ(graph.features.size(), 4u);
  for (const std::size_t row : {1, 2}) {
    const Feature& feature = graph.features[row];
    EXPECT_EQ(feature.cells, 0);
    EXPECT_EQ(feature.volume, 0);
    EXPECT_EQ(feature.centroid, (std::vector<double>{0.5, 1}));
    EXPECT_EQ(feature.low, feature.centroid);
    EXPECT_EQ(feature.high, feature.centroid);
  }
}

// One slab of noise takes long: what is told, and heeded, only at steps would come too late.
TEST(Track, progress_rises_between_steps_and_cancels_there) {
  const Field field = time_field<float, 4>(check::random_field<float, 4>({7, 7, 7, 3}, 100, 1));
  for (const Tracked tracked : {Tracked::surface, Tracked::region}) {
    TrackOptions options;
    options.tracked = tracked;
    const auto expected = signature(track_field(field, 0.5, options));
    std::vector<double> shares;
    options.extraction.progress = [&](double share) { return shares.push_back(share), true; };
    EXPECT_EQ(signature(track_field(field, 0.5, options)), expected);
    EXPECT_TRUE(std::ranges::is_sorted(shares));
    EXPECT_EQ(shares.back(), 1);
    EXPECT_GT(std::ranges::count_if(shares, [](double share) { return share > 0 && share < 0.5; }), 10);

    double last = 0;
    options.extraction.progress = [&](double share) { return last = share, share == 0; };
    FieldSteps steps(field);
    const auto graph = track(steps, 0.5, options);
    ASSERT_FALSE(graph);
    EXPECT_EQ(graph.error().code, Code::cancelled);
    EXPECT_GT(last, 0);
    EXPECT_LT(last, 0.5);
  }
}

} // namespace
} // namespace hyperiso
