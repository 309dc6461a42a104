#pragma once
/// \file
/// Isolines of a 2D field as ordered lines (paper 004 section 3.3).

#include "hyperiso/mesh.hpp"

#include <cstdint>
#include <vector>

namespace hyperiso {

/// A walk along segments, inside on its left.
struct Polyline {
  std::vector<std::uint64_t> vertices; ///< of the mesh; a closed line does not repeat its first
  bool closed = false;
};

/// Joins the segments of a mesh (D >= 2, K = 1) into lines, as long as they go. Every segment is in one line,
/// in its own direction. Open lines begin where no segment ends, closed ones at their smallest vertex; lines
/// are ordered by their first vertices. Cost: linear. Errors: invalid_argument if the mesh has other
/// simplices, or a vertex at which more than one segment begins or ends (Measure::bad_facets); out_of_memory.
Result<std::vector<Polyline>> polylines(const Mesh& mesh);

} // namespace hyperiso
