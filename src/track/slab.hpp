#pragma once
// The part of the surface M between two steps, as a simplicial complex with a time at each vertex.

#include "core/sign.hpp"
#include "track/number_map.hpp"
#include "track/signed_cells.hpp"

#include <algorithm>
#include <functional>
#include <memory>
#include <optional>
#include <span>

namespace hyperiso::track_detail {

using Vertex = std::uint32_t;
using SimplexNumber = std::uint32_t;

// The simplices around each vertex.
class Stars {
 public:
  void build(std::span<const Vertex> corners, std::size_t corners_each, std::size_t vertices) {
    first_.assign(vertices + 1, 0);
    simplices_.resize(corners.size());
    for (const Vertex vertex : corners) ++first_[vertex];
    std::uint32_t end = 0;
    for (std::uint32_t& entry : first_) entry = end += entry;
    for (std::size_t corner = corners.size(); corner-- > 0;) // downwards: each star comes out ascending
      simplices_[--first_[corners[corner]]] = static_cast<SimplexNumber>(corner / corners_each);
  }
  std::span<const SimplexNumber> of(Vertex vertex) const {
    return std::span(simplices_).subspan(first_[vertex], first_[vertex + 1] - first_[vertex]);
  }

 private:
  std::vector<std::uint32_t> first_;
  std::vector<SimplexNumber> simplices_;
};

// Where a vertex is, and whether that is on a wall of the domain.
struct Place {
  std::vector<double> position; // on the axes of space
  bool on_wall = false;
};

// So much of the way from one sample to another; to the bit where they are, at either.
template <int D>
Place place_between(const Grid<D>& grid, const std::array<std::int64_t, D>& from,
                    const std::array<std::int64_t, D>& to, double weight) {
  Place place;
  for (int axis = 0; axis < D - 1; ++axis) {
    const bool at_first = from[axis] == to[axis] || weight == 0;
    const bool at_last = from[axis] == to[axis] || weight == 1;
    const double first = grid.axes[axis].coordinate(from[axis]), last = grid.axes[axis].coordinate(to[axis]);
    place.position.push_back(at_first ? first : at_last ? last : first + weight * (last - first));
    place.on_wall |= (at_first && from[axis] == 0) || (at_last && to[axis] == grid.axes[axis].count - 1);
  }
  return place;
}

// C corners a simplex. Times run from 0 at the lower step to 1 at the upper one: they are the weights of
// crossings, so equal fractions of samples give equal times, and only what lies on a step has 0 or 1.
//
// A slab is a mesh that was handed over, or unfolds from the signs of its samples: then vertices and
// simplices get their numbers when something first asks for what is around them, and numbers say nothing of
// an order.
template <int C>
class Slab {
  struct NoCells {}; // of slabs that are always handed over
  using Cells = std::conditional_t<(C <= 4), SignedCells<C>, NoCells>;

 public:
  Slab() { stars_.build({}, C, 0); }
  // `edges`: of the vertices, ascending. Requires times and `corners`, C of each simplex.
  Slab(Array<GridEdge> edges, std::vector<double> times, std::vector<Vertex> corners)
      : edges_(edges.begin(), edges.end()), times_(std::move(times)), corners_(std::move(corners)) {
    stars_.build(corners_, C, edges_.size());
  }
  explicit Slab(std::unique_ptr<Cells> cells) : cells_(std::move(cells)) {}

  bool region = false;      // of simplices of one dimension more than a surface has
  bool has_missing = false; // samples
  bool ties_below = false;  // a vertex at the lower step that is not on an edge within it
  bool ties_above = false;  // the same at the upper step
  GridEdge row_length = 1;  // samples along axis 0
  GridEdge step_offset = 0; // from the number of an edge within the lower step to that within the upper one
  std::function<Place(GridEdge)> place; // also of an edge within the lower step that M does not cross
  std::function<Place(GridEdge)> place_of_upper_end; // of a crossing at the upper end of an edge

  // Whether slices are surfaces, which walls cut along curves; and whether what changes their Euler
  // characteristic is a matter of genus.
  bool has_rims() const { return C == 4 && !region; }
  bool has_genus() const { return C == 4 || region; }

