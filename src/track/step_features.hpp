#pragma once
// The components of the surface at one step, measured.

#include "hyperiso/track.hpp"
#include "track/feature_rows.hpp"
#include "track/regions.hpp"
#include "track/step_pieces.hpp"

#include <cmath>

namespace hyperiso::track_detail {

// A connected piece of the surface at a step. It parts one inside from one outside region; what it encloses
// is, if it is closed, the one of them that it surrounds, else the inside one.
struct SurfacePiece {
  std::size_t row = SIZE_MAX; // of the rows of the step
  GridEdge first_edge = 0;    // of its vertices
  Region inside = 0, outside = 0;
  bool closed = true;
  double signed_volume = 0; // what this piece and its walls contribute to the volume of its inside region

  Region enclosed() const { return closed && signed_volume < 0 ? outside : inside; }
};

// The rows of a step: one for each component of the level that is a track's, all its pieces together.
template <class T, int D> // D: of space
class StepFeatures {
 public:
  // `step`: the samples, of these regions. `level` knows M there and what became of its components.
  StepFeatures(const FieldView<const T, D>& step, std::shared_ptr<const Regions<D>> regions,
               const SlabSamples<T, D + 1>& samples, bool upper_step, const Level<D + 1>& level)
      : step_(step), samples_(samples), upper_step_(upper_step), owned_regions_(std::move(regions)),
        regions_(*owned_regions_), rows_(level) {
    for (int axis = 0; axis < D; ++axis) {
      const Axis& a = step.grid.axes[axis];
      share_[axis] = shares(a);
      low_end_[axis] = std::min(a.coordinate(0), a.coordinate(a.count - 1));
      length_[axis] = std::abs(a.coordinate(a.count - 1) - a.coordinate(0));
      far_wall_[axis] = (a.increasing() ? 2u : 1u) << (2 * axis);
    }
    row_regions_.resize(rows_.count());
    wanted_.resize(regions_.count());
    counts_.resize(rows_.count());
  }

  const Regions<D>& regions() const { return regions_; }
  const std::vector<bool>& wanted() const { return wanted_; }
  const std::vector<Region>& regions_of(std::size_t row) const { return row_regions_[row]; }
  const std::array<std::vector<double>, D>& share() const { return share_; }

  // Measures the rows. Requires the surface at the step, with its edges and double positions.
  std::vector<Feature> measure(const SimplexMesh<D>& surface, const StepPieces& pieces,
                               const Level<D + 1>& level) {
    positions_ = static_cast<const double*>(surface.positions.data());
    place_vertices(surface, pieces, level);
    find_pieces(pieces);
    add_simplices(surface);
    finish_pieces();
    add_samples();
    rows_.place_what_is_not_there(level);
    return std::move(rows_.features);
  }

  const std::vector<SurfacePiece>& pieces() const { return pieces_; }

  // The row of each component of the level, or SIZE_MAX.
  std::size_t row_of(std::size_t component) const { return rows_.row_of(component); }

 private:
  struct Counts {
    std::int64_t vertices = 0, simplices = 0, boundary_edges = 0;
  };
  struct PlacedVertex {
    std::array<std::int32_t, D> lower; // sample
    std::uint8_t walls = 0; // bit 2k: within the first layer of axis k; bit 2k + 1: within the last one
    std::uint8_t direction = 0;
  };

