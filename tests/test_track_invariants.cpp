// What holds for every field: symmetries, conservation, and the contour tree where time only shifts the
// values.

#include "core/union_find.hpp"
#include "regions_of_samples.hpp"

namespace hyperiso {
namespace {

using check::map_samples;
using check::signature;
using check::time_field;
using check::track_field;

struct Way {
  Tracked tracked;
  Method method;
  bool surface() const { return tracked == Tracked::surface; }
};
constexpr Way ways[] = {{Tracked::surface, Method::hull},
                        {Tracked::surface, Method::simplicial},
                        {Tracked::region, Method::hull},
                        {Tracked::region, Method::simplicial}};
TrackOptions with(const Way& way, Inside inside = Inside::above) {
  TrackOptions options;
  options.tracked = way.tracked;
  options.extraction.method = way.method;
  options.extraction.inside = inside;
  return options;
}

template <int D>
std::array<std::int64_t, D> cube(std::int64_t side, std::int64_t steps) {
  std::array<std::int64_t, D> dims;
  dims.fill(side);
  dims[D - 1] = steps;
  return dims;
}

// test(field, way) for fields of a few small values, of some, and of many.
template <int D, class Test>
void for_random_fields(int count, std::int64_t side, Test&& test) {
  for (const Way& way : ways)
    for (int seed = 0; seed < count; ++seed)
      for (const int range : {1, 4, 1000}) {
        SCOPED_TRACE(seed);
        SCOPED_TRACE(way.surface() ? "surface" : "region");
        SCOPED_TRACE(way.method == Method::hull ? "hull" : "simplicial");
        test(check::random_field<float, D>(cube<D>(side, 4), range, static_cast<unsigned>(seed)), way);
      }
}

// Tracks appear and disappear only at events that say so.
TEST(TrackInvariants, arcs_are_conserved) {
  const auto test = [](const auto& field, const Way& way) {
    const auto graph = track_field(time_field(field), 0, with(way));
    std::int64_t sum = 0;
    for (const auto& event : graph.events) {
      sum +=
          static_cast<std::int64_t>(event.arcs_out.size()) - static_cast<std::int64_t>(event.arcs_in.size());
      EXPECT_EQ(event.arcs_in.size(), event.tracks_in.size());
      EXPECT_EQ(event.position.size(), graph.axes.size() - 1);
    }
    EXPECT_EQ(sum, 0);
    for (const auto& arc : graph.arcs) {
      ASSERT_GE(arc.end_event, 0);
      EXPECT_LE(graph.events[static_cast<std::size_t>(arc.start_event)].time,
                graph.events[static_cast<std::size_t>(arc.end_event)].time);
    }
    for (const auto& row : graph.features) {
      EXPECT_GE(row.track, 0);
      for (std::size_t axis = 0; axis < row.low.size(); ++axis) {
        EXPECT_LE(row.low[axis], row.high[axis]);
        EXPECT_TRUE(std::isfinite(row.low[axis]) && std::isfinite(row.high[axis]));
        EXPECT_TRUE(std::isfinite(row.centroid[axis]));
      }
    }
  };
  for_random_fields<3>(15, 5, test);
  for_random_fields<4>(4, 3, test);
}

// Without ties: along an arc nothing changes, and from step to step what the events say. A surface's genus is
// that of a surface.
TEST(TrackInvariants, euler_characteristics_change_at_events_only) {
  const auto test = [](const auto& field, const Way& way) {
    const auto graph = track_field(time_field(field), 0.5, with(way));
    std::map<std::int64_t, std::int64_t> of_arc, of_step, jumps;
    for (const auto& row : graph.features) {
      if (row.arc >= 0) { // else it is part of an event at the first or last step
        EXPECT_EQ(of_arc.emplace(row.arc, row.euler_characteristic).first->second, row.euler_characteristic);
      }
      of_step[row.step] += row.euler_characteristic;
      if (way.surface() && graph.axes.size() == 4) {
        EXPECT_GE(row.genus(), 0);
        EXPECT_EQ(row.genus(), std::floor(row.genus()));
      }
    }
    for (const auto& event : graph.events)
      jumps[static_cast<std::int64_t>(std::floor(event.time))] += event.delta_euler;
    for (std::int64_t step = 0; step + 1 < graph.steps; ++step)
      EXPECT_EQ(of_step[step] + jumps[step], of_step[step + 1]) << "step " << step;
  };
  for_random_fields<3>(15, 5, test);
  for_random_fields<4>(4, 3, test);
}

TEST(TrackInvariants, regions_are_those_that_a_search_among_samples_finds) {
  const auto test = [](const auto& field, const Way& way) {
    constexpr int D = std::tuple_size_v<decltype(field.view.dims())>;
    if (way.surface()) return;
    const auto graph = track_field(time_field(field), 0.5, with(way));
    check::expect_regions_of_samples<D>(graph, field.view, 0.5, way.method);
  };
  for_random_fields<3>(15, 5, test);
  for_random_fields<4>(4, 4, test);
}

TEST(TrackInvariants, no_event_at_a_step_unless_samples_equal_the_isovalue) {
  const auto test = [](const auto& field, const Way& way) {
    for (const auto& event : track_field(time_field(field), 0.5, with(way)).events)
      EXPECT_EQ(event.time == std::floor(event.time),
                event.type == EventType::open_start || event.type == EventType::open_end);
  };
  for_random_fields<3>(10, 5, test);
  for_random_fields<4>(3, 3, test);
}

TEST(TrackInvariants, negating_the_field_and_swapping_inside_gives_the_same_graph) {
  const auto test = [](const auto& field, const Way& way) {
    auto negated = field;
    for (float& sample : negated.samples) sample = -sample;
    EXPECT_EQ(signature(track_field(time_field(field), 0, with(way))),
              signature(track_field(time_field(negated), 0, with(way, Inside::below))));
  };
  for_random_fields<3>(10, 5, test);
  for_random_fields<4>(3, 3, test);
}

// Uneven steps, distances along axes and the way they run change no history: they name its times and places.
TEST(TrackInvariants, axes_name_times_and_places) {
  const auto test = [](const auto& field, const Way& way) {
    constexpr int D = std::tuple_size_v<decltype(field.view.dims())>;
    auto renamed = field;
    auto& axes = renamed.view.grid.axes;
    axes[0].origin = 7, axes[0].spacing = -0.25;
    axes[1].spacing = 3;
    axes[D - 1].coordinates = {-1, 0.5, 0.75, 20};
    const auto graph = track_field(time_field(field), 0, with(way));
    const auto other = track_field(time_field(renamed), 0, with(way));
    const auto place = [&](int axis, double index) {
      const auto below = std::min(static_cast<std::int64_t>(index), axes[axis].count - 2);
      const double share = index - static_cast<double>(below);
      return (1 - share) * axes[axis].coordinate(below) + share * axes[axis].coordinate(below + 1);
    };
    ASSERT_EQ(graph.events.size(), other.events.size());
    for (std::size_t i = 0; i < graph.events.size(); ++i) {
      const TrackingEvent &event = graph.events[i], &same = other.events[i];
      EXPECT_EQ(event.type, same.type);
      EXPECT_EQ(event.arcs_in, same.arcs_in);
      EXPECT_EQ(event.arcs_out, same.arcs_out);
      EXPECT_EQ(event.delta_euler, same.delta_euler);
      EXPECT_NEAR(place(D - 1, event.time), same.time, 1e-12);
      for (int axis = 0; axis + 1 < D; ++axis)
        EXPECT_NEAR(place(axis, event.position[static_cast<std::size_t>(axis)]),
                    same.position[static_cast<std::size_t>(axis)], 1e-12);
    }
    ASSERT_EQ(graph.features.size(), other.features.size());
    for (std::size_t i = 0; i < graph.features.size(); ++i) {
      const Feature &row = graph.features[i], &same = other.features[i];
      EXPECT_NEAR(row.volume * 0.75, same.volume, 1e-5 * (1 + row.volume));
      EXPECT_NEAR(row.cell_volume * 0.75, same.cell_volume, 1e-9);
      EXPECT_NEAR(place(0, row.centroid[0]), same.centroid[0], 1e-5);
      EXPECT_NEAR(place(0, row.low[0]), same.high[0], 1e-5);
      EXPECT_EQ(row.track, same.track);
      EXPECT_EQ(row.euler_characteristic, same.euler_characteristic);
      EXPECT_EQ(row.wall_curves, same.wall_curves);
    }
  };
  for_random_fields<3>(8, 5, test);
  for_random_fields<4>(3, 3, test);
}

// Kuhn simplices are those of the reversed grid only if all axes are reversed.
TEST(TrackInvariants, time_reversal_reverses_the_history) {
  const auto test = [](const auto& field, const Way& way) {
    constexpr int D = std::tuple_size_v<decltype(field.view.dims())>;
    const auto dims = field.view.dims();
    const auto reversed = map_samples<D>(
        field,
        [&](auto index) {
          for (int axis = 0; axis < D; ++axis)
            if (axis == D - 1 || way.method == Method::simplicial) index[axis] = dims[axis] - 1 - index[axis];
          return index;
        },
        dims);
    EXPECT_EQ(signature(track_field(time_field(field), 0, with(way))),
              signature(track_field(time_field(reversed), 0, with(way)), true));
  };
  for_random_fields<3>(10, 5, test);
  for_random_fields<4>(3, 3, test);
}

// The interpolant on Kuhn simplices knows no order of axes.
TEST(TrackInvariants, permuting_axes_of_space_changes_nothing_with_simplicial) {
  const auto test = [](const auto& field, const Way& way) {
    constexpr int D = std::tuple_size_v<decltype(field.view.dims())>;
    if (way.method == Method::hull) return;
    const auto permuted = map_samples<D>(
        field,
        [](auto index) {
          std::rotate(index.begin(), index.begin() + 1, index.end() - 1);
          return index;
        },
        field.view.dims());
    EXPECT_EQ(signature(track_field(time_field(field), 0, with(way))),
              signature(track_field(time_field(permuted), 0, with(way))));
  };
  for_random_fields<3>(10, 5, test);
  for_random_fields<4>(3, 3, test);
}

// The contour tree of values on a grid, by the join and the split tree (Carr, Snoeyink, Axen 2003), made here
// from nothing but the neighbours of a sample: the events of f = g + v t at 0.
class ContourTree {
 public:
  using Neighbours = std::vector<std::vector<std::size_t>>;

