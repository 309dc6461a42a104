#include "view/payload.hpp"

#include "view/deflate.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>

namespace hyperiso {
namespace {

// The steps from each level to the next as low bytes and then high bytes: neighbours are alike, so that most
// bytes are small, and bytes of one kind beside each other compress best.
void append_steps(std::span<const std::uint16_t> levels, std::vector<unsigned char>& bytes) {
  const std::size_t low = bytes.size(), high = low + levels.size();
  bytes.resize(high + levels.size());
  std::uint16_t previous = 0;
  for (std::size_t i = 0; i < levels.size(); ++i) {
    const auto step = static_cast<std::int16_t>(levels[i] - previous);
    const auto zigzag = static_cast<std::uint16_t>((step << 1) ^ (step >> 15));
    bytes[low + i] = static_cast<unsigned char>(zigzag & 0xff);
    bytes[high + i] = static_cast<unsigned char>(zigzag >> 8);
    previous = levels[i];
  }
}

// The numbers of an attribute, one per vertex of the mesh.
template <class T>
std::vector<T> at_vertices(const Mesh& mesh, const Attribute& attribute, const std::vector<T>& values) {
  if (attribute.location == Attribute::Location::vertex) return values;
  const auto corners = static_cast<std::size_t>(mesh.simplex_dimension + 1);
  std::vector<T> result(mesh.vertex_count());
  for (std::size_t simplex = values.size(); simplex-- > 0;)
    for (std::size_t corner = 0; corner < corners; ++corner)
      result[mesh.simplices[simplex * corners + corner]] = values[simplex];
  return result;
}

void encode_values(const std::vector<std::int64_t>& values, EncodedAttribute& encoded) {
  encoded.is_label = true;
  encoded.labels = values;
  std::sort(encoded.labels.begin(), encoded.labels.end());
  encoded.labels.erase(std::unique(encoded.labels.begin(), encoded.labels.end()), encoded.labels.end());
  for (std::size_t i = 0; i < values.size(); ++i) {
    const auto found = std::lower_bound(encoded.labels.begin(), encoded.labels.end(), values[i]);
    encoded.levels[i] =
        static_cast<std::uint16_t>(std::min<std::ptrdiff_t>(found - encoded.labels.begin(), top_level));
  }
}

void encode_values(const std::vector<double>& values, EncodedAttribute& encoded) {
  encoded.minimum = std::numeric_limits<double>::infinity();
  encoded.maximum = -encoded.minimum;
  for (const double value : values)
    if (std::isfinite(value)) {
      encoded.minimum = std::min(encoded.minimum, value);
      encoded.maximum = std::max(encoded.maximum, value);
    }
  if (encoded.minimum > encoded.maximum) encoded.minimum = encoded.maximum = 0;
  const double range = encoded.maximum - encoded.minimum;
  for (std::size_t i = 0; i < values.size(); ++i) {
    const double share = range > 0 ? (values[i] - encoded.minimum) / range : 0;
    encoded.levels[i] = static_cast<std::uint16_t>(
        std::lround(std::clamp(std::isnan(share) ? 0 : share, 0.0, 1.0) * top_level));
  }
}

} // namespace

std::vector<unsigned char> Payload::encode(const Block& block,
                                           const std::vector<EncodedAttribute>& attributes) const {
  std::vector<unsigned char> bytes;
  std::vector<std::uint16_t> column(block.vertices);
  for (int axis = 0; axis < mesh_.dimension; ++axis) {
    for (std::size_t i = 0; i < block.vertices; ++i)
      column[i] = level(used_vertices_[block.first_vertex + i], axis);
    append_steps(column, bytes);
  }
  for (const EncodedAttribute& attribute : attributes) {
    for (std::size_t i = 0; i < block.vertices; ++i)
      column[i] = attribute.levels[used_vertices_[block.first_vertex + i]];
    append_steps(column, bytes);
  }

  const auto corners = static_cast<std::size_t>(mesh_.simplex_dimension + 1);
  const std::size_t codes = block.simplices * corners, first = bytes.size();
  bytes.resize(first + 3 * codes);
  auto vertices_so_far = static_cast<std::uint32_t>(block.first_vertex);
  for (std::size_t i = 0; i < codes; ++i) {
    const std::size_t simplex = order_[block.first_simplex + i / corners];
    const std::uint32_t code = vertices_so_far - number_[mesh_.simplices[simplex * corners + i % corners]];
    if (code == 0) ++vertices_so_far;
    for (std::size_t plane = 0; plane < 3; ++plane)
      bytes[first + plane * codes + i] = static_cast<unsigned char>(code >> (8 * plane) & 0xff);
  }
  return deflated(bytes);
}

std::vector<unsigned char> Payload::encode(const std::vector<EncodedAttribute>& attributes) const {
  std::vector<unsigned char> bytes;
  std::vector<std::uint16_t> column(used_vertices_.size());
  for (const EncodedAttribute& attribute : attributes) {
    for (std::size_t i = 0; i < column.size(); ++i) column[i] = attribute.levels[used_vertices_[i]];
    append_steps(column, bytes);
  }
  return deflated(bytes);
}

std::vector<EncodedAttribute> encode_attributes(const Mesh& mesh) {
  std::vector<EncodedAttribute> result;
  for (const Attribute& attribute : mesh.attributes) {
    if (attribute.components != 1) continue;
    EncodedAttribute encoded;
    encoded.name = attribute.name;
    encoded.levels.resize(mesh.vertex_count());
    std::visit(
        [&](const auto& values) {
          using T = typename std::decay_t<decltype(values)>::value_type;
          using Wide = std::conditional_t<std::is_integral_v<T>, std::int64_t, double>;
          const std::vector<T> at_vertex = at_vertices(mesh, attribute, values);
          encode_values(std::vector<Wide>(at_vertex.begin(), at_vertex.end()), encoded);
        },
        attribute.values);
    result.push_back(std::move(encoded));
  }
  return result;
}

EncodedAttribute encode_labels(std::string name, const std::vector<std::int32_t>& labels) {
  EncodedAttribute encoded;
  encoded.name = std::move(name);
  encoded.levels.resize(labels.size());
  encode_values(std::vector<std::int64_t>(labels.begin(), labels.end()), encoded);
  return encoded;
}

} // namespace hyperiso
