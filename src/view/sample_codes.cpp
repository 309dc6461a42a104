#include "view/sample_codes.hpp"

namespace hyperiso {
namespace {

std::uint16_t zigzag(std::uint16_t difference, bool narrow) {
  if (narrow) {
    const auto step = static_cast<std::int8_t>(difference);
    return static_cast<std::uint8_t>((step << 1) ^ (step >> 7));
  }
  const auto step = static_cast<std::int16_t>(difference);
  return static_cast<std::uint16_t>((step << 1) ^ (step >> 15));
}

std::uint16_t unzigzag(std::uint16_t number) {
  return static_cast<std::uint16_t>((number >> 1) ^ -(number & 1));
}

} // namespace

SampleLayers::SampleLayers(std::vector<std::int64_t> dims, CodeScale scale, SampleClass first_class)
    : dims_(std::move(dims)), scale_(scale), first_class_(first_class) {
  for (std::size_t axis = 0; axis + 1 < dims_.size(); ++axis)
    layer_samples_ *= static_cast<std::size_t>(dims_[axis]);
  codes.assign(samples(), 0);
  kept.assign(samples(), scale_.band ? 0 : 1);
}

// The plane through the samples before it along the first axis and in the layer before, as far as they are
// there, else along the first two axes; else the nearest of them; else the isovalue.
std::uint16_t SampleLayers::predicted(std::size_t sample, bool first_in_row, bool first_row) const {
  const auto row = static_cast<std::size_t>(dims_[0]);
  const bool left = !first_in_row && kept[sample - 1];
  const bool earlier = sample >= layer_samples_ && kept[sample - layer_samples_];
  const bool below = !first_row && kept[sample - row];
  const auto through = [&](std::size_t other) {
    return static_cast<std::uint16_t>(codes[sample - 1] + codes[sample - other] - codes[sample - other - 1]);
  };
  if (left && earlier && kept[sample - layer_samples_ - 1]) return through(layer_samples_);
  if (left && below && kept[sample - row - 1]) return through(row);
  if (earlier) return codes[sample - layer_samples_];
  if (left) return codes[sample - 1];
  if (below) return codes[sample - row];
  return static_cast<std::uint16_t>(scale_.isovalue < 0       ? 0
                                    : scale_.isovalue > 65535 ? 65535
                                                              : scale_.isovalue);
}

// Sets a sample that is not kept. Where the one before it has another class both would be kept.
void SampleLayers::imply(std::size_t sample) {
  std::size_t stride = 1, index = sample;
  for (const std::int64_t count : dims_) {
    if (index % static_cast<std::size_t>(count) > 0) {
      const std::uint16_t before = codes[sample - stride];
      const bool is_missing = scale_.special && before == CodeScale::missing;
      codes[sample] = is_missing ? before : scale_.far(scale_.is_inside(before));
      return;
    }
    index /= static_cast<std::size_t>(count);
    stride *= static_cast<std::size_t>(count);
  }
  codes[sample] = first_class_ == SampleClass::missing ? CodeScale::missing
                                                       : scale_.far(first_class_ == SampleClass::inside);
}

template <class Use>
void SampleLayers::for_each_sample(std::int64_t first_layer, std::int64_t count, Use&& use) const {
  const auto row = static_cast<std::size_t>(dims_[0]);
  const auto plane = dims_.size() > 1 ? row * static_cast<std::size_t>(dims_[1]) : row;
  const std::size_t begin = static_cast<std::size_t>(first_layer) * layer_samples_,
                    end = begin + static_cast<std::size_t>(count) * layer_samples_;
  for (std::size_t first = begin; first < end; first += row) {
    const bool first_row = first % plane == 0;
    for (std::size_t x = 0; x < row; ++x) use(first + x, x == 0, first_row);
  }
}

std::vector<unsigned char> SampleLayers::encode(std::int64_t first_layer, std::int64_t count) const {
  std::vector<unsigned char> bytes, high;
  const std::size_t begin = static_cast<std::size_t>(first_layer) * layer_samples_,
                    all = static_cast<std::size_t>(count) * layer_samples_;
  if (scale_.band) {
    bytes.assign((all + 7) / 8, 0);
    for (std::size_t i = 0; i < all; ++i) {
      const std::size_t sample = begin + i;
      const bool earlier = sample >= layer_samples_ && kept[sample - layer_samples_];
      bytes[i / 8] = static_cast<unsigned char>(bytes[i / 8] | (kept[sample] != earlier) << i % 8);
    }
  }
  for_each_sample(first_layer, count, [&](std::size_t sample, bool first_in_row, bool first_row) {
    if (!kept[sample]) return;
    const auto difference =
        static_cast<std::uint16_t>(codes[sample] - predicted(sample, first_in_row, first_row));
    const std::uint16_t number = zigzag(difference, scale_.narrow);
    bytes.push_back(static_cast<unsigned char>(number & 0xff));
    if (!scale_.narrow) high.push_back(static_cast<unsigned char>(number >> 8));
  });
  bytes.insert(bytes.end(), high.begin(), high.end());
  return bytes;
}

bool SampleLayers::decode(std::int64_t count, std::span<const unsigned char> bytes) {
  if (count < 0 || count > layers() - decoded_) return false;
  const std::size_t begin = static_cast<std::size_t>(decoded_) * layer_samples_,
                    all = static_cast<std::size_t>(count) * layer_samples_;
  const std::size_t mask_bytes = scale_.band ? (all + 7) / 8 : 0;
  if (bytes.size() < mask_bytes) return false;
  std::size_t kept_count = all;
  if (scale_.band) {
    kept_count = 0;
    for (std::size_t i = 0; i < all; ++i) {
      const std::size_t sample = begin + i;
      const bool earlier = sample >= layer_samples_ && kept[sample - layer_samples_];
      kept[sample] = (bytes[i / 8] >> i % 8 & 1) != earlier;
      kept_count += kept[sample];
    }
  }
  if (bytes.size() != mask_bytes + kept_count * (scale_.narrow ? 1 : 2)) return false;
  const unsigned char *low = bytes.data() + mask_bytes, *high = low + kept_count;
  for_each_sample(decoded_, count, [&](std::size_t sample, bool first_in_row, bool first_row) {
    if (!kept[sample]) return imply(sample);
    std::uint16_t number = *low++;
    if (!scale_.narrow) number = static_cast<std::uint16_t>(number | *high++ << 8);
    const auto code =
        static_cast<std::uint16_t>(predicted(sample, first_in_row, first_row) + unzigzag(number));
    codes[sample] = scale_.narrow ? code & 0xff : code;
  });
  decoded_ += count;
  return true;
}

} // namespace hyperiso
