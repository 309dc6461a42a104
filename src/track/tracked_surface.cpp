#include "core/determinant.hpp"
#include "core/text.hpp"
#include "core/union_find.hpp"
#include "hyperiso/track.hpp"
#include "track/region_mesh.hpp"

#include <algorithm>
#include <new>
#include <numeric>

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

// Turns the simplices that face the wrong way. Where all come with one sign, but for a few that are folded
// over, these stay turned over.
template <int D>
void orient(VolumeMesh<D>& volume, bool one_orientation) {
  std::vector<double> contents;
  for (std::size_t first = 0; first < volume.simplices.size(); first += D + 1) {
    const auto coordinate = [&](std::size_t corner, std::size_t axis) {
      return volume.positions[volume.simplices[first + corner] * D + axis];
    };
    std::array<std::array<double, D>, D> sides;
    for (std::size_t i = 0; i < D; ++i)
      for (std::size_t axis = 0; axis < D; ++axis)
        sides[i][axis] = coordinate(i + 1, axis) - coordinate(0, axis);
    contents.push_back(determinant(sides));
  }
  const double sum = std::accumulate(contents.begin(), contents.end(), 0.0);
  for (std::size_t simplex = 0; simplex < contents.size(); ++simplex) {
    if ((one_orientation ? sum : contents[simplex]) >= 0) continue;
    const std::size_t first = simplex * (D + 1);
    const std::uint64_t a = volume.simplices[first], b = volume.simplices[first + 1];
    volume.simplices.set(first, b);
    volume.simplices.set(first + 1, a);
  }
}

template <class T, int D>
Result<Mesh> region_at(const FieldView<const T, D>& step, const TrackingGraph& graph,
                       const ExtractOptions& options) {
  const auto levels = track_detail::region_levels(graph.isovalue, graph.upper_isovalue, options.inside);
  auto region = track_detail::mesh_region(step, levels, options);
  if (!region) return region.error();
  const track_detail::RegionVertices<T, D> vertices(step, levels);
  VolumeMesh<D> volume;
  volume.positions.reset(region->edges.size() * D, options.precision == Precision::f64);
  for (std::size_t vertex = 0; vertex < region->edges.size(); ++vertex) {
    const auto location = vertices.locate(region->edges[vertex]);
    for (int axis = 0; axis < D; ++axis)
      volume.positions.set(vertex * D + static_cast<std::size_t>(axis), vertices.coordinate(location, axis));
  }
  volume.simplices = std::move(region->simplices);
  volume.edges = std::move(region->edges);
  orient(volume, options.method != Method::simplicial);
  return Mesh(std::move(volume));
}

template <class T, int D>
Result<Mesh> surface_at(const FieldView<const T, D>& step, const TrackingGraph& graph,
                        const ExtractOptions& options) {
  auto surface = extract(step, graph.isovalue, options);
  if (!surface) return surface.error();
  return Mesh(std::move(*surface));
}

} // namespace

Result<Mesh> tracked_surface(const TrackingGraph& graph, const Field& step, std::int64_t number,
                             const TrackOptions& options) {
  const auto of_dimension = [&]<int D, class T>(T) -> Result<Mesh> {
    const auto view = step.view<T, D + 1>().at_index(D, 0);
    try {
      auto mesh = graph.tracked == Tracked::region ? region_at(view, graph, options.extraction)
                                                   : surface_at(view, graph, options.extraction);
      if (mesh) name_tracks(graph, number, *mesh);
      return mesh;
    } catch (const std::bad_alloc&) {
      return Error{Code::out_of_memory, text("not enough memory for the tracks of step ", number)};
    }
  };
  return visit_sample_type(step.info.type, [&]<class T>(T sample) -> Result<Mesh> {
    return step.info.dimension() == 3 ? of_dimension.template operator()<2>(sample)
                                      : of_dimension.template operator()<3>(sample);
  });
}

} // namespace hyperiso
