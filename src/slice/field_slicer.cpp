// Cuts of a field that is read slab by slab.

#include "core/rows.hpp"
#include "core/text.hpp"
#include "hyperiso/interpolate.hpp"
#include "hyperiso/interval.hpp"
#include "hyperiso/slice.hpp"
#include "slice/check_plane.hpp"
#include "slice/slab_join.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <new>

namespace hyperiso {
namespace {

// The samples [begin, end) along the last axis of the field and of the others.
struct Window {
  Field field;
  std::vector<NamedField> others;
};

Field at_index(Field field, int axis, std::int64_t index) {
  field = field.cropped(axis, index, index + 1);
  field.info.axes.erase(field.info.axes.begin() + axis);
  field.strides.erase(field.strides.begin() + axis);
  return field;
}

// Copies the samples of `field` to `to`, axis 0 fastest.
void copy_samples(const Field& field, std::byte* to) {
  const std::size_t size = size_of(field.info.type);
  const auto step = field.strides[0] * static_cast<std::int64_t>(size);
  for_each_row(field, [&](std::int64_t offset) {
    const std::byte* from = field.samples.get() + offset * static_cast<std::int64_t>(size);
    for (std::int64_t x = 0; x < field.info.axes[0].count; ++x, from += step, to += size)
      std::memcpy(to, from, size);
  });
}

// The samples with number `index` along an axis that is not the last, of all steps.
Result<Field> gather_layer(StepSource& source, int axis, std::int64_t index) {
  FieldInfo info = source.info();
  info.axes.erase(info.axes.begin() + axis);
  auto layer = allocate_field(info);
  if (!layer) return layer.error();
  const std::int64_t steps = info.axes.back().count;
  const std::int64_t bytes_per_step =
      static_cast<std::int64_t>(info.bytes()) / std::max<std::int64_t>(steps, 1);
  for (std::int64_t step = 0; step < steps; ++step) {
    const auto field = source.read(step, step + 1);
    if (!field) return field.error();
    copy_samples(at_index(*field, axis, index), layer->samples + step * bytes_per_step);
  }
  return layer->field;
}

} // namespace

template <int D, int K>
class FieldSlicer<D, K>::Work {
  static constexpr int codimension = D - K;

 public:
  Work(StepSource& source, std::vector<double> levels, FieldSliceOptions options)
      : source_(source), levels_(std::move(levels)), options_(std::move(options)) {}

  Result<SimplexMesh<D - 1, K - 1>> slice(const Hyperplane<D>& plane) {
    if (const Status valid = check_plane(plane); !valid) return valid.error();
    if (const Status valid = check_levels(); !valid) return valid.error();
    try {
      const std::optional<int> across = axis_across(plane);
      if (!across) return slice_slabs(plane, std::nullopt);
      const auto around =
          samples_around(axes()[static_cast<std::size_t>(*across)], plane.offset / plane.normal[*across]);
      if (!around) return around.error();
      if (around->end - around->begin == 1) return mesh_of_layer(*across, around->begin);
      return *across == D - 1 ? slice_between(*around, plane) : slice_slabs(plane, *around);
    } catch (const std::bad_alloc&) {
      return Error{Code::out_of_memory, "not enough memory for the slice"};
    }
  }

  Result<MovingSlice<D>> moving_slice(double start, double end) requires(K == D - 1) {
    if (const Status valid = check_levels(); !valid) return valid.error();
    const Axis& last = axes().back();
    const auto around = samples_around(last, start);
    if (!around) return around.error();
    std::int64_t begin = around->begin;
    if (around->end - begin == 1 && last.increasing() != (start < end)) --begin;
    if (begin < 0 || begin + 2 > last.count)
      return Error{Code::outside_domain,
                   text("nothing moves from ", start, " to ", end, ": the field ends at ", start)};
    try {
      if (!keeps(begin))
        if (const Status kept = keep(begin); !kept) return kept.error();
      return hyperiso::moving_slice(kept_->surface, start, end, options_.precision);
    } catch (const std::bad_alloc&) {
      return Error{Code::out_of_memory, "not enough memory for the slice"};
    }
  }

 private:
  Status check_levels() const {
    if (codimension == 1 && levels_.size() != 1)
      return Error{Code::invalid_isovalue, text("a surface has one isovalue, not ", levels_.size())};
    if (codimension == 0 && with_data())
      return Error{Code::invalid_argument, "interval volumes take no normals and no other fields"};
    return {};
  }
  const std::vector<Axis>& axes() const { return source_.info().axes; }
  // Of the grid that the meshes lie on: with the axis of levels, of a volume.
  std::vector<Axis> grid_axes() const {
    std::vector<Axis> result = axes();
    if (codimension == 0) {
      result.emplace_back();
      result.back().count = static_cast<std::int64_t>(levels_.size());
    }
    return result;
  }
  SliceOptions slice_options() const { return {options_.precision, true, options_.frame}; }

