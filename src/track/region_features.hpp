#pragma once
// The components of a region at one step, measured on its mesh.

#include "core/determinant.hpp"
#include "hyperiso/track.hpp"
#include "track/cell_counter.hpp"
#include "track/feature_rows.hpp"
#include "track/region_slab.hpp"
#include "track/regions.hpp"

#include <memory>
#include <numeric>

namespace hyperiso::track_detail {

// A connected piece of the region at a step.
struct RegionPiece {
  std::size_t row = SIZE_MAX; // of the rows of the step
  GridEdge first_edge = 0;    // of its vertices, on the grid of the step with the levels last
};

// The rows of a step: one for each component of the level that is a track's, all its pieces together.
template <class T, int D> // D: of space
class RegionFeatures {
 public:
  RegionFeatures(const FieldView<const T, D>& step, const RegionLevels& levels, Method method)
      : step_(step), vertices_(step, levels), one_orientation_(method != Method::simplicial) {
    for (int axis = 0; axis < D; ++axis) share_[axis] = shares(step.grid.axes[axis]);
  }

  // Measures the rows. Requires the region's mesh at the step and its pieces.
  std::vector<Feature> measure(std::shared_ptr<const SimplexMesh<D + 1>> mesh, const StepPieces& pieces,
                               const Level<D + 2>& level) {
    mesh_ = std::move(mesh);
    rows_ = FeatureRows<D>(level);
    sums_.resize(rows_.count());
    cells_.resize(rows_.count());
    place_vertices(pieces, level);
    find_pieces(pieces);
    for (std::size_t simplex = 0; simplex < simplex_count(); ++simplex) add_simplex(simplex);
    add_faces();
    finish();
    rows_.place_what_is_not_there(level);
    return std::move(rows_.features);
  }

  const std::vector<RegionPiece>& pieces() const { return pieces_; }

  std::size_t row_count() const { return rows_.count(); }
  // The row of each component of the level, or SIZE_MAX.
  std::size_t row_of(std::size_t component) const { return rows_.row_of(component); }

  // The row of what crosses the first level between two samples, or none.
  std::uint32_t row_between(const std::array<std::int64_t, D>& a,
                            const std::array<std::int64_t, D>& b) const {
    const GridEdge edge = first_crossing<D>(vertices_.dims(), a, b);
    const auto& edges = mesh_->edges;
    const auto vertex = std::ranges::lower_bound(edges, edge);
    if (vertex == edges.end() || *vertex != edge) return none;
    return static_cast<std::uint32_t>(
        std::min<std::size_t>(vertex_row_[static_cast<std::size_t>(vertex - edges.begin())], none));
  }

  // The row that a sample belongs to, or none.
  static constexpr std::uint32_t none = UINT32_MAX;
  const std::vector<std::uint32_t>& row_of_sample() const { return row_of_sample_; }
  std::array<std::int64_t, D> dims() const { return step_.dims(); }
  double share_of(const std::array<std::int64_t, D>& sample) const {
    double share = 1;
    for (int axis = 0; axis < D; ++axis) share *= share_[axis][static_cast<std::size_t>(sample[axis])];
    return share;
  }

 private:
  struct PlacedVertex {
    std::array<double, D> position;
    double value;
    std::array<std::int32_t, D> lower;
    std::uint8_t walls = 0; // bit 2k: on the first layer of axis k; bit 2k + 1: on the last one
  };
  // Integrals over simplices, all of one sign or of both.
  struct Sum {
    double volume = 0, mass = 0;
    std::array<double, D> moment{};
  };

  std::size_t simplex_count() const { return mesh_->simplices.size() / (D + 1); }
  std::array<std::uint32_t, D + 1> corners(std::size_t simplex) const {
    std::array<std::uint32_t, D + 1> corners;
    for (std::size_t corner = 0; corner <= D; ++corner)
      corners[corner] = static_cast<std::uint32_t>(mesh_->simplices[simplex * (D + 1) + corner]);
    return corners;
  }

