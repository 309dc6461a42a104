#pragma once
// What the writers of tracking graphs share.

#include "core/text.hpp"
#include "hyperiso/track_files.hpp"
#include "io/encoding.hpp"

#include <algorithm>

namespace hyperiso::tracking_files {

inline std::size_t index(std::int64_t number) { return static_cast<std::size_t>(number); }

// "x", "y", ... : the axes' own names where they have them.
inline std::vector<std::string> space_axis_names(const TrackingGraph& graph) {
  std::vector<std::string> names;
  for (std::size_t axis = 0; axis + 1 < graph.axes.size(); ++axis)
    names.push_back(graph.axes[axis].name.empty() ? std::string(1, "xyz"[axis]) : graph.axes[axis].name);
  return names;
}

// Numbers with something between them.
template <class Numbers>
std::string joined(const Numbers& numbers, const char* separator) {
  std::string result;
  for (const auto number : numbers) {
    if (!result.empty()) result += separator;
    result += text(number);
  }
  return result;
}

// An attribute of a node or an edge of the graph.
struct GraphValue {
  const char* name;
  const char* type; // of GraphML: "string", "long", "double", "boolean"
  std::string value;
};

inline std::vector<GraphValue> values_of(const TrackingGraph& graph, const TrackingEvent& event) {
  std::vector<GraphValue> values{{"type", "string", name_of(event.type)},
                                 {"time", "double", text(event.time)},
                                 {"delta_euler", "long", text(event.delta_euler)},
                                 {"simplified", "boolean", event.simplified ? "true" : "false"}};
  static constexpr const char* coordinates[] = {"x", "y", "z"};
  for (std::size_t axis = 0; axis + 1 < graph.axes.size(); ++axis)
    values.push_back({coordinates[axis], "double", text(event.position[axis])});
  return values;
}

inline std::vector<GraphValue> values_of(const TrackingGraph& graph, const TrackingArc& arc) {
  const Track& track = graph.tracks[index(arc.track)];
  return {{"track_id", "long", text(arc.track)},
          {"family_id", "long", text(track.family)},
          {"start_time", "double", text(graph.events[index(arc.start_event)].time)},
          {"end_time", "double", text(graph.events[index(arc.end_event)].time)},
          {"max_volume", "double", text(arc.max_volume)},
          {"least_overlap", "double", text(arc.least_overlap)},
          {"simplified", "boolean", track.simplified ? "true" : "false"}};
}

// The same colour for a track in every picture: hues a golden angle apart, so that neighbours differ.
std::string colour_of(std::int64_t track);

} // namespace hyperiso::tracking_files
