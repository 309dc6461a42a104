#include "view/pack_field.hpp"

#include "core/rows.hpp"
#include "core/sign.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace hyperiso {
namespace {

// Calls use(sample number, value) for all samples, in their order.
template <class T, class Use>
void for_each_value(const Field& field, Use&& use) {
  const auto* samples = reinterpret_cast<const T*>(field.samples.get());
  std::size_t sample = 0;
  for_each_row(field, [&](std::int64_t offset) {
    for (std::int64_t x = 0; x < field.info.axes[0].count; ++x)
      use(sample++, samples[offset + x * field.strides[0]]);
  });
}

template <class T>
std::vector<std::uint8_t> classes_of(const Field& field, double isovalue, Inside inside) {
  std::vector<std::uint8_t> classes(static_cast<std::size_t>(field.info.samples()));
  const auto classify = [&](auto rule) {
    for_each_value<T>(field, [&](std::size_t sample, T value) {
      classes[sample] = static_cast<std::uint8_t>(is_missing(value)    ? SampleClass::missing
                                                  : rule.inside(value) ? SampleClass::inside
                                                                       : SampleClass::outside);
    });
  };
  if (inside == Inside::above)
    classify(SignRule<T, true>(isovalue));
  else
    classify(SignRule<T, false>(isovalue));
  return classes;
}

// Whether a cell that a sample belongs to has corners of several classes: of each sample the classes within
// one step of it, as bits, axis by axis.
std::vector<std::uint8_t> border_of(const std::vector<std::int64_t>& dims,
                                    std::vector<std::uint8_t> classes) {
  for (std::uint8_t& one : classes) one = static_cast<std::uint8_t>(1 << one);
  std::vector<std::uint8_t> line;
  std::size_t stride = 1;
  for (const std::int64_t count_ : dims) {
    const auto count = static_cast<std::size_t>(count_);
    line.resize(count);
    for (std::size_t first = 0; first < classes.size(); ++first) {
      if (first / stride % count != 0) continue;
      for (std::size_t i = 0; i < count; ++i) line[i] = classes[first + i * stride];
      for (std::size_t i = 0; i < count; ++i) {
        std::uint8_t& within = classes[first + i * stride];
        if (i > 0) within = within | line[i - 1];
        if (i + 1 < count) within = within | line[i + 1];
      }
    }
    stride *= count;
  }
  for (std::uint8_t& one : classes) one = (one & (one - 1)) != 0;
  return classes;
}

template <class T>
constexpr bool fits_codes = std::is_integral_v<T> && sizeof(T) <= 2;

// The scale for what is to be kept.
template <class T>
CodeScale scale_for(const Field& field, double isovalue, const std::vector<std::uint8_t>& kept,
                    CodeScale scale) {
  if constexpr (fits_codes<T>) {
    scale.narrow = sizeof(T) == 1;
    scale.origin = std::numeric_limits<T>::lowest();
    scale.isovalue = isovalue - scale.origin;
  } else {
    double low = std::numeric_limits<double>::infinity(), high = -low;
    for_each_value<T>(field, [&](std::size_t sample, T value_) {
      const auto value = static_cast<double>(value_);
      if (!std::isfinite(value)) scale.special = true;
      if (!kept[sample] || !std::isfinite(value)) return;
      low = std::min(low, value);
      high = std::max(high, value);
    });
    if (low > high) low = high = isovalue;
    const double top = scale.top();
    // Rounded to one side of the isovalue, the samples may take one code more than their range.
    // Neither beyond all numbers nor 0, whatever the range.
    scale.step =
        high > low ? std::max(high / (top - 2) - low / (top - 2), std::numeric_limits<double>::min()) : 1;
    scale.origin = low - scale.step;
    scale.isovalue = (isovalue - scale.origin) / scale.step;
    if (isovalue >= low && isovalue <= high) {
      scale.isovalue = std::clamp(std::round(scale.isovalue), 1.0, top - 1);
      scale.origin = isovalue - scale.isovalue * scale.step;
    }
  }
  return scale;
}

template <class T>
std::uint16_t code_of(T value_, bool is_inside, const CodeScale& scale) {
  if constexpr (fits_codes<T>) {
    return static_cast<std::uint16_t>(value_ - static_cast<int>(scale.origin));
  } else {
    const auto value = static_cast<double>(value_);
    if (std::isnan(value)) return CodeScale::missing;
    if (std::isinf(value)) return value > 0 ? CodeScale::infinity : CodeScale::minus_infinity;
    const double top = scale.top();
    double low = 0, high = top;
    if (scale.isovalue >= 0 && scale.isovalue <= top) {
      const bool up = is_inside == (scale.inside == Inside::above);
      // Of a whole number, the isovalue's own code is inside.
      if (up)
        low = is_inside ? std::ceil(scale.isovalue) : std::floor(scale.isovalue) + 1;
      else
        high = is_inside ? std::floor(scale.isovalue) : std::ceil(scale.isovalue) - 1;
    }
    return static_cast<std::uint16_t>(
        std::clamp(std::round((value - scale.origin) / scale.step), low, std::max(low, high)));
  }
}

template <class T>
SampleLayers pack(const Field& field, double isovalue, Inside inside, bool band) {
  std::vector<std::int64_t> dims;
  for (const Axis& axis : field.info.axes) dims.push_back(axis.count);
  const std::vector<std::uint8_t> classes = classes_of<T>(field, isovalue, inside);
  std::vector<std::uint8_t> kept =
      band ? border_of(dims, classes) : std::vector<std::uint8_t>(classes.size(), 1);
  CodeScale scale;
  scale.band = band;
  scale.inside = inside;
  scale = scale_for<T>(field, isovalue, kept, scale);
  SampleLayers layers(dims, scale, classes.empty() ? SampleClass::outside : SampleClass{classes[0]});
  layers.kept = std::move(kept);
  for_each_value<T>(field, [&](std::size_t sample, T value) {
    const auto one = SampleClass{classes[sample]};
    layers.codes[sample] = layers.kept[sample]           ? code_of(value, one == SampleClass::inside, scale)
                           : one == SampleClass::missing ? CodeScale::missing
                                                         : scale.far(one == SampleClass::inside);
  });
  return layers;
}

} // namespace

SampleLayers pack_field(const Field& field, double isovalue, Inside inside, bool band) {
  return visit_sample_type(
      field.info.type, [&](auto sample) { return pack<decltype(sample)>(field, isovalue, inside, band); });
}

} // namespace hyperiso
