#include "cli/steps.hpp"

#include "cli/console.hpp"
#include "cli/failure.hpp"
#include "cli/surface.hpp"
#include "core/text.hpp"

#include <algorithm>
#include <cstring>

namespace hyperiso::cli {
namespace {

template <class Numbers>
void append(Numbers& whole, const Numbers& piece) {
  const std::size_t start = whole.size();
  if (piece.wide() != whole.wide()) {
    Numbers wide;
    wide.reset(start, true);
    for (std::size_t i = 0; i < start; ++i) wide.set(i, whole[i]);
    whole = std::move(wide);
  }
  whole.resize(start + piece.size());
  if (piece.wide() == whole.wide() && piece.bytes() > 0)
    std::memcpy(static_cast<std::byte*>(whole.data()) + (whole.bytes() - piece.bytes()), piece.data(),
                piece.bytes());
  else
    for (std::size_t i = 0; i < piece.size(); ++i) whole.set(start + i, piece[i]);
}

} // namespace

std::uint64_t step_bytes(const FieldInfo& info) {
  return info.bytes() / static_cast<std::uint64_t>(info.axes.back().count);
}

bool can_stream(const FieldInfo& info, const ExtractOptions& options) {
  return options.method != Method::barycentric && info.dimension() >= 2 && info.dimension() <= 5 &&
         info.axes.back().count > 1;
}

std::uint64_t memory_beside_steps(const FieldInfo& info, std::uint64_t memory_left) {
  const std::uint64_t steps = 2 * step_bytes(info);
  if (steps >= memory_left)
    throw Failure{{Code::out_of_memory, text("two steps of the field take ", byte_size(steps), ", and ",
                                             byte_size(memory_left), " of memory are left")}};
  return memory_left - steps;
}

Result<Mesh> collect_surface(StepSource& steps, double isovalue, const ExtractOptions& options) {
  const int dimension = steps.info().dimension();
  Mesh whole(dimension, dimension - 1);
  whole.positions.reset(0, options.precision == Precision::f64);
  whole.simplices.reset(0, false);
  const Status streamed = stream(
      steps, isovalue,
      [&](SurfaceSlab& slab) -> Status {
        const std::uint64_t needed = bytes_of(whole) + 2 * bytes_of(slab.mesh);
        if (needed > options.memory_limit)
          return Error{Code::out_of_memory,
                       text("the surface as a whole, with more than ",
                            whole.simplex_count() + slab.mesh.simplex_count(), " simplices, needs more than ",
                            byte_size(options.memory_limit))};
        append(whole.positions, slab.mesh.positions);
        append(whole.simplices, slab.mesh.simplices);
        const std::size_t edges = whole.edges.size();
        whole.edges.resize(edges + slab.mesh.edges.size());
        std::copy(slab.mesh.edges.begin(), slab.mesh.edges.end(), whole.edges.begin() + edges);
        whole.grid_axes = slab.mesh.grid_axes;
        whole.active_cells += slab.mesh.active_cells;
        return {};
      },
      options);
  if (!streamed) return streamed.error();
  return whole;
}

} // namespace hyperiso::cli
