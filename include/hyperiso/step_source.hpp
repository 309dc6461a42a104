#pragma once
/// \file
/// Where work that needs a few steps at a time takes them from.

#include "hyperiso/field.hpp"
#include "hyperiso/result.hpp"

#include <utility>

namespace hyperiso {

/// A field that is read in parts along its last axis (steps, if that is time): a file that stays open, a
/// simulation that hands over its state, or a field in memory.
class StepSource {
 public:
  virtual ~StepSource() = default;
  /// What the whole field is; does not change.
  virtual const FieldInfo& info() const = 0;
  /// The samples [begin, end) along the last axis. Requires 0 <= begin <= end <= its count.
  virtual Result<Field> read(std::int64_t begin, std::int64_t end) = 0;
};

/// A view as a field: copies nothing, so the samples must outlive it.
template <class T, int D>
Field unowned_field(const FieldView<const T, D>& view) {
  Field field;
  field.info.type = sample_type_of<T>();
  field.info.axes.assign(view.grid.axes.begin(), view.grid.axes.end());
  field.samples = std::shared_ptr<const std::byte>(std::shared_ptr<const void>(),
                                                   reinterpret_cast<const std::byte*>(view.samples));
  field.strides.assign(view.strides.begin(), view.strides.end());
  return field;
}

/// A field in memory, step by step; copies nothing.
class FieldSteps final : public StepSource {
 public:
  explicit FieldSteps(Field field) : field_(std::move(field)) {}
  const FieldInfo& info() const override { return field_.info; }
  Result<Field> read(std::int64_t begin, std::int64_t end) override {
    return field_.cropped(field_.info.dimension() - 1, begin, end);
  }

 private:
  Field field_;
};

} // namespace hyperiso
