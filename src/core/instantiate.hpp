#pragma once
// The sample types, for explicit instantiations.

#include <cstdint>

// MACRO(T, ...) for every SampleType; `...` are the other arguments, at least one.
#define HYPERISO_FOR_EACH_SAMPLE_TYPE(MACRO, ...)                                                            \
  MACRO(std::uint8_t, __VA_ARGS__)                                                                           \
  MACRO(std::int8_t, __VA_ARGS__)                                                                            \
  MACRO(std::uint16_t, __VA_ARGS__)                                                                          \
  MACRO(std::int16_t, __VA_ARGS__)                                                                           \
  MACRO(std::uint32_t, __VA_ARGS__)                                                                          \
  MACRO(std::int32_t, __VA_ARGS__)                                                                           \
  MACRO(float, __VA_ARGS__)                                                                                  \
  MACRO(double, __VA_ARGS__)
