#pragma once
/// \file
/// Colours for numbers: the one place that pictures, films and coloured meshes take them from.

#include "hyperiso/mesh.hpp"

#include <cstdint>
#include <optional>
#include <string>

namespace hyperiso {

/// sRGB.
struct Colour {
  std::uint8_t red, green, blue;
  friend bool operator==(const Colour&, const Colour&) = default;
};

/// Of what has no value.
inline constexpr Colour colour_of_nan{128, 128, 128};

/// The colour of `share` in [0, 1], which is clamped: viridis (S. van der Walt, N. Smith, 2015), dark blue to
/// yellow, equal steps of which look equal, also without colour and to the colour-blind. Nine of its colours,
/// linear in sRGB in between; the viewer (viewer/src/colours.ts) has the same. NaN: colour_of_nan.
Colour viridis(double share);

/// A colour for a track or another number that is a name: neighbouring numbers are told apart by hue, a
/// golden angle from one to the next, and by lightness.
Colour label_colour(std::int64_t label);

/// The values that get the first and the last colour.
struct ColourRange {
  double low, high;
};

/// Colours the vertices of a mesh by their attribute `name`, which must have one component: adds the vertex
/// attributes `red`, `green` and `blue`, 0 to 255, in the place of such ones as there are; `write_mesh` makes
/// them the vertex colours of a .ply. `range`: left out, from the smallest to the largest finite value; a
/// range without extent gives the middle colour. Errors: invalid_argument if there is no such attribute, or
/// it has several components; out_of_memory. Gives the range it took.
Result<ColourRange> colour_vertices(Mesh& mesh, const std::string& name,
                                    std::optional<ColourRange> range = std::nullopt);

} // namespace hyperiso
