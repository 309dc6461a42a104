#pragma once
// A cut that is made slab by slab.

#include "slice/cut.hpp"

#include <optional>

namespace hyperiso {

// The cuts of the meshes of consecutive slabs of one grid by one plane, as one mesh. A vertex is known by the
// mesh edge it lies on, and that by the grid edges of its two ends on the grid of the whole; so what two
// slabs both have is there once. The order of the grid edges of a slab is theirs in the whole, so every
// simplex is cut as it would be there.
template <int D, int K>
class SlabJoin {
  static constexpr std::size_t N = K + 1; // axes of the grid: a volume has that of levels besides

 public:
  // `axes`: of the whole.
  SlabJoin(const std::vector<Axis>& axes, const Hyperplane<D>& plane, Precision precision, SliceFrame frame)
      : axes_(axes), plane_(plane), frame_(frame), numbers_(edges_) {
    for (std::size_t axis = 0; axis < N; ++axis) dims_[axis] = axes[axis].count;
    cut_.positions.reset(0, precision == Precision::f64);
    cut_.simplices.reset(0, true);
  }

  // `slab` has its grid edges, on a crop of the whole grid.
  void add(const SimplexMesh<D, K>& slab) {
    plane_in_mesh_.emplace(slab, plane_, frame_);
    slab.positions.visit([&](auto positions) {
      slab.simplices.visit([&](auto simplices) { add(slab, positions, simplices); });
    });
  }

  SimplexMesh<D - 1, K - 1> mesh() && {
    if (plane_in_mesh_) turn_normals<D>(cut_, plane_in_mesh_->directions());
    if (cut_.vertex_count() <= UINT32_MAX) {
      IndexArray narrow;
      narrow.reset(cut_.simplices.size(), false);
      for (std::size_t corner = 0; corner < narrow.size(); ++corner)
        narrow.set(corner, cut_.simplices[corner]);
      cut_.simplices = std::move(narrow);
    }
    return std::move(cut_);
  }

 private:
  // The number of a grid edge of a slab on the grid of the whole.
  GridEdge edge_in_whole(const Mesh& slab, std::uint64_t vertex) const {
    std::array<std::int64_t, N> dims;
    for (std::size_t axis = 0; axis < N; ++axis) dims[axis] = slab.grid_axes[axis].count;
    auto ends = grid_edge_ends<static_cast<int>(N)>(dims, slab.edges[vertex]);
    for (std::size_t axis = 0; axis < N; ++axis)
      ends.upper[axis] += slab.grid_axes[axis].first - axes_[axis].first;
    return grid_edge<static_cast<int>(N)>(dims_, ends.upper, ends.direction);
  }

  template <class Real, class Index>
  void add(const SimplexMesh<D, K>& slab, std::span<const Real> positions, std::span<const Index> simplices) {
    CutCorners<std::uint64_t> corners;
    Array<MeshEdge<Index>> vertices; // of those that are new: the edge of the slab's mesh
    cut_simplices<D, K, Real, Index>(
        positions, simplices, *plane_in_mesh_,
        [&](auto&& use) {
          for (std::uint64_t simplex = 0; simplex < slab.simplex_count(); ++simplex) use(simplex);
        },
        [&](MeshEdge<Index> edge) {
          const std::size_t before = edges_.size();
          const std::uint64_t number =
              numbers_.number({edge_in_whole(slab, edge.lower), edge_in_whole(slab, edge.upper)});
          if (edges_.size() > before) vertices.push_back(edge);
          return number;
        },
        corners);

    SimplexMesh<D - 1, K - 1> part;
    part.positions.reset(vertices.size() * (D - 1), cut_.positions.wide());
    const auto weights = part.positions.visit([&](auto coordinates) {
      return place_vertices<D>(positions, vertices, *plane_in_mesh_, coordinates);
    });
    carry_attributes<Index>(slab, vertices, weights, corners.sources, part);
    append(part, corners.corners);
  }

  void append(const Mesh& part, const Array<std::uint64_t>& corners) {
    const std::size_t coordinates = cut_.positions.size(), first_corner = cut_.simplices.size();
    cut_.positions.resize(coordinates + part.positions.size());
    for (std::size_t i = 0; i < part.positions.size(); ++i)
      cut_.positions.set(coordinates + i, part.positions[i]);
    cut_.simplices.resize(first_corner + corners.size());
    for (std::size_t i = 0; i < corners.size(); ++i) cut_.simplices.set(first_corner + i, corners[i]);
    if (cut_.attributes.empty()) {
      cut_.attributes = part.attributes;
      return;
    }
    for (std::size_t number = 0; number < part.attributes.size(); ++number)
      std::visit(
          [&](auto& values) {
            const auto& more = std::get<std::decay_t<decltype(values)>>(part.attributes[number].values);
            values.insert(values.end(), more.begin(), more.end());
          },
          cut_.attributes[number].values);
  }

  const std::vector<Axis> axes_;
  const Hyperplane<D>& plane_;
  const SliceFrame frame_;
  std::array<std::int64_t, N> dims_;
  std::optional<CutPlane<D>> plane_in_mesh_;
  Array<MeshEdge<std::uint64_t>> edges_; // of each vertex: the grid edges of the whole at its ends
  EdgeNumbers<std::uint64_t> numbers_;
  SimplexMesh<D - 1, K - 1> cut_;
};

} // namespace hyperiso
