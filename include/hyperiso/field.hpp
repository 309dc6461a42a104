#pragma once
/// \file
/// Scalar fields sampled on a grid: FieldView for code that knows the dimension and the sample type,
/// Field for the edges of the program that learn them at run time.

#include "hyperiso/grid.hpp"
#include "hyperiso/result.hpp"

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <type_traits>
#include <vector>

namespace hyperiso {

/// Samples in place: a pointer and strides, nothing owned, nothing converted.
///
/// NaN means "no data": a cell that touches one yields no surface. +-Inf is ordinary ordered data.
template <class T, int D>
struct FieldView {
  Grid<D> grid;
  T* samples = nullptr;
  std::array<std::int64_t, D> strides{}; ///< in samples, from one index to the next along each axis

  T& at(const std::array<std::int64_t, D>& index) const {
    std::int64_t offset = 0;
    for (int axis = 0; axis < D; ++axis) offset += index[axis] * strides[axis];
    return samples[offset];
  }
  std::array<std::int64_t, D> dims() const {
    std::array<std::int64_t, D> dims;
    for (int axis = 0; axis < D; ++axis) dims[axis] = grid.axes[axis].count;
    return dims;
  }
  /// Samples [begin, end) along `axis`. Vertices extracted from it have the coordinates they have in the
  /// whole.
  FieldView cropped(int axis, std::int64_t begin, std::int64_t end) const {
    FieldView view = *this;
    view.grid.axes[axis] = grid.axes[axis].cropped(begin, end);
    view.samples += begin * strides[axis];
    return view;
  }
  /// The samples at `index` along `axis`: a field of one dimension less on the other axes, in their order.
  FieldView<T, D - 1> at_index(int axis, std::int64_t index) const requires(D > 1) {
    FieldView<T, D - 1> view;
    view.samples = samples + index * strides[axis];
    for (int from = 0, to = 0; from < D; ++from) {
      if (from == axis) continue;
      view.grid.axes[to] = grid.axes[from];
      view.strides[to++] = strides[from];
    }
    return view;
  }
};

/// A view of samples that lie one after the other, axis 0 fastest.
template <class T, int D>
FieldView<T, D> contiguous_view(T* samples, Grid<D> grid) {
  FieldView<T, D> view{std::move(grid), samples, {}};
  std::int64_t stride = 1;
  for (int axis = 0; axis < D; ++axis) {
    view.strides[axis] = stride;
    stride *= view.grid.axes[axis].count;
  }
  return view;
}

/// A grid with unit spacing from the origin and axes named x, y, z, ..., for tests and examples.
template <int D>
Grid<D> unit_grid(const std::array<std::int64_t, D>& dims) {
  Grid<D> grid;
  for (int axis = 0; axis < D; ++axis) grid.axes[axis].count = dims[axis];
  return grid;
}

enum class SampleType { u8, i8, u16, i16, u32, i32, f32, f64 };

std::size_t size_of(SampleType type);
const char* name_of(SampleType type); ///< "u8", ..., "f64"
std::optional<SampleType> sample_type_named(const std::string& name);

/// Calls `use(T{})` with a value of the sample type's C++ type.
template <class Use>
decltype(auto) visit_sample_type(SampleType type, Use&& use) {
  switch (type) {
  case SampleType::u8:
    return use(std::uint8_t{});
  case SampleType::i8:
    return use(std::int8_t{});
  case SampleType::u16:
    return use(std::uint16_t{});
  case SampleType::i16:
    return use(std::int16_t{});
  case SampleType::u32:
    return use(std::uint32_t{});
  case SampleType::i32:
    return use(std::int32_t{});
  case SampleType::f32:
    return use(float{});
  case SampleType::f64:
    break;
  }
  return use(double{});
}

template <class T>
constexpr SampleType sample_type_of() {
  using S = std::remove_cv_t<T>;
  if constexpr (std::is_same_v<S, std::uint8_t>)
    return SampleType::u8;
  else if constexpr (std::is_same_v<S, std::int8_t>)
    return SampleType::i8;
  else if constexpr (std::is_same_v<S, std::uint16_t>)
    return SampleType::u16;
  else if constexpr (std::is_same_v<S, std::int16_t>)
    return SampleType::i16;
  else if constexpr (std::is_same_v<S, std::uint32_t>)
    return SampleType::u32;
  else if constexpr (std::is_same_v<S, std::int32_t>)
    return SampleType::i32;
  else if constexpr (std::is_same_v<S, float>)
    return SampleType::f32;
  else {
    static_assert(std::is_same_v<S, double>, "not a sample type of hyperiso");
    return SampleType::f64;
  }
}

/// What a field is, without its samples.
struct FieldInfo {
  std::string name; ///< of the variable; empty if unknown
  SampleType type = SampleType::f32;
  std::vector<Axis> axes;      ///< axis 0 fastest; time, if there is one, is the last
  bool has_time = false;       ///< the last axis is time
  std::optional<Affine> world; ///< axis coordinates to world coordinates; none: they are the same

  int dimension() const { return static_cast<int>(axes.size()); }
  std::int64_t samples() const;
  std::uint64_t bytes() const { return static_cast<std::uint64_t>(samples()) * size_of(type); }
  /// Number of the axis called `name`, or of axis `name` if it is a number; nothing if there is none.
  std::optional<int> axis_named(const std::string& name) const;
};

/// A field whose dimension and type are known at run time. Copies share the samples, which never change.
struct Field {
  FieldInfo info;
  std::shared_ptr<const std::byte> samples; ///< sample 0; keeps the memory or the file mapping alive
  std::vector<std::int64_t> strides;        ///< in samples, one per axis

  /// Samples [begin, end) along `axis`; shares the samples. Requires 0 <= begin <= end <= count.
  Field cropped(int axis, std::int64_t begin, std::int64_t end) const;

  /// This field as a view. Requires that T and D are its type and dimension.
  template <class T, int D>
  FieldView<const T, D> view() const {
    FieldView<const T, D> result;
    result.samples = reinterpret_cast<const T*>(samples.get());
    for (int axis = 0; axis < D; ++axis) {
      result.grid.axes[axis] = info.axes[axis];
      result.strides[axis] = strides[axis];
    }
    return result;
  }
};

/// A field with memory of its own, to be filled through the returned pointer, axis 0 fastest.
/// Error: out_of_memory, also where its samples take more than `memory_limit` bytes; invalid_argument if
/// their number overflows.
struct NewField {
  Field field;
  std::byte* samples;
};
Result<NewField> allocate_field(FieldInfo info, std::uint64_t memory_limit = UINT64_MAX);

} // namespace hyperiso
