#pragma once
// The surface at a step, measured: its pieces, or other groups of its vertices.

#include "core/sign.hpp"
#include "core/union_find.hpp"
#include "hyperiso/mesh.hpp"
#include "mesh/normals.hpp"
#include "track/cell_counter.hpp"
#include "track/step_mask.hpp"
#include "track/step_pieces.hpp"

#include <cmath>
#include <limits>

namespace hyperiso::track_detail {

// What is measured of a group of vertices and of the simplices that begin with one of them.
template <int D>
struct GroupMeasure {
  std::int64_t vertices = 0, simplices = 0, boundary_edges = 0;
  std::int64_t cells = 0, wall_curves = 0;
  bool on_wall = false;
  double area = 0;
  std::array<double, D> low = filled(std::numeric_limits<double>::infinity()), // box of the vertices
      high = filled(-std::numeric_limits<double>::infinity());

  // Each edge of a triangle is in two of them, or on the boundary.
  std::int64_t euler_characteristic() const {
    return D == 3 ? vertices - (3 * simplices + boundary_edges) / 2 + simplices : vertices - simplices;
  }

 private:
  static std::array<double, D> filled(double value) {
    std::array<double, D> result;
    result.fill(value);
    return result;
  }
};

// Of a connected piece of the surface.
struct PieceMeasure {
  bool closed = true;
  double signed_volume = 0; // what the piece and its walls contribute to the volume of its inside region
};

template <int D>
struct SurfaceMeasure {
  std::vector<PieceMeasure> pieces;
  std::vector<GroupMeasure<D>> groups;
};

// Measures the surface at a step, once.
template <class T, int D> // D: of space
class SurfaceMeter {
 public:
  static constexpr std::uint32_t no_group = UINT32_MAX;

  // Requires that the surface has its edges and double positions. `mask`: of the samples of `step`.
  SurfaceMeter(const FieldView<const T, D>& step, const StepMask& mask, double isovalue,
               const SimplexMesh<D>& surface, const StepPieces& pieces)
      : step_(step), mask_(mask), isovalue_(isovalue), surface_(surface), pieces_(pieces),
        positions_(static_cast<const double*>(surface.positions.data())) {
    for (std::size_t axis = 0; axis < D; ++axis) {
      const Axis& a = step.grid.axes[axis];
      low_end_[axis] = std::min(a.coordinate(0), a.coordinate(a.count - 1));
      length_[axis] = std::abs(a.coordinate(a.count - 1) - a.coordinate(0));
      far_wall_[axis] = (a.increasing() ? 2u : 1u) << (2 * axis);
    }
    measure_.pieces.resize(pieces.count());
  }

  // With its pieces as the groups.
  SurfaceMeasure<D> by_pieces() {
    return measure([&](std::size_t vertex) { return pieces_.piece(vertex); }, pieces_.count());
  }
  // `group`: of each vertex, or none.
  SurfaceMeasure<D> by_groups(const std::vector<std::uint32_t>& group, std::size_t count) {
    return measure([&](std::size_t vertex) { return group[vertex]; }, count);
  }

 private:
  struct PlacedVertex {
    std::array<std::int32_t, D> lower; // sample
    std::uint8_t walls = 0; // bit 2k: within the first layer of axis k; bit 2k + 1: within the last one
  };
  using BoundaryEdge = std::array<std::uint64_t, 2>;

  template <class GroupOf>
  SurfaceMeasure<D> measure(const GroupOf& group_of, std::size_t groups) {
    measure_.groups.resize(groups);
    cells_.resize(groups);
    place_vertices(group_of);
    add_simplices(group_of);
    add_boundary(group_of);
    return std::move(measure_);
  }

