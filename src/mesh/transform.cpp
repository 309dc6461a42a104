#include "hyperiso/mesh.hpp"

#include "core/determinant.hpp"

#include <algorithm>
#include <limits>

namespace hyperiso {
namespace {

// Whether the image of an axis depends on it alone, and nothing else does.
bool stands_alone(const Affine& map, std::size_t axis) {
  const std::size_t D = map.offset.size();
  for (std::size_t other = 0; other < D; ++other)
    if (other != axis && (map.linear[axis * D + other] != 0 || map.linear[other * D + axis] != 0))
      return false;
  return true;
}

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
  if (determinant(map.linear, mesh.dimension) > 0) return;
  const auto corners = static_cast<std::size_t>(mesh.simplex_dimension + 1);
  mesh.simplices.visit([&](auto simplices) {
    for (std::size_t start = 0; start < simplices.size(); start += corners)
      std::swap(simplices[start], simplices[start + 1]);
  });
}

} // namespace hyperiso
