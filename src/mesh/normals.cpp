#include "mesh/normals.hpp"

#include "mesh/attributes.hpp"

#include <array>
#include <cmath>

namespace hyperiso {
namespace {

using Vector = std::array<double, 3>;

std::vector<Vector> attribute_normals(const Mesh& mesh) {
  std::vector<Vector> normals;
  const Attribute* attribute = find_attribute(mesh, Attribute::Location::vertex, normal_attribute, 3);
  if (!attribute) return normals;
  normals.resize(mesh.vertex_count());
  for (std::size_t k = 0; k < 3 * normals.size(); ++k) normals[k / 3][k % 3] = value_of(*attribute, k);
  return normals;
}

std::vector<Vector> area_weighted_normals(const Mesh& mesh) {
  std::vector<Vector> normals(mesh.vertex_count());
  for (std::size_t triangle = 0; triangle < mesh.simplex_count(); ++triangle) {
    std::array<Vector, 3> corners;
    for (std::size_t corner = 0; corner < 3; ++corner)
      for (std::size_t k = 0; k < 3; ++k)
        corners[corner][k] = mesh.positions[mesh.simplices[triangle * 3 + corner] * 3 + k];
    const Vector normal = triangle_normal(corners);
    for (std::size_t corner = 0; corner < 3; ++corner)
      for (std::size_t k = 0; k < 3; ++k) normals[mesh.simplices[triangle * 3 + corner]][k] += normal[k];
  }
  return normals;
}

} // namespace

std::vector<float> vertex_normals(const Mesh& mesh) {
  std::vector<Vector> normals = attribute_normals(mesh);
  if (normals.empty()) normals = area_weighted_normals(mesh);
  std::vector<float> result;
  result.reserve(3 * normals.size());
  for (const Vector& normal : normals) {
    const double length = std::hypot(normal[0], normal[1], normal[2]);
    const bool known = length > 0 && std::isfinite(length);
    for (std::size_t k = 0; k < 3; ++k)
      result.push_back(known ? static_cast<float>(normal[k] / length) : k == 2 ? 1.0f : 0.0f);
  }
  return result;
}

} // namespace hyperiso
