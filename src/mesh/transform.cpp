#include "hyperiso/mesh.hpp"

#include "core/affine.hpp"
#include "core/determinant.hpp"

#include <algorithm>
#include <limits>

namespace hyperiso {
namespace {

// The axis where the map puts its samples. From the coordinates as positions hold them, so that vertices
// beside samples have the coordinates of these, to the bit.
void move_axis(Axis& axis, double scale, double offset, bool f64) {
  if (scale == 1 && offset == 0) return;
  std::vector<double> coordinates(static_cast<std::size_t>(axis.count));
  for (std::int64_t i = 0; i < axis.count; ++i) {
    const double stored =
        f64 ? axis.coordinate(i) : static_cast<double>(static_cast<float>(axis.coordinate(i)));
    coordinates[static_cast<std::size_t>(i)] = offset + scale * stored;
  }
  axis.origin = offset + scale * axis.origin;
  axis.spacing *= scale;
  axis.coordinates = std::move(coordinates);
}

void move_grid(Mesh& mesh, const Affine& map) {
  const auto D = static_cast<std::size_t>(mesh.dimension);
  for (std::size_t axis = 0; axis < std::min(D, mesh.grid_axes.size()); ++axis) { // not that of levels
    if (stands_alone(map, axis)) {
      move_axis(mesh.grid_axes[axis], map.linear[axis * D + axis], map.offset[axis], mesh.positions.wide());
    } else {
      mesh.grid_axes[axis].origin = std::numeric_limits<double>::quiet_NaN();
      mesh.grid_axes[axis].coordinates.clear();
    }
  }
}

// Matrix of the cofactors of `linear`, of D rows of D: the inverse transposed, times the determinant. Normals
// turn by it, up to their length.
std::vector<double> cofactors(const std::vector<double>& linear, std::size_t D) {
  std::vector<double> result(D * D);
  for (std::size_t row = 0; row < D; ++row)
    for (std::size_t column = 0; column < D; ++column) {
      std::vector<double> minor;
      for (std::size_t r = 0; r < D; ++r)
        for (std::size_t c = 0; c < D; ++c)
          if (r != row && c != column) minor.push_back(linear[r * D + c]);
      result[row * D + column] =
          ((row + column) % 2 == 0 ? 1 : -1) * determinant(minor, static_cast<int>(D) - 1);
    }
  return result;
}

void turn_normals(Mesh& mesh, const Affine& map) {
  const auto D = static_cast<std::size_t>(mesh.dimension);
  const double sign = determinant(map.linear, mesh.dimension) < 0 ? -1 : 1;
  const std::vector<double> matrix = cofactors(map.linear, D);
  const auto turn = [&](auto& values) {
    using Value = typename std::decay_t<decltype(values)>::value_type;
    std::vector<double> image(D);
    for (std::size_t start = 0; start + D <= values.size(); start += D) {
      double length = 0;
      for (std::size_t row = 0; row < D; ++row) {
        image[row] = 0;
        for (std::size_t column = 0; column < D; ++column)
          image[row] += sign * matrix[row * D + column] * static_cast<double>(values[start + column]);
        length = std::hypot(length, image[row]);
      }
      for (std::size_t row = 0; row < D; ++row)
        values[start + row] = static_cast<Value>(length > 0 ? image[row] / length : 0);
    }
  };
  for (Attribute& attribute : mesh.attributes)
    if (attribute.location == Attribute::Location::vertex && attribute.name == normal_attribute &&
        attribute.components == mesh.dimension)
      std::visit(turn, attribute.values);
}

} // namespace

void transform(Mesh& mesh, const Affine& map) {
  const auto D = static_cast<std::size_t>(mesh.dimension);
  std::vector<double> image(D);
  mesh.positions.visit([&](auto positions) {
    using Real = typename decltype(positions)::value_type;
    for (std::size_t start = 0; start < positions.size(); start += D) {
      for (std::size_t row = 0; row < D; ++row) {
        image[row] = map.offset[row];
        for (std::size_t column = 0; column < D; ++column)
          image[row] += map.linear[row * D + column] * static_cast<double>(positions[start + column]);
      }
      for (std::size_t row = 0; row < D; ++row) positions[start + row] = static_cast<Real>(image[row]);
    }
  });
  move_grid(mesh, map);
  turn_normals(mesh, map);
  if (determinant(map.linear, mesh.dimension) > 0) return;
  const auto corners = static_cast<std::size_t>(mesh.simplex_dimension + 1);
  mesh.simplices.visit([&](auto simplices) {
    for (std::size_t start = 0; start < simplices.size(); start += corners)
      std::swap(simplices[start], simplices[start + 1]);
  });
}

} // namespace hyperiso
