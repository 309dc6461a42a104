// Two ways to cut: through the inside of cells (cut.hpp), and along a layer of samples (trace.hpp).

#include "hyperiso/slice.hpp"

#include "core/text.hpp"
#include "slice/check_plane.hpp"
#include "slice/cut.hpp"
#include "slice/trace.hpp"

#include <new>

namespace hyperiso {

template <int D, int K>
Result<SimplexMesh<D - 1, K - 1>> slice(const SimplexMesh<D, K>& mesh, const Hyperplane<D>& plane,
                                        const SliceOptions& options) {
  if (const Status valid = check_plane(plane); !valid) return valid.error();
  const auto all = [&](auto&& use) {
    for (std::uint64_t simplex = 0; simplex < mesh.simplex_count(); ++simplex) use(simplex);
  };
  try {
    if (const auto layer = layer_in(mesh, plane)) return Trace<D, K>(mesh, *layer, all).mesh(options);
    return cut_inside(mesh, plane, options, all);
  } catch (const std::bad_alloc&) {
    return Error{Code::out_of_memory,
                 text("not enough memory to slice ", mesh.simplex_count(), " simplices")};
  }
}

template <int D>
PlaneCoordinates plane_coordinates(const Hyperplane<D>& plane, SliceFrame kind) {
  const Frame<D> frame(plane, kind);
  PlaneCoordinates result;
  for (std::size_t row = 0; row < D - 1; ++row) {
    result.rows.emplace_back(frame.rows[row].begin(), frame.rows[row].end());
    result.directions.emplace_back(frame.directions[row].begin(), frame.directions[row].end());
  }
  result.foot.assign(frame.foot.begin(), frame.foot.end());
  return result;
}

template <int D>
Attribute axis_on_slice(const Mesh& cut, const Hyperplane<D>& plane, SliceFrame kind, int axis,
                        std::string name) {
  const Frame<D> frame(plane, kind);
  std::vector<double> values(cut.vertex_count());
  for (std::size_t vertex = 0; vertex < values.size(); ++vertex) {
    values[vertex] = frame.foot[axis];
    for (std::size_t k = 0; k < D - 1; ++k)
      values[vertex] += frame.directions[k][axis] * cut.positions[vertex * (D - 1) + k];
  }
  if (cut.positions.wide()) return {std::move(name), Attribute::Location::vertex, 1, std::move(values)};
  return {std::move(name), Attribute::Location::vertex, 1, std::vector<float>(values.begin(), values.end())};
}

template PlaneCoordinates plane_coordinates(const Hyperplane<3>&, SliceFrame);
template PlaneCoordinates plane_coordinates(const Hyperplane<4>&, SliceFrame);
template Attribute axis_on_slice(const Mesh&, const Hyperplane<3>&, SliceFrame, int, std::string);
template Attribute axis_on_slice(const Mesh&, const Hyperplane<4>&, SliceFrame, int, std::string);

#define HYPERISO_INSTANTIATE_SLICE(D, K)                                                                     \
  template Result<SimplexMesh<D - 1, K - 1>> slice(const SimplexMesh<D, K>&, const Hyperplane<D>&,           \
                                                   const SliceOptions&)
HYPERISO_INSTANTIATE_SLICE(3, 2);
HYPERISO_INSTANTIATE_SLICE(4, 3);
HYPERISO_INSTANTIATE_SLICE(3, 3);
HYPERISO_INSTANTIATE_SLICE(4, 4);

} // namespace hyperiso
