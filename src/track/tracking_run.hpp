#pragma once
// Tracking from the first step to the last: what track.cpp tells of, in order.

#include "track/graph_builder.hpp"
#include "track/level.hpp"
#include "track/links.hpp"
#include "track/step_window.hpp"
#include "track/tracks.hpp"
#include "track/with_fields.hpp"

#include <memory>

namespace hyperiso::track_detail {

template <class T, int D, template <class, int> class TargetOf>
class TrackingRun {
  using Target = TargetOf<T, D>; // the surface or a region
  using Rows = typename Target::Rows;
  static constexpr int C = Target::corners;

 public:
  TrackingRun(StepSource& source, double isovalue, const TrackOptions& options)
      : options_(options), target_(isovalue, options), window_(source),
        builder_(graph_, options.extraction.progress), links_(graph_) {
    graph_.axes = source.info().axes;
    graph_.steps = graph_.axes.back().count;
    graph_.tracked = options.tracked;
    graph_.isovalue = isovalue;
    graph_.upper_isovalue = options.upper_isovalue;
    for (const FieldBeside& field : options.with) graph_.with.push_back(field.name);
  }

  Result<TrackingGraph> run() {
    if (const Status read = window_.read(0); !read) return read.error();
    auto first = target_.first_step(window_.step());
    if (!first) return first.error();
    step_ = std::move(*first);
    std::unique_ptr<Sweep<C>> lower;
    for (std::int64_t step = 0; step + 1 < graph_.steps; ++step) {
      if (const Status read = window_.read(step + 1); !read) return read.error();
      auto next = target_.advance(window_.slab(), step_, time(step), time(step + 1));
      if (!next) return next.error();
      builder_.tell_progress(time(step));
      std::unique_ptr<Sweep<C>> upper = std::move(next->between);
      if (const Status passed = pass_step(step, lower.get(), upper.get()); !passed) return passed.error();
      upper->run(builder_);
      lower = std::move(upper);
      step_ = std::move(next->step);
      builder_.tell_progress(time(step + 1));
    }
    if (const Status passed = pass_step(graph_.steps - 1, lower.get(), nullptr); !passed)
      return passed.error();
    assign_tracks(graph_);
    return std::move(graph_);
  }

 private:
  double time(std::int64_t step) const { return graph_.axes.back().coordinate(step); }

  Status pass_step(std::int64_t step, Sweep<C>* lower, Sweep<C>* upper) {
    Level<C> level(lower, upper, step_.pieces());
    links_.pass_events();
    level.resolve(time(step), builder_);
    if (!options_.measure_features) return {};

    const bool last = !upper;
    std::vector<Feature> features;
    std::unique_ptr<Rows> rows = target_.rows(window_.slab(), last, step_, level, features);
    for (const FieldBeside& field : options_.with)
      if (const Status added = add_with(*field.source, step, *rows, features); !added) return added;
    add_features(step, std::move(features));
    auto& pieces = graph_.pieces.emplace_back();
    for (const auto& piece : rows->pieces())
      if (piece.row != SIZE_MAX)
        pieces.push_back({piece.first_edge, first_row_ + static_cast<std::int64_t>(piece.row)});
    add_links(level, *rows);
    links_.restart();
    for (std::size_t component = 0; component < level.outcomes().size(); ++component)
      if (rows->row_of(component) != SIZE_MAX)
        for (const std::int64_t arc : level.arcs_out(component))
          links_.start(arc, first_row_ + static_cast<std::int64_t>(rows->row_of(component)));
    rows_before_ = std::move(rows);
    return {};
  }

  static Status add_with(StepSource& source, std::int64_t step, const Rows& rows,
                         std::vector<Feature>& features) {
    const auto sums = sums_by_owner(source, step, rows.owner_of_sample(), rows.owner_count());
    if (!sums) return sums.error();
    for (std::size_t row = 0; row < features.size(); ++row) {
      FieldSum& sum = features[row].with.emplace_back();
      for (const auto owner : rows.owners_of(row)) add(sum, (*sums)[owner]);
    }
    return {};
  }

  void add_features(std::int64_t step, std::vector<Feature> features) {
    first_row_before_ = first_row_;
    first_row_ = static_cast<std::int64_t>(graph_.features.size());
    for (Feature& feature : features) {
      feature.step = step;
      feature.time = time(step);
      graph_.features.push_back(std::move(feature));
    }
  }

  // Paper 003 section 3.3, for the rows of the last step that each row of this one comes from.
  void add_links(const Level<C>& level, const Rows& rows) {
    if (!rows_before_) return;
    const typename Target::Overlap overlap(*rows_before_, rows);
    for (std::size_t component = 0; component < level.outcomes().size(); ++component) {
      const std::size_t row = rows.row_of(component);
      if (row == SIZE_MAX) continue;
      for (const std::int64_t from : links_.sources(level.arcs_in(component))) {
        FeatureLink link{from, first_row_ + static_cast<std::int64_t>(row)};
        link.overlap = overlap.of(static_cast<std::size_t>(from - first_row_before_), feature(from), row,
                                  feature(link.to));
        link.weak = options_.overlap_threshold && link.overlap <= *options_.overlap_threshold;
        graph_.links.push_back(link);
      }
    }
  }
  const Feature& feature(std::int64_t number) const {
    return graph_.features[static_cast<std::size_t>(number)];
  }

  const TrackOptions& options_;
  Target target_;
  StepWindow<T, D> window_;
  typename Target::Step step_; // that is passed next
  TrackingGraph graph_;
  GraphBuilder builder_;
  LinkTracer links_;
  std::unique_ptr<Rows> rows_before_; // of the last step
  std::int64_t first_row_ = 0, first_row_before_ = 0;
};

// The two targets, each compiled in a file of its own.
Result<TrackingGraph> track_surface(StepSource& source, double isovalue, const TrackOptions& options);
Result<TrackingGraph> track_region(StepSource& source, double isovalue, const TrackOptions& options);

// Requires a source that `check_source` lets pass.
template <template <class, int> class TargetOf>
Result<TrackingGraph> run_tracking(StepSource& source, double isovalue, const TrackOptions& options) {
  return visit_sample_type(source.info().type, [&]<class T>(T) -> Result<TrackingGraph> {
    if (source.info().dimension() == 3) return TrackingRun<T, 3, TargetOf>(source, isovalue, options).run();
    return TrackingRun<T, 4, TargetOf>(source, isovalue, options).run();
  });
}

} // namespace hyperiso::track_detail
