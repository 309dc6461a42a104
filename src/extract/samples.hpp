#pragma once
// A field as the engine reads it: its sample type is gone from the types, and with it one copy of the engine
// per type. What depends on it are three functions on a row, which the kernels provide.

#include "core/sign.hpp"
#include "hyperiso/extract.hpp"

#include <cstddef>
#include <cstring>

namespace hyperiso {

// The sign rule in any type: `threshold` holds a T.
struct InsideTest {
  SampleType type;
  bool above;
  bool never; // no sample is inside
  alignas(8) std::byte threshold[8];

  template <class T>
  T threshold_as() const {
    T value;
    std::memcpy(&value, threshold, sizeof value);
    return value;
  }
};

template <class T>
InsideTest inside_test(double isovalue, Inside inside) {
  InsideTest test{sample_type_of<T>(), inside == Inside::above, false, {}};
  const auto set = [&](auto rule) {
    const T threshold = rule.threshold();
    std::memcpy(test.threshold, &threshold, sizeof threshold);
    test.never = rule.never();
  };
  if (test.above)
    set(SignRule<T, true>(isovalue));
  else
    set(SignRule<T, false>(isovalue));
  return test;
}

template <int D>
struct Samples {
  const std::byte* first;                         // sample 0
  std::array<std::int64_t, D> dims;               // at least 2 each
  std::array<std::int64_t, D> strides;            // in samples
  std::size_t sample_size;                        // in bytes
  std::array<std::vector<double>, D> coordinates; // of each index along each axis
  double isovalue;
  InsideTest test;

  const std::byte* at(const std::array<std::int64_t, D>& index) const {
    std::int64_t offset = 0;
    for (int axis = 0; axis < D; ++axis) offset += index[axis] * strides[axis];
    return first + offset * static_cast<std::int64_t>(sample_size);
  }
};

template <class T, int D>
Samples<D> samples_of(const FieldView<const T, D>& field, double isovalue, Inside inside) {
  Samples<D> samples{reinterpret_cast<const std::byte*>(field.samples),
                     field.dims(),
                     field.strides,
                     sizeof(T),
                     {},
                     isovalue,
                     inside_test<T>(isovalue, inside)};
  for (int axis = 0; axis < D; ++axis)
    for (std::int64_t i = 0; i < samples.dims[axis]; ++i)
      samples.coordinates[axis].push_back(field.grid.axes[axis].coordinate(i));
  return samples;
}

} // namespace hyperiso