  // How many have numbers.
  std::size_t vertex_count() const { return edges_.size(); }
  std::size_t simplex_count() const { return corners_.size() / C; }

  GridEdge edge(Vertex vertex) const { return edges_[vertex]; }
  double time(Vertex vertex) const { return times_[vertex]; }
  // The order in which vertices are passed: by time, then edge; what a step has comes before all else at the
  // lower step and after all else at the upper one.
  bool is_earlier(Vertex a, Vertex b) const {
    if (times_[a] != times_[b]) return times_[a] < times_[b];
    if ((times_[a] == 0 || times_[a] == 1) && in_step(a) != in_step(b)) return in_step(a) == (times_[a] == 0);
    return edges_[a] < edges_[b];
  }
  // Whether the edge of the vertex lies within a step: such vertices are those of the surface at that step.
  bool in_step(Vertex vertex) const { return !(edges_[vertex] / row_length >> (C - 1) & 1); }
  // The vertex on an edge, if M has one there.
  std::optional<Vertex> find(GridEdge edge) {
    if constexpr (C <= 4)
      if (cells_) {
        const auto ends = cells_->ends_of(edge);
        if (!cells_->crosses(ends)) return std::nullopt;
        return vertex_on(edge, [&] { return ends; });
      }
    const auto place_of_edge = std::ranges::lower_bound(edges_, edge);
    if (place_of_edge == edges_.end() || *place_of_edge != edge) return std::nullopt;
    return static_cast<Vertex>(place_of_edge - edges_.begin());
  }

  std::array<Vertex, C> simplex(SimplexNumber number) const {
    std::array<Vertex, C> corners;
    std::copy_n(corners_.begin() + static_cast<std::ptrdiff_t>(std::size_t{number} * C), C, corners.begin());
    return corners;
  }
  std::pair<double, double> time_range(SimplexNumber number) const {
    const auto corners = simplex(number);
    double first = times_[corners[0]], last = first;
    for (const Vertex vertex : corners) {
      first = std::min(first, times_[vertex]);
      last = std::max(last, times_[vertex]);
    }
    return {first, last};
  }
  bool has_corner(SimplexNumber number, Vertex vertex) const {
    bool found = false;
    for (const Vertex corner : simplex(number)) found |= corner == vertex;
    return found;
  }
  // The simplices around a vertex, in the order of their cells.
  std::span<const SimplexNumber> star(Vertex vertex) {
    if (!cells_) return stars_.of(vertex);
    if constexpr (C <= 4)
      if (vertex >= unfolded_stars_.size() || unfolded_stars_[vertex].empty()) unfold_star(vertex);
    return unfolded_stars_[vertex];
  }

  // Calls use(simplex) for the simplices around an edge of M.
  template <class Use>
  void for_each_around(Vertex a, Vertex b, Use&& use) {
    if constexpr (C <= 4)
      if (cells_) {
        const auto around = [&](std::uint64_t cell, unsigned slot, unsigned other) {
          for_each_simplex_with(std::uint32_t{1} << slot | std::uint32_t{1} << other, cell, use);
        };
        return cells_->for_each_cell_around(edges_[a], edges_[b], around);
      }
    for (const SimplexNumber number : stars_.of(a))
      if (has_corner(number, b)) use(number);
  }

  // Whether a triangle of M is one where M ends: at a wall of the domain, or where samples are missing.
  bool is_on_boundary(const std::array<Vertex, 3>& triangle) {
    if (cells_) return walls_[triangle[0]] & walls_[triangle[1]] & walls_[triangle[2]];
    return std::ranges::count_if(star(triangle[0]), [&](SimplexNumber number) {
             return has_corner(number, triangle[1]) && has_corner(number, triangle[2]);
           }) == 1;
  }

