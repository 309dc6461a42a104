#pragma once
// Looking for what a mesh knows of its vertices and simplices.

#include "hyperiso/mesh.hpp"

#include <array>
#include <optional>
#include <string_view>

namespace hyperiso {

// The attribute `name`, if there is one of so many components.
inline const Attribute* find_attribute(const Mesh& mesh, Attribute::Location location, std::string_view name,
                                       int components = 1) {
  for (const Attribute& attribute : mesh.attributes)
    if (attribute.name == name && attribute.location == location && attribute.components == components)
      return &attribute;
  return nullptr;
}

// The attribute `name` of the vertices, of however many components.
inline const Attribute* vertex_attribute(const Mesh& mesh, std::string_view name) {
  for (const Attribute& attribute : mesh.attributes)
    if (attribute.name == name && attribute.location == Attribute::Location::vertex) return &attribute;
  return nullptr;
}

// Number `place` of an attribute: that of vertex or simplex `place`, if it has one component.
inline double value_of(const Attribute& attribute, std::size_t place) {
  return std::visit([&](const auto& values) { return static_cast<double>(values[place]); }, attribute.values);
}

// The colours that `colour_vertices` gives, 0 to 255 each; nothing unless all three are there.
using ColourChannels = std::array<const Attribute*, 3>;
inline std::optional<ColourChannels> vertex_colours(const Mesh& mesh) {
  ColourChannels channels;
  for (std::size_t k = 0; k < 3; ++k) {
    channels[k] = find_attribute(mesh, Attribute::Location::vertex, std::array{"red", "green", "blue"}[k]);
    if (!channels[k]) return std::nullopt;
  }
  return channels;
}

// The track of each simplex, -1 for none, if the mesh is parted into tracks.
inline const Attribute* track_of_simplices(const Mesh& mesh) {
  return find_attribute(mesh, Attribute::Location::simplex, "track_id");
}

} // namespace hyperiso
