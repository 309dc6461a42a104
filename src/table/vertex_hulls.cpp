#include "table/vertex_hulls.hpp"

#include "table/cube.hpp"
#include "table/half_space.hpp"

#include <bit>
#include <cassert>
#include <vector>

namespace hyperiso {

template <int D>
VertexHulls<D>::VertexHulls() {
  std::vector<IntegerVector<D>> vertices;
  for (int vertex = 0; vertex < 1 << D; ++vertex) vertices.push_back(cube_vertex<D>(vertex));
  std::size_t hyperplane = 0;
  for (const HalfSpace<D>& half_space : spanned_hyperplanes<D>(vertices)) {
    for (std::size_t vertex = 0; vertex < vertices.size(); ++vertex) {
      const std::int64_t height = half_space.height(vertices[vertex]);
      sides_of_vertex_[vertex].below[hyperplane] = height <= 0;
      sides_of_vertex_[vertex].above[hyperplane] = height >= 0;
    }
    ++hyperplane;
  }
  assert(hyperplane == hyperplanes);
}

template <int D>
typename VertexHulls<D>::Sides VertexHulls<D>::sides(CubeLabels vertices) const {
  Sides sides;
  sides.below.set();
  sides.above.set();
  for (; vertices != 0; vertices &= vertices - 1) {
    const Sides& vertex = sides_of_vertex_[static_cast<std::size_t>(std::countr_zero(vertices))];
    sides.below &= vertex.below;
    sides.above &= vertex.above;
  }
  return sides;
}

template class VertexHulls<2>;
template class VertexHulls<3>;
template class VertexHulls<4>;

} // namespace hyperiso
