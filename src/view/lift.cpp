#include "view/lift.hpp"

#include "mesh/attributes.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <string_view>

namespace hyperiso {
namespace {

// The numbers of a vertex attribute; nothing if there is none of the name.
std::optional<std::vector<double>> numbers_of(const Mesh& mesh, std::string_view name) {
  const Attribute* attribute = find_attribute(mesh, Attribute::Location::vertex, name);
  if (!attribute) return std::nullopt;
  return std::visit([](const auto& values) { return std::vector<double>(values.begin(), values.end()); },
                    attribute->values);
}

} // namespace

std::optional<Mesh> lifted(const Mesh& volume) {
  const auto isovalues = numbers_of(volume, "isovalue");
  const int D = volume.dimension;
  if (volume.simplex_dimension != D || D < 2 || D > 3 || !isovalues) return std::nullopt;
  Mesh surface(D + 1, D);
  surface.positions.reset(volume.vertex_count() * static_cast<std::size_t>(D + 1), volume.positions.wide());
  for (std::size_t vertex = 0, from = 0, to = 0; vertex < volume.vertex_count(); ++vertex) {
    for (int axis = 0; axis < D; ++axis) surface.positions.set(to++, volume.positions[from++]);
    surface.positions.set(to++, (*isovalues)[vertex]);
  }
  surface.simplices = volume.simplices;
  // Normals point from + to -, so towards larger isovalues. Beside a simplex that is oriented positively,
  // this direction, as the last coordinate, passes D rows on its way to the first of the determinant.
  if (D % 2 == 1)
    surface.simplices.visit([&](auto simplices) {
      for (std::size_t i = 0; i < simplices.size(); i += static_cast<std::size_t>(D + 1))
        std::swap(simplices[i], simplices[i + 1]);
    });
  for (const Attribute& attribute : volume.attributes)
    if (attribute.name != "isovalue") surface.attributes.push_back(attribute);
  return surface;
}

Axis isovalue_axis(const Mesh& volume) {
  const auto isovalues = numbers_of(volume, "isovalue").value_or(std::vector<double>{}),
             levels = numbers_of(volume, "level").value_or(std::vector<double>{});
  std::map<double, double> known;
  for (std::size_t vertex = 0; vertex < std::min(levels.size(), isovalues.size()); ++vertex)
    if (levels[vertex] == std::round(levels[vertex])) known.emplace(levels[vertex], isovalues[vertex]);
  Axis axis;
  axis.name = "isovalue";
  for (const auto& [level, isovalue] : known)
    if (axis.coordinates.empty() || isovalue > axis.coordinates.back()) axis.coordinates.push_back(isovalue);
  axis.count = static_cast<std::int64_t>(axis.coordinates.size());
  if (axis.count < 2) axis.count = 0, axis.coordinates.clear();
  return axis;
}

} // namespace hyperiso
