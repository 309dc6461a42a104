#include "core/text.hpp"
#include "core/union_find.hpp"
#include "hyperiso/track.hpp"

#include <algorithm>
#include <new>

namespace hyperiso {
namespace {

// Vertices ascend by their edges, so the representative of a piece is its first vertex.
void name_tracks(const TrackingGraph& graph, std::int64_t step, Mesh& surface) {
  UnionFind united(surface.vertex_count());
  const auto corners = static_cast<std::size_t>(surface.simplex_dimension + 1);
  for (std::size_t corner = 0; corner < surface.simplices.size(); ++corner)
    united.unite(surface.simplices[corner / corners * corners], surface.simplices[corner]);
  const auto& pieces = graph.pieces[static_cast<std::size_t>(step)];
  std::vector<std::int32_t> tracks(surface.simplex_count(), -1), families(surface.simplex_count(), -1);
  for (std::size_t simplex = 0; simplex < surface.simplex_count(); ++simplex) {
    const GridEdge edge = surface.edges[united.find(surface.simplices[simplex * corners])];
    const auto piece = std::ranges::lower_bound(pieces, edge, {}, &TrackingGraph::Piece::edge);
    if (piece == pieces.end() || piece->edge != edge) continue;
    const std::int64_t track = graph.features[static_cast<std::size_t>(piece->feature)].track;
    tracks[simplex] = static_cast<std::int32_t>(track);
    families[simplex] = static_cast<std::int32_t>(graph.tracks[static_cast<std::size_t>(track)].family);
  }
  surface.attributes.push_back({"track_id", Attribute::Location::simplex, 1, std::move(tracks)});
  surface.attributes.push_back({"family_id", Attribute::Location::simplex, 1, std::move(families)});
}

} // namespace

Result<Mesh> tracked_surface(const TrackingGraph& graph, const Field& step, std::int64_t number,
                             const TrackOptions& options) {
  const auto of_dimension = [&]<int D, class T>(T) -> Result<Mesh> {
    auto surface = extract(step.view<T, D + 1>().at_index(D, 0), graph.isovalue, options.extraction);
    if (!surface) return surface.error();
    try {
      name_tracks(graph, number, *surface);
    } catch (const std::bad_alloc&) {
      return Error{Code::out_of_memory, text("not enough memory for the tracks of step ", number)};
    }
    return Mesh(std::move(*surface));
  };
  return visit_sample_type(step.info.type, [&]<class T>(T sample) -> Result<Mesh> {
    return step.info.dimension() == 3 ? of_dimension.template operator()<2>(sample)
                                      : of_dimension.template operator()<3>(sample);
  });
}

} // namespace hyperiso
