#pragma once
// The part of a region between two steps, as a slab: a complex of one dimension more than that of a surface.

#include "track/region_mesh.hpp"
#include "track/slab.hpp"

namespace hyperiso::track_detail {

// The grid of a region's slab: the axes of space, the two levels, the two steps. Its edges are those of the
// lifted grid with time as the last axis, so that numbers go on from slab to slab as those of surfaces do.
template <class T, int D>
class RegionSlabSamples {
 public:
  RegionSlabSamples(const FieldView<const T, D>& field, const RegionLevels& levels)
      : vertices_(field, levels), dims_(vertices_.dims()), rows_in_space_(1) {
    std::swap(dims_[D - 1], dims_[D]);
    for (int axis = 1; axis < D - 1; ++axis) rows_in_space_ *= static_cast<GridEdge>(dims_[axis]);
  }

  GridEdge row_length() const { return static_cast<GridEdge>(dims_[0]); }
  GridEdge step_offset() const { return (2 * rows_in_space_ << (D + 1)) * row_length(); }

  // From an edge of the grid with the levels last.
  GridEdge with_time_last(GridEdge edge) const {
    const GridEdge row_and_direction = edge / row_length(), x = edge % row_length();
    const GridEdge row = row_and_direction >> (D + 1), direction = row_and_direction & ((2u << D) - 1);
    const GridEdge in_space = row % rows_in_space_, step = row / rows_in_space_ % 2,
                   level = row / rows_in_space_ / 2;
    const GridEdge along_step = direction >> (D - 1) & 1, along_level = direction >> D & 1;
    const GridEdge space = direction & ((1u << (D - 1)) - 1);
    return (((in_space + rows_in_space_ * (level + 2 * step)) << (D + 1)) |
            (space | along_level << (D - 1) | along_step << D)) *
               row_length() +
           x;
  }
  double time(GridEdge edge) const { return locate(edge).weight; }
  Place place(GridEdge edge) const { return place_at(locate(edge)); }
  Place place_of_upper_end(GridEdge edge) const {
    auto location = locate(edge);
    location.weight = 1;
    return place_at(location);
  }

 private:
  using Location = typename RegionVertices<T, D>::Location;

  Location locate(GridEdge edge) const {
    auto ends = grid_edge_ends<D + 1>(dims_, edge);
    std::swap(ends.lower[D - 1], ends.lower[D]);
    std::swap(ends.upper[D - 1], ends.upper[D]);
    const unsigned along_level = ends.direction >> (D - 1) & 1, along_step = ends.direction >> D & 1;
    ends.direction = (ends.direction & ((1u << (D - 1)) - 1)) | along_step << (D - 1) | along_level << D;
    return vertices_.locate(ends);
  }

  Place place_at(const Location& at) const {
    return place_between<D>(vertices_.field().grid, at.lower, at.upper, at.weight);
  }

  RegionVertices<T, D> vertices_;
  std::array<std::int64_t, D + 1> dims_;
  GridEdge rows_in_space_;
};

// Takes over a region between two steps.
template <class T, int D>
Result<Slab<D + 1>> make_region_slab(const RegionSlabSamples<T, D>& samples, const SimplexMesh<D + 1>& mesh,
                                     bool has_missing) {
  if (mesh.edges.size() > UINT32_MAX || mesh.simplices.size() > UINT32_MAX)
    return Error{Code::out_of_memory, "the region between two steps has more than 2^32 corners"};
  std::vector<std::pair<GridEdge, Vertex>> order;
  for (const GridEdge edge : mesh.edges)
    order.emplace_back(samples.with_time_last(edge), static_cast<Vertex>(order.size()));
  std::ranges::sort(order);

  Array<GridEdge> edges;
  edges.reset(order.size());
  std::vector<Vertex> number(order.size());
  for (Vertex vertex = 0; vertex < order.size(); ++vertex) {
    edges[vertex] = order[vertex].first;
    number[order[vertex].second] = vertex;
  }
  std::vector<Vertex> corners(mesh.simplices.size());
  for (std::size_t corner = 0; corner < corners.size(); ++corner)
    corners[corner] = number[mesh.simplices[corner]];
  Slab<D + 1> slab = slab_of<D + 1>(std::move(edges), std::move(corners), samples, has_missing);
  slab.region = true;
  return slab;
}

} // namespace hyperiso::track_detail
