#pragma once
// Meshes without geometry worth the name, to be written to files and read back.

#include "hyperiso/mesh.hpp"

#include <algorithm>
#include <array>
#include <cstdint>
#include <numeric>
#include <random>

namespace hyperiso {

struct MeshKind {
  int dimension, simplex_dimension;
  bool f64 = false;
  std::size_t vertices = 12, simplices = 7;
};

// Positions and simplices at random, no corner twice in a simplex; attributes of every type, one of them with
// three components.
inline Mesh random_mesh(const MeshKind& kind) {
  std::mt19937 random(1);
  Mesh mesh(kind.dimension, kind.simplex_dimension);
  mesh.positions.reset(kind.vertices * static_cast<std::size_t>(kind.dimension), kind.f64);
  std::normal_distribution<double> coordinate(0, 10);
  for (std::size_t i = 0; i < mesh.positions.size(); ++i) mesh.positions.set(i, coordinate(random));
  mesh.simplices.reset(kind.simplices * static_cast<std::size_t>(kind.simplex_dimension + 1), false);
  for (std::size_t simplex = 0, i = 0; simplex < kind.simplices; ++simplex)
    for (std::size_t vertex = random(); i < (simplex + 1) * (mesh.simplices.size() / kind.simplices); ++i)
      mesh.simplices.set(i, vertex++ % kind.vertices);

  std::vector<float> f32(kind.vertices);
  std::vector<double> f64(3 * kind.vertices);
  std::vector<std::int32_t> i32(kind.simplices);
  std::vector<std::int64_t> i64(kind.simplices);
  for (float& value : f32) value = static_cast<float>(coordinate(random));
  for (double& value : f64) value = coordinate(random);
  std::iota(i32.begin(), i32.end(), -3);
  std::iota(i64.begin(), i64.end(), -2);
  using enum Attribute::Location;
  mesh.attributes = {{"heat", vertex, 1, f32},
                     {"velocity <m/s> & \"more\"", vertex, 3, f64},
                     {"component", simplex, 1, i32},
                     {"cell", simplex, 1, i64}};
  return mesh;
}

// Gives the mesh grid edges of a grid that has an uneven and a cropped axis.
template <int D>
void add_edges(Mesh& mesh) {
  std::array<std::int64_t, D> dims;
  for (std::size_t axis = 0; axis < D; ++axis) {
    dims[axis] = 9 + static_cast<std::int64_t>(axis);
    mesh.grid_axes.push_back(
        {dims[axis], 3, 0.1, -0.3, {}, std::string(1, "xyztv"[axis]), axis < 3 ? "mm" : "\u00b5s"});
  }
  mesh.grid_axes[D - 1].coordinates.resize(static_cast<std::size_t>(dims[D - 1]));
  std::iota(mesh.grid_axes[D - 1].coordinates.begin(), mesh.grid_axes[D - 1].coordinates.end(), 0.5);
  std::array<std::int64_t, D> upper;
  upper.fill(1);
  std::vector<GridEdge> edges;
  for (std::size_t vertex = 0; vertex < mesh.vertex_count(); ++vertex) {
    edges.push_back(grid_edge<D>(dims, upper, 1 + vertex % 2));
    if (vertex % 2 == 1) ++upper[1 + vertex / 2 % (D - 1)];
  }
  std::sort(edges.begin(), edges.end());
  mesh.edges.assign(edges.begin(), edges.end());
  mesh.active_cells = 42;
}

} // namespace hyperiso
