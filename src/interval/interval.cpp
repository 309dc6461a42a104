#include "hyperiso/interval.hpp"

#include "core/instantiate.hpp"
#include "core/orientation.hpp"
#include "core/text.hpp"
#include "extract/engine.hpp"
#include "extract/surface_memory.hpp"

#include <algorithm>
#include <cmath>
#include <new>

namespace hyperiso {
namespace {

Status check_levels(std::span<const double> levels) {
  if (levels.size() < 2)
    return Error{Code::invalid_isovalue, text("an interval volume needs two levels, not ", levels.size())};
  for (const double level : levels)
    if (!std::isfinite(level))
      return Error{Code::invalid_isovalue, text("a level is ", level, "; levels must be finite numbers")};
  const auto wrong = std::ranges::adjacent_find(levels, std::greater_equal{});
  if (wrong != levels.end())
    return Error{Code::invalid_isovalue,
                 text("levels must increase, but ", *wrong, " is followed by ", *(wrong + 1))};
  return {};
}

// Whether the table has to be turned. The engine's simplices face from + to -, and for that it takes a
// mirrored table on a grid that an odd number of falling axes reflects. A simplex that faces along the last
// axis projects with the sign of (-1)^D, and with `inside` above it faces so, since the field less the level
// falls along it.
template <class T, int D>
bool mirrored(const FieldView<const T, D>& field, Inside inside) {
  const bool projects_positively = (D % 2 == 0) == (inside == Inside::above);
  return mirror_space(field.grid.axes) != !projects_positively;
}

// Takes the last coordinate off the positions, into attributes.
template <int D>
void project(Mesh& lifted, std::span<const double> levels, VolumeMesh<D>& volume) {
  const std::size_t vertices = lifted.vertex_count();
  std::vector<double> level(vertices), isovalue(vertices);
  volume.positions = std::move(lifted.positions);
  for (std::size_t vertex = 0; vertex < vertices; ++vertex) { // moved down, never over what comes later
    for (std::size_t k = 0; k < D; ++k)
      volume.positions.set(vertex * D + k, volume.positions[vertex * (D + 1) + k]);
    level[vertex] = volume.positions[vertex * (D + 1) + D];
    const auto below = std::min(static_cast<std::size_t>(level[vertex]), levels.size() - 2);
    isovalue[vertex] =
        std::lerp(levels[below], levels[below + 1], level[vertex] - static_cast<double>(below));
  }
  volume.positions.resize(vertices * D);
  volume.attributes.push_back({"level", Attribute::Location::vertex, 1, std::move(level)});
  volume.attributes.push_back({"isovalue", Attribute::Location::vertex, 1, std::move(isovalue)});
}

Axis level_axis(std::span<const double> levels) {
  Axis axis;
  axis.count = static_cast<std::int64_t>(levels.size());
  axis.name = "level";
  axis.coordinates.assign(levels.begin(), levels.end());
  return axis;
}

template <class T, int D>
Result<VolumeMesh<D>> fill(const FieldView<const T, D>& field, std::span<const double> levels,
                           const IntervalOptions& options) {
  VolumeMesh<D> volume;
  if (std::ranges::any_of(field.dims(), [](std::int64_t count) { return count < 2; })) return volume;
  const Samples<D + 1> samples =
      lifted_samples(field, std::vector<double>(levels.begin(), levels.end()), options.inside);
  const TableForm form{mirrored(field, options.inside), options.level_axis == LevelAxis::first};
  SimplexMesh<D + 1> lifted;
  if (const Status made = run_engine(samples, form, options, EngineOptions{}, lifted); !made)
    return made.error();
  const std::uint64_t vertices = lifted.vertex_count();
  const std::uint64_t needed =
      vertices * (bytes_per_vertex(D + 1, lifted.positions.wide(), options.keep_edges) + 2 * sizeof(double)) +
      lifted.simplices.bytes();
  if (const Status fits = check_memory(vertices, lifted.simplex_count(), needed, options.memory_limit); !fits)
    return fits.error();
  project(lifted, levels, volume);
  volume.simplices = std::move(lifted.simplices);
  volume.active_cells = lifted.active_cells;
  if (options.keep_edges) {
    volume.edges = std::move(lifted.edges);
    volume.grid_axes.assign(field.grid.axes.begin(), field.grid.axes.end());
    volume.grid_axes.push_back(level_axis(levels));
  }
  return volume;
}

} // namespace

template <class T, int D>
Result<VolumeMesh<D>> interval(const FieldView<const T, D>& field, std::span<const double> levels,
                               const IntervalOptions& options) {
  if (const Status valid = check_levels(levels); !valid) return valid.error();
  try {
    return fill(field, levels, options);
  } catch (const std::bad_alloc&) {
    return Error{Code::out_of_memory, "not enough memory for the interval volume"};
  }
}

#define HYPERISO_INSTANTIATE_INTERVAL(T, D)                                                                  \
  template Result<VolumeMesh<D>> interval(const FieldView<const T, D>&, std::span<const double>,             \
                                          const IntervalOptions&);
HYPERISO_FOR_EACH_SAMPLE_TYPE(HYPERISO_INSTANTIATE_INTERVAL, 2)
HYPERISO_FOR_EACH_SAMPLE_TYPE(HYPERISO_INSTANTIATE_INTERVAL, 3)
HYPERISO_FOR_EACH_SAMPLE_TYPE(HYPERISO_INSTANTIATE_INTERVAL, 4)

} // namespace hyperiso
