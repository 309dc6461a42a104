#pragma once
// `extract` with the choices that only tests and benchmarks make.

#include "core/orientation.hpp"
#include "extract/engine.hpp"

#include <algorithm>

namespace hyperiso {

// Extracts into `mesh`, in the memory it has if that is enough.
template <class T, int D>
Status extract_with(const FieldView<const T, D>& field, double isovalue, const ExtractOptions& options,
                    const EngineOptions& engine_options, SimplexMesh<D>& mesh) {
  const auto dims = field.dims();
  mesh.grid_axes.clear();
  mesh.attributes.clear();
  if (options.keep_edges && options.method != Method::barycentric)
    mesh.grid_axes.assign(field.grid.axes.begin(), field.grid.axes.end());
  const Samples<D> samples = samples_of(field, isovalue, options.inside);
  if (samples.test.never || std::ranges::any_of(dims, [](std::int64_t count) { return count < 2; })) {
    mesh.positions.reset(0, options.precision == Precision::f64);
    mesh.edges.reset(0);
    mesh.simplices.reset(0, engine_options.wide_indices);
    mesh.active_cells = 0;
    return {};
  }
  return run_engine(samples, {.mirrored = mirror_space(field.grid.axes)}, options, engine_options, mesh);
}

} // namespace hyperiso
