#pragma once
// The attributes of a mesh on its cut.

#include "slice/edge_numbers.hpp"

#include "hyperiso/mesh.hpp"

#include <variant>
#include <vector>

namespace hyperiso {

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
