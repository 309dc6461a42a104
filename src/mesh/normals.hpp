#pragma once
// Normals for shading.

#include "hyperiso/mesh.hpp"

#include <vector>

namespace hyperiso {

// A unit normal for each vertex of a mesh of triangles in R^3, three numbers each: its attribute `normal`
// where it has one of three components, else the mean of the triangles around it by area. A vertex without
// either, on triangles without area, gets (0, 0, 1).
std::vector<float> vertex_normals(const Mesh& mesh);

} // namespace hyperiso
