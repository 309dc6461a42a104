#pragma once
/// \file
/// The isosurface from seeds: only the components through them, touching only their neighbourhood (papers 003
/// section 3.1 and 004 section 3.2).

#include "hyperiso/extract.hpp"

#include <array>
#include <functional>
#include <utility>
#include <vector>

namespace hyperiso {

/// A field whose samples are computed when they are asked for, each once. Its grid may be far larger than any
/// memory: up to 2^31 samples along each axis.
template <int D>
struct LazyField {
  Grid<D> grid;
  std::function<double(const std::array<std::int64_t, D>&)> sample; ///< of an index; called from one thread
};

/// Where to begin. Indices are those of samples; a cell is named by its lowest corner.
template <int D>
struct Seeds {
  std::vector<std::array<std::int64_t, D>> cells; ///< the components through any part of these cells
  /// Two samples, one inside and one not: a crossing is found between them by bisection of the straight line
  /// that joins them.
  std::vector<std::pair<std::array<std::int64_t, D>, std::array<std::int64_t, D>>> pairs;
};

template <int D>
struct TracedSurface {
  SimplexMesh<D> mesh;
  std::uint64_t samples = 0; ///< that were looked at
  std::uint64_t cells = 0;   ///< whose labels were looked at
};

/// The components of the isosurface that pass the seeds.
///
/// The mesh is what `extract` gives of these components: the same vertices and simplices in the same order.
/// Mesh::edges is left empty where the numbers of the grid's edges do not fit 64 bits.
/// Cost: follows the surface, not the grid: about 1 microsecond for each simplex and 200 bytes for each
/// vertex; the samples of the cells that the components pass, and log2 of its distance for each pair. D = 2,
/// 3, 4. Errors: those of `extract`; outside_domain for a seed that is not on the grid or not on the surface;
/// invalid_argument for a pair with both samples on one side.
template <int D>
Result<TracedSurface<D>> extract_from_seeds(const LazyField<D>& field, double isovalue, const Seeds<D>& seeds,
                                            const ExtractOptions& options = {});

/// The same of a field with samples.
template <class T, int D>
Result<TracedSurface<D>> extract_from_seeds(const FieldView<const T, D>& field, double isovalue,
                                            const Seeds<D>& seeds, const ExtractOptions& options = {}) {
  const auto sample = [&](const std::array<std::int64_t, D>& index) {
    return static_cast<double>(field.at(index));
  };
  return extract_from_seeds<D>(LazyField<D>{field.grid, sample}, isovalue, seeds, options);
}

} // namespace hyperiso
