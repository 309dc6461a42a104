#pragma once
/// \file
/// Simplex meshes: what extraction makes and what everything after it works on.

#include "hyperiso/grid.hpp"
#include "hyperiso/number_array.hpp"
#include "hyperiso/result.hpp"

#include <cstdint>
#include <optional>
#include <string>
#include <variant>
#include <vector>

namespace hyperiso {

/// Numbers that belong to the vertices or to the simplices of a mesh.
struct Attribute {
  enum class Location { vertex, simplex };
  std::string name;
  Location location = Location::vertex;
  int components = 1;
  std::variant<std::vector<float>, std::vector<double>, std::vector<std::int32_t>, std::vector<std::int64_t>>
      values; ///< (vertices or simplices) x components
};

/// The name of the vertex attribute, of D components, that holds unit normals of a surface in R^D. Whatever
/// moves or cuts a mesh turns it along; other attributes are numbers that stay as they are.
inline constexpr const char* normal_attribute = "normal";

/// A welded, oriented mesh of K-simplices in R^D, its dimensions known at run time.
struct Mesh {
  Mesh(int dimension_, int simplex_dimension_)
      : dimension(dimension_), simplex_dimension(simplex_dimension_) {}

  int dimension;           ///< D, of the space
  int simplex_dimension;   ///< K: D-1 for a surface, D for an interval volume
  PositionArray positions; ///< vertices x D, f32 or f64
  IndexArray simplices;    ///< simplices x (K+1), 32- or 64-bit vertex numbers

  /// Where each vertex came from: vertices numbers of grid edges, ascending, or empty (see GridEdge).
  /// `grid_axes` are the axes of that grid; `coordinate` of a vertex along an axis that its edge does not
  /// run along is that of the edge's samples, to the bit (rounded to f32 if positions are). An axis whose
  /// origin is NaN has no coordinates any more: `transform` has mixed it with others.
  Array<GridEdge> edges;
  std::vector<Axis> grid_axes;

  std::uint64_t active_cells = 0; ///< grid cells that the simplices came from; 0 if not known

  std::vector<Attribute> attributes;

  std::size_t vertex_count() const { return positions.size() / static_cast<std::size_t>(dimension); }
  std::size_t simplex_count() const {
    return simplices.size() / static_cast<std::size_t>(simplex_dimension + 1);
  }
};

/// The same with its dimensions in the type.
template <int D, int K = D - 1>
struct SimplexMesh : Mesh {
  SimplexMesh() : Mesh(D, K) {}
  /// Takes over a mesh. Requires that its dimensions are D and K.
  explicit SimplexMesh(Mesh&& mesh) : Mesh(std::move(mesh)) {}
};

/// D-simplices in R^D.
template <int D>
using VolumeMesh = SimplexMesh<D, D>;

/// Moves the vertices by an affine map and turns the simplices where the map reflects, so that normals still
/// point from + to -. `grid_axes` and the attribute `normal` move along. Requires that `map` has the mesh's
/// dimension.
void transform(Mesh& mesh, const Affine& map);

} // namespace hyperiso
