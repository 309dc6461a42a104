// What holds for every field: symmetries, conservation, and the contour tree where time only shifts the
// values.

#include "core/union_find.hpp"
#include "hyperiso/io.hpp"
#include "hyperiso/slice.hpp"
#include "track_fields.hpp"

#include <filesystem>

namespace hyperiso {
namespace {

using check::OwnedField;
using check::time_field;
using check::track_field;

TrackOptions with(Method method, Inside inside = Inside::above, Tracked tracked = Tracked::surface) {
  TrackOptions options;
  options.tracked = tracked;
  options.extraction.method = method;
  options.extraction.inside = inside;
  return options;
}

std::string name_of_reversed(EventType type) {
  switch (type) {
  case EventType::birth:
    return "death";
  case EventType::death:
    return "birth";
  case EventType::merge:
    return "split";
  case EventType::split:
    return "merge";
  case EventType::enter:
    return "exit";
  case EventType::exit:
    return "enter";
  case EventType::open_start:
    return "open_end";
  case EventType::open_end:
    return "open_start";
  default:
    return name_of(type);
  }
}

// Type, time, numbers of arcs and Euler jump of each event; as they would be were time to run backwards.
std::multiset<std::string> signature(const TrackingGraph& graph, bool reversed = false) {
  std::multiset<std::string> lines;
  const double end = graph.axes.back().coordinate(graph.steps - 1);
  for (const TrackingEvent& event : graph.events) {
    char line[120];
    auto in = event.arcs_in.size(), out = event.arcs_out.size();
    if (reversed) std::swap(in, out);
    std::snprintf(line, sizeof line, "%s %.9f %zu>%zu %+d",
                  reversed ? name_of_reversed(event.type).c_str() : name_of(event.type),
                  reversed ? end - event.time : event.time, in, out,
                  static_cast<int>(reversed ? -event.delta_euler : event.delta_euler));
    lines.insert(line);
  }
  return lines;
}

template <int D>
OwnedField<float, D>
map_samples(const OwnedField<float, D>& field,
            const std::function<std::array<std::int64_t, D>(std::array<std::int64_t, D>)>& from,
            const std::array<std::int64_t, D>& dims, float factor = 1) {
  return check::make_field<float, D>(unit_grid<D>(dims), [&](const std::array<double, D>& point) {
    std::array<std::int64_t, D> index;
    for (int axis = 0; axis < D; ++axis) index[axis] = static_cast<std::int64_t>(point[axis]);
    return factor * field.view.at(from(index));
  });
}

template <int D>
std::array<std::int64_t, D> cube(std::int64_t side, std::int64_t steps) {
  std::array<std::int64_t, D> dims;
  dims.fill(side);
  dims[D - 1] = steps;
  return dims;
}

template <int D, class Test>
void for_random_fields(int count, std::int64_t side, Test&& test) {
  for (int seed = 0; seed < count; ++seed)
    for (const int range : {1, 4, 1000}) {
      SCOPED_TRACE(seed);
      test(check::random_field<float, D>(cube<D>(side, 4), range, static_cast<unsigned>(seed)));
    }
}

// Tracks appear and disappear only at events that say so.
TEST(TrackInvariants, arcs_are_conserved) {
  const auto test = [](const auto& field) {
    for (const auto& [method, tracked] :
         {std::pair(Method::hull, Tracked::surface), std::pair(Method::simplicial, Tracked::surface),
          std::pair(Method::hull, Tracked::region)}) {
      const auto graph = track_field(time_field(field), 0, with(method, Inside::above, tracked));
      std::int64_t sum = 0;
      for (const auto& event : graph.events) {
        sum += static_cast<std::int64_t>(event.arcs_out.size()) -
               static_cast<std::int64_t>(event.arcs_in.size());
        EXPECT_EQ(event.arcs_in.size(), event.tracks_in.size());
        EXPECT_EQ(event.position.size(), graph.axes.size() - 1);
      }
      EXPECT_EQ(sum, 0);
      for (const auto& arc : graph.arcs) {
        ASSERT_GE(arc.end_event, 0);
        EXPECT_LE(graph.events[static_cast<std::size_t>(arc.start_event)].time,
                  graph.events[static_cast<std::size_t>(arc.end_event)].time);
      }
      for (const auto& row : graph.features) EXPECT_GE(row.track, 0);
    }
  };
  for_random_fields<3>(20, 5, test);
  for_random_fields<4>(6, 3, test);
}

TEST(TrackInvariants, no_event_at_a_step_unless_samples_equal_the_isovalue) {
  for (unsigned seed = 0; seed < 20; ++seed) {
    auto field = check::random_field<float, 3>({5, 5, 5}, 1000, seed);
    for (const Tracked tracked : {Tracked::surface, Tracked::region})
      for (const auto& event :
           track_field(time_field(field), 0.5, with(Method::hull, Inside::above, tracked)).events)
        EXPECT_EQ(event.time == std::floor(event.time),
                  event.type == EventType::open_start || event.type == EventType::open_end);
  }
}

TEST(TrackInvariants, negating_the_field_and_swapping_inside_gives_the_same_graph) {
  const auto test = [](const auto& field) {
    auto negated = field;
    for (float& sample : negated.samples) sample = -sample;
    EXPECT_EQ(signature(track_field(time_field(field), 0)),
              signature(track_field(time_field(negated), 0, with(Method::hull, Inside::below))));
  };
  for_random_fields<3>(15, 5, test);
  for_random_fields<4>(4, 3, test);
}

TEST(TrackInvariants, time_reversal_reverses_the_history) {
  const auto test = [](const auto& field) {
    constexpr int D = std::tuple_size_v<decltype(field.view.dims())>;
    const auto dims = field.view.dims();
    for (const Method method : {Method::hull, Method::simplicial}) {
      const auto reversed = map_samples<D>(
          field,
          [&](auto index) {
            for (int axis = 0; axis < D; ++axis)
              if (axis == D - 1 || method == Method::simplicial) index[axis] = dims[axis] - 1 - index[axis];
            return index;
          },
          dims);
      EXPECT_EQ(signature(track_field(time_field(field), 0, with(method))),
                signature(track_field(time_field(reversed), 0, with(method)), true));
    }
  };
  for_random_fields<3>(15, 5, test);
  for_random_fields<4>(4, 3, test);
}

// A region of the interpolant on Kuhn simplices is a set that knows no order of cells.
TEST(TrackInvariants, a_simplicial_region_is_the_same_backwards_and_with_other_axes) {
  const TrackOptions region = with(Method::simplicial, Inside::above, Tracked::region);
  for_random_fields<3>(8, 4, [&](const auto& field) {
    const auto dims = field.view.dims();
    const auto back = map_samples<3>(
        field,
        [&](auto index) {
          return std::array{dims[0] - 1 - index[0], dims[1] - 1 - index[1], dims[2] - 1 - index[2]};
        },
        dims);
    const auto turned = map_samples<3>(
        field,
        [](auto index) {
          return std::array{index[1], index[0], index[2]};
        },
        dims);
    const auto graph = track_field(time_field(field), 0, region);
    EXPECT_EQ(signature(graph), signature(track_field(time_field(back), 0, region), true));
    EXPECT_EQ(signature(graph), signature(track_field(time_field(turned), 0, region)));
  });
}

TEST(TrackInvariants, permuting_axes_of_space_changes_nothing_with_simplicial) {
  for_random_fields<4>(4, 3, [](const auto& field) {
    const auto permuted = map_samples<4>(
        field,
        [](auto index) {
          return std::array{index[2], index[0], index[1], index[3]};
        },
        field.view.dims());
    EXPECT_EQ(signature(track_field(time_field(field), 0, with(Method::simplicial))),
              signature(track_field(time_field(permuted), 0, with(Method::simplicial))));
  });
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
  const auto graph = track_field(time_field(field), -0.5, with(method, Inside::above, tracked));

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

// Real data: at moments between events, the components of the slice that `slice` cuts are the arcs alive, and
// its Euler characteristic changes from moment to moment by what the events say.
void compare_with_slices(const Field& field, double isovalue) {
  const auto graph = track_field(field, isovalue);
  std::vector<double> times;
  for (const auto& event : graph.events) times.push_back(event.time);
  const auto view = field.view<float, 4>();
  std::optional<std::int64_t> euler;
  std::size_t next_event = 0;
  std::mt19937 random(7);
  const double start = times.front(), end = times.back();
  for (int i = 1; i < 24; ++i) {
    const double share = (i + std::uniform_real_distribution<double>(0.1, 0.9)(random)) / 25;
    const double time = start + share * (end - start);
    const auto cut = slice(view, isovalue, Hyperplane<4>::at(3, time));
    ASSERT_TRUE(cut) << cut.error().message;
    const auto measured = measure(*cut);
    const auto alive = std::ranges::count_if(graph.arcs, [&](const TrackingArc& arc) {
      return times[static_cast<std::size_t>(arc.start_event)] < time &&
             times[static_cast<std::size_t>(arc.end_event)] > time;
    });
    EXPECT_EQ(static_cast<std::uint64_t>(alive), measured->components) << "at " << time;
    for (; next_event < graph.events.size() && times[next_event] < time; ++next_event)
      if (euler) *euler += graph.events[next_event].delta_euler;
    EXPECT_EQ(euler.value_or(measured->euler_characteristic), measured->euler_characteristic)
        << "at " << time;
    euler = measured->euler_characteristic;
  }
  for (const auto& row : graph.features) {
    EXPECT_EQ(row.genus(), std::floor(row.genus()));
    EXPECT_GE(row.volume, 0);
  }
}

// The symmetries above, on real data.
void check_symmetries(const Field& data, double isovalue) {
  const auto view = data.view<float, 4>();
  const auto field =
      check::make_field<float, 4>(unit_grid<4>(view.dims()), [&](const std::array<double, 4>& point) {
        std::array<std::int64_t, 4> index;
        for (std::size_t axis = 0; axis < 4; ++axis) index[axis] = static_cast<std::int64_t>(point[axis]);
        return view.at(index);
      });
  const auto dims = field.view.dims();
  const auto graph = track_field(time_field(field), isovalue);
  const bool has_ties = std::ranges::find(field.samples, static_cast<float>(isovalue)) != field.samples.end();
  std::int64_t sum = 0;
  for (const auto& event : graph.events) {
    sum += static_cast<std::int64_t>(event.arcs_out.size()) - static_cast<std::int64_t>(event.arcs_in.size());
    if (!has_ties) {
      EXPECT_EQ(event.time == std::floor(event.time),
                event.type == EventType::open_start || event.type == EventType::open_end);
    }
  }
  EXPECT_EQ(sum, 0);

  auto negated = field;
  for (float& sample : negated.samples) sample = -sample;
  EXPECT_EQ(signature(graph),
            signature(track_field(time_field(negated), -isovalue, with(Method::hull, Inside::below))));

  const auto backwards = [&](auto index) {
    index[3] = dims[3] - 1 - index[3];
    return index;
  };
  EXPECT_EQ(signature(graph),
            signature(track_field(time_field(map_samples<4>(field, backwards, dims)), isovalue), true));

  const auto few_steps = std::array{dims[0], dims[1], dims[2], std::min<std::int64_t>(dims[3], 12)};
  const auto late = [&](auto index) {
    index[3] += dims[3] - few_steps[3];
    return index;
  };
  const auto turned = [&](auto index) { return late(std::array{index[2], index[0], index[1], index[3]}); };
  EXPECT_EQ(
      signature(track_field(time_field(map_samples<4>(field, late, few_steps)), isovalue,
                            with(Method::simplicial))),
      signature(track_field(
          time_field(map_samples<4>(field, turned, {few_steps[1], few_steps[2], few_steps[0], few_steps[3]})),
          isovalue, with(Method::simplicial))));
}

// Read step by step, the history is that of the field in memory.
void compare_with_stream(FieldReader& reader, double isovalue) {
  const auto whole = track_field(*reader.read(), isovalue);
  const auto streamed = track(reader, isovalue);
  ASSERT_TRUE(streamed) << streamed.error().message;
  EXPECT_EQ(signature(whole), signature(*streamed));
  ASSERT_EQ(whole.features.size(), streamed->features.size());
  for (std::size_t row = 0; row < whole.features.size(); ++row) {
    EXPECT_EQ(whole.features[row].track, streamed->features[row].track);
    EXPECT_EQ(whole.features[row].volume, streamed->features[row].volume);
  }
}

std::filesystem::path shared_data() {
  if (const char* folder = std::getenv("HYPERISO_SHARED_DATA")) return folder;
  return std::filesystem::path(HYPERISO_SOURCE_FOLDER) / ".." / "shared" / "data";
}

TEST(TrackInvariants, water_of_the_dam_break) {
  auto reader = open_field(
      {std::filesystem::path(HYPERISO_SOURCE_FOLDER) / "examples/data/alpha_water_24x24x24x41.nrrd"});
  ASSERT_TRUE(reader) << reader.error().message;
  const auto field = *(*reader)->read();
  compare_with_slices(field, 0.5);
  check_symmetries(field, 0.5);
  compare_with_stream(**reader, 0.5);
}

TEST(TrackInvariants, viscous_fingers) {
  const auto folder = shared_data() / "viscous_fingers";
  if (!std::filesystem::exists(folder)) GTEST_SKIP() << folder << " is not there";
  std::vector<std::filesystem::path> files;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) files.push_back(entry.path());
  std::ranges::sort(files);
  auto reader = open_field(files);
  ASSERT_TRUE(reader) << reader.error().message;
  const auto field = *(*reader)->read();
  compare_with_slices(field, 30);
  check_symmetries(field, 30);
  compare_with_stream(**reader, 30);
}

} // namespace
} // namespace hyperiso