  template <class GroupOf>
  void place_vertices(const GroupOf& group_of) {
    vertices_.resize(surface_.vertex_count());
    const auto dims = step_.dims();
    const auto row_length = static_cast<GridEdge>(dims[0]);
    GridEdge first = 0, end = 0; // edges of the row that is passed, of one direction
    GridEdgeEnds<D> ends{};
    for (std::size_t vertex = 0; vertex < vertices_.size(); ++vertex) {
      const GridEdge edge = surface_.edges[vertex];
      if (edge >= end) {
        ends = grid_edge_ends<D>(dims, edge);
        first = edge / row_length * row_length;
        end = first + row_length;
      } else {
        ends.upper[0] = static_cast<std::int64_t>(edge - first);
        ends.lower[0] = ends.upper[0] - (ends.direction & 1);
      }
      PlacedVertex& placed = vertices_[vertex];
      bool near_wall = false;
      for (std::size_t axis = 0; axis < D; ++axis) {
        placed.lower[axis] = static_cast<std::int32_t>(ends.lower[axis]);
        near_wall |= ends.lower[axis] == 0 || ends.upper[axis] == dims[axis] - 1;
        placed.walls |= static_cast<std::uint8_t>(
            ((ends.upper[axis] == 0 ? 1u : 0u) | (ends.lower[axis] == dims[axis] - 1 ? 2u : 0u))
            << (2 * axis));
      }
      if (near_wall) add_far_point(vertex, ends);
      const std::uint32_t group = group_of(vertex);
      if (group == no_group) continue;
      GroupMeasure<D>& measure = measure_.groups[group];
      ++measure.vertices;
      for (std::size_t axis = 0; axis < D; ++axis) {
        const double coordinate = positions_[vertex * D + axis];
        measure.low[axis] = std::min(measure.low[axis], coordinate);
        measure.high[axis] = std::max(measure.high[axis], coordinate);
      }
      if (near_wall && !measure.on_wall) measure.on_wall = is_on_wall(ends);
    }
  }

  bool is_on_wall(const GridEdgeEnds<D>& ends) const {
    const double weight = crossing(static_cast<double>(step_.at(ends.lower)),
                                   static_cast<double>(step_.at(ends.upper)), isovalue_);
    bool on_wall = false;
    for (int axis = 0; axis < D; ++axis) {
      const bool along = ends.direction >> axis & 1;
      on_wall |= ((!along || weight == 0) && ends.lower[axis] == 0) ||
                 ((!along || weight == 1) && ends.upper[axis] == step_.dims()[axis] - 1);
    }
    return on_wall;
  }

  // Where the surface crosses the domain's edge along the last axis at which all other coordinates are
  // largest: what is left of the walls' contribution to volumes.
  void add_far_point(std::size_t vertex, const GridEdgeEnds<D>& ends) {
    double scale = 1;
    unsigned walls = 0;
    for (std::size_t axis = 0; axis + 1 < D; ++axis) scale *= length_[axis], walls |= far_wall_[axis];
    if ((vertices_[vertex].walls & walls) != walls) return;
    std::int64_t row = 0;
    for (int axis = D - 1; axis > 0; --axis) row = row * step_.dims()[axis] + ends.lower[axis];
    const bool inside_first =
        mask_.inside(static_cast<std::size_t>(row), static_cast<std::size_t>(ends.lower[0]));
    const double sign = inside_first == step_.grid.axes[D - 1].increasing() ? 1 : -1;
    measure_.pieces[pieces_.piece(vertex)].signed_volume += sign * scale * coordinate(vertex, D - 1);
  }

  // Measured from the lowest corner of the domain.
  double coordinate(std::uint64_t vertex, std::size_t axis) const {
    return positions_[vertex * D + axis] - low_end_[axis];
  }

  // Of simplices of one piece and group that follow each other.
  struct Sum {
    std::uint32_t piece = UINT32_MAX, group = no_group;
    double signed_volume = 0, area = 0;
    std::int64_t simplices = 0, cells = 0;
  };

  template <class GroupOf>
  void add_simplices(const GroupOf& group_of) {
    std::vector<int> segments_at(D == 2 ? vertices_.size() : 0);
    Sum sum;
    surface_.simplices.visit([&](auto all_corners) {
      for (auto first = all_corners.begin(); first != all_corners.end(); first += D) {
        std::array<std::uint64_t, D> corners;
        std::copy_n(first, D, corners.begin());
        const std::uint32_t piece = pieces_.piece(corners[0]), group = group_of(corners[0]);
        if (piece != sum.piece || group != sum.group) {
          add(sum);
          sum = {piece, group};
        }
        add_size(corners, sum);
        ++sum.simplices;
        if (group != no_group) sum.cells += cells_.is_next(group, vertices_, corners);
        if constexpr (D == 2)
          for (const std::uint64_t corner : corners) ++segments_at[corner];
        if constexpr (D == 3) find_boundary_edges(corners);
      }
    });
    add(sum);
    for (std::size_t vertex = 0; vertex < segments_at.size(); ++vertex)
      if (segments_at[vertex] == 1) measure_.pieces[pieces_.piece(vertex)].closed = false;
  }
  void add(const Sum& sum) {
    if (sum.simplices == 0) return;
    measure_.pieces[sum.piece].signed_volume += sum.signed_volume;
    if (sum.group == no_group) return;
    GroupMeasure<D>& measure = measure_.groups[sum.group];
    measure.area += sum.area;
    measure.simplices += sum.simplices;
    measure.cells += sum.cells;
  }

