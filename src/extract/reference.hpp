#pragma once
// The isosurface by a plain loop over the cells: slow, short, and the definition of what the engine must
// give, vertex for vertex and simplex for simplex. It also extracts in the dimensions that the engine does
// not.

#include "core/sign.hpp"
#include "core/text.hpp"
#include "extract/cell_corners.hpp"
#include "hyperiso/extract.hpp"
#include "table/entry_cache.hpp"

#include <algorithm>
#include <optional>

namespace hyperiso {

// The labels of the cell whose lowest corner is `cell`; nothing if it has no surface: if all are alike, or it
// touches NaN.
template <class T, int D, bool Above>
std::optional<LabelSet<D>> active_cell_labels(const FieldView<const T, D>& field,
                                              const std::array<std::int64_t, D>& cell,
                                              SignRule<T, Above> rule) {
  LabelSet<D> labels{};
  bool any = false, all = true;
  for (unsigned vertex = 0; vertex < 1u << D; ++vertex) {
    std::array<std::int64_t, D> sample = cell;
    for (int axis = 0; axis < D; ++axis) sample[axis] += vertex >> axis & 1;
    const T value = field.at(sample);
    if (is_missing(value)) return std::nullopt;
    const bool inside = rule.inside(value);
    any |= inside;
    all &= inside;
    if (inside) labels |= LabelSet<D>{1} << vertex;
  }
  if (!any || all) return std::nullopt;
  return labels;
}

// Calls use(cell) for the lowest corner of each cell, in memory order, until it returns false.
template <int D, class Use>
void for_each_cell(const std::array<std::int64_t, D>& dims, Use&& use) {
  for (const std::int64_t count : dims)
    if (count < 2) return;
  std::array<std::int64_t, D> cell{};
  while (use(cell)) {
    int axis = 0;
    while (axis < D && ++cell[axis] == dims[axis] - 1) cell[axis++] = 0;
    if (axis == D) return;
  }
}

// What cells hold, by their labels; in 6D, entries of the hull table are kept.
template <int D>
class CellEntries {
 public:
  explicit CellEntries(Method method) : method_(method) {}

  // As for_each_cell_corner does.
  template <class Use>
  void for_each_corner(const LabelSet<D>& labels, Use&& use) {
    if constexpr (D == 6) {
      if (method_ != Method::simplicial) {
        const auto kept = reader_.entry(labels, [&]() -> std::span<const std::uint8_t> {
          made_.clear();
          for_each_cell_corner<D>(method_, labels, [&](unsigned lower, unsigned upper) {
            made_.push_back(static_cast<std::uint8_t>(lower));
            made_.push_back(static_cast<std::uint8_t>(upper));
          });
          return made_;
        });
        for (std::size_t i = 0; i < kept.size(); i += 2) use(kept[i], kept[i + 1]);
        return;
      }
    }
    for_each_cell_corner<D>(method_, labels, use);
  }

 private:
  static constexpr std::size_t kept_bytes = D == 6 ? 64 << 20 : 0;

  Method method_;
  EntryCache<std::uint64_t> cache_{kept_bytes};
  EntryCache<std::uint64_t>::Reader reader_{cache_};
  std::vector<std::uint8_t> made_;
};

// The grid edges of the simplices' corners, D for each simplex, cell by cell; counts the active cells.
template <class T, int D, bool Above>
Status find_corners(const FieldView<const T, D>& field, SignRule<T, Above> rule,
                    const ExtractOptions& options, std::vector<GridEdge>& corners,
                    std::uint64_t& active_cells) {
  const auto dims = field.dims();
  CellEntries<D> entries(options.method);
  Status status;
  for_each_cell<D>(dims, [&](const std::array<std::int64_t, D>& cell) {
    if (cell[0] == 0 && options.progress) {
      const double share = static_cast<double>(cell[D - 1]) / static_cast<double>(dims[D - 1] - 1);
      if (!options.progress(share)) status = Error{Code::cancelled, "the extraction was cancelled"};
    }
    if (corners.size() > options.memory_limit / sizeof(std::uint32_t))
      status = Error{Code::out_of_memory,
                     text("the surface has more than ", corners.size() / D,
                          " simplices, which need more than the limit of ", byte_size(options.memory_limit))};
    if (!status) return false;
    const auto labels = active_cell_labels<T, D, Above>(field, cell, rule);
    if (!labels) return true;
    ++active_cells;
    entries.for_each_corner(*labels, [&](unsigned lower, unsigned upper) {
      std::array<std::int64_t, D> sample = cell;
      for (int axis = 0; axis < D; ++axis) sample[axis] += upper >> axis & 1;
      corners.push_back(grid_edge<D>(dims, sample, lower ^ upper));
    });
    return true;
  });
  return status;
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

// Replaces what `mesh` holds. Throws std::bad_alloc.
template <class T, int D>
Status extract_plainly(const FieldView<const T, D>& field, double isovalue, const ExtractOptions& options,
                       SimplexMesh<D>& mesh) {
  mesh.active_cells = 0;
  std::vector<GridEdge> corners;
  const Status status =
      options.inside == Inside::above
          ? find_corners(field, SignRule<T, true>(isovalue), options, corners, mesh.active_cells)
          : find_corners(field, SignRule<T, false>(isovalue), options, corners, mesh.active_cells);
  if (!status) return status;
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
  mesh.edges.clear();
  mesh.grid_axes.clear();
  mesh.attributes.clear();
  if (options.keep_edges) {
    mesh.edges.assign(edges.begin(), edges.end());
    mesh.grid_axes.assign(field.grid.axes.begin(), field.grid.axes.end());
  }
  return {};
}

// For tests of the engine.
template <class T, int D>
SimplexMesh<D> extract_reference(const FieldView<const T, D>& field, double isovalue,
                                 const ExtractOptions& options = {}) {
  SimplexMesh<D> mesh;
  (void)extract_plainly(field, isovalue, options, mesh);
  return mesh;
}

} // namespace hyperiso
