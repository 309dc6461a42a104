#include "hyperiso/colours.hpp"

#include "core/text.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace hyperiso {
namespace {

constexpr std::array<Colour, 9> viridis_stops{{{0x44, 0x01, 0x54},
                                               {0x47, 0x2d, 0x7b},
                                               {0x3b, 0x52, 0x8b},
                                               {0x2c, 0x72, 0x8e},
                                               {0x21, 0x91, 0x8c},
                                               {0x28, 0xae, 0x80},
                                               {0x5e, 0xc9, 0x62},
                                               {0xad, 0xdc, 0x30},
                                               {0xfd, 0xe7, 0x25}}};

const Attribute* vertex_attribute(const Mesh& mesh, const std::string& name) {
  for (const Attribute& attribute : mesh.attributes)
    if (attribute.name == name && attribute.location == Attribute::Location::vertex) return &attribute;
  return nullptr;
}

std::string vertex_attributes(const Mesh& mesh) {
  std::string names;
  for (const Attribute& attribute : mesh.attributes)
    if (attribute.location == Attribute::Location::vertex)
      names += (names.empty() ? "there are " : ", ") + attribute.name;
  return names.empty() ? "there are none" : names;
}

ColourRange range_of(const std::vector<double>& values) {
  ColourRange range{HUGE_VAL, -HUGE_VAL};
  for (const double value : values)
    if (std::isfinite(value)) range = {std::min(range.low, value), std::max(range.high, value)};
  return range.low <= range.high ? range : ColourRange{0, 0};
}

double share_of(double value, const ColourRange& range) {
  if (!(range.high > range.low)) return std::isnan(value) ? value : 0.5;
  return (value - range.low) / (range.high - range.low);
}

} // namespace

Colour viridis(double share) {
  if (std::isnan(share)) return colour_of_nan;
  const double place = std::clamp(share, 0.0, 1.0) * (viridis_stops.size() - 1);
  const auto below = std::min(static_cast<std::size_t>(place), viridis_stops.size() - 2);
  const Colour &from = viridis_stops[below], &to = viridis_stops[below + 1];
  const auto between = [&](std::uint8_t a, std::uint8_t b) {
    return static_cast<std::uint8_t>(std::lround(std::lerp(a, b, place - static_cast<double>(below))));
  };
  return {between(from.red, to.red), between(from.green, to.green), between(from.blue, to.blue)};
}

Result<ColourRange> colour_vertices(Mesh& mesh, const std::string& name, std::optional<ColourRange> range) {
  const Attribute* attribute = vertex_attribute(mesh, name);
  if (!attribute)
    return Error{Code::invalid_argument,
                 text("the vertices have no data '", name, "' to colour by; ", vertex_attributes(mesh))};
  if (attribute->components != 1)
    return Error{Code::invalid_argument, text("'", name, "' has ", attribute->components,
                                              " components; colours are given by data of one")};
  std::vector<double> values;
  std::visit([&](const auto& stored) { values.assign(stored.begin(), stored.end()); }, attribute->values);
  if (!range) range = range_of(values);

  std::erase_if(mesh.attributes, [](const Attribute& old) {
    return old.location == Attribute::Location::vertex &&
           (old.name == "red" || old.name == "green" || old.name == "blue");
  });
  std::array<std::vector<std::int32_t>, 3> channels;
  for (const double value : values) {
    const Colour colour = viridis(share_of(value, *range));
    channels[0].push_back(colour.red);
    channels[1].push_back(colour.green);
    channels[2].push_back(colour.blue);
  }
  constexpr const char* names[] = {"red", "green", "blue"};
  for (std::size_t channel = 0; channel < 3; ++channel)
    mesh.attributes.push_back({names[channel], Attribute::Location::vertex, 1, std::move(channels[channel])});
  return *range;
}

} // namespace hyperiso