  void add_size(const std::array<std::uint64_t, D>& corners, Sum& sum) const {
    std::array<std::array<double, D>, D> p;
    for (std::size_t corner = 0; corner < D; ++corner)
      for (std::size_t axis = 0; axis < D; ++axis) p[corner][axis] = coordinate(corners[corner], axis);
    if constexpr (D == 3) {
      const auto [nx, ny, nz] = triangle_normal(p);
      sum.signed_volume += 0.5 * nx * ((p[0][0] + p[1][0] + p[2][0]) / 3);
      sum.area += 0.5 * std::sqrt(nx * nx + ny * ny + nz * nz);
    } else {
      sum.signed_volume += (p[1][1] - p[0][1]) * ((p[0][0] + p[1][0]) / 2);
      sum.area += std::hypot(p[1][0] - p[0][0], p[1][1] - p[0][1]);
    }
  }

  // Of a triangle. Where samples are missing, walls do not tell which they are: then all edges are noted.
  void find_boundary_edges(const std::array<std::uint64_t, D>& corners) {
    unsigned walls[3];
    for (std::size_t corner = 0; corner < 3; ++corner) walls[corner] = vertices_[corners[corner]].walls;
    if (!mask_.has_missing() && (walls[0] == 0) + (walls[1] == 0) + (walls[2] == 0) > 1) return;
    for (std::size_t corner = 0; corner < 3; ++corner) {
      const std::uint64_t a = corners[corner], b = corners[(corner + 1) % 3];
      const unsigned shared = walls[corner] & walls[(corner + 1) % 3];
      if (mask_.has_missing())
        boundary_.push_back({std::min(a, b), std::max(a, b)});
      else if (shared != 0)
        boundary_.push_back({a, b});
      // The wall at the far end of axis 0 adds its length times the area inside, which is an integral along
      // the rim: x cross the direction of the edge points out of the inside.
      if (shared & far_wall_[0])
        measure_.pieces[pieces_.piece(corners[0])].signed_volume -=
            length_[0] * (coordinate(b, 2) - coordinate(a, 2)) * 0.5 * (coordinate(b, 1) + coordinate(a, 1));
    }
  }

  template <class GroupOf>
  void add_boundary(const GroupOf& group_of) {
    if (boundary_.empty()) return;
    if (mask_.has_missing()) keep_those_that_occur_once(boundary_);
    UnionFind curves(vertices_.size());
    std::vector<bool> on_boundary(vertices_.size());
    for (const auto& [a, b] : boundary_) {
      curves.unite(a, b);
      on_boundary[a] = on_boundary[b] = true;
      measure_.pieces[pieces_.piece(a)].closed = false;
      if (const std::uint32_t group = group_of(a); group != no_group) ++measure_.groups[group].boundary_edges;
    }
    for (std::size_t vertex = 0; vertex < vertices_.size(); ++vertex)
      if (on_boundary[vertex] && curves.find(vertex) == vertex)
        if (const std::uint32_t group = group_of(vertex); group != no_group)
          ++measure_.groups[group].wall_curves;
  }
  static void keep_those_that_occur_once(std::vector<BoundaryEdge>& edges) {
    std::ranges::sort(edges);
    std::vector<BoundaryEdge> once;
    for (std::size_t i = 0; i < edges.size(); ++i)
      if ((i == 0 || edges[i - 1] != edges[i]) && (i + 1 == edges.size() || edges[i + 1] != edges[i]))
        once.push_back(edges[i]);
    edges = std::move(once);
  }

  const FieldView<const T, D>& step_;
  const StepMask& mask_;
  double isovalue_;
  const SimplexMesh<D>& surface_;
  const StepPieces& pieces_;
  const double* positions_;                // D of each vertex
  std::array<double, D> low_end_, length_; // of the domain
  std::array<unsigned, D> far_wall_; // bit of PlacedVertex::walls: where the axis' coordinate is largest
  std::vector<PlacedVertex> vertices_;
  std::vector<BoundaryEdge> boundary_;
  CellCounter<D> cells_;
  SurfaceMeasure<D> measure_;
};

} // namespace hyperiso::track_detail