  // Of slices, or of the curves where they end (landmarks.hpp): if the slab unfolds, and once so many of
  // their parts were searched that it takes less time to find them.
  const Landmarks<C>* landmarks(bool of_rim) {
    if constexpr (C <= 4) {
      auto& landmarks = landmarks_[of_rim];
      if (cells_ && !landmarks && searched_[of_rim] > cells_->cost_of_landmarks())
        landmarks = cells_->landmarks(of_rim);
      return landmarks.get();
    }
    return nullptr;
  }
  void add_searched(std::size_t parts, bool of_rim) { searched_[of_rim] += parts; }

  // By cell, and in the order of its table within one.
  bool comes_before(SimplexNumber a, SimplexNumber b) const {
    return cells_ && cell_of_[a] != cell_of_[b] ? cell_of_[a] < cell_of_[b] : a < b;
  }

  // Gives everything a number.
  void unfold_all() {
    if constexpr (C <= 4)
      if (cells_) cells_->for_each_cell([&](std::uint64_t cell) { unfold(cell); });
  }

 private:
  // `ends()`: of the edge.
  template <class Ends>
  Vertex vertex_on(GridEdge edge, Ends&& ends) {
    const auto [number, is_new] = vertex_on_edge_.insert(edge, static_cast<std::uint32_t>(edges_.size()));
    if (is_new) {
      edges_.push_back(edge);
      times_.push_back(cells_->time(ends()));
      walls_.push_back(cells_->walls(ends()));
    }
    return number;
  }
  struct UnfoldedCell {
    SimplexNumber first, end; // of its simplices
  };
  UnfoldedCell unfold(std::uint64_t cell) {
    const auto [number, is_new] =
        number_of_cell_.insert(cell, static_cast<std::uint32_t>(unfolded_cells_.size()));
    if (is_new) {
      const auto first = static_cast<SimplexNumber>(simplex_count());
      const typename Cells::Edges edges(*cells_, cell);
      std::array<Vertex, CellEdges<C, Method::hull>::slots> vertex; // of each slot
      std::uint32_t known = 0, in_simplex = 0;                      // slots
      for (const unsigned slot : cells_->simplices(cells_->code_of(cell))) {
        const std::uint32_t bit = std::uint32_t{1} << slot;
        if (!(known & bit)) vertex[slot] = vertex_on(edges[slot], [&] { return edges.ends(slot); });
        known |= bit;
        corners_.push_back(vertex[slot]);
        in_simplex |= bit;
        if (corners_.size() % C == 0) slots_.push_back(std::exchange(in_simplex, 0));
      }
      cell_of_.resize(simplex_count(), cell);
      unfolded_cells_.push_back({first, static_cast<SimplexNumber>(simplex_count())});
    }
    return unfolded_cells_[number];
  }
  // Calls use(simplex) for those of a cell with corners at all of some slots.
  template <class Use>
  void for_each_simplex_with(std::uint32_t slots, std::uint64_t cell, Use&& use) {
    const auto [first, end] = unfold(cell);
    for (SimplexNumber number = first; number < end; ++number)
      if ((slots_[number] & slots) == slots) use(number);
  }
  void unfold_star(Vertex vertex) {
    found_.clear();
    cells_->for_each_cell_around(edges_[vertex], [&](std::uint64_t cell, unsigned slot) {
      for_each_simplex_with(std::uint32_t{1} << slot, cell, [&](auto number) { found_.push_back(number); });
    });
    if (unfolded_stars_.size() < edges_.size()) unfolded_stars_.resize(edges_.size());
    unfolded_stars_[vertex] = found_; // stays where it is when others come
  }

  std::vector<GridEdge> edges_;
  std::vector<double> times_;
  std::vector<Vertex> corners_;
  Stars stars_;

  std::unique_ptr<Cells> cells_;
  std::array<std::unique_ptr<Landmarks<C>>, 2> landmarks_; // of slices, of the curves where they end
  std::array<std::size_t, 2> searched_{};                  // parts of these
  NumberMap vertex_on_edge_, number_of_cell_;
  std::vector<UnfoldedCell> unfolded_cells_;
  std::vector<std::uint8_t> walls_;                        // of each vertex
  std::vector<std::uint32_t> slots_;                       // of the corners of each simplex, as bits
  std::vector<std::uint64_t> cell_of_;                     // each simplex
  std::vector<std::vector<SimplexNumber>> unfolded_stars_; // empty where not asked for
  std::vector<SimplexNumber> found_;                       // of the star that is unfolded
};

// Decodes grid edges of a slab and knows its samples.
template <class T, int D>
class SlabSamples {
 public:
  SlabSamples(const FieldView<const T, D>& field, double isovalue)
      : field_(field), dims_(field.dims()), isovalue_(isovalue) {}

