#pragma once
// Where tracks stand in a picture with time to the right.

#include "hyperiso/track.hpp"

namespace hyperiso::track_detail {

struct Lanes {
  std::vector<std::int64_t> lane_of_track; // -1: simplified
  std::int64_t count = 0;
};

// Tracks on one lane do not overlap in time and keep `gap` between them; a family's lanes lie together, new
// ones next to the track they split from or merge into.
Lanes assign_lanes(const TrackingGraph& graph, double gap);

} // namespace hyperiso::track_detail
