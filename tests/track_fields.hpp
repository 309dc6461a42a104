#pragma once
// Fields whose history is known, and short ways to track them.

#include "check.hpp"
#include "hyperiso/track.hpp"

#include <cstring>

namespace hyperiso::check {

// A copy of the samples as a field in memory, time last.
template <class T, int D>
Field time_field(const OwnedField<T, D>& owned) {
  FieldInfo info;
  info.type = sample_type_of<T>();
  info.axes.assign(owned.view.grid.axes.begin(), owned.view.grid.axes.end());
  info.has_time = true;
  auto made = allocate_field(info);
  std::memcpy(made->samples, owned.samples.data(), owned.samples.size() * sizeof(T));
  return made->field;
}

inline TrackingGraph track_field(const Field& field, double isovalue, const TrackOptions& options = {}) {
  FieldSteps steps(field);
  auto graph = track(steps, isovalue, options);
  EXPECT_TRUE(graph) << graph.error().message;
  return graph ? *graph : TrackingGraph{};
}

// Axes of space from -half to half and steps 0 ... steps-1, all with spacing 1.
template <int D>
Grid<D> space_time_grid(int half, int steps, int first_step = 0) {
  Grid<D> grid;
  for (Axis& axis : grid.axes) {
    axis.count = 2 * half + 1;
    axis.origin = -half;
  }
  grid.axes[D - 1].count = steps;
  grid.axes[D - 1].origin = first_step;
  return grid;
}

struct Moment {
  EventType type;
  double time;
  std::optional<std::int64_t> delta_euler = {};
};

// The events in order of time without those at the first and last step, times to 1e-5.
inline void expect_history(const TrackingGraph& graph, const std::vector<Moment>& expected) {
  std::vector<const TrackingEvent*> events;
  for (const TrackingEvent& event : graph.events)
    if (event.type != EventType::open_start && event.type != EventType::open_end) events.push_back(&event);
  EXPECT_EQ(events.size(), expected.size());
  for (std::size_t i = 0; i < std::min(events.size(), expected.size()); ++i) {
    EXPECT_STREQ(name_of(events[i]->type), name_of(expected[i].type)) << "event " << i;
    EXPECT_NEAR(events[i]->time, expected[i].time, 1e-5) << "event " << i;
    if (expected[i].delta_euler) {
      EXPECT_EQ(events[i]->delta_euler, *expected[i].delta_euler) << "event " << i;
    }
  }
}

inline std::ptrdiff_t count_events(const TrackingGraph& graph, EventType type) {
  return std::ranges::count(graph.events, type, &TrackingEvent::type);
}

inline std::string name_of_reversed(EventType type) {
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
inline std::multiset<std::string> signature(const TrackingGraph& graph, bool reversed = false) {
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

} // namespace hyperiso::check
