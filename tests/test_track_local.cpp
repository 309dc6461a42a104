// Tracking from seeds finds what tracking of everything finds for the same families, and looks at nothing
// else.

#include "track_fields.hpp"

namespace hyperiso {
namespace {

using check::time_field;
using check::track_field;

std::multiset<std::string> events_of(const TrackingGraph& graph, const std::set<std::int64_t>& families) {
  std::multiset<std::string> lines;
  for (const auto& event : graph.events) {
    std::set<std::int64_t> touched;
    for (const auto* tracks : {&event.tracks_in, &event.tracks_out})
      for (const auto track : *tracks) touched.insert(graph.tracks[static_cast<std::size_t>(track)].family);
    if (std::ranges::none_of(touched, [&](auto family) { return families.contains(family); })) continue;
    char line[120];
    std::snprintf(line, sizeof line, "%s %.9f %zu>%zu %+d", name_of(event.type), event.time,
                  event.arcs_in.size(), event.arcs_out.size(), static_cast<int>(event.delta_euler));
    lines.insert(line);
  }
  return lines;
}

std::set<std::int64_t> all_families(const TrackingGraph& graph) {
  std::set<std::int64_t> families;
  for (const auto& track : graph.tracks) families.insert(track.family);
  return families;
}

// Blobs that move on the plane: some meet, some do not.
Field blobs() {
  const auto grid = unit_grid<3>({60, 40, 20});
  return time_field<float, 3>(check::make_field<float, 3>(grid, [](const std::array<double, 3>& p) {
    const auto blob = [&](double x, double y, double s) {
      return std::exp(-((p[0] - x) * (p[0] - x) + (p[1] - y) * (p[1] - y)) / (2 * s * s));
    };
    const double t = p[2];
    return blob(8 + t, 8, 2.5) + blob(30 - t, 8.5, 3.5) + blob(45, 10 + t, 3) +
           blob(12, 30, 3) * (1 - (t - 9) * (t - 9) / 36);
  }));
}

TEST(TrackLocal, a_family_and_nothing_else) {
  const Field field = blobs();
  const auto whole = track_field(field, 0.5);
  ASSERT_GE(all_families(whole).size(), 3u);
  FieldSteps steps(field);
  // The two that meet, from the middle of the first; by the birth, the last of all, alone.
  for (const std::vector<std::int64_t>& cell :
       {std::vector<std::int64_t>{7, 5, 0}, {42, 10, 0}, {12, 33, 9}}) {
    std::optional<LocalTracking> local;
    for (std::int64_t shift = 0; shift < 8 && !local; ++shift) {
      auto found = track_from_seeds(steps, 0.5, {{cell[0], cell[1] + shift - 3, cell[2]}});
      if (found) local = std::move(*found);
    }
    ASSERT_TRUE(local) << cell[0];
    const auto events = events_of(local->graph, all_families(local->graph));
    const auto everything = events_of(whole, all_families(whole));
    EXPECT_LT(events.size(), everything.size());
    EXPECT_TRUE(std::ranges::includes(everything, events)) << cell[0];
    std::int64_t sum = 0;
    for (const auto& event : local->graph.events)
      sum +=
          static_cast<std::int64_t>(event.arcs_out.size()) - static_cast<std::int64_t>(event.arcs_in.size());
    EXPECT_EQ(sum, 0);
  }
}

TEST(TrackLocal, cost_follows_the_feature_and_not_the_field) {
  const auto samples_looked_at = [](std::int64_t side) {
    Grid<4> grid = unit_grid<4>({side, side, side, 4});
    const auto field = check::make_field<float, 4>(grid, [](const std::array<double, 4>& p) {
      return 4 - std::hypot(p[0] - 8 - 0.5 * p[3], p[1] - 8, p[2] - 8);
    });
    FieldSteps steps(time_field<float, 4>(field));
    const auto local = track_from_seeds(steps, 0.1, {{11, 8, 8, 0}});
    EXPECT_TRUE(local) << local.error().message;
    EXPECT_EQ(local->graph.tracks.size(), 1u);
    return local->samples;
  };
  EXPECT_EQ(samples_looked_at(20), samples_looked_at(60));
}

TEST(TrackLocal, random_fields_family_by_family) {
  for (unsigned seed = 0; seed < 4; ++seed) {
    const auto owned = check::random_field<float, 3>({7, 6, 6}, seed % 2 == 0 ? 2 : 100, seed);
    const Field field = time_field<float, 3>(owned);
    const auto whole = track_field(field, 0.5);
    FieldSteps steps(field);
    std::multiset<std::string> of_all_cells;
    std::vector<std::vector<std::int64_t>> cells;
    for (std::int64_t t = 0; t < 5; ++t)
      for (std::int64_t y = 0; y < 5; ++y)
        for (std::int64_t x = 0; x < 6; ++x)
          if (track_from_seeds(steps, 0.5, {{x, y, t}})) cells.push_back({x, y, t});
    const auto local = track_from_seeds(steps, 0.5, cells);
    ASSERT_TRUE(local) << local.error().message;
    EXPECT_EQ(events_of(local->graph, all_families(local->graph)), events_of(whole, all_families(whole)))
        << seed;
  }
}

// From the cell that each track names: its family.
template <int D>
void expect_families(const std::array<std::int64_t, D>& dims, int range, unsigned seed, Method method,
                     int missing = 0) {
  auto owned = check::random_field<float, D>(dims, range, seed);
  std::mt19937 random(seed);
  for (int i = 0; i < missing; ++i) owned.samples[random() % owned.samples.size()] = std::nanf("");
  const Field field = time_field<float, D>(owned);
  TrackOptions options;
  options.extraction.method = method;
  FieldSteps steps(field);
  for (const double isovalue : {0.0, 0.5}) {
    const auto whole = track_field(field, isovalue, options);
    const auto everything = events_of(whole, all_families(whole));
    for (const auto& track : whole.tracks) {
      const auto local = track_from_seeds(steps, isovalue, {track.cell}, options);
      if (!local && missing > 0) continue; // the cell touches a missing sample
      ASSERT_TRUE(local) << local.error().message;
      const auto events = events_of(local->graph, all_families(local->graph));
      // A cell may hold pieces of several families.
      EXPECT_TRUE(std::ranges::includes(events, events_of(whole, {track.family}))) << "seed " << seed;
      EXPECT_TRUE(std::ranges::includes(everything, events)) << "seed " << seed;
    }
  }
}

TEST(TrackLocal, the_family_of_every_track_of_random_fields) {
  for (const Method method : {Method::hull, Method::simplicial})
    for (const int range : {1, 4, 1000})
      for (unsigned seed = 0; seed < 4; ++seed) {
        expect_families<3>({5, 5, 5}, range, seed, method);
        expect_families<3>({5, 4, 4}, range, seed, method, 3);
        if (seed < 2) expect_families<4>({4, 3, 3, 3}, range, seed, method);
      }
}

TEST(TrackLocal, a_seed_off_the_surface_is_an_error) {
  FieldSteps steps(blobs());
  EXPECT_FALSE(track_from_seeds(steps, 0.5, {{0, 0, 0}}));
  EXPECT_FALSE(track_from_seeds(steps, 0.5, {{0, 0, 40}}));
  EXPECT_FALSE(track_from_seeds(steps, 0.5, {{0, 0}}));
}

} // namespace
} // namespace hyperiso
