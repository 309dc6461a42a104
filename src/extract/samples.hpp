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

  // A lifted field: its last axis is that of `levels`, and a sample is one of the field less its level.
  // Nothing of it is stored: the stride along that axis is 0. Empty for ordinary fields.
  std::vector<double> levels;
  std::vector<InsideTest> level_tests; // a level's

  const InsideTest& test_in_layer(std::int64_t layer) const {
    return levels.empty() ? test : level_tests[static_cast<std::size_t>(layer)];
  }

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
                     inside_test<T>(isovalue, inside),
                     {},
                     {}};
  for (int axis = 0; axis < D; ++axis)
    for (std::int64_t i = 0; i < samples.dims[axis]; ++i)
      samples.coordinates[axis].push_back(field.grid.axes[axis].coordinate(i));
  return samples;
}

// The field lifted by an axis of levels; its coordinates are their numbers.
template <class T, int D>
Samples<D + 1> lifted_samples(const FieldView<const T, D>& field, const std::vector<double>& levels,
                              Inside inside) {
  const Samples<D> flat = samples_of(field, levels.front(), inside);
  Samples<D + 1> samples{flat.first, {}, {}, flat.sample_size, {}, 0, flat.test, levels, {}};
  for (int axis = 0; axis < D; ++axis) {
    samples.dims[axis] = flat.dims[axis];
    samples.strides[axis] = flat.strides[axis];
    samples.coordinates[axis] = flat.coordinates[axis];
  }
  samples.dims[D] = static_cast<std::int64_t>(levels.size());
  samples.strides[D] = 0;
  for (std::size_t level = 0; level < levels.size(); ++level) {
    samples.coordinates[D].push_back(static_cast<double>(level));
    samples.level_tests.push_back(inside_test<T>(levels[level], inside));
  }
  return samples;
}

} // namespace hyperiso
