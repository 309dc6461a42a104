// Tracking from seeds: the families of a few components, by following the surface from slab to slab in both
// directions of time until no step has a vertex that only one of its slabs knows: cell by cell where that is
// enough (family_trace.hpp), else with the mesh of each slab.

#include "core/cell.hpp"
#include "core/text.hpp"
#include "hyperiso/seeds.hpp"
#include "hyperiso/track.hpp"
#include "track/check_source.hpp"
#include "track/family_trace.hpp"
#include "track/level.hpp"
#include "track/tracks.hpp"

#include <memory>
#include <new>
#include <unordered_set>

namespace hyperiso {
namespace {

using namespace track_detail;

template <class T, int D>
class LocalRun {
 public:
  LocalRun(StepSource& source, double isovalue, const TrackOptions& options)
      : source_(source), isovalue_(isovalue), extraction_(options.extraction),
        builder_(result_.graph, options.extraction.progress) {
    result_.graph.axes = source.info().axes;
    result_.graph.steps = result_.graph.axes.back().count;
    result_.graph.isovalue = isovalue;
    extraction_.keep_edges = true;
    extraction_.precision = Precision::f32;
    extraction_.progress = {};
  }

  Result<LocalTracking> run(const std::vector<std::vector<std::int64_t>>& cells) {
    for (const auto& cell : cells) {
      if (cell.size() != D)
        return Error{Code::invalid_argument,
                     text("a seed cell needs ", D, " indices; one has ", cell.size())};
      if (cell[D - 1] < 0 || cell[D - 1] > result_.graph.steps - 2)
        return Error{Code::outside_domain, text("a seed cell begins at step ", cell[D - 1],
                                                "; cells begin at steps 0 to ", result_.graph.steps - 2)};
      std::array<std::int64_t, D> in_slab;
      std::copy(cell.begin(), cell.end(), in_slab.begin());
      in_slab[D - 1] = 0;
      pending_[cell[D - 1]].cells.push_back(in_slab);
    }
    auto quick = run_cell_by_cell(cells);
    if (!quick) return quick.error();
    if (!*quick) {
      if (const Status followed = follow(); !followed) return followed.error();
      if (const Status swept = sweep(); !swept) return swept.error();
    }
    assign_tracks(result_.graph);
    return std::move(result_);
  }

 private:
  struct SlabTrace {
    Seeds<D> seeds;
    Field steps; // keeps the samples
    std::optional<Slab<D>> slab;
    std::unordered_set<GridEdge> lower, upper; // edges within the steps, numbered as within a lower step
  };

  // Where no sample is missing and none near the family makes ties. False, and nothing done, if not so.
  Result<bool> run_cell_by_cell(const std::vector<std::vector<std::int64_t>>& cells) {
    if (extraction_.method == Method::simplicial) return false;
    FamilyTrace<T, D> trace(source_, isovalue_, extraction_);
    for (const auto& cell : cells) {
      for (std::size_t axis = 0; axis < D; ++axis)
        if (cell[axis] < 0 || cell[axis] > result_.graph.axes[axis].count - 2) return false;
      auto added = trace.add_cell(cell);
      if (!added || !*added) return added;
    }
    auto followed = trace.follow();
    if (!followed || !*followed) return followed;

    const auto [begin, end] = trace.slabs();
    std::map<std::int64_t, typename FamilyTrace<T, D>::Made> made;
    for (std::int64_t number = begin; number < end; ++number) {
      made.emplace(number, trace.make(number, time(number), time(number + 1)));
      if (!made.at(number).sweep) return false;
    }
    const auto nothing = std::make_shared<const StepPieces>(std::vector<GridEdge>(),
                                                            std::vector<std::uint32_t>(), GridEdge{1}, D - 1);
    pass_slabs(
        begin, end,
        [&](std::int64_t number) {
          const auto found = made.find(number);
          return found != made.end() ? std::move(found->second.sweep) : sweep_of(number, Slab<D>());
        },
        [&](std::int64_t step) {
          const auto found = made.find(step);
          if (found != made.end()) return found->second.pieces;
          const bool is_last = step == result_.graph.steps - 1 && made.contains(step - 1);
          return is_last ? made.at(step - 1).upper_pieces : nothing;
        });
    result_.samples = trace.samples();
    return true;
  }

