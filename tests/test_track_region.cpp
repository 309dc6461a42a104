// Components of the inside, and of what lies between two isovalues.

#include "hyperiso/measure.hpp"
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

constexpr Method both_methods[] = {Method::hull, Method::simplicial};

TrackOptions region(Method method, std::optional<double> upper = {}) {
  TrackOptions options;
  options.tracked = Tracked::region;
  options.extraction.method = method;
  options.upper_isovalue = upper;
  return options;
}
double squared(double x) { return x * x; }
double radius(const Point& p) { return std::sqrt(squared(p[0]) + squared(p[1]) + squared(p[2])); }

// From 20 to 30 away from the middle: a shell that moves outwards, and no surface of which is all of it.
TEST(TrackRegion, between_two_isovalues_a_shell_is_born_as_a_ball_and_opens) {
  const auto field = time_field<double, 3>(make_field<double, 3>(
      space_time_grid<3>(14, 9), [](const auto& p) { return 1.5 * p[2] - std::hypot(p[0], p[1]); }));
  for (const Method method : both_methods) {
    const auto graph = track_field(field, 1.5, region(method, 4.5));
    expect_history(graph, {{EventType::birth, 1}, {EventType::genus, 3}});
    ASSERT_EQ(graph.tracks.size(), 1u);
    for (const Feature& row : graph.features) {
      const double outer = 1.5 * row.time - 1.5, inner = std::max(outer - 3, 0.0);
      EXPECT_NEAR(row.volume, M_PI * (squared(outer) - squared(inner)), 0.3 + 0.4 * outer) << row.time;
      EXPECT_GE(row.minimum, 1.5);
      EXPECT_LE(row.maximum, 4.5);
      EXPECT_EQ(row.euler_characteristic, row.time < 2.5 ? 1 : 0) << row.time;
    }
  }
}

// The mesh of the region gives what the divergence theorem gives on its surface.
TEST(TrackRegion, volume_and_area_are_those_of_the_surface) {
  for (const Method method : both_methods) {
    const auto field = time_field<double, 4>(make_field<double, 4>(space_time_grid<4>(6, 3), [](auto p) {
      return 2.5 + 0.3 * p[3] - std::abs(radius(p) - 4.7) + 0.1 * p[0];
    }));
    TrackOptions surface;
    surface.extraction.method = method;
    const auto surfaces = track_field(field, 0, surface);
    const auto regions = track_field(field, 0, region(method));
    ASSERT_EQ(regions.features.size(), 3u);
    ASSERT_EQ(surfaces.features.size(), 6u);
    for (const Feature& row : regions.features) {
      double area = 0;
      for (const Feature& other : surfaces.features) {
        if (other.step != row.step) continue;
        area += other.surface_area;
        if (other.on_wall) {
          EXPECT_NEAR(row.volume, other.volume, 1e-8 * row.volume);
          EXPECT_DOUBLE_EQ(row.cell_volume, other.cell_volume);
        }
      }
      EXPECT_NEAR(row.surface_area, area, 1e-8 * area);
    }
  }
}

// The mesh that is written: simplices that face one way, each on its track.
TEST(TrackRegion, mesh_of_a_step) {
  const auto field = time_field<double, 4>(make_field<double, 4>(space_time_grid<4>(6, 3), [](auto p) {
    return 3.3 - std::abs(std::abs(p[0]) - 1.2 - p[3]) - std::hypot(p[1], p[2]);
  }));
  for (const Method method : both_methods) {
    const TrackOptions options = region(method);
    const auto graph = track_field(field, 1, options);
    FieldSteps steps(field);
    for (std::int64_t step = 0; step < 3; ++step) {
      const auto mesh = tracked_surface(graph, *steps.read(step, step + 1), step, options);
      ASSERT_TRUE(mesh) << mesh.error().message;
      const auto measured = measure(*mesh);
      // Those that fold count twice in `content`.
      EXPECT_LE(measured->inverted_simplices, method == Method::hull ? mesh->simplex_count() / 50 : 0);
      double volume = 0;
      std::int64_t euler = 0;
      std::set<std::int32_t> tracks;
      for (const Feature& row : graph.features)
        if (row.step == step) {
          volume += row.volume;
          euler += row.euler_characteristic;
          tracks.insert(static_cast<std::int32_t>(row.track));
        }
      EXPECT_NEAR(measured->content, volume, (method == Method::hull ? 5e-3 : 1e-4) * volume);
      EXPECT_EQ(measured->euler_characteristic, euler);
      ASSERT_EQ(mesh->attributes.size(), 2u);
      const auto& of_simplices = std::get<std::vector<std::int32_t>>(mesh->attributes[0].values);
      EXPECT_EQ(std::set(of_simplices.begin(), of_simplices.end()), tracks);
    }
  }
}

TEST(TrackRegion, negated_field_and_inside_below_give_the_same) {
  for (const Method method : both_methods)
    for (unsigned seed = 0; seed < 20; ++seed) {
      auto field = check::random_field<float, 3>({5, 4, 4}, 3, seed);
      for (const std::optional<double> upper : {std::optional<double>(), std::optional<double>(2)}) {
        const auto graph = track_field(time_field<float, 3>(field), 1, region(method, upper));
        auto negated = field;
        for (float& sample : negated.samples) sample = -sample;
        TrackOptions below = region(method);
        below.extraction.inside = Inside::below;
        if (upper) below.upper_isovalue = -1;
        const auto same = track_field(time_field<float, 3>(negated), upper ? -2 : -1, below);
        ASSERT_EQ(graph.events.size(), same.events.size());
        for (std::size_t i = 0; i < graph.events.size(); ++i) {
          EXPECT_EQ(graph.events[i].type, same.events[i].type);
          EXPECT_EQ(graph.events[i].time, same.events[i].time);
          EXPECT_EQ(graph.events[i].arcs_in, same.events[i].arcs_in);
        }
      }
    }
}

TEST(TrackRegion, says_what_it_cannot_do) {
  const auto field = time_field<float, 3>(check::random_field<float, 3>({3, 3, 3}, 3, 1));
  FieldSteps steps(field);
  EXPECT_EQ(track(steps, 0, region(Method::component)).error().code, Code::invalid_argument);
  EXPECT_EQ(track(steps, 0, region(Method::hull, 0)).error().code, Code::invalid_isovalue);
  TrackOptions surface;
  surface.upper_isovalue = 1;
  EXPECT_EQ(track(steps, 0, surface).error().code, Code::invalid_argument);
  EXPECT_EQ(track_from_seeds(steps, 0, {{0, 0, 0}}, region(Method::hull)).error().code,
            Code::invalid_argument);
}

} // namespace
} // namespace hyperiso
