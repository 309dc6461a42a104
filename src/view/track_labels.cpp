#include "view/track_labels.hpp"

#include "core/union_find.hpp"

#include <algorithm>
#include <array>

namespace hyperiso {
namespace {

constexpr std::int32_t no_track = -1;
constexpr std::int64_t between_steps = -1;

template <int D>
class Labels {
 public:
  Labels(const Mesh& surface, const TrackingGraph& graph)
      : surface_(surface), graph_(graph), tracks_(surface.vertex_count(), no_track),
        step_(surface.vertex_count(), between_steps) {
    for (int axis = 0; axis < D; ++axis) dims_[axis] = surface.grid_axes[axis].count;
    for (std::size_t vertex = 0; vertex < step_.size(); ++vertex) {
      const GridEdgeEnds<D> ends = grid_edge_ends<D>(dims_, surface.edges[vertex]);
      if (!(ends.direction >> (D - 1) & 1)) step_[vertex] = ends.upper[D - 1];
    }
  }

  std::vector<std::int32_t> take() {
    name_pieces_at_steps();
    while (spread(true)) {
    }
    while (spread(false)) {
    }
    return std::move(tracks_);
  }

 private:
  // What the surface leaves on a step is the surface of the step, so its pieces hang together by the edges of
  // simplices whose ends are both there.
  void name_pieces_at_steps() {
    UnionFind pieces(tracks_.size());
    for_each_pair([&](std::uint64_t a, std::uint64_t b) {
      if (step_[a] == step_[b] && step_[a] != between_steps) pieces.unite(a, b);
    });
    for (std::size_t vertex = 0; vertex < tracks_.size(); ++vertex) {
      if (step_[vertex] == between_steps) continue;
      const std::uint64_t first = pieces.find(vertex); // no later than `vertex`
      tracks_[vertex] = first == vertex ? track_of_piece(vertex) : tracks_[first];
    }
  }

  std::int32_t track_of_piece(std::size_t vertex) const {
    const GridEdgeEnds<D> ends = grid_edge_ends<D>(dims_, surface_.edges[vertex]);
    std::array<std::int64_t, D - 1> dims, upper;
    std::copy_n(dims_.begin(), D - 1, dims.begin());
    std::copy_n(ends.upper.begin(), D - 1, upper.begin());
    const GridEdge edge = grid_edge<D - 1>(dims, upper, ends.direction);
    const auto step = static_cast<std::size_t>(step_[vertex]);
    if (step >= graph_.pieces.size()) return no_track;
    const auto& pieces = graph_.pieces[step];
    const auto piece = std::ranges::lower_bound(pieces, edge, {}, &TrackingGraph::Piece::edge);
    if (piece == pieces.end() || piece->edge != edge) return no_track;
    return static_cast<std::int32_t>(graph_.features[static_cast<std::size_t>(piece->feature)].track);
  }

  // Gives vertices without a track that of a neighbour earlier (or later) in time; whether any got one.
  bool spread(bool from_before) {
    bool changed = false;
    for_each_pair([&](std::uint64_t a, std::uint64_t b) {
      if (tracks_[a] == tracks_[b] || (tracks_[a] != no_track && tracks_[b] != no_track)) return;
      const std::uint64_t named = tracks_[a] != no_track ? a : b, other = a + b - named;
      if (step_[other] != between_steps || (time_of(named) <= time_of(other)) != from_before) return;
      tracks_[other] = tracks_[named];
      changed = true;
    });
    return changed;
  }

  double time_of(std::uint64_t vertex) const { return surface_.positions[vertex * D + D - 1]; }

  template <class Use>
  void for_each_pair(Use&& use) const {
    surface_.simplices.visit([&](auto simplices) {
      for (std::size_t first = 0; first < simplices.size(); first += D)
        for (std::size_t i = 0; i < D; ++i)
          for (std::size_t j = 0; j < i; ++j) use(simplices[first + j], simplices[first + i]);
    });
  }

  const Mesh& surface_;
  const TrackingGraph& graph_;
  std::array<std::int64_t, D> dims_{};
  std::vector<std::int32_t> tracks_;
  std::vector<std::int64_t> step_; // of the vertices that lie on one
};

} // namespace

std::vector<std::int32_t> tracks_of_vertices(const Mesh& surface, const TrackingGraph& graph) {
  if (surface.edges.size() != surface.vertex_count())
    return std::vector<std::int32_t>(surface.vertex_count(), no_track);
  if (surface.dimension == 3) return Labels<3>(surface, graph).take();
  return Labels<4>(surface, graph).take();
}

} // namespace hyperiso
