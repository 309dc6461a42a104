#pragma once
/// \file
/// Whether a mesh passes through itself.

#include "hyperiso/mesh.hpp"
#include "hyperiso/progress.hpp"

#include <array>
#include <cstdint>
#include <vector>

namespace hyperiso {

struct SelfIntersections {
  std::uint64_t pairs = 0; ///< of simplices whose interiors have a point in common
  /// The first of them, at most `kept`, in ascending order: numbers of two simplices each, the lower first.
  std::vector<std::array<std::uint64_t, 2>> examples;
  static constexpr std::size_t kept = 16;
};

/// Finds the pairs of simplices that meet elsewhere than in a common face: whose relative interiors have a
/// point in common. In a mesh that is embedded there are none.
///
/// Exact: the coordinates as they are stored are taken for the rational numbers that they are. Simplices that
/// only touch do not count, nor do simplices of content 0; two that lie on each other do. (Where a sample
/// equals the isovalue, vertices coincide; sheets on both sides of such samples can lie on each other.)
///
/// Meshes of (D-1)- or D-simplices in R^D, 2 <= D <= 8. Cost: n log n for the boxes of n simplices, and an
/// exact test for each pair whose boxes overlap; for a surface from a grid these are pairs from one cell.
/// Errors: invalid_argument for other dimensions, an index out of range or a coordinate that is not finite;
/// out_of_memory; cancelled.
Result<SelfIntersections> find_self_intersections(const Mesh& mesh, const Progress& progress = {});

} // namespace hyperiso