  // `inside` connects samples above a level, `outside` those below it.
  ContourTree(const std::vector<int>& values, const Neighbours& inside, const Neighbours& outside) {
    std::vector<std::size_t> order(values.size());
    for (std::size_t i = 0; i < order.size(); ++i) order[i] = i;
    std::ranges::sort(order, std::greater(), [&](std::size_t i) { return values[i]; });
    joins_ = merges(order, inside, values);
    std::ranges::reverse(order);
    splits_ = merges(order, outside, values);
  }
  // (value, number of components that meet there: 0 for a new one) for every sample where it is not 1.
  const std::vector<std::pair<int, std::size_t>>& joins() const { return joins_; }
  const std::vector<std::pair<int, std::size_t>>& splits() const { return splits_; }

 private:
  static std::vector<std::pair<int, std::size_t>> merges(const std::vector<std::size_t>& order,
                                                         const Neighbours& neighbours,
                                                         const std::vector<int>& values) {
    UnionFind united(order.size());
    std::vector<bool> there(order.size());
    std::vector<std::pair<int, std::size_t>> events;
    for (const std::size_t sample : order) {
      std::set<std::uint64_t> met;
      for (const std::size_t other : neighbours[sample])
        if (there[other]) met.insert(united.find(other));
      if (met.size() != 1) events.emplace_back(values[sample], met.size());
      for (const auto other : met) united.unite(other, sample);
      there[sample] = true;
    }
    return events;
  }
  std::vector<std::pair<int, std::size_t>> joins_, splits_;
};

template <int D>
ContourTree::Neighbours neighbours(const std::array<std::int64_t, D>& dims,
                                   const std::function<bool(std::array<int, D>)>& use) {
  std::size_t count = 1;
  for (const auto n : dims) count *= static_cast<std::size_t>(n);
  ContourTree::Neighbours result(count);
  int codes = 1;
  for (int axis = 0; axis < D; ++axis) codes *= 3;
  for (std::size_t sample = 0; sample < count; ++sample)
    for (int code = 0; code < codes; ++code) {
      std::array<int, D> step;
      std::size_t other = 0, stride = 1, rest = sample;
      bool inside = true;
      for (int axis = 0, digits = code; axis < D; ++axis, digits /= 3) {
        step[axis] = digits % 3 - 1;
        const auto n = static_cast<std::size_t>(dims[axis]);
        const auto at = static_cast<std::int64_t>(rest % n) + step[axis];
        inside &= at >= 0 && at < dims[axis];
        other += static_cast<std::size_t>(inside ? at : 0) * stride;
        stride *= n;
        rest /= n;
      }
      if (inside && other != sample && use(step)) result[sample].push_back(other);
    }
  return result;
}

// g a permutation of 0, 1, ... on the grid of space, f = g + t - n on steps so many that the isosurface at
// -1/2 comes and goes within them; the sample with value g joins the inside at t = n - g - 1/2.
template <int D>
void compare_with_contour_tree(Method method, unsigned seed, const std::array<std::int64_t, D>& dims,
                               Tracked tracked = Tracked::surface) {
  int count = 1;
  for (const auto n : dims) count *= static_cast<int>(n);
  std::vector<int> values(static_cast<std::size_t>(count));
  for (int i = 0; i < count; ++i) values[static_cast<std::size_t>(i)] = i;
  std::mt19937 random(seed);
  std::shuffle(values.begin(), values.end(), random);

  std::array<std::int64_t, D + 1> with_time;
  std::copy(dims.begin(), dims.end(), with_time.begin());
  with_time[D] = count + 1;
  std::size_t next = 0;
  const auto field = check::make_field<float, D + 1>(unit_grid<D + 1>(with_time), [&](const auto& point) {
    return values[next++ % values.size()] + point[D] - count;
  });
  const auto graph = track_field(time_field(field), -0.5, with(Way{tracked, method}));

  const auto kuhn = [](std::array<int, D> step) {
    const auto [low, high] = std::ranges::minmax(step);
    return low >= 0 || high <= 0;
  };
  const auto all = [](std::array<int, D>) { return true; };
  const auto axes = [](std::array<int, D> step) {
    int moved = 0;
    for (const int s : step) moved += s != 0;
    return moved == 1;
  };
  const bool simplicial = method == Method::simplicial;
  const ContourTree tree(
      values, neighbours<D>(dims, simplicial ? kuhn : std::function<bool(std::array<int, D>)>(all)),
      neighbours<D>(dims, simplicial ? kuhn : std::function<bool(std::array<int, D>)>(axes)));

  // Inside, time runs with falling g: a new component is born, several join; outside it runs backwards: where
  // outside components would join, the surface's part; where one would begin, the surface's dies. The region
  // inside knows nothing of these: its tree is that of the joins.
  std::map<double, int> expected, found; // components after less before, at each time
  const auto time_of = [&](int value) { return count - value - 0.5; };
  for (const auto& [value, met] : tree.joins()) expected[time_of(value)] += 1 - static_cast<int>(met);
  for (const auto& [value, met] : tree.splits())
    if (tracked == Tracked::surface) expected[time_of(value)] += static_cast<int>(met) - 1;
  for (const auto& event : graph.events)
    if (event.type != EventType::open_end) // a region is all there is at last
      found[event.time] += static_cast<int>(event.arcs_out.size()) - static_cast<int>(event.arcs_in.size());
  for (auto* changes : {&expected, &found})
    std::erase_if(*changes, [](const auto& change) { return change.second == 0; });
  EXPECT_EQ(found, expected) << "seed " << seed;
}

TEST(TrackInvariants, the_graph_of_a_rising_region_is_the_join_tree) {
  for (unsigned seed = 0; seed < 25; ++seed)
    for (const Method method : {Method::simplicial, Method::hull}) {
      compare_with_contour_tree<2>(method, seed, {5, 4}, Tracked::region);
      if (seed < 4) compare_with_contour_tree<3>(method, seed, {3, 3, 3}, Tracked::region);
    }
}

TEST(TrackInvariants, the_graph_of_a_rising_field_is_its_contour_tree) {
  for (unsigned seed = 0; seed < 40; ++seed) {
    compare_with_contour_tree<2>(Method::simplicial, seed, {5, 4});
    compare_with_contour_tree<2>(Method::hull, seed, {5, 4});
  }
  for (unsigned seed = 0; seed < 8; ++seed) {
    compare_with_contour_tree<3>(Method::simplicial, seed, {3, 4, 3});
    compare_with_contour_tree<3>(Method::hull, seed, {3, 4, 3});
  }
}

} // namespace
} // namespace hyperiso
