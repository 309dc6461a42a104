#pragma once
// The surface at each step and between two of them, as tracking takes it.

#include "extract/extract_with.hpp"
#include "track/candidates.hpp"
#include "track/sweep.hpp"

namespace hyperiso::track_detail {

// The surface at a step, and its pieces.
template <int S>
struct StepSurface {
  StepSurface(SimplexMesh<S>&& mesh_, GridEdge row_length)
      : mesh(std::move(mesh_)), pieces(mesh, row_length) {}
  StepSurface(const StepSurface&) = delete; // the pieces refer to the mesh
  SimplexMesh<S> mesh;
  StepPieces pieces;
};

template <class T, int D>
class SurfaceSteps {
 public:
  struct Step {
    std::shared_ptr<const StepMask> mask;
    std::shared_ptr<const StepSurface<D - 1>> surface;

    std::shared_ptr<const StepPieces> pieces() const { return {surface, &surface->pieces}; }
  };

  SurfaceSteps(double isovalue, const ExtractOptions& options) : isovalue_(isovalue), options_(options) {
    options_.keep_edges = true;
    options_.progress = {};
    if (options_.method != Method::simplicial) {
      table_ = &march_table<D>(options_.method, {});
      candidates_.emplace(options_.method);
    }
  }

  Result<Step> step(const FieldView<const T, D - 1>& samples) {
    auto mask = std::make_shared<const StepMask>(samples, isovalue_, options_.inside);
    ExtractOptions options = options_;
    options.precision = Precision::f64;
    options.workspace = &workspace_;
    EngineOptions with_masks;
    if (!mask->has_missing()) with_masks.given_masks = {mask->row(0), mask->uniform()};
    SimplexMesh<D - 1> mesh;
    if (Status status = extract_with(samples, isovalue_, options, with_masks, mesh); !status)
      return status.error();
    if (mesh.vertex_count() > UINT32_MAX)
      return Error{Code::out_of_memory, "the surface at a step has more than 2^32 vertices"};
    return Step{std::move(mask), std::make_shared<const StepSurface<D - 1>>(
                                     std::move(mesh), static_cast<GridEdge>(samples.dims()[0]))};
  }

  // What lies between two steps. Where vertices only come close to the steps but do not lie on them, and no
  // sample is missing, little of it has to be looked at; elsewhere all of it is.
  Result<std::unique_ptr<Sweep<D>>> between(const SlabSamples<T, D>& samples, const Step& lower,
                                            const Step& upper, double lower_time, double upper_time) {
    const bool has_missing = lower.mask->has_missing() || upper.mask->has_missing();
    if (candidates_ && !has_missing) {
      Crossings<D> crossings(samples.field(), isovalue_, lower.mask, upper.mask);
      if (!crossings.has_ties()) {
        std::vector<GridEdge> candidates = candidates_->find(crossings);
        Slab<D> slab(std::make_unique<MaskedCells<D>>(*table_, options_.method, std::move(crossings)));
        describe(slab, samples);
        return std::make_unique<Sweep<D>>(std::move(slab), lower_time, upper_time, lower.pieces(),
                                          std::move(candidates));
      }
    }
    ExtractOptions options = options_;
    options.precision = Precision::f32; // of positions that nobody reads
    auto mesh = extract(samples.field(), isovalue_, options);
    if (!mesh) return mesh.error();
    auto slab = make_slab(samples, std::move(*mesh), has_missing);
    if (!slab) return slab.error();
    return std::make_unique<Sweep<D>>(std::move(*slab), lower_time, upper_time);
  }

 private:
  double isovalue_;
  ExtractOptions options_;
  Workspace workspace_; // of the surfaces at steps
  const MarchTable<D>* table_ = nullptr;
  std::optional<CandidateSearch<D>> candidates_;
};

} // namespace hyperiso::track_detail
