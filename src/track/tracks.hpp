#pragma once
// Names for what goes on through events.

#include "hyperiso/track.hpp"

namespace hyperiso::track_detail {

// Makes the tracks of a graph whose events, arcs, features and links are complete, and fills in every
// reference to tracks. At an event with components before and after, the largest before goes on as the
// largest after: by the volume at the last step before it and at the first step after it; then the older,
// then the smaller number (paper 003 section 5). No track passes a weak link.
void assign_tracks(TrackingGraph& graph);

} // namespace hyperiso::track_detail
