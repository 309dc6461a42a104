#pragma once
// What the measuring of surfaces and of regions at a step shares: the rows of its components.

#include "hyperiso/track.hpp"
#include "track/level.hpp"

#include <cstdint>
#include <limits>
#include <vector>

namespace hyperiso::track_detail {

// The rows of a step, nothing measured yet: one for each component of the level that is a track's.
template <int D> // of space
class FeatureRows {
 public:
  FeatureRows() = default;
  template <int C>
  explicit FeatureRows(const Level<C>& level) {
    for (const auto& outcome : level.outcomes()) {
      const bool is_row = outcome.arc >= 0 || outcome.event >= 0;
      row_of_component_.push_back(is_row ? features.size() : SIZE_MAX);
      if (!is_row) continue;
      Feature& feature = features.emplace_back();
      feature.arc = outcome.arc;
      feature.event = outcome.event;
      feature.low.assign(D, std::numeric_limits<double>::infinity());
      feature.high.assign(D, -std::numeric_limits<double>::infinity());
      feature.centroid.assign(D, 0.0);
      feature.minimum = std::numeric_limits<double>::infinity();
      feature.maximum = -std::numeric_limits<double>::infinity();
    }
    count_ = features.size();
  }

  // Rows without a surface at the step, where samples equal the isovalue: they are where their level is.
  template <int C>
  void place_what_is_not_there(const Level<C>& level) {
    for (std::size_t component = 0; component < row_of_component_.size(); ++component) {
      const std::size_t row = row_of_component_[component];
      if (row == SIZE_MAX || features[row].low[0] <= features[row].high[0]) continue;
      const auto& middle = level.outcomes()[component].middle;
      features[row].centroid = features[row].low = features[row].high = middle;
    }
  }

  std::size_t count() const { return count_; }
  // The row of each component of the level, or SIZE_MAX.
  std::size_t row_of(std::size_t component) const { return row_of_component_[component]; }

  std::vector<Feature> features; // of each row

 private:
  std::vector<std::size_t> row_of_component_;
  std::size_t count_ = 0;
};

} // namespace hyperiso::track_detail
