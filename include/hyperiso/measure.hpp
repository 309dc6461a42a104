#pragma once
/// \file
/// Checks and measures of a mesh.

#include "hyperiso/mesh.hpp"

#include <cstdint>
#include <vector>

namespace hyperiso {

/// Sums over the simplices of a mesh; K is their dimension, D that of the space.
struct Contents {
  double content = 0;              ///< total K-volume, unsigned
  std::vector<double> vector_area; ///< K = D-1: sum of content times unit normal, D numbers; else empty
  /// K = D: of negative orientation, by more than the rounding of their coordinates can make: a simplex that
  /// is flat, as those on samples that equal a level are, has no orientation to tell.
  std::uint64_t inverted_simplices = 0;
  std::uint64_t zero_content_simplices = 0; ///< whose computed content is exactly 0
};

/// What `measure` found.
struct Measure : Contents {
  std::uint64_t components = 0; ///< connected through shared vertices
  std::int64_t euler_characteristic =
      0;                             ///< vertices - edges + triangles - ..., over the faces of all simplices
  std::uint64_t boundary_facets = 0; ///< (K-1)-faces of exactly one simplex
  std::uint64_t bad_facets = 0; ///< (K-1)-faces of three or more, or of two that orient it alike; must be 0
  bool closed = false;          ///< no boundary facets
};

/// Measures a mesh of (D-1)- or D-simplices in R^D, 2 <= D <= 8. Sums run in the order of the simplices, by
/// blocks: the same mesh gives the same bits for any number of threads (0: one per processor), which share
/// the contents. Vertices that no simplex uses do not count. Cost: sorts the faces around each vertex; 8
/// bytes of memory per corner of a simplex and 16 per vertex. Errors: out_of_memory; invalid_argument for
/// other dimensions or an index out of range.
Result<Measure> measure(const Mesh& mesh, int threads = 0);

/// The Contents of that alone, to the bit: one pass over the simplices, hardly any memory. The same errors.
Result<Contents> measure_contents(const Mesh& mesh, int threads = 0);

} // namespace hyperiso
