#include "hyperiso/mesh.hpp"

#include "core/determinant.hpp"

namespace hyperiso {

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
  if (determinant(map.linear, mesh.dimension) > 0) return;
  const auto corners = static_cast<std::size_t>(mesh.simplex_dimension + 1);
  mesh.simplices.visit([&](auto simplices) {
    for (std::size_t start = 0; start < simplices.size(); start += corners)
      std::swap(simplices[start], simplices[start + 1]);
  });
}

} // namespace hyperiso