  void place_vertices(const StepPieces& pieces, const Level<D + 2>& level) {
    row_of_sample_.assign(static_cast<std::size_t>(step_.grid.samples()), none);
    vertex_row_.assign(mesh_->edges.size(), SIZE_MAX);
    placed_.resize(mesh_->edges.size());
    for (std::size_t vertex = 0; vertex < placed_.size(); ++vertex) {
      const GridEdge edge = mesh_->edges[vertex];
      const auto location = vertices_.locate(edge);
      placed_[vertex] = place(location);
      const auto component = level.component_of(pieces, vertex);
      if (!component || row_of(*component) == SIZE_MAX) continue;
      vertex_row_[vertex] = row_of(*component);
      add_vertex(placed_[vertex], rows_.features[vertex_row_[vertex]]);
      if (vertices_.is_sample(edge)) add_sample(location.lower, vertex_row_[vertex]);
    }
  }
  PlacedVertex place(const typename RegionVertices<T, D>::Location& at) const {
    PlacedVertex placed;
    placed.value = at.value;
    for (int axis = 0; axis < D; ++axis) {
      const Axis& grid_axis = step_.grid.axes[axis];
      placed.position[axis] = vertices_.coordinate(at, axis);
      placed.lower[axis] = static_cast<std::int32_t>(at.lower[axis]);
      const bool at_first = at.upper[axis] == 0 || (at.lower[axis] == 0 && at.weight == 0);
      const bool at_last =
          at.lower[axis] == grid_axis.count - 1 || (at.upper[axis] == grid_axis.count - 1 && at.weight == 1);
      placed.walls |= static_cast<std::uint8_t>((at_first ? 1u : 0u) << (2 * axis));
      placed.walls |= static_cast<std::uint8_t>((at_last ? 2u : 0u) << (2 * axis));
    }
    return placed;
  }
  static void add_vertex(const PlacedVertex& vertex, Feature& feature) {
    ++feature.euler_characteristic;
    feature.minimum = std::min(feature.minimum, vertex.value);
    feature.maximum = std::max(feature.maximum, vertex.value);
    feature.on_wall |= vertex.walls != 0;
    for (std::size_t axis = 0; axis < D; ++axis) {
      feature.low[axis] = std::min(feature.low[axis], vertex.position[axis]);
      feature.high[axis] = std::max(feature.high[axis], vertex.position[axis]);
    }
  }
  void add_sample(const std::array<std::int64_t, D>& sample, std::size_t row) {
    std::int64_t number = 0;
    for (int axis = D - 1; axis >= 0; --axis) number = number * step_.grid.axes[axis].count + sample[axis];
    row_of_sample_[static_cast<std::size_t>(number)] = static_cast<std::uint32_t>(row);
    rows_.features[row].cell_volume += share_of(sample);
  }

  void find_pieces(const StepPieces& pieces) {
    for (std::size_t vertex = 0; vertex < placed_.size(); ++vertex)
      if (pieces.piece(vertex) == pieces_.size())
        pieces_.push_back({vertex_row_[vertex], pieces.edge_at_step(vertex)});
  }

  // SIZE_MAX where the track ends at cells without data: some corners may be on it, some not.
  template <std::size_t N>
  std::size_t row_at(const std::array<std::uint32_t, N>& corners) const {
    std::size_t row = 0;
    for (const std::uint32_t corner : corners) row = std::max(row, vertex_row_[corner]);
    return row;
  }

