#pragma once
// The surface at each step and between two of them, as tracking takes it.

#include "core/parallel.hpp"
#include "extract/extract_with.hpp"
#include "track/candidates.hpp"
#include "track/regions.hpp"
#include "track/surface_measure.hpp"
#include "track/sweep.hpp"

namespace hyperiso::track_detail {

// The surface at a step, and its pieces; measured by pieces if that is wanted and no sample is missing.
template <int S>
struct StepSurface {
  StepSurface(SimplexMesh<S>&& mesh_, GridEdge row_length)
      : mesh(std::move(mesh_)), pieces(mesh, row_length) {}
  StepSurface(const StepSurface&) = delete; // the pieces refer to the mesh
  SimplexMesh<S> mesh;
  StepPieces pieces;
  std::optional<SurfaceMeasure<S>> measure;
};

template <class T, int D>
class SurfaceSteps {
 public:
  struct Step {
    std::shared_ptr<const StepMask> mask;
    std::shared_ptr<const StepSurface<D - 1>> surface;
    std::shared_ptr<const Regions<D - 1>> regions; // if features are wanted

    std::shared_ptr<const StepPieces> pieces() const { return {surface, &surface->pieces}; }
  };
  // A step, and what lies between the one before and it.
  struct Advance {
    Step step;
    std::unique_ptr<Sweep<D>> between;
  };

  SurfaceSteps(double isovalue, const ExtractOptions& options, bool wants_features)
      : isovalue_(isovalue), options_(options), wants_features_(wants_features) {
    options_.keep_edges = true;
    options_.progress = {};
    if (options_.method != Method::simplicial) {
      table_ = &march_table<D>(options_.method, {});
      candidates_.emplace(options_.method);
    }
  }

  Result<Step> first_step(const FieldView<const T, D - 1>& samples) {
    Step step{mask_of(samples), {}, {}};
    Status surface;
    run_tasks(
        threads(), [&] { surface = add_surface(samples, step); }, [&] { add_regions(samples, step); });
    if (!surface) return surface.error();
    return step;
  }

  // Where vertices only come close to the steps but do not lie on them, and no sample is missing, little of
  // what lies between has to be looked at; elsewhere all of it is.
  Result<Advance> advance(const SlabSamples<T, D>& slab, const Step& lower, double lower_time,
                          double upper_time) {
    const auto samples = slab.field().at_index(D - 1, 1);
    Step upper{mask_of(samples), {}, {}};
    const bool has_missing = lower.mask->has_missing() || upper.mask->has_missing();
    std::optional<Crossings<D>> crossings;
    std::optional<std::vector<GridEdge>> candidates;
    Status surface;
    run_tasks(
        threads(), [&] { surface = add_surface(samples, upper); },
        [&] {
          if (!candidates_ || has_missing) return;
          crossings.emplace(slab.field(), isovalue_, lower.mask, upper.mask);
          candidates = candidates_->find(*crossings);
        },
        [&] { add_regions(samples, upper); });
    if (!surface) return surface.error();
    if (crossings && !crossings->has_ties()) {
      Slab<D> part(std::make_unique<MaskedCells<D>>(*table_, std::move(*crossings)));
      describe(part, slab);
      return Advance{std::move(upper), std::make_unique<Sweep<D>>(std::move(part), lower_time, upper_time,
                                                                  lower.pieces(), std::move(*candidates))};
    }
    ExtractOptions options = options_;
    options.precision = Precision::f32; // of positions that nobody reads
    auto mesh = extract(slab.field(), isovalue_, options);
    if (!mesh) return mesh.error();
    auto whole = make_slab(slab, std::move(*mesh), has_missing);
    if (!whole) return whole.error();
    return Advance{std::move(upper), std::make_unique<Sweep<D>>(std::move(*whole), lower_time, upper_time,
                                                                std::move(candidates))};
  }

 private:
  int threads() const { return worker_count(options_.threads); }

  std::shared_ptr<const StepMask> mask_of(const FieldView<const T, D - 1>& samples) const {
    return std::make_shared<const StepMask>(samples, isovalue_, options_.inside, threads());
  }
  Status add_surface(const FieldView<const T, D - 1>& samples, Step& step) {
    ExtractOptions options = options_;
    options.precision = Precision::f64;
    options.workspace = &workspace_;
    options.threads = std::max(1, threads() - 1); // others are busy beside it
    EngineOptions with_masks;
    if (!step.mask->has_missing()) with_masks.given_masks = {step.mask->row(0), step.mask->uniform()};
    SimplexMesh<D - 1> mesh;
    if (Status status = extract_with(samples, isovalue_, options, with_masks, mesh); !status) return status;
    if (mesh.vertex_count() > UINT32_MAX)
      return Error{Code::out_of_memory, "the surface at a step has more than 2^32 vertices"};
    auto surface =
        std::make_shared<StepSurface<D - 1>>(std::move(mesh), static_cast<GridEdge>(samples.dims()[0]));
    if (wants_features_ && !step.mask->has_missing())
      surface->measure =
          SurfaceMeter<T, D - 1>(samples, *step.mask, isovalue_, surface->mesh, surface->pieces).by_pieces();
    step.surface = std::move(surface);
    return {};
  }
  void add_regions(const FieldView<const T, D - 1>& samples, Step& step) const {
    if (wants_features_)
      step.regions = std::make_shared<const Regions<D - 1>>(samples, *step.mask, options_.method);
  }

  double isovalue_;
  ExtractOptions options_;
  bool wants_features_;
  Workspace workspace_; // of the surfaces at steps
  const MarchTable<D>* table_ = nullptr;
  std::optional<CandidateSearch<D>> candidates_;
};

} // namespace hyperiso::track_detail