  double time(std::int64_t step) const { return result_.graph.axes.back().coordinate(step); }
  FieldView<const T, D> view(const SlabTrace& trace) const { return trace.steps.template view<T, D>(); }

  // Traces slabs until the neighbours of each know all it has at their common step.
  Status follow() {
    while (!pending_.empty()) {
      const std::int64_t number = pending_.begin()->first;
      SlabTrace& trace = traces_[number];
      Seeds<D> seeds = std::move(pending_.begin()->second);
      pending_.erase(pending_.begin());
      trace.seeds.cells.insert(trace.seeds.cells.end(), seeds.cells.begin(), seeds.cells.end());
      trace.seeds.pairs.insert(trace.seeds.pairs.end(), seeds.pairs.begin(), seeds.pairs.end());
      if (const Status traced = trace_slab(number, trace); !traced) return traced;
      if (number > 0) ask_neighbour(number, number - 1, trace.lower);
      if (number < result_.graph.steps - 2) ask_neighbour(number, number + 1, trace.upper);
    }
    return {};
  }

  Status trace_slab(std::int64_t number, SlabTrace& trace) {
    if (!trace.steps.samples) {
      auto steps = source_.read(number, number + 2);
      if (!steps) return steps.error();
      trace.steps = std::move(*steps);
    }
    const SlabSamples<T, D> samples(view(trace), isovalue_);
    auto traced = extract_from_seeds(samples.field(), isovalue_, trace.seeds, extraction_);
    if (!traced) return traced.error();
    result_.samples += traced->samples;
    const bool missing = is_near_missing(samples.field(), traced->mesh);
    auto slab = make_slab(samples, std::move(traced->mesh), missing);
    if (!slab) return slab.error();
    trace.slab = std::move(*slab);
    for (Vertex vertex = 0; vertex < trace.slab->vertex_count(); ++vertex) {
      if (!trace.slab->in_step(vertex)) continue;
      const GridEdge edge = trace.slab->edge(vertex);
      if (edge < trace.slab->step_offset)
        trace.lower.insert(edge);
      else
        trace.upper.insert(edge - trace.slab->step_offset);
    }
    return {};
  }

  // Seeds for what the other slab does not know at the common step.
  void ask_neighbour(std::int64_t number, std::int64_t other, const std::unordered_set<GridEdge>& edges) {
    const auto known = traces_.find(other);
    const FieldView<const T, D> field = view(traces_.at(number));
    for (const GridEdge edge : edges) {
      if (known != traces_.end() &&
          (other > number ? known->second.lower : known->second.upper).contains(edge))
        continue;
      auto ends = grid_edge_ends<D>(field.dims(), edge);
      if (is_cut_off(other, ends)) continue;
      ends.lower[D - 1] = ends.upper[D - 1] = other > number ? 0 : 1;
      pending_[other].pairs.emplace_back(ends.lower, ends.upper);
    }
  }
  // Missing samples may leave an edge without a cell on the other side of its step.
  bool is_cut_off(std::int64_t other, const GridEdgeEnds<D>& ends) {
    if constexpr (!std::is_floating_point_v<T>) return false;
    SlabTrace& trace = traces_[other];
    if (!trace.steps.samples) {
      auto steps = source_.read(other, other + 2);
      if (!steps) return true;
      trace.steps = std::move(*steps);
    }
    const FieldView<const T, D> field = view(trace);
    std::array<std::int64_t, D> cell;
    for (unsigned around = 0; around < 1u << (D - 1); ++around) {
      bool exists = true;
      for (int axis = 0; axis < D - 1; ++axis) {
        const bool along = ends.direction >> axis & 1;
        cell[axis] = ends.lower[axis] - (!along && (around >> axis & 1));
        exists &= cell[axis] >= 0 && cell[axis] <= field.dims()[axis] - 2 && !(along && (around >> axis & 1));
      }
      cell[D - 1] = 0;
      if (exists && !has_missing_corner(field, cell)) return false;
    }
    return true;
  }
  static bool has_missing_corner(const FieldView<const T, D>& field,
                                 const std::array<std::int64_t, D>& cell) {
    for (unsigned corner = 0; corner < 1u << D; ++corner)
      if (is_missing(field.at(corner_of(cell, corner)))) return true;
    return false;
  }

