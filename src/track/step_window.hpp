#pragma once
// Two consecutive steps of a source in memory.

#include "core/sign.hpp"
#include "hyperiso/step_source.hpp"

#include <span>

namespace hyperiso::track_detail {

template <class T, int D>
class StepWindow {
 public:
  StepWindow(StepSource& source) : source_(source), axes_(source.info().axes), step_samples_(1) {
    for (std::size_t axis = 0; axis + 1 < D; ++axis) step_samples_ *= axes_[axis].count;
    samples_.resize(static_cast<std::size_t>(2 * step_samples_));
  }

  // Reads a step in place of the one before the last.
  Status read(std::int64_t step) {
    auto field = source_.read(step, step + 1);
    if (!field) return field.error();
    const auto view = field->template view<T, D>();
    T* to = samples_.data() + step % 2 * step_samples_;
    std::array<std::int64_t, D> index{};
    for (std::int64_t done = 0; done < step_samples_; done += view.grid.axes[0].count) {
      const T* row = &view.at(index);
      for (std::int64_t x = 0; x < view.grid.axes[0].count; ++x) *to++ = row[x * view.strides[0]];
      for (int axis = 1; axis < D && ++index[axis] == view.grid.axes[axis].count; ++axis) index[axis] = 0;
    }
    return {};
  }
  // Steps `first` and `first` + 1, both read.
  FieldView<const T, D> slab(std::int64_t first) const {
    FieldView<const T, D> view;
    std::int64_t stride = 1;
    for (std::size_t axis = 0; axis < D; ++axis) {
      view.grid.axes[axis] = axis == D - 1 ? axes_[axis].cropped(first, first + 2) : axes_[axis];
      view.strides[axis] = stride;
      stride *= axes_[axis].count;
    }
    view.samples = samples_.data() + first % 2 * step_samples_;
    view.strides[D - 1] = first % 2 == 0 ? step_samples_ : -step_samples_;
    return view;
  }
  // A step that was read.
  FieldView<const T, D - 1> step(std::int64_t number) const {
    return slab(number > 0 ? number - 1 : 0).at_index(D - 1, number > 0 ? 1 : 0);
  }

 private:
  StepSource& source_;
  std::vector<Axis> axes_;
  std::int64_t step_samples_;
  std::vector<T> samples_; // even steps, then odd ones
};

} // namespace hyperiso::track_detail
