#pragma once
// Fields and the bytes of their files, for the tests of readers and writers.

#include "hyperiso/io.hpp"

#include <algorithm>
#include <cstring>
#include <gtest/gtest.h>
#include <string>
#include <vector>

namespace hyperiso {

// The samples in their order, axis 0 fastest.
template <class T>
std::vector<T> samples_of(const Field& field) {
  std::vector<T> result;
  std::vector<std::int64_t> index(field.info.axes.size(), 0);
  const auto* samples = reinterpret_cast<const T*>(field.samples.get());
  for (std::int64_t i = 0; i < field.info.samples(); ++i) {
    std::int64_t offset = 0;
    for (std::size_t axis = 0; axis < index.size(); ++axis) offset += index[axis] * field.strides[axis];
    result.push_back(samples[offset]);
    for (std::size_t axis = 0; axis < index.size() && ++index[axis] == field.info.axes[axis].count; ++axis)
      index[axis] = 0;
  }
  return result;
}

inline std::vector<std::int64_t> dims_of(const FieldInfo& info) {
  std::vector<std::int64_t> dims;
  for (const Axis& axis : info.axes) dims.push_back(axis.count);
  return dims;
}

inline std::vector<std::string> names_of(const FieldInfo& info) {
  std::vector<std::string> names;
  for (const Axis& axis : info.axes) names.push_back(axis.name);
  return names;
}

inline std::vector<double> coordinates_of(const Axis& axis) {
  std::vector<double> coordinates;
  for (std::int64_t i = 0; i < axis.count; ++i) coordinates.push_back(axis.coordinate(i));
  return coordinates;
}

// The bytes of numbers, in this machine's order or the other.
template <class T>
std::string bytes_of(const std::vector<T>& numbers, bool swapped = false) {
  std::string bytes(numbers.size() * sizeof(T), '\0');
  if (!numbers.empty()) std::memcpy(bytes.data(), numbers.data(), bytes.size());
  if (swapped)
    for (std::size_t i = 0; i < bytes.size(); i += sizeof(T))
      std::reverse(bytes.begin() + static_cast<std::ptrdiff_t>(i),
                   bytes.begin() + static_cast<std::ptrdiff_t>(i + sizeof(T)));
  return bytes;
}

// first, first + 1, ...: every sample another number, so that none can stand in another's place.
template <class T>
std::vector<T> counting(std::size_t count, int first = 1) {
  std::vector<T> numbers(count);
  for (std::size_t i = 0; i < count; ++i) numbers[i] = static_cast<T>(first + static_cast<int>(i));
  return numbers;
}

// One line that begins with the name of the file: what every error about a file must be.
inline void expect_error_names(const Error& error, const std::string& file) {
  EXPECT_NE(error.message.find(file), std::string::npos) << error.message;
  EXPECT_EQ(error.message.find('\n'), std::string::npos) << error.message;
  EXPECT_NE(error.code, Code::internal) << error.message;
}

} // namespace hyperiso
