#pragma once
// The isosurface by a plain loop over the cells: slow, short, and the definition of what the engine must
// give, vertex for vertex and simplex for simplex. It also extracts in the dimensions that the engine does
// not.

#include "core/cell.hpp"
#include "core/orientation.hpp"
#include "core/sign.hpp"
#include "extract/cell_corners.hpp"
#include "extract/surface_memory.hpp"
#include "table/entry_cache.hpp"

#include <algorithm>
#include <optional>
#include <vector>

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
    const T value = field.at(corner_of(cell, vertex));
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
  CellEntries(Method method, std::uint64_t memory_limit)
      : method_(method), kept_bytes_(kept_bytes(method, memory_limit)) {}

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

  // The most that is kept, with the places where it is looked up.
  std::uint64_t bytes() const { return kept_bytes_ + kept_bytes_ / 8; }

 private:
  static std::size_t kept_bytes(Method method, std::uint64_t memory_limit) {
    if (D != 6 || method == Method::simplicial) return 0;
    return static_cast<std::size_t>(std::min<std::uint64_t>(64 << 20, memory_limit / 8));
  }

  const Method method_;
  const std::size_t kept_bytes_;
  EntryCache<std::uint64_t> cache_{kept_bytes_};
  EntryCache<std::uint64_t>::Reader reader_{cache_};
  std::vector<std::uint8_t> made_;
};

// The simplices while their vertices have no numbers: a corner takes less than the number of its grid edge.
template <int D>
struct CellSimplices {
  using EdgeEnds = std::array<std::uint8_t, 2>; // cube vertices, lower and upper
  struct Cell {
    std::array<std::int64_t, D> lowest; // sample
    std::uint64_t corners_end;          // in `corners`
  };
  Array<Cell> cells;       // active ones, in memory order
  Array<EdgeEnds> corners; // D for each simplex

  std::uint64_t bytes() const { return cells.size() * sizeof(Cell) + corners.size() * sizeof(EdgeEnds); }
};

template <int D>
GridEdge edge_in_cell(const std::array<std::int64_t, D>& dims, const std::array<std::int64_t, D>& lowest,
                      const typename CellSimplices<D>::EdgeEnds& ends) {
  return grid_edge<D>(dims, corner_of(lowest, ends[1]), ends[0] ^ ends[1]);
}

// Edges of the grid, each once and ascending, in hardly more memory than twice their own.
class SortedEdges {
 public:
  explicit SortedEdges(Array<GridEdge>& edges) : edges_(edges) { edges_.reset(0); }

  void add(GridEdge edge) { edges_.push_back(edge); }
  // Sorts what was added if it is as much as there was before.
  void tidy() {
    if (edges_.size() >= 2 * sorted_ + least_to_sort) finish();
  }
  void finish() {
    std::ranges::sort(edges_);
    edges_.resize(static_cast<std::size_t>(std::unique(edges_.begin(), edges_.end()) - edges_.begin()));
    sorted_ = edges_.size();
  }

  std::size_t sorted() const { return sorted_; } // different ones, at least
  std::uint64_t bytes() const { return edges_.size() * sizeof(GridEdge); }

 private:
  static constexpr std::size_t least_to_sort = 1 << 12;

  Array<GridEdge>& edges_;
  std::size_t sorted_ = 0;
};