  void add_simplex(std::size_t simplex) {
    const auto vertices = corners(simplex);
    const std::size_t row = row_at(vertices);
    if (row == SIZE_MAX) return;
    std::array<std::array<double, D>, D> sides;
    Sum part;
    double value = 0;
    const auto& origin = placed_[vertices[0]];
    for (std::size_t corner = 0; corner <= D; ++corner) {
      const PlacedVertex& vertex = placed_[vertices[corner]];
      value += vertex.value / (D + 1);
      for (std::size_t axis = 0; axis < D; ++axis) {
        part.moment[axis] += vertex.position[axis] / (D + 1);
        if (corner > 0) sides[corner - 1][axis] = vertex.position[axis] - origin.position[axis];
      }
    }
    double volume = determinant(sides) / (D == 2 ? 2 : 6);
    if (!one_orientation_) volume = std::abs(volume);
    Sum& sum = sums_[row];
    sum.volume += volume;
    sum.mass += volume * value;
    for (std::size_t axis = 0; axis < D; ++axis) sum.moment[axis] += volume * part.moment[axis];
    rows_.features[row].cells += cells_.is_next(row, placed_, vertices);
  }
  // The Euler characteristic counts each face once; those of one simplex only are its surface, or on walls.
  void add_faces() {
    std::vector<std::array<std::uint32_t, 2>> edges;
    std::vector<std::array<std::uint32_t, D>> facets;
    for (std::size_t simplex = 0; simplex < simplex_count(); ++simplex) {
      auto vertices = corners(simplex);
      const std::size_t row = row_at(vertices);
      if (row == SIZE_MAX) continue;
      rows_.features[row].euler_characteristic += D == 3 ? -1 : 1;
      std::ranges::sort(vertices);
      for (std::size_t i = 0; i <= D; ++i)
        for (std::size_t j = i + 1; j <= D && D == 3; ++j) edges.push_back({vertices[i], vertices[j]});
      for (std::size_t left_out = 0; left_out <= D; ++left_out) {
        auto& facet = facets.emplace_back();
        for (std::size_t i = 0; i < D; ++i) facet[i] = vertices[i + (i >= left_out)];
      }
    }
    std::ranges::sort(edges);
    edges.erase(std::unique(edges.begin(), edges.end()), edges.end());
    for (const auto& edge : edges) --rows_.features[row_at(edge)].euler_characteristic;
    std::ranges::sort(facets);
    for (std::size_t i = 0; i < facets.size();) {
      std::size_t end = i + 1;
      while (end < facets.size() && facets[end] == facets[i]) ++end;
      Feature& feature = rows_.features[row_at(facets[i])];
      feature.euler_characteristic += D == 3 ? 1 : -1;
      if (end - i == 1 && !is_on_wall(facets[i])) feature.surface_area += size_of(facets[i]);
      i = end;
    }
  }
  bool is_on_wall(const std::array<std::uint32_t, D>& facet) const {
    unsigned walls = ~0u;
    for (const std::uint32_t vertex : facet) walls &= placed_[vertex].walls;
    return walls != 0;
  }
  double size_of(const std::array<std::uint32_t, D>& facet) const {
    std::array<std::array<double, D>, D - 1> sides;
    for (std::size_t i = 0; i + 1 < D; ++i)
      for (std::size_t axis = 0; axis < D; ++axis)
        sides[i][axis] = placed_[facet[i + 1]].position[axis] - placed_[facet[0]].position[axis];
    if constexpr (D == 2) {
      return std::hypot(sides[0][0], sides[0][1]);
    } else {
      std::array<double, 3> normal;
      for (std::size_t k = 0; k < 3; ++k) {
        const std::size_t i = (k + 1) % 3, j = (k + 2) % 3;
        normal[k] = sides[0][i] * sides[1][j] - sides[0][j] * sides[1][i];
      }
      return 0.5 * std::hypot(normal[0], normal[1], normal[2]);
    }
  }

  void finish() {
    for (std::size_t row = 0; row < rows_.features.size(); ++row) {
      Feature& feature = rows_.features[row];
      const Sum& sum = sums_[row];
      const double sign = sum.volume < 0 ? -1 : 1;
      feature.volume = sign * sum.volume;
      feature.mass = sign * sum.mass;
      for (std::size_t axis = 0; axis < D; ++axis)
        feature.centroid[axis] = sum.volume != 0 ? sum.moment[axis] / sum.volume
                                                 : std::midpoint(feature.low[axis], feature.high[axis]);
    }
    placed_ = {};
  }

  FieldView<const T, D> step_;
  RegionVertices<T, D> vertices_;
  bool one_orientation_; // of the mesh
  std::shared_ptr<const SimplexMesh<D + 1>> mesh_;
  std::array<std::vector<double>, D> share_;
  FeatureRows<D> rows_;
  std::vector<std::uint32_t> row_of_sample_;
  std::vector<PlacedVertex> placed_;
  std::vector<std::size_t> vertex_row_; // or SIZE_MAX
  std::vector<Sum> sums_;               // of each row
  CellCounter<D> cells_;
  std::vector<RegionPiece> pieces_;
};

} // namespace hyperiso::track_detail
