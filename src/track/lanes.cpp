#include "track/lanes.hpp"

#include <algorithm>
#include <map>

namespace hyperiso::track_detail {
namespace {

struct Interval {
  double start, end;
};

// Spans of time in use on a lane.
class Lane {
 public:
  bool is_free(Interval wanted, double gap) const {
    return std::ranges::none_of(
        used_, [&](Interval used) { return wanted.start < used.end + gap && used.start < wanted.end + gap; });
  }
  void use(Interval interval) { used_.push_back(interval); }

 private:
  std::vector<Interval> used_;
};

// The lanes of one family, top to bottom.
class FamilyBlock {
 public:
  FamilyBlock(const TrackingGraph& graph, const std::vector<std::int64_t>& tracks, double gap) {
    for (const std::int64_t track : tracks) place(graph, track, gap);
    for (const auto& [lane, rank] : ranks()) {
      height = std::max(height, rank + 1);
      for (const std::int64_t track : tracks_on_[lane]) rows[track] = rank;
    }
    span = {graph.tracks[static_cast<std::size_t>(tracks[0])].start_time, 0};
    for (const std::int64_t track : tracks) {
      span.start = std::min(span.start, graph.tracks[static_cast<std::size_t>(track)].start_time);
      span.end = std::max(span.end, graph.tracks[static_cast<std::size_t>(track)].end_time);
    }
  }

  std::map<std::int64_t, std::int64_t> rows; // of tracks, within the block
  std::int64_t height = 0;
  Interval span{};

 private:
  void place(const TrackingGraph& graph, std::int64_t number, double gap) {
    const Track& track = graph.tracks[static_cast<std::size_t>(number)];
    const Interval time{track.start_time, track.end_time};
    const std::size_t near = place_of_relative(track);
    std::size_t best = order_.size();
    for (std::size_t i = 0; i < order_.size(); ++i)
      if (lanes_[order_[i]].is_free(time, gap) &&
          (best == order_.size() || distance(i, near) < distance(best, near)))
        best = i;
    // Few tracks get lanes beside their relatives; many would need more than a picture has room for.
    const bool far = distance(best, near) > 3 && order_.size() < comfortable_lanes;
    if (best == order_.size() || far) {
      best = order_.empty() ? 0 : std::min(near + (number % 2 == 0 ? 1 : 0), order_.size());
      order_.insert(order_.begin() + static_cast<std::ptrdiff_t>(best), lanes_.size());
      lanes_.emplace_back();
      tracks_on_.emplace_back();
    }
    const std::size_t lane = order_[best];
    lanes_[lane].use(time);
    tracks_on_[lane].push_back(number);
    lane_of_[number] = lane;
  }
  static constexpr std::size_t comfortable_lanes = 24;
  static std::size_t distance(std::size_t a, std::size_t b) { return a < b ? b - a : a - b; }

  // Where in the order a parent or child that has a lane already stands, else the end.
  std::size_t place_of_relative(const Track& track) const {
    for (const auto* relatives : {&track.parents, &track.children})
      for (const std::int64_t relative : *relatives)
        if (const auto found = lane_of_.find(relative); found != lane_of_.end())
          return static_cast<std::size_t>(std::ranges::find(order_, found->second) - order_.begin());
    return order_.size();
  }
  std::map<std::size_t, std::int64_t> ranks() const {
    std::map<std::size_t, std::int64_t> ranks;
    for (std::size_t i = 0; i < order_.size(); ++i) ranks[order_[i]] = static_cast<std::int64_t>(i);
    return ranks;
  }

  std::vector<Lane> lanes_;
  std::vector<std::size_t> order_; // lanes, top to bottom
  std::vector<std::vector<std::int64_t>> tracks_on_;
  std::map<std::int64_t, std::size_t> lane_of_;
};

} // namespace

Lanes assign_lanes(const TrackingGraph& graph, double gap) {
  std::map<std::int64_t, std::vector<std::int64_t>> families; // tracks by age
  for (std::size_t number = 0; number < graph.tracks.size(); ++number)
    if (!graph.tracks[number].simplified)
      families[graph.tracks[number].family].push_back(static_cast<std::int64_t>(number));

  Lanes lanes{std::vector<std::int64_t>(graph.tracks.size(), -1), 0};
  std::vector<Lane> used;
  for (const auto& [family, tracks] : families) {
    const FamilyBlock block(graph, tracks, gap);
    std::size_t top = 0; // of the first stack of lanes that is free all the time
    for (std::size_t row = 0; row < static_cast<std::size_t>(block.height) && top < used.size();) {
      if (top + row >= used.size() || used[top + row].is_free(block.span, gap))
        ++row;
      else
        top += row + 1, row = 0;
    }
    for (std::size_t row = top; row < top + static_cast<std::size_t>(block.height); ++row) {
      if (row == used.size()) used.emplace_back();
      used[row].use(block.span);
    }
    for (const auto& [track, row] : block.rows)
      lanes.lane_of_track[static_cast<std::size_t>(track)] = static_cast<std::int64_t>(top) + row;
  }
  lanes.count = static_cast<std::int64_t>(used.size());
  return lanes;
}

} // namespace hyperiso::track_detail
