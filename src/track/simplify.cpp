#include "hyperiso/track.hpp"

#include <algorithm>
#include <set>

namespace hyperiso {
namespace {

bool is_open_end(const std::string& type) { return type == "open_start" || type == "open_end"; }
bool is_free_end(const std::string& type) {
  return type == "birth" || type == "death" || type == "enter" || type == "exit";
}

bool is_leaf_or_loop(const Track& track) {
  if (is_open_end(track.start_type) || is_open_end(track.end_type)) return false;
  if (is_free_end(track.start_type) || is_free_end(track.end_type)) return true;
  return std::ranges::any_of(track.parents, [&](std::int64_t parent) {
    return std::ranges::find(track.children, parent) != track.children.end();
  });
}

// What is left of an event's tracks.
std::multiset<std::int64_t> kept(const TrackingGraph& graph, const std::vector<std::int64_t>& tracks) {
  std::multiset<std::int64_t> result;
  for (const std::int64_t track : tracks)
    if (!graph.tracks[static_cast<std::size_t>(track)].simplified) result.insert(track);
  return result;
}

} // namespace

std::int64_t simplify(TrackingGraph& graph, double minimum_volume, double minimum_duration) {
  for (Track& track : graph.tracks)
    track.simplified = track.max_volume < minimum_volume ||
                       (track.end_time - track.start_time < minimum_duration && is_leaf_or_loop(track));
  for (TrackingEvent& event : graph.events) {
    const auto before = kept(graph, event.tracks_in), after = kept(graph, event.tracks_out);
    const bool lost_some = before.size() < event.tracks_in.size() || after.size() < event.tracks_out.size();
    event.simplified = lost_some && before == after;
  }
  return std::ranges::count(graph.tracks, true, &Track::simplified);
}

} // namespace hyperiso
