#include "core/text.hpp"
#include "hyperiso/view.hpp"
#include "mesh/attributes.hpp"

#include <algorithm>
#include <array>
#include <new>
#include <span>

namespace hyperiso {
namespace {

// On a grid that has the two levels of a region as its last axis, the crossings of the first level lie in the
// first layer; without that axis they are the vertices of the surface.
template <int D>
class BoundaryEdges {
 public:
  explicit BoundaryEdges(std::span<const Axis> axes) {
    for (int axis = 0; axis < D; ++axis) step_[axis] = lifted_[axis] = axes[axis].count;
    lifted_[D] = 2;
  }

  std::optional<GridEdge> on_step(GridEdge edge) const {
    const GridEdgeEnds<D + 1> ends = grid_edge_ends<D + 1>(lifted_, edge);
    if (ends.upper[D] != 0) return std::nullopt;
    std::array<std::int64_t, D> upper;
    std::copy_n(ends.upper.begin(), D, upper.begin());
    return grid_edge<D>(step_, upper, ends.direction);
  }

 private:
  std::array<std::int64_t, D> step_;
  std::array<std::int64_t, D + 1> lifted_;
};

template <int D>
std::vector<TrackingGraph::Piece> boundary_pieces(const Mesh& region, std::span<const Axis> axes,
                                                  const std::vector<std::int64_t>& feature_of_track) {
  const BoundaryEdges<D> edges(axes);
  const auto& tracks = std::get<std::vector<std::int32_t>>(track_of_simplices(region)->values);
  const auto corners = static_cast<std::size_t>(region.simplex_dimension + 1);
  std::vector<std::int64_t> features(region.vertex_count(), -1);
  for (std::size_t corner = 0; corner < region.simplices.size(); ++corner)
    if (const std::int32_t track = tracks[corner / corners]; track >= 0)
      features[region.simplices[corner]] = feature_of_track[static_cast<std::size_t>(track)];
  std::vector<TrackingGraph::Piece> pieces;
  for (std::size_t vertex = 0; vertex < features.size(); ++vertex) {
    if (features[vertex] < 0) continue;
    if (const auto edge = edges.on_step(region.edges[vertex])) pieces.push_back({*edge, features[vertex]});
  }
  std::ranges::sort(pieces, {}, &TrackingGraph::Piece::edge);
  return pieces;
}

} // namespace

Status use_boundary_pieces(TrackingGraph& graph, StepSource& source, const TrackOptions& options) {
  if (graph.tracked == Tracked::surface) return {};
  if (graph.upper_isovalue)
    return Error{Code::invalid_argument,
                 text("the regions lie between ", graph.isovalue, " and ", *graph.upper_isovalue,
                      ", so two surfaces bound them; a page shows one")};
  try {
    std::vector<std::int64_t> feature_of_track(graph.tracks.size(), -1);
    for (std::size_t feature = 0; feature < graph.features.size(); ++feature)
      if (const std::int64_t track = graph.features[feature].track; track >= 0)
        feature_of_track[static_cast<std::size_t>(track)] = static_cast<std::int64_t>(feature);
    std::vector<std::vector<TrackingGraph::Piece>> pieces;
    for (std::int64_t step = 0; step < graph.steps; ++step) {
      Result<Field> field = source.read(step, step + 1);
      if (!field) return field.error();
      const Result<Mesh> region = tracked_surface(graph, *field, step, options);
      if (!region) return region.error();
      pieces.push_back(region->dimension == 2 ? boundary_pieces<2>(*region, graph.axes, feature_of_track)
                                              : boundary_pieces<3>(*region, graph.axes, feature_of_track));
    }
    graph.pieces = std::move(pieces);
    return {};
  } catch (const std::bad_alloc&) {
    return Error{Code::out_of_memory, "not enough memory for the surfaces that bound the regions"};
  }
}

} // namespace hyperiso
