#pragma once
// Which rows of one step the rows of the next come from.

#include "hyperiso/track.hpp"

#include <map>
#include <set>

namespace hyperiso::track_detail {

// Follows the arcs from a step through the events up to the next step.
class LinkTracer {
 public:
  explicit LinkTracer(const TrackingGraph& graph) : graph_(graph) {}

  // The arc leaves the step in this row.
  void start(std::int64_t arc, std::int64_t row) { sources_[arc].insert(row); }

  // Goes on through the events found since the last call.
  void pass_events() {
    for (; next_event_ < graph_.events.size(); ++next_event_) {
      const TrackingEvent& event = graph_.events[next_event_];
      const std::set<std::int64_t> rows = sources(event.arcs_in);
      for (const std::int64_t arc : event.arcs_in) sources_.erase(arc); // it ends here
      for (const std::int64_t arc : event.arcs_out) sources_[arc] = rows;
    }
  }
  // The rows that any of the arcs leads back to.
  std::set<std::int64_t> sources(const std::vector<std::int64_t>& arcs) const {
    std::set<std::int64_t> rows;
    for (const std::int64_t arc : arcs)
      if (const auto found = sources_.find(arc); found != sources_.end())
        rows.insert(found->second.begin(), found->second.end());
    return rows;
  }
  // At the next step: forgets all rows, and the events up to there.
  void restart() {
    sources_.clear();
    next_event_ = graph_.events.size();
  }

 private:
  const TrackingGraph& graph_;
  std::map<std::int64_t, std::set<std::int64_t>> sources_; // rows of each arc
  std::size_t next_event_ = 0;
};

} // namespace hyperiso::track_detail
