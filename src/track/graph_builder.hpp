#pragma once
// Events and arcs as they are found, in order of time.

#include "hyperiso/track.hpp"
#include "track/slab.hpp"

namespace hyperiso::track_detail {

// Thrown where `progress` asks to stop; never leaves the library.
struct TrackingCancelled {};

class GraphBuilder {
 public:
  // `progress` hears of each event and of much that is looked at: one slab may take long and hold much.
  GraphBuilder(TrackingGraph& graph, const Progress& progress) : graph_(graph), progress_(progress) {}

  // That all is passed before `time`. Throws TrackingCancelled.
  void tell_progress(double time) const {
    if (!progress_) return;
    const Axis& steps = graph_.axes.back();
    const double first = steps.coordinate(0), last = steps.coordinate(steps.count - 1);
    if (!progress_((time - first) / (last - first))) throw TrackingCancelled{};
  }

  // Ends the arcs `in` in a new event and starts `out` arcs there; they are the last ones.
  // Throws TrackingCancelled.
  TrackingEvent& add_event(EventType type, double time, std::vector<std::int64_t> in, std::size_t out) {
    tell_progress(time);
    const auto number = static_cast<std::int64_t>(graph_.events.size());
    TrackingEvent& event = graph_.events.emplace_back();
    event.type = type;
    event.time = time;
    for (const std::int64_t arc : in) graph_.arcs[static_cast<std::size_t>(arc)].end_event = number;
    event.arcs_in = std::move(in);
    for (std::size_t i = 0; i < out; ++i) {
      event.arcs_out.push_back(static_cast<std::int64_t>(graph_.arcs.size()));
      graph_.arcs.push_back({number, -1, -1});
    }
    return event;
  }
  std::int64_t last_event() const { return static_cast<std::int64_t>(graph_.events.size()) - 1; }

 private:
  TrackingGraph& graph_;
  const Progress& progress_;
};

// From just before a node to just after it: of the Euler characteristic and of the boundary curves on walls.
struct ChangeWithin {
  std::int64_t euler = 0, rims = 0;
};

// The type of a node with `before` and `after` components; nothing if it is none.
// `has_genus`: the slices are surfaces; curves only touch walls.
inline std::optional<EventType> type_of_node(std::size_t before, std::size_t after, bool on_wall,
                                             const ChangeWithin& change, bool has_genus) {
  if (before == 0 && after == 0) return std::nullopt;
  if (before == 0 && after == 1) return on_wall ? EventType::enter : EventType::birth;
  if (before == 1 && after == 0) return on_wall ? EventType::exit : EventType::death;
  if (before == 1 && after == 1) {
    if (change.euler == 0 && change.rims == 0) return std::nullopt;
    return has_genus && change.euler + change.rims != 0 ? EventType::genus : EventType::touch;
  }
  if (after == 1) return EventType::merge;
  if (before == 1) return EventType::split;
  return EventType::compound;
}

// The mean of places, and whether all of them are on walls.
class PlaceSum {
 public:
  void add(const Place& place) {
    if (sum_.empty()) sum_.resize(place.position.size());
    for (std::size_t axis = 0; axis < sum_.size(); ++axis) sum_[axis] += place.position[axis];
    all_on_wall_ &= place.on_wall;
    ++count_;
  }
  bool empty() const { return count_ == 0; }
  bool all_on_wall() const { return count_ > 0 && all_on_wall_; }
  std::vector<double> mean() const {
    std::vector<double> mean = sum_;
    for (double& coordinate : mean) coordinate /= count_;
    return mean;
  }

 private:
  std::vector<double> sum_;
  double count_ = 0;
  bool all_on_wall_ = true;
};

} // namespace hyperiso::track_detail