  GridEdge step_offset() const {
    GridEdge rows = 1;
    for (int axis = 1; axis < D - 1; ++axis) rows *= static_cast<GridEdge>(dims_[axis]);
    return (rows << D) * row_length();
  }

  double weight(const GridEdgeEnds<D>& ends) const {
    return crossing(static_cast<double>(field_.at(ends.lower)), static_cast<double>(field_.at(ends.upper)),
                    isovalue_);
  }
  // Of a crossing between the steps.
  double time(GridEdge edge) const { return weight(grid_edge_ends<D>(dims_, edge)); }

  Place place(GridEdge edge) const {
    const auto ends = grid_edge_ends<D>(dims_, edge);
    return place_of(ends, weight(ends));
  }
  // Where the edge ends: the place of a crossing at its upper sample.
  Place place_of_upper_end(GridEdge edge) const { return place_of(grid_edge_ends<D>(dims_, edge), 1); }

  const FieldView<const T, D>& field() const { return field_; }
  GridEdge row_length() const { return static_cast<GridEdge>(dims_[0]); }

 private:
  Place place_of(const GridEdgeEnds<D>& ends, double weight) const {
    return place_between<D>(field_.grid, ends.lower, ends.upper, weight);
  }

  FieldView<const T, D> field_;
  std::array<std::int64_t, D> dims_;
  double isovalue_;
};

// What both kinds of slabs know of their samples.
template <int C, class Samples>
void describe(Slab<C>& slab, const Samples& samples) {
  slab.row_length = samples.row_length();
  slab.step_offset = samples.step_offset();
  slab.place = [samples](GridEdge edge) { return samples.place(edge); };
  slab.place_of_upper_end = [samples](GridEdge edge) { return samples.place_of_upper_end(edge); };
}

// A slab of the given vertices, ascending, and simplices. An edge that runs from step to step is crossed at a
// time of its own, any other at its step.
template <int C, class Samples>
Slab<C> slab_of(Array<GridEdge>&& edges, std::vector<Vertex>&& corners, const Samples& samples,
                bool has_missing) {
  std::vector<double> times(edges.size());
  bool ties_below = false, ties_above = false;
  for (Vertex vertex = 0; vertex < times.size(); ++vertex) {
    const GridEdge edge = edges[vertex];
    if (!(edge / samples.row_length() >> (C - 1) & 1)) {
      times[vertex] = edge < samples.step_offset() ? 0 : 1;
    } else {
      times[vertex] = samples.time(edge);
      ties_below |= times[vertex] == 0;
      ties_above |= times[vertex] == 1;
    }
  }
  Slab<C> slab(std::move(edges), std::move(times), std::move(corners));
  slab.ties_below = ties_below;
  slab.ties_above = ties_above;
  slab.has_missing = has_missing;
  describe(slab, samples);
  return slab;
}

// Takes over a surface between two steps. Requires its edges.
template <class T, int D>
Result<Slab<D>> make_slab(const SlabSamples<T, D>& samples, SimplexMesh<D>&& mesh, bool has_missing) {
  if (mesh.vertex_count() > UINT32_MAX || mesh.simplices.size() > UINT32_MAX)
    return Error{Code::out_of_memory, "the surface between two steps has more than 2^32 corners"};
  std::vector<Vertex> corners(mesh.simplices.size());
  for (std::size_t corner = 0; corner < corners.size(); ++corner)
    corners[corner] = static_cast<Vertex>(mesh.simplices[corner]);
  return slab_of<D>(std::move(mesh.edges), std::move(corners), samples, has_missing);
}

} // namespace hyperiso::track_detail
