#pragma once
// The samples of a field as whole numbers, and those as bytes: what a page holds that extracts its surfaces
// itself. The writer and the module in the page share this file.

#include "hyperiso/extract.hpp"

#include <cstdint>
#include <span>
#include <vector>

namespace hyperiso {

// What the codes of samples stand for: value = origin + code * step. Codes have 16 bits; if `narrow`, 8.
struct CodeScale {
  static constexpr std::uint16_t missing = 65535, infinity = 65534, minus_infinity = 65533; // if `special`

  bool narrow = false;
  bool special = false;
  bool band = false; // samples whose neighbours in all cells are on their side have that side's `far` code
  Inside inside = Inside::above;
  double origin = 0, step = 1;
  double isovalue = 0; // in codes
  bool is_inside(std::uint16_t code) const {
    return inside == Inside::above ? code >= isovalue : code <= isovalue;
  }
  // The highest code of a number.
  std::uint16_t top() const { return special ? minus_infinity - 1 : narrow ? 255 : 65535; }
  // A code on the far side of all others on its side.
  std::uint16_t far(bool is_inside) const { return is_inside == (inside == Inside::above) ? top() : 0; }
};

// The classes of samples, of which a band keeps the borders.
enum class SampleClass : std::uint8_t { outside, inside, missing };

// Codes in the order of samples, from and to bytes, some layers (indices of the last axis) at a time.
//
// Bytes of some layers: if it is a band, which samples are kept: a bit each, exclusive or with those of the
// layer before; then, of each kept sample, its difference from a prediction by the kept ones before it
// (zigzag): all low bytes, then, unless `narrow`, all high bytes. The samples left out are of the class of
// the one before them along the first axis along which there is one; the very first is of `first_class`.
class SampleLayers {
 public:
  SampleLayers(std::vector<std::int64_t> dims, CodeScale scale, SampleClass first_class);

  std::int64_t layers() const { return dims_.back(); }
  std::size_t layer_samples() const { return layer_samples_; }
  std::size_t samples() const { return layer_samples_ * static_cast<std::size_t>(layers()); }
  const CodeScale& scale() const { return scale_; }
  SampleClass first_class() const { return first_class_; }

  // Of all samples that have been set or decoded; kept: one byte each, all 1 unless it is a band.
  std::vector<std::uint16_t> codes;
  std::vector<std::uint8_t> kept;

  std::vector<unsigned char> encode(std::int64_t first_layer, std::int64_t count) const;
  // The next `count` layers. False if the bytes are not theirs.
  bool decode(std::int64_t count, std::span<const unsigned char> bytes);

 private:
  std::uint16_t predicted(std::size_t sample, bool first_in_row, bool first_row) const;
  void imply(std::size_t sample);
  template <class Use>
  void for_each_sample(std::int64_t first_layer, std::int64_t count, Use&& use) const;

  std::vector<std::int64_t> dims_;
  CodeScale scale_;
  SampleClass first_class_;
  std::size_t layer_samples_ = 1;
  std::int64_t decoded_ = 0; // layers
};

} // namespace hyperiso
