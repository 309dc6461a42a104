#pragma once
// The tracks of the vertices of a surface in space and time.

#include "hyperiso/track.hpp"

#include <cstdint>
#include <vector>

namespace hyperiso {

// For each vertex of `surface` the number of its track, -1 where it has none.
//
// At a step, the pieces of the surface are those that the graph knows. A vertex between two steps has the
// track of its neighbours before it, or, of one that has none there, of those after it: so the part of a
// surface between a step and an event inside the slab goes by the track before. Requires the surface and the
// graph of one field, D = 3 or 4, and the surface's edges; without edges all are -1.
std::vector<std::int32_t> tracks_of_vertices(const Mesh& surface, const TrackingGraph& graph);

} // namespace hyperiso
