#pragma once
// The attributes of a mesh on its cut.

#include "slice/edge_numbers.hpp"

#include "hyperiso/mesh.hpp"

#include <array>
#include <cmath>
#include <variant>
#include <vector>

namespace hyperiso {

// A normal of the mesh as one of the cut, in the plane: of length 1, 0 where none is left. `directions` are
// those of the coordinates on the plane.
template <std::size_t D>
void turn_normals(Mesh& cut, const std::array<std::array<double, D>, D - 1>& directions) {
  const auto turned = [&]<class Value>(const std::vector<Value>& normals) {
    std::vector<Value> result;
    for (std::size_t start = 0; start + D <= normals.size(); start += D) {
      std::array<double, D - 1> normal{};
      double length = 0;
      for (std::size_t row = 0; row < D - 1; ++row) {
        for (std::size_t k = 0; k < D; ++k)
          normal[row] += directions[row][k] * static_cast<double>(normals[start + k]);
        length = std::hypot(length, normal[row]);
      }
      for (const double component : normal)
        result.push_back(static_cast<Value>(length > 0 ? component / length : 0));
    }
    return result;
  };
  for (Attribute& attribute : cut.attributes) {
    if (attribute.location != Attribute::Location::vertex || attribute.name != normal_attribute ||
        attribute.components != static_cast<int>(D))
      continue;
    attribute.components = static_cast<int>(D) - 1;
    std::visit([&](auto& values) { values = turned(values); }, attribute.values);
  }
}

// Vertex i of the cut lies at weights[i] along vertices[i]; simplex i lies in simplex sources[i] of the mesh.
template <class Index>
void carry_attributes(const Mesh& mesh, const Array<MeshEdge<Index>>& vertices, const Array<double>& weights,
                      const Array<std::uint64_t>& sources, Mesh& cut) {
  const auto on_cut = [&](const Attribute& attribute, const auto& values) {
    const auto components = static_cast<std::size_t>(attribute.components);
    std::decay_t<decltype(values)> carried;
    using Value = typename decltype(carried)::value_type;
    if (attribute.location == Attribute::Location::simplex) {
      for (const std::uint64_t source : sources)
        for (std::size_t k = 0; k < components; ++k) carried.push_back(values[source * components + k]);
    } else {
      for (std::size_t vertex = 0; vertex < vertices.size(); ++vertex)
        for (std::size_t k = 0; k < components; ++k) {
          const auto lower =
              static_cast<double>(values[std::size_t{vertices[vertex].lower} * components + k]);
          const auto upper =
              static_cast<double>(values[std::size_t{vertices[vertex].upper} * components + k]);
          carried.push_back(static_cast<Value>(lower + weights[vertex] * (upper - lower)));
        }
    }
    return carried;
  };
  for (const Attribute& attribute : mesh.attributes) {
    Attribute carried{attribute.name, attribute.location, attribute.components, {}};
    std::visit([&](const auto& values) { carried.values = on_cut(attribute, values); }, attribute.values);
    cut.attributes.push_back(std::move(carried));
  }
}

} // namespace hyperiso