  // `take` is what is done with each source.
  template <class Take>
  Result<Window> window(const Take& take) {
    auto field = take(source_);
    if (!field) return field.error();
    Window window{*std::move(field), {}};
    for (const FieldSliceOptions::Other& other : options_.others) {
      if (other.source->info().axes.size() != axes().size() ||
          other.source->info().axes.back().count != axes().back().count)
        return Error{Code::invalid_argument, text("'", other.name, "' is not on the grid of the field")};
      auto values = take(*other.source);
      if (!values) return values.error();
      window.others.push_back({other.name, *std::move(values)});
    }
    return window;
  }
  // Those, and what the gradient needs besides.
  Result<Window> read(std::int64_t begin, std::int64_t end) {
    const std::int64_t margin = options_.with_normals ? 1 : 0;
    begin = std::max<std::int64_t>(begin - margin, 0);
    end = std::min(end + margin, axes().back().count);
    return window([&](StepSource& source) { return source.read(begin, end); });
  }
  // The samples from `step` to the next of what was read for them.
  static Field slab_of(const Window& samples, std::int64_t step, const std::vector<Axis>& whole) {
    const std::int64_t begin = step - (samples.field.info.axes.back().first - whole.back().first);
    return samples.field.cropped(D - 1, begin, begin + 2);
  }

  // The surface, or the volume, of `part`, a part of the samples of `window`.
  template <int Dimension>
  Result<SimplexMesh<Dimension, Dimension - codimension>> mesh_of(const Field& part, const Window& window,
                                                                  const ExtractOptions& options) const {
    auto mesh = visit_sample_type(part.info.type, [&](auto sample) {
      const auto view = part.view<decltype(sample), Dimension>();
      if constexpr (codimension == 1)
        return extract(view, levels_[0], options);
      else
        return interval(view, std::span<const double>(levels_), IntervalOptions{options, LevelAxis::last});
    });
    if (!mesh) return mesh;
    if (const Status added = add_point_data(*mesh, window.field, levels_[0], options_.inside, window.others,
                                            options_.with_normals);
        !added)
      return added.error();
    return mesh;
  }
  bool with_data() const { return options_.with_normals || !options_.others.empty(); }

  Result<SimplexMesh<D - 1, K - 1>> mesh_of_layer(int axis, std::int64_t index) {
    const auto layer = window([&](StepSource& source) -> Result<Field> {
      if (axis != D - 1) return gather_layer(source, axis, index);
      auto step = source.read(index, index + 1);
      if (!step) return step;
      return at_index(*std::move(step), axis, 0);
    });
    if (!layer) return layer.error();
    ExtractOptions options = options_;
    options.keep_edges |= with_data();
    return mesh_of<D - 1>(layer->field, *layer, options);
  }

  // Between two samples of the last axis; from the second time on with an index.
  Result<SimplexMesh<D - 1, K - 1>> slice_between(SampleRange around, const Hyperplane<D>& plane) {
    if (!keeps(around.begin)) {
      if (const Status kept = keep(around.begin); !kept) return kept.error();
      return hyperiso::slice(kept_->surface, plane, slice_options());
    }
    if (!kept_->index) kept_->index.emplace(kept_->surface);
    return kept_->index->slice(kept_->surface, plane, slice_options());
  }
  bool keeps(std::int64_t begin) const { return kept_ && kept_->begin == begin; }
  // Holds the surface from the sample `begin` of the last axis to the next, for the cuts to come.
  Status keep(std::int64_t begin) {
    kept_.reset();
    const auto samples = read(begin, begin + 2);
    if (!samples) return samples.error();
    ExtractOptions options = options_;
    options.keep_edges = true;
    auto surface = mesh_of<D>(slab_of(*samples, begin, axes()), *samples, options);
    if (!surface) return surface.error();
    kept_.emplace(Kept{begin, *std::move(surface), {}});
    return {};
  }

