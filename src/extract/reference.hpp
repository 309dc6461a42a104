#pragma once
// The isosurface by a plain loop over the cells: slow, short, and the definition of what the engine must
// give, vertex for vertex and simplex for simplex.

#include "core/sign.hpp"
#include "extract/cell_corners.hpp"
#include "hyperiso/extract.hpp"

#include <algorithm>

namespace hyperiso {

// The labels of the cell whose lowest corner is `cell`, or nothing if the cell touches NaN.
template <class T, int D, bool Above>
std::optional<CubeLabels> cell_labels(const FieldView<const T, D>& field,
                                      const std::array<std::int64_t, D>& cell, SignRule<T, Above> rule) {
  CubeLabels labels = 0;
  for (unsigned vertex = 0; vertex < 1u << D; ++vertex) {
    std::array<std::int64_t, D> sample = cell;
    for (int axis = 0; axis < D; ++axis) sample[axis] += vertex >> axis & 1;
    const T value = field.at(sample);
    if (is_missing(value)) return std::nullopt;
    if (rule.inside(value)) labels |= CubeLabels{1} << vertex;
  }
  return labels;
}

// Calls use(cell) for the lowest corner of each cell, in memory order.
template <int D, class Use>
void for_each_cell(const std::array<std::int64_t, D>& dims, Use&& use) {
  for (const std::int64_t count : dims)
    if (count < 2) return;
  std::array<std::int64_t, D> cell{};
  for (;;) {
    use(cell);
    int axis = 0;
    while (axis < D && ++cell[axis] == dims[axis] - 1) cell[axis++] = 0;
    if (axis == D) return;
  }
}

// The grid edges of the simplices' corners, D for each simplex, cell by cell; counts the active cells.
template <class T, int D, bool Above>
std::vector<GridEdge> reference_corners(const FieldView<const T, D>& field, SignRule<T, Above> rule,
                                        Method method, std::uint64_t& active_cells) {
  const auto dims = field.dims();
  std::vector<GridEdge> corners;
  for_each_cell<D>(dims, [&](const std::array<std::int64_t, D>& cell) {
    const auto labels = cell_labels<T, D, Above>(field, cell, rule);
    constexpr auto all = static_cast<CubeLabels>((std::uint64_t{1} << (1 << D)) - 1);
    if (!labels || *labels == 0 || *labels == all) return;
    ++active_cells;
    const auto add_corner = [&](unsigned lower, unsigned upper) {
      std::array<std::int64_t, D> sample = cell;
      for (int axis = 0; axis < D; ++axis) sample[axis] += upper >> axis & 1;
      corners.push_back(grid_edge<D>(dims, sample, lower ^ upper));
    };
    for_each_cell_corner<D>(method, *labels, add_corner);
  });
  return corners;
}

template <class T, int D>
std::array<double, D> reference_position(const FieldView<const T, D>& field, GridEdge edge, double isovalue) {
  const auto ends = grid_edge_ends<D>(field.dims(), edge);
  const double weight = crossing(static_cast<double>(field.at(ends.lower)),
                                 static_cast<double>(field.at(ends.upper)), isovalue);
  std::array<double, D> position;
  for (int axis = 0; axis < D; ++axis) {
    const double lower = field.grid.axes[axis].coordinate(ends.lower[axis]);
    const double upper = field.grid.axes[axis].coordinate(ends.upper[axis]);
    position[axis] = ends.direction >> axis & 1 ? lower + weight * (upper - lower) : lower;
  }
  return position;
}

template <class T, int D>
SimplexMesh<D> extract_reference(const FieldView<const T, D>& field, double isovalue,
                                 const ExtractOptions& options = {}) {
  SimplexMesh<D> mesh;
  std::vector<GridEdge> corners =
      options.inside == Inside::above
          ? reference_corners(field, SignRule<T, true>(isovalue), options.method, mesh.active_cells)
          : reference_corners(field, SignRule<T, false>(isovalue), options.method, mesh.active_cells);
  const auto reversed_axes =
      std::ranges::count_if(field.grid.axes, [](const Axis& a) { return !a.increasing(); });
  if (reversed_axes % 2 == 1)
    for (std::size_t simplex = 0; simplex < corners.size(); simplex += D)
      std::swap(corners[simplex], corners[simplex + 1]);

  std::vector<GridEdge> edges = corners;
  std::ranges::sort(edges);
  edges.erase(std::unique(edges.begin(), edges.end()), edges.end());

  mesh.positions.reset(edges.size() * D, options.precision == Precision::f64);
  for (std::size_t vertex = 0; vertex < edges.size(); ++vertex) {
    const auto position = reference_position(field, edges[vertex], isovalue);
    for (std::size_t axis = 0; axis < D; ++axis) mesh.positions.set(vertex * D + axis, position[axis]);
  }
  mesh.simplices.reset(corners.size(), edges.size() > UINT32_MAX);
  for (std::size_t corner = 0; corner < corners.size(); ++corner) {
    const auto vertex = std::ranges::lower_bound(edges, corners[corner]) - edges.begin();
    mesh.simplices.set(corner, static_cast<std::uint64_t>(vertex));
  }
  if (options.keep_edges) {
    mesh.edges.assign(edges.begin(), edges.end());
    mesh.grid_axes.assign(field.grid.axes.begin(), field.grid.axes.end());
  }
  return mesh;
}

} // namespace hyperiso
