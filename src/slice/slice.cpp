// Two ways to cut: through the inside of cells (cut.hpp), and along a layer of samples (trace.hpp).

#include "hyperiso/slice.hpp"

#include "core/text.hpp"
#include "slice/check_plane.hpp"
#include "slice/cut.hpp"
#include "slice/trace.hpp"

#include <algorithm>
#include <cmath>
#include <new>
#include <numeric>

namespace hyperiso {
namespace {

// The layer of samples of the grid that a mesh came from, if the plane holds one.
template <int D, int K>
std::optional<Layer> layer_in(const SimplexMesh<D, K>& mesh, const Hyperplane<D>& plane) {
  const std::optional<int> across = axis_across(plane);
  if (!across || mesh.edges.empty() || mesh.grid_axes.size() != K + 1) return std::nullopt;
  const auto around =
      samples_around(mesh.grid_axes[static_cast<std::size_t>(*across)], plane.offset / plane.normal[*across]);
  if (!around || around->end - around->begin != 1) return std::nullopt;
  return Layer{*across, around->begin};
}

template <int D, int K, class ForEachSimplex>
Result<SimplexMesh<D - 1, K - 1>> slice_some(const SimplexMesh<D, K>& mesh, const Hyperplane<D>& plane,
                                             const SliceOptions& options,
                                             const ForEachSimplex& for_each_simplex) {
  if (const Status valid = check_plane(plane); !valid) return valid.error();
  try {
    if (const auto layer = layer_in(mesh, plane))
      return Trace<D, K>(mesh, *layer, for_each_simplex).mesh(options);
    return cut_inside(mesh, plane, options, for_each_simplex);
  } catch (const std::bad_alloc&) {
    return Error{Code::out_of_memory,
                 text("not enough memory to slice ", mesh.simplex_count(), " simplices")};
  }
}

constexpr std::size_t group_size = 256; // simplices of a SliceIndex that share a box

template <int D>
struct Box {
  std::array<double, D> low, high;

  Box() {
    low.fill(HUGE_VAL);
    high.fill(-HUGE_VAL);
  }
  void add(const std::array<double, D>& point) {
    for (int k = 0; k < D; ++k) {
      low[k] = std::min(low[k], point[k]);
      high[k] = std::max(high[k], point[k]);
    }
  }
};

template <int D>
std::array<double, D> position_of(const Mesh& mesh, std::uint64_t vertex) {
  std::array<double, D> position;
  for (std::size_t k = 0; k < D; ++k) position[k] = mesh.positions[vertex * D + k];
  return position;
}

// Where a simplex stands in the order of an index: by slab of the last axis, within it along a Morton curve.
template <int D>
std::uint64_t place_in_order(const Box<D>& whole, double slabs, const std::array<double, D>& point) {
  std::array<std::uint64_t, D> cell;
  for (int k = 0; k < D; ++k) {
    const double cells = k == D - 1 ? slabs : 65536;
    const double share = (point[k] - whole.low[k]) / (whole.high[k] - whole.low[k]); // NaN in a flat box
    cell[k] = share > 0 ? static_cast<std::uint64_t>(std::min(share * cells, cells - 1)) : 0;
  }
  std::uint64_t place = cell[D - 1];
  for (int bit = 15; bit >= 0; --bit)
    for (int axis = D - 2; axis >= 0; --axis) place = place << 1 | (cell[axis] >> bit & 1);
  return place;
}

} // namespace

template <int D, int K>
Result<SimplexMesh<D - 1, K - 1>> slice(const SimplexMesh<D, K>& mesh, const Hyperplane<D>& plane,
                                        const SliceOptions& options) {
  return slice_some(mesh, plane, options, [&](auto&& use) {
    for (std::uint64_t simplex = 0; simplex < mesh.simplex_count(); ++simplex) use(simplex);
  });
}

template <int D, int K>
SliceIndex<D, K>::SliceIndex(const SimplexMesh<D, K>& mesh) {
  Box<D> whole;
  for (std::uint64_t vertex = 0; vertex < mesh.vertex_count(); ++vertex)
    whole.add(position_of<D>(mesh, vertex));

  const double slabs = mesh.grid_axes.empty() ? 64 : static_cast<double>(mesh.grid_axes[D - 1].count - 1);
  std::vector<std::pair<std::uint64_t, std::uint64_t>> places(mesh.simplex_count());
  for (std::uint64_t simplex = 0; simplex < places.size(); ++simplex) {
    std::array<double, D> centre{};
    for (std::size_t corner = 0; corner <= K; ++corner) {
      const auto position = position_of<D>(mesh, mesh.simplices[simplex * (K + 1) + corner]);
      for (int k = 0; k < D; ++k) centre[k] += position[k] / (K + 1);
    }
    places[simplex] = {place_in_order<D>(whole, slabs, centre), simplex};
  }
  std::ranges::sort(places);

  order_.resize(places.size());
  groups_.resize((places.size() + group_size - 1) / group_size);
  std::vector<Box<D>> boxes(groups_.size());
  for (std::size_t place = 0; place < places.size(); ++place) {
    order_[place] = places[place].second;
    for (std::size_t corner = 0; corner <= K; ++corner)
      boxes[place / group_size].add(position_of<D>(mesh, mesh.simplices[order_[place] * (K + 1) + corner]));
  }
  for (std::size_t group = 0; group < groups_.size(); ++group)
    groups_[group] = {boxes[group].low, boxes[group].high};
}

template <int D, int K>
Result<SimplexMesh<D - 1, K - 1>> SliceIndex<D, K>::slice(const SimplexMesh<D, K>& mesh,
                                                          const Hyperplane<D>& plane,
                                                          const SliceOptions& options) const {
  const CutPlane<D> cut_plane(mesh, plane, options.frame);
  return slice_some(mesh, plane, options, [&](auto&& use) {
    for (std::size_t group = 0; group < groups_.size(); ++group) {
      if (!cut_plane.meets(groups_[group].low, groups_[group].high)) continue;
      const std::size_t end = std::min(order_.size(), (group + 1) * group_size);
      for (std::size_t place = group * group_size; place < end; ++place) use(order_[place]);
    }
  });
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
                                                   const SliceOptions&);                                     \
  template class SliceIndex<D, K>
HYPERISO_INSTANTIATE_SLICE(3, 2);
HYPERISO_INSTANTIATE_SLICE(4, 3);
HYPERISO_INSTANTIATE_SLICE(3, 3);
HYPERISO_INSTANTIATE_SLICE(4, 4);

} // namespace hyperiso
