#pragma once
// Two consecutive steps of a source in memory.

#include "extract/held_steps.hpp"

namespace hyperiso::track_detail {

template <class T, int D>
class StepWindow {
 public:
  StepWindow(StepSource& source) : steps_(source), axes_(source.info().axes) {}

  // Reads a step in place of the one before the last.
  Status read(std::int64_t step) {
    steps_.forget_before(step - 1);
    const auto samples = steps_.at(step);
    if (!samples) return samples.error();
    samples_ = {samples_[1], reinterpret_cast<const T*>(*samples)};
    step_ = step;
    return {};
  }
  // The step that was read last.
  FieldView<const T, D - 1> step() const {
    Grid<D - 1> grid;
    std::copy_n(axes_.begin(), D - 1, grid.axes.begin());
    return contiguous_view<const T, D - 1>(samples_[1], std::move(grid));
  }
  // That and the one before it.
  FieldView<const T, D> slab() const {
    const FieldView<const T, D - 1> last = step();
    FieldView<const T, D> view;
    std::ranges::copy(last.grid.axes, view.grid.axes.begin());
    std::ranges::copy(last.strides, view.strides.begin());
    view.grid.axes[D - 1] = axes_[D - 1].cropped(step_ - 1, step_ + 1);
    view.strides[D - 1] = samples_[1] - samples_[0];
    view.samples = samples_[0];
    return view;
  }

 private:
  HeldSteps steps_;
  std::vector<Axis> axes_;
  std::int64_t step_ = -1;            // the last one
  std::array<const T*, 2> samples_{}; // of both
};

} // namespace hyperiso::track_detail