  // Slab after slab; `around`: the samples of the axis that the plane lies across, if there is one.
  Result<SimplexMesh<D - 1, K - 1>> slice_slabs(const Hyperplane<D>& plane,
                                                std::optional<SampleRange> around) {
    if (options_.method == Method::barycentric) return slice_whole(plane);
    SlabJoin<D, K> join(grid_axes(), plane, options_.precision, options_.frame);
    const std::int64_t steps = axes().back().count;
    for (std::int64_t step = 0; step + 1 < steps; ++step) {
      const auto ranges = ranges_met(plane, step, around);
      if (!ranges) continue;
      const auto samples = read(step, step + 2);
      if (!samples) return samples.error();
      Field part = slab_of(*samples, step, axes());
      for (int axis = 0; axis + 1 < D; ++axis)
        part = part.cropped(axis, (*ranges)[axis].begin, (*ranges)[axis].end);
      const auto surface = mesh_of<D>(part, *samples, slab_options(step, steps - 1));
      if (!surface) return surface.error();
      join.add(*surface);
    }
    return std::move(join).mesh();
  }
  Result<SimplexMesh<D - 1, K - 1>> slice_whole(const Hyperplane<D>& plane) {
    const auto samples = read(0, axes().back().count);
    if (!samples) return samples.error();
    const auto surface = mesh_of<D>(samples->field, *samples, options_);
    if (!surface) return surface.error();
    return hyperiso::slice(*surface, plane, slice_options());
  }
  ExtractOptions slab_options(std::int64_t slab, std::int64_t slabs) const {
    ExtractOptions options = options_;
    options.keep_edges = true;
    if (options_.progress)
      options.progress = [this, slab, slabs](double share) {
        return options_.progress((static_cast<double>(slab) + share) / static_cast<double>(slabs));
      };
    return options;
  }

  // The samples of each axis but the last whose cells the plane may meet between a step and the next; nothing
  // if it meets none. One sample more on both sides makes up for positions that are rounded.
  std::optional<std::array<SampleRange, D - 1>> ranges_met(const Hyperplane<D>& plane, std::int64_t step,
                                                           std::optional<SampleRange> around) const {
    std::array<double, D> least, most; // of normal[k] * x[k]
    double size = std::abs(plane.offset);
    for (int axis = 0; axis < D; ++axis) {
      const Axis& along = axes()[static_cast<std::size_t>(axis)];
      const bool last = axis == D - 1;
      const double a = plane.normal[axis] * along.coordinate(last ? step : 0),
                   b = plane.normal[axis] * along.coordinate(last ? step + 1 : along.count - 1);
      least[axis] = std::min(a, b);
      most[axis] = std::max(a, b);
      size += std::max(std::abs(a), std::abs(b));
    }
    const double margin = 1e-6 * size;
    std::array<SampleRange, D - 1> ranges;
    for (int axis = 0; axis + 1 < D; ++axis) {
      const Axis& along = axes()[static_cast<std::size_t>(axis)];
      ranges[axis] = {0, along.count};
      if (plane.normal[axis] == 0) continue;
      if (around) {
        ranges[axis] = *around;
        continue;
      }
      double low = plane.offset - margin, high = plane.offset + margin; // of normal * x
      for (int other = 0; other < D; ++other)
        if (other != axis) low -= most[other], high -= least[other];
      SampleRange& range = ranges[axis];
      const auto product = [&](std::int64_t i) { return plane.normal[axis] * along.coordinate(i); };
      const bool rising = product(along.count - 1) > product(0);
      while (range.begin < range.end && (rising ? product(range.begin) < low : product(range.begin) > high))
        ++range.begin;
      while (range.begin < range.end &&
             (rising ? product(range.end - 1) > high : product(range.end - 1) < low))
        --range.end;
      if (range.begin == range.end && (range.begin == 0 || range.end == along.count)) return std::nullopt;
      range.begin = std::max<std::int64_t>(range.begin - 1, 0);
      range.end = std::min(range.end + 1, along.count);
    }
    return ranges;
  }

  struct Kept {
    std::int64_t begin;
    SimplexMesh<D, K> surface;
    std::optional<SliceIndex<D, K>> index;
  };

  StepSource& source_;
  const std::vector<double> levels_;
  FieldSliceOptions options_;
  std::optional<Kept> kept_;
};

template <int D, int K>
FieldSlicer<D, K>::FieldSlicer(StepSource& source, std::vector<double> levels, FieldSliceOptions options)
    : work_(std::make_unique<Work>(source, std::move(levels), std::move(options))) {}
template <int D, int K>
FieldSlicer<D, K>::~FieldSlicer() = default;
template <int D, int K>
FieldSlicer<D, K>::FieldSlicer(FieldSlicer&&) noexcept = default;

template <int D, int K>
Result<SimplexMesh<D - 1, K - 1>> FieldSlicer<D, K>::slice(const Hyperplane<D>& plane) {
  return work_->slice(plane);
}

template <int D, int K>
Result<MovingSlice<D>> FieldSlicer<D, K>::moving_slice(double start, double end) requires(K == D - 1) {
  return work_->moving_slice(start, end);
}

template class FieldSlicer<3>;
template class FieldSlicer<4>;
template class FieldSlicer<3, 3>;
template class FieldSlicer<4, 4>;

} // namespace hyperiso
