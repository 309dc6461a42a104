#pragma once
// What is tracked: components of the inside of a surface, or of the volume between two levels.

#include "track/exact_overlap.hpp"
#include "track/region_features.hpp"
#include "track/surface_steps.hpp"

#include <map>
#include <memory>

namespace hyperiso::track_detail {

template <class T, int D>
class RegionTarget {
 public:
  static constexpr int corners = D + 1; // of a simplex of a slab
  struct Rows : RegionFeatures<T, D - 1> {
    using RegionFeatures<T, D - 1>::RegionFeatures;
    std::optional<StepShape<D - 1>> shape; // for exact overlaps

    // Rows own their samples.
    const std::vector<std::uint32_t>& owner_of_sample() const { return this->row_of_sample(); }
    std::size_t owner_count() const { return this->row_count(); }
    std::array<std::size_t, 1> owners_of(std::size_t row) const { return {row}; }
  };

  struct Step {
    std::shared_ptr<const StepSurface<D>> region; // its mesh lies on D - 1 axes of space and the levels
    bool has_missing = false;

    std::shared_ptr<const StepPieces> pieces() const { return {region, &region->pieces}; }
  };

  RegionTarget(double isovalue, const TrackOptions& options)
      : levels_(region_levels(isovalue, options.upper_isovalue, options.extraction.inside)),
        extraction_(options.extraction), exact_(options.overlap_volumes == OverlapVolumes::exact) {
    extraction_.keep_edges = true;
    extraction_.precision = Precision::f32; // of positions that nobody reads
    extraction_.progress = {};
  }

  struct Advance { // a step, and what lies between the one before and it
    Step step;
    std::unique_ptr<Sweep<D + 1>> between;
  };

  Result<Step> first_step(const FieldView<const T, D - 1>& samples) const {
    auto mesh = mesh_region(samples, levels_, extraction_);
    if (!mesh) return mesh.error();
    const StepMask mask(samples, levels_.first, levels_.inside);
    return Step{
        std::make_shared<const StepSurface<D>>(std::move(*mesh), static_cast<GridEdge>(samples.dims()[0])),
        mask.has_missing()};
  }

  Result<Advance> advance(const FieldView<const T, D>& two_steps, const Step& lower, double lower_time,
                          double upper_time) const {
    auto upper = first_step(two_steps.at_index(D - 1, 1));
    if (!upper) return upper.error();
    const auto mesh = mesh_region(two_steps, levels_, extraction_);
    if (!mesh) return mesh.error();
    auto slab = make_region_slab(RegionSlabSamples<T, D>(two_steps, levels_), *mesh,
                                 lower.has_missing || upper->has_missing);
    if (!slab) return slab.error();
    return Advance{std::move(*upper),
                   std::make_unique<Sweep<D + 1>>(std::move(*slab), lower_time, upper_time)};
  }

  // The rows of the lower or upper one of two steps, measured into `features`.
  std::unique_ptr<Rows> rows(const FieldView<const T, D>& two_steps, bool upper, const Step& step,
                             const Level<D + 1>& level, std::vector<Feature>& features) const {
    const auto samples = two_steps.at_index(D - 1, upper ? 1 : 0);
    auto rows = std::make_unique<Rows>(samples, levels_, extraction_.method);
    features = rows->measure({step.region, &step.region->mesh}, step.region->pieces, level);
    if (exact_) rows->shape = shape_of(samples, *rows);
    return rows;
  }

  // How much rows of two steps have in common, as a share of the smaller one.
  class Overlap {
   public:
    Overlap(const Rows& before, const Rows& after) {
      if (after.shape) {
        exact_.emplace(*before.shape, *after.shape);
        return;
      }
      std::array<std::int64_t, D - 1> index{};
      for (std::size_t sample = 0; sample < before.row_of_sample().size(); ++sample) {
        const std::uint32_t a = before.row_of_sample()[sample], b = after.row_of_sample()[sample];
        if (a != Rows::none && b != Rows::none) sizes_[{a, b}] += after.share_of(index);
        for (std::size_t axis = 0; axis + 1 < D && ++index[axis] == after.dims()[axis]; ++axis)
          index[axis] = 0;
      }
    }
    double of(std::size_t before, const Feature& from, std::size_t after, const Feature& to) const {
      if (exact_) {
        const auto a = static_cast<std::uint32_t>(before), b = static_cast<std::uint32_t>(after);
        return share_of_smaller(exact_->common(a, b), exact_->first(a), exact_->second(b));
      }
      const auto found = sizes_.find({before, after});
      return share_of_smaller(found == sizes_.end() ? 0 : found->second, from.cell_volume, to.cell_volume);
    }

   private:
    std::optional<ExactOverlap<D - 1>> exact_;
    std::map<std::pair<std::size_t, std::size_t>, double> sizes_;
  };

 private:
  StepShape<D - 1> shape_of(const FieldView<const T, D - 1>& step, const Rows& rows) const {
    const bool above = levels_.inside == Inside::above;
    SimplexPart part;
    part.bounds[0] = {levels_.first, above, false};
    if (levels_.second) {
      part.bounds[1] = {*levels_.second, !above, true};
      part.count = 2;
    }
    StepShape<D - 1> shape(step, {part}, rows.row_of_sample());
    if (levels_.second)
      shape.owner_between = [&rows](const auto& a, const auto& b) { return rows.row_between(a, b); };
    return shape;
  }

  RegionLevels levels_;
  ExtractOptions extraction_;
  bool exact_; // overlaps
};

} // namespace hyperiso::track_detail
