#pragma once
// The part of the surface M between two steps, as a simplicial complex with a time at each vertex.

#include "core/sign.hpp"
#include "hyperiso/extract.hpp"

#include <algorithm>
#include <functional>
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

// C corners a simplex. Times run from 0 at the lower step to 1 at the upper one: they are the weights of
// crossings, so equal fractions of samples give equal times, and only what lies on a step has 0 or 1.
template <int C>
struct Slab {
  Array<GridEdge> edges; // of the vertices, ascending, on the grid of these two steps
  std::vector<double> times;
  std::vector<Vertex> corners; // C of each simplex
  Stars stars;
  bool has_missing = false; // samples
  bool ties_below = false;  // a vertex at the lower step that is not on an edge within it
  bool ties_above = false;  // the same at the upper step
  GridEdge row_length = 1;  // samples along axis 0
  GridEdge step_offset = 0; // from the number of an edge within the lower step to that within the upper one
  std::function<Place(GridEdge)> place; // also of an edge within the lower step that M does not cross
  std::function<Place(GridEdge)> place_of_upper_end; // of a crossing at the upper end of an edge

  // Whether the edge of the vertex lies within a step: such vertices are those of the surface at that step.
  bool in_step(Vertex vertex) const { return !(edges[vertex] / row_length >> (C - 1) & 1); }

  std::size_t simplex_count() const { return corners.size() / C; }
  std::span<const Vertex, C> simplex(SimplexNumber number) const {
    return std::span<const Vertex, C>(corners.data() + std::size_t{number} * C, C);
  }
  std::pair<double, double> time_range(SimplexNumber number) const {
    double first = times[simplex(number)[0]], last = first;
    for (const Vertex vertex : simplex(number)) {
      first = std::min(first, times[vertex]);
      last = std::max(last, times[vertex]);
    }
    return {first, last};
  }
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
    return place_between(ends, weight(ends));
  }
  // Where the edge ends: the place of a crossing at its upper sample.
  Place place_of_upper_end(GridEdge edge) const { return place_between(grid_edge_ends<D>(dims_, edge), 1); }

  const FieldView<const T, D>& field() const { return field_; }
  GridEdge row_length() const { return static_cast<GridEdge>(dims_[0]); }

 private:
  Place place_between(const GridEdgeEnds<D>& ends, double weight) const {
    Place place;
    for (int axis = 0; axis < D - 1; ++axis) {
      const bool along = ends.direction >> axis & 1;
      const bool at_lower = !along || weight == 0, at_upper = !along || weight == 1;
      const double lower = field_.grid.axes[axis].coordinate(ends.lower[axis]);
      const double upper = field_.grid.axes[axis].coordinate(ends.upper[axis]);
      place.position.push_back(at_lower ? lower : at_upper ? upper : lower + weight * (upper - lower));
      place.on_wall |=
          (at_lower && ends.lower[axis] == 0) || (at_upper && ends.upper[axis] == dims_[axis] - 1);
    }
    return place;
  }

  FieldView<const T, D> field_;
  std::array<std::int64_t, D> dims_;
  double isovalue_;
};

// Takes over a surface between two steps. Requires its edges.
template <class T, int D>
Result<Slab<D>> make_slab(const SlabSamples<T, D>& samples, SimplexMesh<D>&& mesh, bool has_missing) {
  if (mesh.vertex_count() > UINT32_MAX || mesh.simplices.size() > UINT32_MAX)
    return Error{Code::out_of_memory, "the surface between two steps has more than 2^32 corners"};
  Slab<D> slab;
  slab.edges = std::move(mesh.edges);
  slab.row_length = samples.row_length();
  slab.step_offset = samples.step_offset();
  slab.times.resize(slab.edges.size());
  for (Vertex vertex = 0; vertex < slab.times.size(); ++vertex) {
    const GridEdge edge = slab.edges[vertex];
    if (slab.in_step(vertex)) {
      slab.times[vertex] = edge < slab.step_offset ? 0 : 1;
    } else {
      slab.times[vertex] = samples.time(edge);
      slab.ties_below |= slab.times[vertex] == 0;
      slab.ties_above |= slab.times[vertex] == 1;
    }
  }
  slab.corners.resize(mesh.simplices.size());
  for (std::size_t corner = 0; corner < slab.corners.size(); ++corner)
    slab.corners[corner] = static_cast<Vertex>(mesh.simplices[corner]);
  slab.stars.build(slab.corners, D, slab.edges.size());
  slab.has_missing = has_missing;
  slab.place = [samples](GridEdge edge) { return samples.place(edge); };
  slab.place_of_upper_end = [samples](GridEdge edge) { return samples.place_of_upper_end(edge); };
  return slab;
}

} // namespace hyperiso::track_detail
