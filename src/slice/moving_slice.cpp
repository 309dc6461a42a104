// Slices whose vertices slide along the edges of the mesh.

#include "core/text.hpp"
#include "hyperiso/slice.hpp"
#include "slice/cut.hpp"

#include <algorithm>
#include <cmath>
#include <new>

namespace hyperiso {
namespace {

// The vertices on `edges` at `time`, or at the end of their edge that is nearest to it.
template <int D>
SimplexMesh<D - 1> placed_at(double time, int axis, const SimplexMesh<D>& mesh,
                             const CutCorners<std::uint64_t>& cut, const CutPlane<D>& plane,
                             Precision precision) {
  SimplexMesh<D - 1> placed;
  placed.positions.reset(cut.vertices.size() * (D - 1), precision == Precision::f64);
  Array<double> weights;
  weights.reset(cut.vertices.size());
  for (std::size_t vertex = 0; vertex < cut.vertices.size(); ++vertex) {
    const auto lower = position_of<D>(mesh, cut.vertices[vertex].lower),
               upper = position_of<D>(mesh, cut.vertices[vertex].upper);
    const auto [first, last] = std::minmax(lower[axis], upper[axis]);
    const double when = std::clamp(time, first, last);
    const PointOnEdge<D> point(plane, lower, lower[axis] - when, upper, upper[axis] - when);
    weights[vertex] = point.weight;
    for (std::size_t k = 0; k < D - 1; ++k) placed.positions.set(vertex * (D - 1) + k, point.coordinates[k]);
  }
  placed.simplices.reset(cut.corners.size(), cut.vertices.size() > UINT32_MAX);
  for (std::size_t corner = 0; corner < cut.corners.size(); ++corner)
    placed.simplices.set(corner, cut.corners[corner]);
  carry_attributes<std::uint64_t>(mesh, cut.vertices, weights, cut.sources, placed);
  turn_normals<D>(placed, plane.directions());
  return placed;
}

template <int D>
MovingSlice<D> cut_moving(const SimplexMesh<D>& mesh, double start, double end, Precision precision,
                          int axis) {
  const CutPlane<D> from(mesh, Hyperplane<D>::at(axis, start), SliceFrame::orthonormal);
  const CutPlane<D> to(mesh, Hyperplane<D>::at(axis, end), SliceFrame::orthonormal);
  // Vertices at `start` are on the side that is left behind.
  const CutPlane<D> between = start < end ? from.just_after() : from;
  CutCorners<std::uint64_t> cut;
  EdgeNumbers<std::uint64_t> numbers(cut.vertices);
  mesh.positions.visit([&](auto positions) {
    mesh.simplices.visit([&]<class Index>(std::span<const Index> simplices) {
      cut_simplices<D, D - 1>(
          positions, simplices, between,
          [&](auto&& use) {
            for (std::uint64_t simplex = 0; simplex < mesh.simplex_count(); ++simplex) use(simplex);
          },
          [&](MeshEdge<Index> edge) {
            return numbers.number({edge.lower, edge.upper});
          },
          cut);
    });
  });
  return {placed_at(from.value(), axis, mesh, cut, from, precision),
          placed_at(to.value(), axis, mesh, cut, from, precision)};
}

} // namespace

template <int D>
Result<MovingSlice<D>> moving_slice(const SimplexMesh<D>& mesh, double start, double end, Precision precision,
                                    int axis) {
  if (axis < 0 || axis >= D)
    return Error{Code::invalid_argument, text("axis ", axis, " is none of the ", D, " axes of the surface")};
  if (!std::isfinite(start) || !std::isfinite(end) || start == end)
    return Error{Code::invalid_argument,
                 text("a slice moves from one time to another, not from ", start, " to ", end)};
  try {
    return cut_moving(mesh, start, end, precision, axis);
  } catch (const std::bad_alloc&) {
    return Error{Code::out_of_memory,
                 text("not enough memory to slice ", mesh.simplex_count(), " simplices")};
  }
}

template Result<MovingSlice<3>> moving_slice(const SimplexMesh<3>&, double, double, Precision, int);
template Result<MovingSlice<4>> moving_slice(const SimplexMesh<4>&, double, double, Precision, int);

} // namespace hyperiso
