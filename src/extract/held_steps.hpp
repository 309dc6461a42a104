#pragma once
// Steps of a source in memory.

#include "core/rows.hpp"
#include "core/text.hpp"
#include "extract/kernels.hpp"
#include "hyperiso/step_source.hpp"

#include <algorithm>
#include <list>

namespace hyperiso {

// The steps of a source that are in memory, each with its samples one after the other.
class HeldSteps {
 public:
  explicit HeldSteps(StepSource& source)
      : source_(source), info_(source.info()), gather_(row_kernels(info_.type, best_instructions()).gather) {}

  // Sample 0 of a step, which is read unless it is held. The others follow it, axis 0 fastest.
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

} // namespace hyperiso
