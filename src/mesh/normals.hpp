#pragma once
// Normals for shading.

#include "hyperiso/mesh.hpp"

#include <array>
#include <vector>

namespace hyperiso {

// At right angles to a triangle, on the side from which its corners turn to the left; twice its area long.
inline std::array<double, 3> triangle_normal(const std::array<std::array<double, 3>, 3>& corners) {
  std::array<double, 3> u, v;
  for (std::size_t k = 0; k < 3; ++k) {
    u[k] = corners[1][k] - corners[0][k];
    v[k] = corners[2][k] - corners[0][k];
  }
  return {u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]};
}

// A unit normal for each vertex of a mesh of triangles in R^3, three numbers each: its attribute `normal`
// where it has one of three components, else the mean of the triangles around it by area. A vertex without
// either, on triangles without area, gets (0, 0, 1).
std::vector<float> vertex_normals(const Mesh& mesh);

} // namespace hyperiso
