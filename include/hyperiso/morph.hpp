#pragma once
/// \file
/// A surface in space and time as pieces that move: for renderers that draw it at any moment without cutting.

#include "hyperiso/mesh.hpp"

#include <cstdint>
#include <vector>

namespace hyperiso {

/// Moving (D-2)-simplices in the D-1 axes of space: triangles of a 4D surface, segments of a 3D one. Corner c
/// of piece p goes in a straight line, at constant speed, from its start at start_times[p] to its end at
/// end_times[p]; the piece is there in the half-open interval (start, end].
template <int D>
struct MorphPieces {
  static constexpr std::size_t corners = D - 1;             ///< of a piece
  static constexpr std::size_t numbers = corners * (D - 1); ///< coordinates of a piece at one time

  PositionArray starts, ends;                 ///< pieces x corners x (D-1) coordinates, as wide as the mesh's
  std::vector<double> start_times, end_times; ///< pieces; start < end, `start_times` ascending
  std::vector<std::uint64_t> simplices;       ///< pieces: the simplex of the surface that each lies in

  std::size_t count() const { return start_times.size(); }
};

/// The pieces of a surface (paper 004 section 3.5, step 5, for any D and any axis as time): between two
/// consecutive times of its corners the cut of a tetrahedron is a triangle, or a quadrilateral given as two,
/// whose corners move linearly along its edges.
///
/// Exact: nothing is sampled. At a time t the pieces with start < t <= end are the simplices of
/// `slice(mesh, Hyperplane<D>::at(axis, t))` between samples, one for one and oriented alike, to rounding; at
/// a time of samples they cover the same points. A piece may have no extent at one of its ends, where it
/// grows from a corner. Simplices that lie in one moment have no piece.
///
/// Cost: a pass to count and a pass to fill; a tetrahedron has about 4 triangles, of 96 bytes each.
/// Types: D = 3, 4. Errors: invalid_argument if `axis` is no axis; out_of_memory, also where the pieces take
/// more than `memory_limit` bytes.
template <int D>
Result<MorphPieces<D>> morph_pieces(const SimplexMesh<D>& mesh, int axis = D - 1,
                                    std::uint64_t memory_limit = UINT64_MAX);

/// The pieces that are there at `time`, where they are then: simplices of one moment, not welded.
template <int D>
SimplexMesh<D - 1> pieces_at(const MorphPieces<D>& pieces, double time);

/// The pieces as a mesh of their starts, each with corners of its own; point data `end`: the coordinates of
/// the ends; simplex data `start_time`, `end_time`, `simplex`.
template <int D>
SimplexMesh<D - 1> morph_mesh(const MorphPieces<D>& pieces);

} // namespace hyperiso