  void place_vertices(const SimplexMesh<D>& surface, const StepPieces& pieces, const Level<D + 1>& level) {
    const auto dims = step_.dims();
    vertices_.resize(surface.vertex_count());
    vertex_row_.assign(surface.vertex_count(), SIZE_MAX);
    for (std::size_t vertex = 0; vertex < vertices_.size(); ++vertex) {
      const auto ends = grid_edge_ends<D>(dims, surface.edges[vertex]);
      PlacedVertex& placed = vertices_[vertex];
      placed.direction = static_cast<std::uint8_t>(ends.direction);
      bool near_wall = false;
      for (int axis = 0; axis < D; ++axis) {
        placed.lower[axis] = static_cast<std::int32_t>(ends.lower[axis]);
        near_wall |= ends.lower[axis] == 0 || ends.upper[axis] == dims[axis] - 1;
        if (ends.upper[axis] == 0) placed.walls |= static_cast<std::uint8_t>(1u << (2 * axis));
        if (ends.lower[axis] == dims[axis] - 1) placed.walls |= static_cast<std::uint8_t>(2u << (2 * axis));
      }
      const auto component = level.component_of(pieces, vertex);
      if (!component || row_of(*component) == SIZE_MAX) continue;
      vertex_row_[vertex] = row_of(*component);
      Feature& feature = rows_.features[vertex_row_[vertex]];
      ++counts_[vertex_row_[vertex]].vertices;
      for (std::size_t axis = 0; axis < D; ++axis) {
        const double coordinate = positions_[vertex * D + axis];
        feature.low[axis] = std::min(feature.low[axis], coordinate);
        feature.high[axis] = std::max(feature.high[axis], coordinate);
      }
      if (near_wall && !feature.on_wall) {
        const GridEdge edge = pieces.edge(vertex);
        feature.on_wall = samples_.place(upper_step_ ? edge + samples_.step_offset() : edge).on_wall;
      }
    }
  }

  void find_pieces(const StepPieces& pieces) {
    piece_.resize(vertices_.size());
    for (std::size_t vertex = 0; vertex < vertices_.size(); ++vertex) {
      piece_[vertex] = pieces.piece(vertex);
      if (piece_[vertex] < pieces_.size()) continue;
      SurfacePiece& piece = pieces_.emplace_back();
      piece.row = vertex_row_[vertex];
      piece.first_edge = pieces.edge_at_step(vertex);
      std::tie(piece.inside, piece.outside) = regions_beside(vertices_[vertex]);
    }
  }

  std::pair<Region, Region> regions_beside(const PlacedVertex& vertex) const {
    std::array<std::int64_t, D> lower, upper;
    for (int axis = 0; axis < D; ++axis) {
      lower[axis] = vertex.lower[axis];
      upper[axis] = lower[axis] + (vertex.direction >> axis & 1);
    }
    const Region a = regions_.at(lower), b = regions_.at(upper);
    return regions_.kind(a) == Regions<D>::Kind::inside ? std::pair{a, b} : std::pair{b, a};
  }

  // Coordinates measured from the lowest corner of the domain.
  std::array<double, D> point(std::uint64_t vertex) const {
    std::array<double, D> result;
    for (std::size_t axis = 0; axis < D; ++axis)
      result[axis] = positions_[vertex * D + axis] - low_end_[axis];
    return result;
  }

  void add_simplices(const SimplexMesh<D>& surface) {
    std::vector<std::array<std::uint64_t, 2>> all_edges; // where walls do not tell which are on the boundary
    UnionFind rims(vertices_.size());
    std::vector<bool> on_rim(vertices_.size());
    std::vector<int> segments_at(D == 2 ? vertices_.size() : 0);
    const auto add_boundary_edge = [&](std::uint64_t a, std::uint64_t b) {
      rims.unite(a, b);
      on_rim[a] = on_rim[b] = true;
      pieces_[piece_[a]].closed = false;
      if (vertex_row_[a] != SIZE_MAX) ++counts_[vertex_row_[a]].boundary_edges;
    };
    surface.simplices.visit([&](auto all_corners) {
      for (auto first = all_corners.begin(); first != all_corners.end(); first += D) {
        std::array<std::uint64_t, D> corners;
        std::copy_n(first, D, corners.begin());
        add_simplex(corners);
        if constexpr (D == 2)
          for (const std::uint64_t corner : corners) ++segments_at[corner];
        if constexpr (D == 3)
          for (std::size_t corner = 0; corner < 3; ++corner) {
            const std::uint64_t a = corners[corner], b = corners[(corner + 1) % 3];
            if (regions_.has_missing())
              all_edges.push_back({std::min(a, b), std::max(a, b)});
            else if (vertices_[a].walls & vertices_[b].walls)
              add_boundary_edge(a, b);
          }
      }
    });
    std::ranges::sort(all_edges);
    for (std::size_t i = 0; i < all_edges.size(); ++i)
      if ((i == 0 || all_edges[i - 1] != all_edges[i]) &&
          (i + 1 == all_edges.size() || all_edges[i + 1] != all_edges[i]))
        add_boundary_edge(all_edges[i][0], all_edges[i][1]);
    for (std::size_t vertex = 0; vertex < vertices_.size(); ++vertex) {
      if (vertex_row_[vertex] != SIZE_MAX && on_rim[vertex] && rims.find(vertex) == vertex)
        ++rows_.features[vertex_row_[vertex]].wall_curves;
      if (D == 2 && segments_at[vertex] == 1) pieces_[piece_[vertex]].closed = false;
    }
    // Each edge of a triangle is in two of them, or on the boundary.
    for (std::size_t row = 0; row < rows_.features.size(); ++row) {
      const Counts& count = counts_[row];
      const std::int64_t edges = D == 3 ? (3 * count.simplices + count.boundary_edges) / 2 : count.simplices;
      rows_.features[row].euler_characteristic = count.vertices - edges + (D == 3 ? count.simplices : 0);
    }
    add_wall_points();
  }

