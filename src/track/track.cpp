// Tracking: the Reeb graph of time on the isosurface M in space and time, slab by slab (docs/tracking.md).
//
// surface_steps.hpp makes, for each step:
//   step_mask.hpp     which samples are inside, in bits
//   step_pieces.hpp   the connected pieces of the surface there
// and for each slab, which is what lies between two steps:
//   crossings.hpp     the vertices strictly inside it, each with its time, a fraction of the step: the
//                     weight of its crossing, so that equal samples give equal times and only vertices on a
//                     step have 0 or 1
//   candidates.hpp    those of them that tables of cells (cell_links.hpp) do not tell to be regular
//   slab.hpp          the slab's part of M, which unfolds from the signs (signed_cells.hpp) where something
//                     asks for it; or all of it, where samples are missing or equal the isovalue
// Then, in order of time:
//   level.hpp         decides the nodes at the step where the slab begins, from the closed level set of that
//                     time: which arcs of the slab before reach each of its pieces, which strands of this
//                     one leave it
//   sweep.hpp         passes the candidates in order of time and decides the nodes there
//     link_test.hpp     whether one is regular, in bits
//     side.hpp          the slices just before and after a cluster of vertices with one time: their pieces,
//                       their Euler characteristic
//     slice_search.hpp  whether several places of a slice are connected, and how many boundary curves pass
//                       some
//   graph_builder.hpp collects events and arcs
//   step_features.hpp measures the components at the step, on regions of samples (regions.hpp)
//   links.hpp         says which rows of the last step each row comes from, for overlaps
// After the last step:
//   tracks.hpp        names what goes on through events
//
// A strand is a component of the slices within one slab, an arc one from node to node; a strand has an arc,
// and at a step an arc goes on to a strand of the next slab. Nothing compares times or places with a
// tolerance: a node is what is connected at exactly its time.

#include "hyperiso/track.hpp"

#include "track/check_source.hpp"
#include "track/level.hpp"
#include "track/links.hpp"
#include "track/step_features.hpp"
#include "track/step_window.hpp"
#include "track/surface_steps.hpp"
#include "track/tracks.hpp"

#include <memory>
#include <new>

namespace hyperiso {
namespace {

using namespace track_detail;

template <class T, int D>
class TrackingRun {
 public:
  TrackingRun(StepSource& source, double isovalue, const TrackOptions& options)
      : options_(options), isovalue_(isovalue), window_(source), steps_(isovalue, options.extraction),
        builder_(graph_), links_(graph_) {
    graph_.axes = source.info().axes;
    graph_.steps = graph_.axes.back().count;
    graph_.isovalue = isovalue;
  }

  Result<TrackingGraph> run() {
    std::unique_ptr<Sweep<D>> lower;
    if (const Status read = read_step(0); !read) return read.error();
    for (std::int64_t step = 0; step + 1 < graph_.steps; ++step) {
      if (const Status read = read_step(step + 1); !read) return read.error();
      const SlabSamples<T, D> samples(window_.slab(step), isovalue_);
      auto made = steps_.between(samples, this_step_, next_step_, time(step), time(step + 1));
      if (!made) return made.error();
      std::unique_ptr<Sweep<D>> upper = std::move(*made);
      if (const Status passed = pass_step(step, lower.get(), upper.get()); !passed) return passed.error();
      upper->run(builder_);
      lower = std::move(upper);
      if (options_.extraction.progress &&
          !options_.extraction.progress(static_cast<double>(step + 1) /
                                        static_cast<double>(graph_.steps - 1)))
        return Error{Code::cancelled, "tracking was cancelled"};
    }
    this_step_ = next_step_;
    if (const Status passed = pass_step(graph_.steps - 1, lower.get(), nullptr); !passed)
      return passed.error();
    assign_tracks(graph_);
    return std::move(graph_);
  }

 private:
  double time(std::int64_t step) const { return graph_.axes.back().coordinate(step); }

  Status read_step(std::int64_t step) {
    this_step_ = std::move(next_step_);
    if (const Status read = window_.read(step); !read) return read;
    auto made = steps_.step(window_.step(step));
    if (!made) return made.error();
    next_step_ = std::move(*made);
    return {};
  }

  using StepRows = StepFeatures<T, D - 1>;

  Status pass_step(std::int64_t step, Sweep<D>* lower, Sweep<D>* upper) {
    Level<D> level(lower, upper, this_step_.pieces());
    links_.pass_events();
    level.resolve(time(step), builder_);
    if (!options_.measure_features) return {};

    const bool last = !upper;
    const SlabSamples<T, D> samples(window_.slab(last ? step - 1 : step), isovalue_);
    const auto view = samples.field().at_index(D - 1, last ? 1 : 0);
    auto rows =
        std::make_unique<StepRows>(view, *this_step_.mask, samples, last, options_.extraction.method, level);
    add_features(step, rows->measure(this_step_.surface->mesh, this_step_.surface->pieces, level));
    auto& pieces = graph_.pieces.emplace_back();
    for (const SurfacePiece& piece : rows->pieces())
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
  void add_links(const Level<D>& level, const StepRows& rows) {
    if (!rows_before_) return;
    const RegionOverlap<D - 1> overlap(rows_before_->regions(), rows_before_->wanted(), rows.regions(),
                                       rows.wanted(), rows.share());
    for (std::size_t component = 0; component < level.outcomes().size(); ++component) {
      const std::size_t row = rows.row_of(component);
      if (row == SIZE_MAX) continue;
      for (const std::int64_t from : links_.sources(level.arcs_in(component))) {
        FeatureLink link{from, first_row_ + static_cast<std::int64_t>(row)};
        double common = 0;
        for (const Region a : rows_before_->regions_of(static_cast<std::size_t>(from - first_row_before_)))
          for (const Region b : rows.regions_of(row)) common += overlap.of(a, b);
        link.overlap = common / std::min(feature(from).cell_volume, feature(link.to).cell_volume);
        link.weak = options_.overlap_threshold && link.overlap <= *options_.overlap_threshold;
        graph_.links.push_back(link);
      }
    }
  }
  const Feature& feature(std::int64_t number) const {
    return graph_.features[static_cast<std::size_t>(number)];
  }

  const TrackOptions& options_;
  double isovalue_;
  StepWindow<T, D> window_;
  SurfaceSteps<T, D> steps_;
  typename SurfaceSteps<T, D>::Step this_step_, next_step_;
  TrackingGraph graph_;
  GraphBuilder builder_;
  LinkTracer links_;
  std::unique_ptr<StepRows> rows_before_; // of the last step
  std::int64_t first_row_ = 0, first_row_before_ = 0;
};

} // namespace

const char* name_of(EventType type) {
  constexpr const char* names[] = {"birth", "death", "merge", "split",      "compound", "genus",
                                   "enter", "exit",  "touch", "open_start", "open_end"};
  return names[static_cast<std::size_t>(type)];
}

Result<TrackingGraph> track(StepSource& source, double isovalue, const TrackOptions& options) {
  const FieldInfo& info = source.info();
  if (const Status valid = check_source(info, options.extraction.method); !valid) return valid.error();
  try {
    return visit_sample_type(info.type, [&]<class T>(T) -> Result<TrackingGraph> {
      if (info.dimension() == 3) return TrackingRun<T, 3>(source, isovalue, options).run();
      return TrackingRun<T, 4>(source, isovalue, options).run();
    });
  } catch (const std::bad_alloc&) {
    return Error{Code::out_of_memory, "not enough memory to track"};
  }
}

} // namespace hyperiso