// The simplices of all cells; in `edges` those of the grid that carry their vertices.
template <class T, int D, bool Above>
Status find_simplices(const FieldView<const T, D>& field, SignRule<T, Above> rule,
                      const ExtractOptions& options, CellSimplices<D>& found, Array<GridEdge>& edges) {
  const auto dims = field.dims();
  const std::uint64_t position_bytes = bytes_per_vertex(D, options.precision == Precision::f64, false);
  constexpr std::uint64_t corner_bytes = // and the number it will be
      sizeof(typename CellSimplices<D>::EdgeEnds) + sizeof(std::uint32_t);
  CellEntries<D> entries(options.method, options.memory_limit);
  std::vector<bool> seen(std::size_t{1} << 2 * D); // edges of one cell
  SortedEdges sorted(edges);
  Status status;
  for_each_cell<D>(dims, [&](const std::array<std::int64_t, D>& cell) {
    if (cell[0] == 0 && options.progress) {
      const double share = static_cast<double>(cell[D - 1]) / static_cast<double>(dims[D - 1] - 1);
      if (!options.progress(share)) status = Error{Code::cancelled, "the extraction was cancelled"};
    }
    if (!status) return false;
    const auto labels = active_cell_labels<T, D, Above>(field, cell, rule);
    if (!labels) return true;
    const std::size_t first = found.corners.size();
    const std::uint64_t held = found.bytes() + first * sizeof(std::uint32_t) + sorted.bytes() +
                               sorted.sorted() * position_bytes + entries.bytes();
    const std::uint64_t most =
        first + (options.memory_limit - std::min(options.memory_limit, held)) / corner_bytes;
    bool fits = true;
    entries.for_each_corner(*labels, [&](unsigned lower, unsigned upper) {
      fits = fits && found.corners.size() < most;
      if (fits) found.corners.push_back({static_cast<std::uint8_t>(lower), static_cast<std::uint8_t>(upper)});
    });
    if (!fits) {
      status = more_than_fits(sorted.sorted(), found.corners.size() / D, options.memory_limit);
      return false;
    }
    found.cells.push_back({cell, found.corners.size()});
    seen.assign(seen.size(), false);
    for (std::size_t corner = first; corner < found.corners.size(); ++corner) {
      const auto ends = found.corners[corner];
      const std::size_t edge = std::size_t{ends[0]} << D | ends[1];
      if (!seen[edge]) sorted.add(edge_in_cell<D>(dims, cell, ends));
      seen[edge] = true;
    }
    sorted.tidy();
    return true;
  });
  sorted.finish();
  return status;
}

template <class T, int D>
std::array<double, D> reference_position(const FieldView<const T, D>& field, GridEdge edge, double isovalue) {
  const auto ends = grid_edge_ends<D>(field.dims(), edge);
  const double weight = crossing(static_cast<double>(field.at(ends.lower)),
                                 static_cast<double>(field.at(ends.upper)), isovalue);
  return point_between(field.grid, ends, weight);
}

// The corners of the mesh, by the places of their edges among those that carry its vertices.
template <int D>
void number_corners(const std::array<std::int64_t, D>& dims, const CellSimplices<D>& found,
                    const Array<GridEdge>& edges, bool mirrored, SimplexMesh<D>& mesh) {
  mesh.simplices.reset(found.corners.size(), edges.size() > UINT32_MAX);
  std::size_t corner = 0;
  for (const auto& cell : found.cells)
    for (; corner < cell.corners_end; ++corner) {
      const GridEdge edge = edge_in_cell<D>(dims, cell.lowest, found.corners[corner]);
      const auto vertex = std::ranges::lower_bound(edges, edge) - edges.begin();
      const std::size_t place = corner % D;
      mesh.simplices.set(mirrored && place < 2 ? corner - place + (1 - place) : corner,
                         static_cast<std::uint64_t>(vertex));
    }
}

// Replaces what `mesh` holds. Throws std::bad_alloc.
template <class T, int D>
Status extract_plainly(const FieldView<const T, D>& field, double isovalue, const ExtractOptions& options,
                       SimplexMesh<D>& mesh) {
  mesh.grid_axes.clear();
  mesh.attributes.clear();
  CellSimplices<D> found;
  Status status = options.inside == Inside::above
                      ? find_simplices(field, SignRule<T, true>(isovalue), options, found, mesh.edges)
                      : find_simplices(field, SignRule<T, false>(isovalue), options, found, mesh.edges);
  if (!status) return status;
  mesh.active_cells = found.cells.size();
  const std::size_t vertices = mesh.edges.size();
  const bool wide = options.precision == Precision::f64;
  status = check_memory(vertices, found.corners.size() / D,
                        vertices * bytes_per_vertex(D, wide, true) + found.bytes() +
                            found.corners.size() * bytes_per_index(vertices > UINT32_MAX),
                        options.memory_limit);
  if (!status) return status;

  mesh.positions.reset(vertices * D, wide);
  for (std::size_t vertex = 0; vertex < vertices; ++vertex) {
    const auto position = reference_position(field, mesh.edges[vertex], isovalue);
    for (std::size_t axis = 0; axis < D; ++axis) mesh.positions.set(vertex * D + axis, position[axis]);
  }
  number_corners<D>(field.dims(), found, mesh.edges, mirror_space(field.grid.axes), mesh);
  if (options.keep_edges)
    mesh.grid_axes.assign(field.grid.axes.begin(), field.grid.axes.end());
  else
    mesh.edges = {};
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
