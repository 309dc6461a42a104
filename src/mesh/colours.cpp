#include "hyperiso/colours.hpp"

#include "core/text.hpp"
#include "mesh/attributes.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <new>
#include <numbers>

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

// Of the OKLab colour space (Ottosson 2020), where equal steps look equal, to sRGB.
std::array<double, 3> srgb_of_oklch(double lightness, double chroma, double hue) {
  const double a = chroma * std::cos(hue), b = chroma * std::sin(hue);
  const double l = std::pow(lightness + 0.3963377774 * a + 0.2158037573 * b, 3);
  const double m = std::pow(lightness - 0.1055613458 * a - 0.0638541728 * b, 3);
  const double s = std::pow(lightness - 0.0894841775 * a - 1.2914855480 * b, 3);
  std::array<double, 3> rgb{4.0767416621 * l - 3.3077115913 * m + 0.2309699292 * s,
                            -1.2684380046 * l + 2.6097574011 * m - 0.3413193965 * s,
                            -0.0041960863 * l - 0.7034186147 * m + 1.7076147010 * s};
  for (double& channel : rgb) {
    channel = std::clamp(channel, 0.0, 1.0);
    channel = channel <= 0.0031308 ? 12.92 * channel : 1.055 * std::pow(channel, 1 / 2.4) - 0.055;
  }
  return rgb;
}

// Replaces red, green and blue of the vertices by the colours of `attribute`.
ColourRange add_colours(Mesh& mesh, const Attribute& attribute, std::optional<ColourRange> range) {
  std::vector<double> values;
  std::visit([&](const auto& stored) { values.assign(stored.begin(), stored.end()); }, attribute.values);
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

Colour label_colour(std::int64_t label) {
  const double golden_angle = std::numbers::pi * (3 - std::sqrt(5.0));
  const double lightness = label % 3 == 0 ? 0.6 : label % 3 == 1 ? 0.68 : 0.52;
  const auto rgb = srgb_of_oklch(lightness, 0.14, 4.3 + golden_angle * static_cast<double>(label));
  const auto byte = [](double channel) { return static_cast<std::uint8_t>(std::lround(channel * 255)); };
  return {byte(rgb[0]), byte(rgb[1]), byte(rgb[2])};
}

Result<ColourRange> colour_vertices(Mesh& mesh, const std::string& name, std::optional<ColourRange> range) {
  const Attribute* attribute = vertex_attribute(mesh, name);
  if (!attribute)
    return Error{Code::invalid_argument,
                 text("the vertices have no data '", name, "' to colour by; ", vertex_attributes(mesh))};
  if (attribute->components != 1)
    return Error{Code::invalid_argument, text("'", name, "' has ", attribute->components,
                                              " components; colours are given by data of one")};
  try {
    return add_colours(mesh, *attribute, range);
  } catch (const std::bad_alloc&) {
    return Error{Code::out_of_memory,
                 text("not enough memory for the colours of ", mesh.vertex_count(), " vertices")};
  }
}

} // namespace hyperiso
