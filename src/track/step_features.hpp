#pragma once
// The components of the surface at one step, measured.

#include "hyperiso/track.hpp"
#include "track/feature_rows.hpp"
#include "track/regions.hpp"
#include "track/surface_steps.hpp"

namespace hyperiso::track_detail {

// A connected piece of the surface at a step. It parts one inside from one outside region; what it encloses
// is, if it is closed, the one of them that it surrounds, else the inside one.
struct SurfacePiece {
  std::size_t row = SIZE_MAX; // of the rows of the step
  GridEdge first_edge = 0;    // of its vertices
  Region inside = 0, outside = 0;
  PieceMeasure measure;

  Region enclosed() const { return measure.closed && measure.signed_volume < 0 ? outside : inside; }
};

// The rows of a step: one for each component of the level that is a track's, all its pieces together.
template <class T, int D> // D: of space
class StepFeatures {
 public:
  using Step = typename SurfaceSteps<T, D + 1>::Step;

  // `samples`: of the step. `level` knows M there and what became of its components.
  StepFeatures(const FieldView<const T, D>& samples, double isovalue, const Step& step,
               const Level<D + 1>& level)
      : samples_(samples), owned_regions_(step.regions), regions_(*owned_regions_), rows_(level) {
    for (int axis = 0; axis < D; ++axis) share_[axis] = shares(samples.grid.axes[axis]);
    row_regions_.resize(rows_.count());
    wanted_.resize(regions_.count());
    measure_surface(step, isovalue, level);
    add_volumes();
    add_samples();
    rows_.place_what_is_not_there(level);
  }

  std::vector<Feature> take_features() { return std::move(rows_.features); }

  const Regions<D>& regions() const { return regions_; }
  const std::vector<bool>& wanted() const { return wanted_; }
  const std::vector<Region>& regions_of(std::size_t row) const { return row_regions_[row]; }
  const std::array<std::vector<double>, D>& share() const { return share_; }
  const std::vector<SurfacePiece>& pieces() const { return pieces_; }

  // The row of each component of the level, or SIZE_MAX.
  std::size_t row_of(std::size_t component) const { return rows_.row_of(component); }

 private:
  void measure_surface(const Step& step, double isovalue, const Level<D + 1>& level) {
    const StepPieces& pieces = step.surface->pieces;
    const auto& by_pieces = step.surface->measure;
    if (by_pieces && level.components_are_pieces()) {
      for (std::size_t piece = 0; piece < pieces.count(); ++piece)
        add_piece(pieces, piece, row_of(piece), by_pieces->pieces[piece]);
      for (std::size_t piece = 0; piece < pieces.count(); ++piece)
        if (row_of(piece) != SIZE_MAX) set(rows_.features[row_of(piece)], by_pieces->groups[piece]);
      return;
    }
    std::vector<std::uint32_t> row(pieces.vertex_count()); // of each vertex
    for (std::size_t vertex = 0; vertex < row.size(); ++vertex) {
      const auto component = level.component_of(pieces, vertex);
      row[vertex] = static_cast<std::uint32_t>(component ? row_of(*component) : SIZE_MAX);
    }
    const auto measure = SurfaceMeter<T, D>(samples_, *step.mask, isovalue, step.surface->mesh, pieces)
                             .by_groups(row, rows_.count());
    for (std::size_t piece = 0; piece < pieces.count(); ++piece) {
      const std::uint32_t row_of_piece = row[pieces.first_vertex(piece)];
      add_piece(pieces, piece, row_of_piece == SurfaceMeter<T, D>::no_group ? SIZE_MAX : row_of_piece,
                measure.pieces[piece]);
    }
    for (std::size_t number = 0; number < rows_.count(); ++number)
      set(rows_.features[number], measure.groups[number]);
  }

  static void set(Feature& feature, const GroupMeasure<D>& measure) {
    feature.surface_area = measure.area;
    feature.low.assign(measure.low.begin(), measure.low.end());
    feature.high.assign(measure.high.begin(), measure.high.end());
    feature.euler_characteristic = measure.euler_characteristic();
    feature.wall_curves = measure.wall_curves;
    feature.cells = measure.cells;
    feature.on_wall = measure.on_wall;
  }

  void add_piece(const StepPieces& pieces, std::size_t number, std::size_t row, const PieceMeasure& measure) {
    const GridEdge first = pieces.edge_at_step(pieces.first_vertex(number));
    const auto ends = grid_edge_ends<D>(samples_.dims(), first);
    const Region a = regions_.at(ends.lower), b = regions_.at(ends.upper);
    const bool a_is_inside = regions_.kind(a) == Regions<D>::Kind::inside;
    pieces_.push_back({row, first, a_is_inside ? a : b, a_is_inside ? b : a, measure});
  }

  void add_volumes() {
    std::array<std::int64_t, D> far_corner;
    double domain = 1;
    for (int axis = 0; axis < D; ++axis) {
      const Axis& a = samples_.grid.axes[axis];
      far_corner[axis] = a.increasing() ? a.count - 1 : 0;
      domain *= std::abs(a.coordinate(a.count - 1) - a.coordinate(0));
    }
    std::vector<double> volume(regions_.count());
    volume[regions_.at(far_corner)] = domain;
    for (const SurfacePiece& piece : pieces_) {
      volume[piece.inside] += piece.measure.signed_volume;
      volume[piece.outside] -= piece.measure.signed_volume;
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
    for (std::size_t plane = 0; plane < regions_.planes(); ++plane) {
      for (const auto& band : regions_.bands(plane))
        for (const auto& run : regions_.runs(band))
          for (index[1] = band.begin; index[1] < band.end && wanted_[run.region]; ++index[1]) {
            double row_share = 1;
            for (int axis = 1; axis < D; ++axis)
              row_share *= share_[axis][static_cast<std::size_t>(index[axis])];
            add_run(run, index, row_share, sums[run.region]);
          }
      for (int axis = 2; axis < D && ++index[axis] == samples_.grid.axes[axis].count; ++axis) index[axis] = 0;
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
      const auto value = static_cast<double>(samples_.at(index));
      const double size = row_share * share_[0][static_cast<std::size_t>(index[0])];
      run_size += size;
      sum.mass += size * value;
      sum.minimum = std::min(sum.minimum, value);
      sum.maximum = std::max(sum.maximum, value);
      sum.moment[0] += size * samples_.grid.axes[0].coordinate(index[0]);
    }
    sum.size += run_size;
    for (std::size_t axis = 1; axis < D; ++axis)
      sum.moment[axis] += run_size * samples_.grid.axes[axis].coordinate(index[axis]);
  }

  FieldView<const T, D> samples_;
  std::shared_ptr<const Regions<D>> owned_regions_;
  const Regions<D>& regions_;
  std::array<std::vector<double>, D> share_;
  FeatureRows<D> rows_;
  std::vector<std::vector<Region>> row_regions_;
  std::vector<bool> wanted_; // regions
  std::vector<SurfacePiece> pieces_;
};

} // namespace hyperiso::track_detail
