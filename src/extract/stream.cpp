#include "hyperiso/stream.hpp"

#include "core/orientation.hpp"
#include "core/text.hpp"
#include "extract/check_options.hpp"
#include "extract/extract_with.hpp"
#include "extract/held_steps.hpp"
#include "extract/slab_engine.hpp"

#include <algorithm>
#include <new>

namespace hyperiso {
namespace {

template <class T, int D>
Samples<D> samples_without_memory(const FieldInfo& info, double isovalue, Inside inside) {
  Grid<D> grid;
  std::ranges::copy(info.axes, grid.axes.begin());
  return samples_of(contiguous_view<const T, D>(nullptr, std::move(grid)), isovalue, inside);
}

template <int D>
class StreamRun {
 public:
  StreamRun(StepSource& source, double isovalue, const SlabSink& sink, const ExtractOptions& options,
            const EngineOptions& engine_options)
      : info_(source.info()), steps_(source), sink_(sink), options_(options),
        engine_options_(engine_options) {
    if (options.progress)
      options_.progress = [this](double share) {
        return this->progress_((static_cast<double>(slab_) + share) / static_cast<double>(slabs_));
      };
    progress_ = options.progress;
    visit_sample_type(info_.type, [&]<class T>(T) {
      samples_ = samples_without_memory<T, D>(info_, isovalue, options.inside);
    });
  }

  Status run() {
    const bool any_cell = std::ranges::all_of(samples_.dims, [](std::int64_t count) { return count >= 2; });
    if (any_cell && !samples_.test.never)
      engine_ = make_slab_engine(samples_, {.mirrored = mirror_space(info_.axes)}, options_, engine_options_,
                                 mesh_);
    for (slab_ = 0; slab_ < slabs_; ++slab_) {
      if (Status status = extract_slab(); !status) return status;
      const std::uint64_t vertices = mesh_.vertex_count(), simplices = mesh_.simplex_count();
      SurfaceSlab slab{slab_, first_vertex_, first_simplex_, mesh_};
      if (Status status = sink_(slab); !status) return status;
      first_vertex_ += vertices;
      first_simplex_ += simplices;
    }
    return {};
  }

 private:
  Status extract_slab() {
    mesh_.attributes.clear();
    mesh_.grid_axes.clear();
    if (options_.keep_edges) mesh_.grid_axes = info_.axes;
    if (!engine_) {
      mesh_.positions.reset(0, options_.precision == Precision::f64);
      mesh_.edges.reset(0);
      mesh_.simplices.reset(0, false);
      mesh_.active_cells = 0;
      return {};
    }
    steps_.forget_before(slab_);
    const auto lower = steps_.at(slab_);
    if (!lower) return lower.error();
    const auto upper = steps_.at(slab_ + 1);
    if (!upper) return upper.error();
    return engine_->extract(*lower, *upper, [&]() -> Result<const std::byte*> {
      if (slab_ + 1 == slabs_) return static_cast<const std::byte*>(nullptr);
      return steps_.at(slab_ + 2);
    });
  }

  const FieldInfo& info_;
  HeldSteps steps_;
  const SlabSink& sink_;
  ExtractOptions options_;
  const EngineOptions& engine_options_;
  Progress progress_;
  Samples<D> samples_{};
  SimplexMesh<D> mesh_;
  std::unique_ptr<SlabEngine<D>> engine_; // none where no surface can be
  const std::int64_t slabs_ = info_.axes.back().count - 1;
  std::int64_t slab_ = 0;
  std::uint64_t first_vertex_ = 0, first_simplex_ = 0;
};

Status check(const FieldInfo& info, Method method) {
  if (method == Method::barycentric)
    return Error{Code::invalid_argument,
                 "the vertices of the method barycentric come in no order, so that it has no slabs; hull, "
                 "component and simplicial have"};
  if (info.dimension() < 2 || info.dimension() > 5)
    return Error{Code::unsupported_dimension,
                 text("the field has ", info.dimension(), " dimensions; slab by slab, 2 to 5 work")};
  return {};
}

} // namespace

Status stream_with(StepSource& source, double isovalue, const SlabSink& sink, const ExtractOptions& options,
                   const EngineOptions& engine_options) {
  const FieldInfo& info = source.info();
  if (Status status = check_arguments(isovalue, options.threads); !status) return status;
  if (Status status = check(info, options.method); !status) return status;
  try {
    const auto run = [&]<int D>() {
      return StreamRun<D>(source, isovalue, sink, options, engine_options).run();
    };
    switch (info.dimension()) {
    case 2:
      return run.template operator()<2>();
    case 3:
      return run.template operator()<3>();
    case 4:
      return run.template operator()<4>();
    default:
      return run.template operator()<5>();
    }
  } catch (const std::bad_alloc&) {
    return Error{Code::out_of_memory, "not enough memory for the steps and the surface between them"};
  }
}

Status stream(StepSource& source, double isovalue, const SlabSink& sink, const ExtractOptions& options) {
  return stream_with(source, isovalue, sink, options, {});
}

} // namespace hyperiso
