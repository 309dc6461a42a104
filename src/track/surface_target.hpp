#pragma once
// What is tracked: components of the surface.

#include "track/exact_overlap.hpp"
#include "track/step_features.hpp"
#include "track/surface_steps.hpp"

#include <memory>

namespace hyperiso::track_detail {

template <class T, int D>
class SurfaceTarget {
 public:
  static constexpr int corners = D; // of a simplex of a slab
  struct Rows : StepFeatures<T, D - 1> {
    using StepFeatures<T, D - 1>::StepFeatures;
    std::optional<StepShape<D - 1>> shape; // for exact overlaps

    // Samples are owned by regions, these by rows.
    std::vector<std::uint32_t> owner_of_sample() const {
      std::vector<std::uint32_t> owners;
      for (std::size_t plane = 0; plane < this->regions().planes(); ++plane)
        for (const auto& band : this->regions().bands(plane))
          for (auto row = band.begin; row < band.end; ++row)
            for (const auto& run : this->regions().runs(band))
              owners.insert(owners.end(), static_cast<std::size_t>(run.end - run.begin),
                            this->wanted()[run.region] ? run.region : StepShape<D - 1>::nobody);
      return owners;
    }
    std::size_t owner_count() const { return this->regions().count(); }
    const std::vector<Region>& owners_of(std::size_t row) const { return this->regions_of(row); }
  };

  using Step = typename SurfaceSteps<T, D>::Step;

  SurfaceTarget(double isovalue, const TrackOptions& options)
      : isovalue_(isovalue), extraction_(options.extraction),
        exact_(options.overlap_volumes == OverlapVolumes::exact),
        steps_(isovalue, options.extraction, options.measure_features) {}

  Result<Step> first_step(const FieldView<const T, D - 1>& samples) { return steps_.first_step(samples); }

  auto advance(const FieldView<const T, D>& two_steps, const Step& lower, double lower_time,
               double upper_time) {
    return steps_.advance(SlabSamples<T, D>(two_steps, isovalue_), lower, lower_time, upper_time);
  }

  // The rows of the lower or upper one of two steps, measured into `features`.
  std::unique_ptr<Rows> rows(const FieldView<const T, D>& two_steps, bool upper, const Step& step,
                             const Level<D>& level, std::vector<Feature>& features) const {
    const auto samples = two_steps.at_index(D - 1, upper ? 1 : 0);
    auto rows = std::make_unique<Rows>(samples, isovalue_, step, level);
    features = rows->take_features();
    if (exact_) rows->shape = shape_of(samples, *rows);
    return rows;
  }

  // How much rows of two steps have in common, as a share of the smaller one.
  class Overlap {
   public:
    Overlap(const Rows& before, const Rows& after) : before_(before), after_(after) {
      if (after.shape)
        exact_.emplace(*before.shape, *after.shape);
      else
        cells_.emplace(before.regions(), before.wanted(), after.regions(), after.wanted(), after.share());
    }
    double of(std::size_t before, const Feature& from, std::size_t after, const Feature& to) const {
      double common = 0;
      for (const Region a : before_.regions_of(before))
        for (const Region b : after_.regions_of(after))
          common += exact_ ? exact_->common(a, b) : cells_->of(a, b);
      if (!exact_) return share_of_smaller(common, from.cell_volume, to.cell_volume);
      double first = 0, second = 0;
      for (const Region a : before_.regions_of(before)) first += exact_->first(a);
      for (const Region b : after_.regions_of(after)) second += exact_->second(b);
      return share_of_smaller(common, first, second);
    }

   private:
    const Rows &before_, &after_;
    std::optional<RegionOverlap<D - 1>> cells_;
    std::optional<ExactOverlap<D - 1>> exact_;
  };

 private:
  // What is inside, and the cavities outside that rows enclose.
  StepShape<D - 1> shape_of(const FieldView<const T, D - 1>& step, const Rows& rows) const {
    const bool above = extraction_.inside == Inside::above;
    SimplexPart inside, outside;
    inside.bounds[0] = {isovalue_, above, false};
    outside.bounds[0] = {isovalue_, !above, true};
    return {step, {inside, outside}, rows.owner_of_sample()};
  }

  double isovalue_;
  ExtractOptions extraction_;
  bool exact_; // overlaps
  SurfaceSteps<T, D> steps_;
};

} // namespace hyperiso::track_detail