  void add_simplex(const std::array<std::uint64_t, D>& corners) {
    SurfacePiece& piece = pieces_[piece_[corners[0]]];
    std::array<std::array<double, D>, D> p;
    for (std::size_t corner = 0; corner < D; ++corner) p[corner] = point(corners[corner]);
    double area = 0, mean = 0;
    for (const auto& q : p) mean += q[0];
    mean /= D;
    if constexpr (D == 3) {
      const double ax = p[1][0] - p[0][0], ay = p[1][1] - p[0][1], az = p[1][2] - p[0][2];
      const double bx = p[2][0] - p[0][0], by = p[2][1] - p[0][1], bz = p[2][2] - p[0][2];
      const double nx = ay * bz - az * by, ny = az * bx - ax * bz, nz = ax * by - ay * bx;
      area = 0.5 * std::sqrt(nx * nx + ny * ny + nz * nz);
      piece.signed_volume += 0.5 * nx * mean;
      // The wall at the far end of axis 0 adds its length times the area inside, which is an integral along
      // the rim: x cross the direction of the edge points out of the inside.
      for (std::size_t corner = 0; corner < 3; ++corner) {
        const auto next = (corner + 1) % 3;
        if (vertices_[corners[corner]].walls & vertices_[corners[next]].walls & far_wall_[0])
          piece.signed_volume -= length_[0] * (p[next][2] - p[corner][2]) * 0.5 * (p[next][1] + p[corner][1]);
      }
    } else {
      area = std::hypot(p[1][0] - p[0][0], p[1][1] - p[0][1]);
      piece.signed_volume += (p[1][1] - p[0][1]) * mean;
    }
    if (vertex_row_[corners[0]] == SIZE_MAX) return;
    const std::size_t row = vertex_row_[corners[0]];
    rows_.features[row].surface_area += area;
    ++counts_[row].simplices;
    rows_.count_cell(row, vertices_, corners, step_.grid);
  }

  // Crossings of the domain's edge along the last axis where all other coordinates are largest: what is left
  // of the walls' contribution to volumes.
  void add_wall_points() {
    double scale = 1;
    unsigned walls = 0;
    for (int axis = 0; axis + 1 < D; ++axis) scale *= length_[axis], walls |= far_wall_[axis];
    for (std::size_t vertex = 0; vertex < vertices_.size(); ++vertex) {
      if ((vertices_[vertex].walls & walls) != walls) continue;
      const auto [inside, outside] = regions_beside(vertices_[vertex]);
      std::array<std::int64_t, D> lower;
      std::copy(vertices_[vertex].lower.begin(), vertices_[vertex].lower.end(), lower.begin());
      const bool inside_first = regions_.at(lower) == inside;
      const double sign = inside_first == step_.grid.axes[D - 1].increasing() ? 1 : -1;
      pieces_[piece_[vertex]].signed_volume += sign * scale * point(vertex)[D - 1];
    }
  }

