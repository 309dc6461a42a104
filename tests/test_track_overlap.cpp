// Overlaps of components from step to step, by cells and exactly.

#include "track/exact_overlap.hpp"
#include "track_fields.hpp"

namespace hyperiso {
namespace {

using check::expect_history;
using check::make_field;
using check::space_time_grid;
using check::time_field;
using check::track_field;
using track_detail::ExactOverlap;
using track_detail::SimplexPart;
using track_detail::StepShape;

struct Way {
  Tracked tracked;
  Method method;
};
constexpr Way ways[] = {{Tracked::surface, Method::hull},
                        {Tracked::surface, Method::simplicial},
                        {Tracked::region, Method::hull},
                        {Tracked::region, Method::simplicial}};

TrackOptions options_of(const Way& way, OverlapVolumes volumes, std::optional<double> threshold) {
  TrackOptions options;
  options.tracked = way.tracked;
  options.extraction.method = way.method;
  options.overlap_volumes = volumes;
  options.overlap_threshold = threshold;
  return options;
}
TrackOptions by_cells(const Way& way, std::optional<double> threshold = {}) {
  return options_of(way, OverlapVolumes::cells, threshold);
}
TrackOptions exact(const Way& way, std::optional<double> threshold = {}) {
  return options_of(way, OverlapVolumes::exact, threshold);
}
double squared(double x) { return x * x; }

// What two balls of one size share whose centres are u diameters apart.
double common_share_of_balls(double u) { return (2 + u) * squared(1 - u) / 2; }

// A box of ones, n cells long, that is somewhere else at the second step.
Field shifted_box(int shift) {
  const int n = 20;
  return time_field<float, 4>(make_field<float, 4>(unit_grid<4>({46, 6, 5, 2}), [=](const auto& p) {
    const double start = (shift < 0 ? 22.5 : 2.5) + shift * p[3];
    return p[0] > start && p[0] < start + n && p[1] > 1 && p[1] < 4 && p[2] > 1 && p[2] < 4 ? 1.0 : 0.0;
  }));
}

TEST(TrackOverlap, of_shifted_boxes_by_cells) {
  for (const Way& way : ways) {
    for (const int shift : {0, 5, 12, 13, 19}) {
      const auto graph = track_field(shifted_box(shift), 0.5, by_cells(way));
      expect_history(graph, {});
      ASSERT_EQ(graph.links.size(), 1u);
      EXPECT_DOUBLE_EQ(graph.links[0].overlap, (20 - shift) / 20.0);
      EXPECT_EQ(graph.tracks.size(), 1u);
    }
    EXPECT_EQ(track_field(shifted_box(12), 0.5, by_cells(way, 0.35)).tracks.size(), 1u);
    const auto cut = track_field(shifted_box(13), 0.5, by_cells(way, 0.35));
    EXPECT_TRUE(cut.links[0].weak);
    ASSERT_EQ(cut.tracks.size(), 2u);
    EXPECT_EQ(cut.tracks[0].end_type, "weak");
    EXPECT_EQ(cut.tracks[1].start_type, "weak");
    expect_history(track_field(shifted_box(21), 0.5, by_cells(way)),
                   {{EventType::death, 0.5}, {EventType::birth, 0.5}});
    // Boxes that just touch: the hull joins all that is inside of a cell, a Kuhn diagonal only one direction.
    const auto right = track_field(shifted_box(20), 0.5, by_cells(way));
    const auto left = track_field(shifted_box(-20), 0.5, by_cells(way));
    if (way.method == Method::hull) {
      expect_history(right, {});
      expect_history(left, {});
    } else
      EXPECT_NE(right.links.empty(), left.links.empty());
  }
}

TEST(TrackOverlap, of_balls_by_cells) {
  const double r = 12;
  for (const Way& way : ways)
    for (const double d : {4.0, 8.0, 11.0}) {
      const auto field =
          time_field<float, 4>(make_field<float, 4>(unit_grid<4>({38, 14, 14, 2}), [=](const auto& p) {
            return r - std::sqrt(squared(p[0] - 18.5 + d / 2 - d * p[3]) + squared(p[1]) + squared(p[2]));
          }));
      const auto graph = track_field(field, 0, by_cells(way));
      ASSERT_EQ(graph.links.size(), 1u);
      EXPECT_NEAR(graph.links[0].overlap, common_share_of_balls(d / (2 * r)), 0.02);
    }
}

// Owner 0 has the inside, owner 1 the outside: what they share adds up to all there is, at any values.
template <int D>
void expect_shares_to_add_up(const std::array<std::int64_t, D>& dims, int range, unsigned seed) {
  const auto first = check::random_field<float, D>(dims, range, seed);
  const auto second = check::random_field<float, D>(dims, range, seed + 1000);
  const auto shape_of = [](const check::OwnedField<float, D>& field) {
    SimplexPart inside, outside;
    inside.bounds[0] = {0, true, false};
    outside.bounds[0] = {0, false, true};
    std::vector<std::uint32_t> owners;
    for (const float value : field.samples) owners.push_back(value >= 0 ? 0 : 1);
    return StepShape<D>(field.view, {inside, outside}, owners);
  };
  const StepShape<D> a = shape_of(first), b = shape_of(second);
  const ExactOverlap<D> overlap(a, b);
  double whole = 1;
  for (const std::int64_t count : dims) whole *= static_cast<double>(count - 1);
  EXPECT_NEAR(overlap.first(0) + overlap.first(1), whole, 1e-10);
  EXPECT_NEAR(overlap.second(0) + overlap.second(1), whole, 1e-10);
  for (const std::uint32_t owner : {0u, 1u}) {
    EXPECT_NEAR(overlap.common(owner, 0) + overlap.common(owner, 1), overlap.first(owner), 1e-10);
    EXPECT_NEAR(overlap.common(0, owner) + overlap.common(1, owner), overlap.second(owner), 1e-10);
  }
  const ExactOverlap<D> itself(a, a);
  EXPECT_NEAR(itself.common(0, 0), itself.first(0), 1e-10);
  EXPECT_NEAR(itself.common(0, 1), 0, 1e-10);
}

TEST(TrackOverlap, shares_add_up) {
  for (unsigned seed = 0; seed < 30; ++seed)
    for (const int range : {1, 4, 1000}) {
      expect_shares_to_add_up<2>({4, 5}, range, seed);
      expect_shares_to_add_up<3>({3, 3, 4}, range, seed);
    }
}

// The interpolant on the Kuhn simplex of each of many points, which its coordinates in order of size tell.
TEST(TrackOverlap, shares_are_those_of_sampled_points) {
  for (unsigned seed = 0; seed < 5; ++seed) {
    const auto first = check::random_field<float, 3>({2, 2, 2}, 1000, seed);
    const auto second = check::random_field<float, 3>({2, 2, 2}, 1000, seed + 50);
    const auto shape_of = [](const check::OwnedField<float, 3>& field) {
      SimplexPart inside;
      inside.bounds[0] = {100, true, false};
      return StepShape<3>(field.view, {inside}, std::vector<std::uint32_t>(8, 0));
    };
    const auto value = [](const check::OwnedField<float, 3>& field, std::array<double, 3> point) {
      std::array<std::size_t, 3> order{0, 1, 2};
      std::ranges::sort(order, std::greater{}, [&](std::size_t axis) { return point[axis]; });
      std::array<std::int64_t, 3> corner{};
      double sum = field.view.at(corner), last = sum;
      for (const std::size_t axis : order) {
        corner[axis] = 1;
        const double next = field.view.at(corner);
        sum += point[axis] * (next - last);
        last = next;
      }
      return sum;
    };
    constexpr int n = 60;
    double expected = 0;
    for (int i = 0; i < n * n * n; ++i) {
      const std::array<double, 3> point{(i % n + 0.5) / n, (i / n % n + 0.5) / n, (i / n / n + 0.5) / n};
      expected += value(first, point) >= 100 && value(second, point) >= 100;
    }
    const StepShape<3> a = shape_of(first), b = shape_of(second);
    EXPECT_NEAR((ExactOverlap<3>(a, b).common(0, 0)), expected / (n * n * n), 0.003) << "seed " << seed;
  }
}

// A plate between two faces that are n apart and move by any distance: exact where the field is linear.
TEST(TrackOverlap, plates) {
  const double n = 20;
  for (const Way& way : ways)
    for (const double shift : {0.0, 5.0, 12.0, 13.0, 7.37}) {
      Grid<4> grid = unit_grid<4>({44, 4, 4, 2});
      const auto field = time_field<double, 4>(make_field<double, 4>(grid, [=](const auto& p) {
        const double start = 4.3 + shift * p[3];
        return std::min(p[0] - start, start + n - p[0]);
      }));
      // The two faces of a plate are two surfaces, each with all that is inside.
      for (const FeatureLink& link : track_field(field, 0, exact(way)).links)
        EXPECT_NEAR(link.overlap, (n - shift) / n, 1e-12) << shift;
    }
}

// A region is a quarter of a ball, from its axis to the walls: to fill all of it takes time.
TEST(TrackOverlap, balls_of_equal_size) {
  const double r = 12;
  for (const Way& way : ways)
    for (const double d : {0.690 * r, 0.699 * r, 0.930 * r, 0.939 * r}) {
      Grid<4> grid = unit_grid<4>({38, 14, 14, 2});
      if (way.tracked == Tracked::surface)
        for (const std::size_t axis : {1, 2}) {
          grid.axes[axis].origin = -13;
          grid.axes[axis].count = 27;
        }
      const auto field = time_field<float, 4>(make_field<float, 4>(grid, [=](const auto& p) {
        return r - std::sqrt(squared(p[0] - 18.5 + d / 2 - d * p[3]) + squared(p[1]) + squared(p[2]));
      }));
      const auto graph = track_field(field, 0, exact(way, d < 0.8 * r ? 0.5 : 0.35));
      ASSERT_EQ(graph.links.size(), 1u);
      EXPECT_NEAR(graph.links[0].overlap, common_share_of_balls(d / (2 * r)), 0.001);
      EXPECT_EQ(graph.links[0].weak, d == 0.699 * r || d == 0.939 * r) << d / r;
    }
}

// A cavity is what its surface encloses, in the outside.
TEST(TrackOverlap, of_cavities) {
  const double r = 7, d = 5;
  Grid<4> grid = unit_grid<4>({24, 19, 19, 2});
  const auto field = time_field<float, 4>(make_field<float, 4>(grid, [=](const auto& p) {
    return std::sqrt(squared(p[0] - 9 - d * p[3]) + squared(p[1] - 9) + squared(p[2] - 9)) - r;
  }));
  for (const Method method : {Method::hull, Method::simplicial}) {
    const auto graph = track_field(field, 0, exact({Tracked::surface, method}));
    ASSERT_EQ(graph.links.size(), 1u);
    EXPECT_NEAR(graph.links[0].overlap, common_share_of_balls(d / (2 * r)), 0.005);
  }
}

// A thin shell that no sample need be in.
TEST(TrackOverlap, between_two_isovalues) {
  for (const Method method : {Method::hull, Method::simplicial})
    for (const double shift : {0.0, 0.1, 0.25}) {
      Grid<3> grid = unit_grid<3>({8, 5, 2});
      const auto field = time_field<double, 3>(
          make_field<double, 3>(grid, [=](const auto& p) { return p[0] - 3.4 - shift * p[2]; }));
      TrackOptions options = exact({Tracked::region, method});
      options.upper_isovalue = 0.3;
      const auto graph = track_field(field, 0, options);
      ASSERT_EQ(graph.links.size(), 1u);
      EXPECT_NEAR(graph.links[0].overlap, (0.3 - shift) / 0.3, 1e-9) << shift;
    }
}

} // namespace
} // namespace hyperiso