  // Whether a sample of a cell around a vertex is missing.
  static bool is_near_missing(const FieldView<const T, D>& field, const Mesh& mesh) {
    if constexpr (!std::is_floating_point_v<T>) return false;
    const auto dims = field.dims();
    for (const GridEdge edge : mesh.edges) {
      const auto ends = grid_edge_ends<D>(dims, edge);
      std::array<std::int64_t, D> first, last, index;
      for (int axis = 0; axis < D; ++axis) {
        first[axis] = std::max<std::int64_t>(ends.lower[axis] - 1, 0);
        last[axis] = std::min(ends.upper[axis] + 1, dims[axis] - 1);
      }
      for (index = first;;) {
        if (is_missing(field.at(index))) return true;
        int axis = 0;
        while (axis < D && ++index[axis] > last[axis]) index[axis] = first[axis], ++axis;
        if (axis == D) break;
      }
    }
    return false;
  }

  // As `track` does, with slabs that hold the families only; empty ones where these begin and end.
  Status sweep() {
    std::erase_if(traces_, [](const auto& entry) { return !entry.second.slab; });
    if (traces_.empty()) return {};
    const auto pieces_are_not_known = [](std::int64_t) { return std::shared_ptr<const StepPieces>(); };
    pass_slabs(
        traces_.begin()->first, traces_.rbegin()->first + 1,
        [&](std::int64_t number) {
          const auto trace = traces_.find(number);
          if (trace != traces_.end()) return sweep_of(number, *std::move(trace->second.slab));
          Slab<D> empty;
          empty.has_missing = true; // beside missing samples a family may end at a step that it reaches
          return sweep_of(number, std::move(empty));
        },
        pieces_are_not_known);
    return {};
  }

  std::unique_ptr<Sweep<D>> sweep_of(std::int64_t number, Slab<D> slab) const {
    return std::make_unique<Sweep<D>>(std::move(slab), time(number), time(number + 1));
  }

  // Goes through the slabs [begin, end) of the families, with one that is empty before them and one after, as
  // `track` does through all. `make_sweep` is asked for each slab, `pieces_at` for the pieces of the surface
  // at each step.
  void pass_slabs(std::int64_t begin, std::int64_t end, const auto& make_sweep, const auto& pieces_at) {
    const std::int64_t first = std::max<std::int64_t>(begin - 1, 0),
                       last = std::min(end, result_.graph.steps - 2);
    std::unique_ptr<Sweep<D>> lower;
    for (std::int64_t number = first; number <= last; ++number) {
      std::unique_ptr<Sweep<D>> upper = make_sweep(number);
      if (lower || number == 0)
        Level<D>(lower.get(), upper.get(), pieces_at(number)).resolve(time(number), builder_);
      upper->run(builder_);
      lower = std::move(upper);
    }
    if (last == result_.graph.steps - 2)
      Level<D>(lower.get(), nullptr, pieces_at(last + 1)).resolve(time(last + 1), builder_);
  }

  StepSource& source_;
  double isovalue_;
  ExtractOptions extraction_;
  LocalTracking result_;
  GraphBuilder builder_;
  std::map<std::int64_t, Seeds<D>> pending_; // of slabs to trace
  std::map<std::int64_t, SlabTrace> traces_;
};

} // namespace

Result<LocalTracking> track_from_seeds(StepSource& source, double isovalue,
                                       const std::vector<std::vector<std::int64_t>>& cells,
                                       const TrackOptions& options) {
  const FieldInfo& info = source.info();
  if (const Status valid = check_source(info, options.extraction.method); !valid) return valid.error();
  if (options.tracked == Tracked::region)
    return Error{Code::invalid_argument, "from seeds surfaces are tracked, not regions"};
  if (const Status valid = check_tracked(isovalue, options); !valid) return valid.error();
  try {
    return visit_sample_type(info.type, [&]<class T>(T) -> Result<LocalTracking> {
      if (info.dimension() == 3) return LocalRun<T, 3>(source, isovalue, options).run(cells);
      return LocalRun<T, 4>(source, isovalue, options).run(cells);
    });
  } catch (const TrackingCancelled&) {
    return Error{Code::cancelled, "tracking was cancelled"};
  } catch (const std::bad_alloc&) {
    return Error{Code::out_of_memory, "not enough memory to track"};
  }
}

} // namespace hyperiso