  void finish_pieces() {
    std::array<std::int64_t, D> far_corner;
    double domain = 1;
    for (int axis = 0; axis < D; ++axis) {
      const Axis& a = step_.grid.axes[axis];
      far_corner[axis] = a.increasing() ? a.count - 1 : 0;
      domain *= length_[axis];
    }
    std::vector<double> volume(regions_.count());
    volume[regions_.at(far_corner)] = domain;
    for (const SurfacePiece& piece : pieces_) {
      volume[piece.inside] += piece.signed_volume;
      volume[piece.outside] -= piece.signed_volume;
      if (piece.row == SIZE_MAX) continue;
      row_regions_[piece.row].push_back(piece.enclosed());
      wanted_[piece.enclosed()] = true;
    }
    for (std::size_t row = 0; row < rows_.features.size(); ++row) {
      auto& regions = row_regions_[row];
      std::ranges::sort(regions);
      regions.erase(std::unique(regions.begin(), regions.end()), regions.end());
      for (const Region region : regions) rows_.features[row].volume += volume[region];
    }
  }

  struct RegionSum {
    double size = 0, mass = 0;
    double minimum = std::numeric_limits<double>::infinity(), maximum = -minimum;
    std::array<double, D> moment{};
  };

  void add_samples() {
    std::vector<RegionSum> sums(regions_.count());
    std::array<std::int64_t, D> index{};
    for (std::size_t number = 0; number < regions_.rows(); ++number) {
      double row_share = 1;
      for (int axis = 1; axis < D; ++axis) row_share *= share_[axis][static_cast<std::size_t>(index[axis])];
      for (const auto& run : regions_.row(number))
        if (wanted_[run.region]) add_run(run, index, row_share, sums[run.region]);
      for (int axis = 1; axis < D && ++index[axis] == step_.grid.axes[axis].count; ++axis) index[axis] = 0;
    }
    for (std::size_t row = 0; row < rows_.features.size(); ++row) {
      Feature& feature = rows_.features[row];
      for (const Region region : row_regions_[row]) {
        const RegionSum& sum = sums[region];
        feature.cell_volume += sum.size;
        feature.mass += sum.mass;
        feature.minimum = std::min(feature.minimum, sum.minimum);
        feature.maximum = std::max(feature.maximum, sum.maximum);
        for (std::size_t axis = 0; axis < D; ++axis) feature.centroid[axis] += sum.moment[axis];
      }
      for (double& coordinate : feature.centroid) coordinate /= feature.cell_volume;
      if (regions_.has_missing()) feature.volume = feature.cell_volume; // its surface may be open inside
    }
  }

  void add_run(const typename Regions<D>::Run& run, std::array<std::int64_t, D> index, double row_share,
               RegionSum& sum) const {
    double run_size = 0;
    for (index[0] = run.begin; index[0] < run.end; ++index[0]) {
      const auto value = static_cast<double>(step_.at(index));
      const double size = row_share * share_[0][static_cast<std::size_t>(index[0])];
      run_size += size;
      sum.mass += size * value;
      sum.minimum = std::min(sum.minimum, value);
      sum.maximum = std::max(sum.maximum, value);
      sum.moment[0] += size * step_.grid.axes[0].coordinate(index[0]);
    }
    sum.size += run_size;
    for (std::size_t axis = 1; axis < D; ++axis)
      sum.moment[axis] += run_size * step_.grid.axes[axis].coordinate(index[axis]);
  }

  FieldView<const T, D> step_;
  SlabSamples<T, D + 1> samples_;
  bool upper_step_; // which step of `samples_` this is
  std::shared_ptr<const Regions<D>> owned_regions_;
  const Regions<D>& regions_;
  std::array<std::vector<double>, D> share_;
  std::array<double, D> low_end_, length_; // of the domain
  std::array<unsigned, D> far_wall_; // bit of PlacedVertex::walls: where the axis' coordinate is largest
  FeatureRows<D> rows_;
  std::vector<std::vector<Region>> row_regions_;
  std::vector<bool> wanted_;          // regions
  std::vector<Counts> counts_;        // of each row
  const double* positions_ = nullptr; // D of each vertex
  std::vector<PlacedVertex> vertices_;
  std::vector<std::size_t> vertex_row_; // or SIZE_MAX
  std::vector<std::size_t> piece_;      // of each vertex
  std::vector<SurfacePiece> pieces_;
};

} // namespace hyperiso::track_detail
