// What is added up over components from other fields, and the seeds that lead back to them.

#include "track_fields.hpp"

namespace hyperiso {
namespace {

using check::time_field;
using check::track_field;

Field constant(const std::array<std::int64_t, 4>& dims, float value) {
  return time_field<float, 4>(check::make_field<float, 4>(unit_grid<4>(dims), [=](auto) { return value; }));
}

TEST(TrackWith, the_field_itself_and_a_constant) {
  const std::array<std::int64_t, 4> dims{5, 4, 4, 4};
  const auto random = check::random_field<float, 4>(dims, 1000, 7);
  const auto field = time_field<float, 4>(random);
  const Field twos = constant(dims, 2);
  for (const Tracked tracked : {Tracked::surface, Tracked::region})
    for (const Method method : {Method::hull, Method::simplicial}) {
      FieldSteps same(field), two(twos);
      TrackOptions options;
      options.tracked = tracked;
      options.extraction.method = method;
      options.with = {{"same", &same}, {"two", &two}};
      const auto graph = track_field(field, 0, options);
      EXPECT_EQ(graph.with, (std::vector<std::string>{"same", "two"}));
      ASSERT_FALSE(graph.features.empty());
      for (const Feature& row : graph.features) {
        ASSERT_EQ(row.with.size(), 2u);
        EXPECT_NEAR(row.with[1].mass, 2 * row.cell_volume, 1e-9);
        EXPECT_EQ(row.with[1].minimum, row.cell_volume > 0 ? 2 : row.with[1].minimum);
        EXPECT_EQ(row.with[0].maximum, row.maximum);
        if (tracked == Tracked::region) continue;
        EXPECT_NEAR(row.with[0].mass, row.mass, 1e-9 * std::abs(row.mass));
        EXPECT_EQ(row.with[0].minimum, row.minimum);
      }
    }
}

TEST(TrackWith, missing_samples_do_not_count_and_other_grids_are_refused) {
  const auto field = constant({4, 3, 3, 3}, 1);
  auto other = check::make_field<float, 4>(unit_grid<4>({4, 3, 3, 3}),
                                           [](const auto& p) { return p[0] < 2 ? std::nan("") : p[0]; });
  const Field holes = time_field<float, 4>(other);
  FieldSteps beside(holes), tracked(field);
  TrackOptions options;
  options.tracked = Tracked::region;
  options.with = {{"x", &beside}};
  const auto graph = track(tracked, 0.5, options);
  ASSERT_TRUE(graph) << graph.error().message;
  for (const Feature& row : graph->features) {
    EXPECT_EQ(row.with[0].minimum, 2);
    EXPECT_EQ(row.with[0].maximum, 3);
    EXPECT_DOUBLE_EQ(row.with[0].mass, (2 + 3 * 0.5) * 4);
  }
  const Field small = constant({4, 3, 2, 3}, 1);
  FieldSteps wrong(small);
  options.with = {{"small", &wrong}};
  EXPECT_EQ(track(tracked, 0.5, options).error().code, Code::invalid_argument);
}

// From its cell each track is found again, by the event where it begins.
TEST(TrackWith, the_cell_of_a_track_is_a_seed_for_it) {
  for (unsigned seed = 0; seed < 12; ++seed)
    for (const int range : {3, 1000}) {
      const auto field = time_field<float, 3>(check::random_field<float, 3>({7, 6, 5}, range, seed));
      const auto graph = track_field(field, 0);
      std::set<std::size_t> started;
      for (const TrackingEvent& event : graph.events)
        for (const std::int64_t number : event.tracks_out) {
          const auto track_number = static_cast<std::size_t>(number);
          if (!started.insert(track_number).second) continue;
          FieldSteps steps(field);
          const auto local = track_from_seeds(steps, 0, {graph.tracks[track_number].cell});
          ASSERT_TRUE(local) << local.error().message;
          EXPECT_TRUE(std::ranges::any_of(local->graph.events,
                                          [&](const TrackingEvent& other) {
                                            return other.type == event.type && other.time == event.time;
                                          }))
              << "seed " << seed << ", track " << number;
        }
    }
}

} // namespace
} // namespace hyperiso
