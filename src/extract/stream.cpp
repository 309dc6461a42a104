#include "hyperiso/stream.hpp"

#include "core/rows.hpp"
#include "core/text.hpp"
#include "extract/check_options.hpp"
#include "extract/extract_with.hpp"
#include "extract/slab_engine.hpp"

#include <algorithm>
#include <list>
#include <new>

namespace hyperiso {
namespace {

// The steps of a source that are in memory, each with its samples one after the other.
class HeldSteps {
 public:
  explicit HeldSteps(StepSource& source)
      : source_(source), info_(source.info()), gather_(row_kernels(info_.type, best_instructions()).gather) {}

  // Sample 0 of a step, which is read unless it is held.
  Result<const std::byte*> at(std::int64_t step) {
    const auto held = std::ranges::find(held_, step, &Held::step);
    if (held != held_.end()) return held->first;
    auto field = source_.read(step, step + 1);
    if (!field) return field.error();
    if (Status status = check(*field, step); !status) return status.error();
    if (spare_.empty()) spare_.emplace_back();
    held_.splice(held_.end(), spare_, spare_.begin());
    held_.back().step = step;
    hold(std::move(*field), held_.back());
    return held_.back().first;
  }
  void forget_before(std::int64_t step) {
    while (!held_.empty() && held_.front().step < step) {
      held_.front().field.samples.reset();
      spare_.splice(spare_.end(), held_, held_.begin());
    }
  }

 private:
  struct Held {
    std::int64_t step = -1;
    Field field;           // owns the samples, or
    Array<std::byte> copy; // this does
    const std::byte* first = nullptr;
  };

  Status check(const Field& field, std::int64_t step) const {
    const auto wrong = [&](const auto&... pieces) {
      return Error{Code::invalid_argument, text("step ", step, " of the source ", pieces...)};
    };
    if (field.info.type != info_.type)
      return wrong("has samples of type ", name_of(field.info.type), ", not ", name_of(info_.type));
    if (field.info.dimension() != info_.dimension())
      return wrong("has ", field.info.dimension(), " axes, not ", info_.dimension());
    for (std::size_t axis = 0; axis < info_.axes.size(); ++axis) {
      const std::int64_t count = axis + 1 < info_.axes.size() ? info_.axes[axis].count : 1;
      if (field.info.axes[axis].count != count)
        return wrong("has ", field.info.axes[axis].count, " samples along axis ", axis, ", not ", count);
    }
    return {};
  }

  void hold(Field&& field, Held& held) const {
    if (is_contiguous(field)) {
      held.field = std::move(field);
      held.first = held.field.samples.get();
      return;
    }
    const std::size_t sample_bytes = size_of(info_.type);
    const std::int64_t row_samples = info_.axes[0].count;
    held.copy.reset(static_cast<std::size_t>(field.info.samples()) * sample_bytes);
    std::byte* to = held.copy.data();
    for_each_row(field, [&](std::int64_t offset) {
      const std::byte* row = field.samples.get() + offset * static_cast<std::int64_t>(sample_bytes);
      gather_(row, field.strides[0], row_samples, to);
      to += static_cast<std::size_t>(row_samples) * sample_bytes;
    });
    held.first = held.copy.data();
  }
  bool is_contiguous(const Field& step) const {
    if (reinterpret_cast<std::uintptr_t>(step.samples.get()) % size_of(info_.type) != 0) return false;
    std::int64_t stride = 1;
    for (std::size_t axis = 0; axis + 1 < info_.axes.size(); ++axis) {
      if (info_.axes[axis].count > 1 && step.strides[axis] != stride) return false;
      stride *= info_.axes[axis].count;
    }
    return true;
  }

  StepSource& source_;
  const FieldInfo& info_;
  decltype(RowKernels::gather) gather_;
  std::list<Held> held_, spare_; // in the order of the steps; memory to be used again
};

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
    const auto falling =
        std::ranges::count_if(info_.axes, [](const Axis& axis) { return !axis.increasing(); });
    const bool any_cell = std::ranges::all_of(samples_.dims, [](std::int64_t count) { return count >= 2; });
    if (any_cell && !samples_.test.never)
      engine_ = make_slab_engine(samples_, {.mirrored = falling % 2 == 1}, options_, engine_options_, mesh_);
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
