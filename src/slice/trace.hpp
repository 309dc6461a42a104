#pragma once
// A cut along a layer of samples: the faces of the mesh whose vertices all lie on grid edges within the
// layer. The cells on both sides leave the same there (paper 000, lemma 2); one of them may be missing at the
// ends of the grid and at NaN.

#include "hyperiso/slice.hpp"
#include "slice/carry.hpp"
#include "slice/frame.hpp"
#include "slice/simplex_corners.hpp"
#include "table/simplex_cut.hpp"

#include <algorithm>

namespace hyperiso {

// The grid of a volume has the axis of levels besides those of the mesh; its edges are those of the surface
// that the volume was before it was projected, and the trace is that of this surface, projected.

// The samples with number `index` along `axis`.
struct Layer {
  int axis;
  std::int64_t index;
};

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

template <int D, int K>
class Trace {
  // Axes of the grid, and corners of a simplex.
  static constexpr int N = K + 1;

 public:
  // Looks at the simplices that `for_each_simplex` calls its argument with.
  template <class ForEachSimplex>
  Trace(const SimplexMesh<D, K>& mesh, Layer layer, ForEachSimplex&& for_each_simplex)
      : mesh_(mesh), layer_(layer), axis_(mesh.grid_axes[static_cast<std::size_t>(layer.axis)]) {
    for (std::size_t axis = 0; axis < N; ++axis) dims_[axis] = mesh.grid_axes[axis].count;
    const double coordinate = axis_.coordinate(layer.index);
    stored_coordinate_ =
        mesh.positions.wide() ? coordinate : static_cast<double>(static_cast<float>(coordinate));
    mesh.simplices.visit([&](auto simplices) {
      for_each_simplex([&](std::uint64_t simplex) {
        add_face_of(simplex, SortedSimplex<std::uint64_t, N>(&simplices[simplex * N]));
      });
    });
    std::ranges::sort(faces_, {}, &Face::sorted);
    const auto repeats = std::ranges::unique(faces_, {}, &Face::sorted);
    faces_.erase(repeats.begin(), repeats.end());
  }

  SimplexMesh<D - 1, K - 1> mesh(const SliceOptions& options) const {
    // Leaving out an axis may change the order of grid edges: number the vertices by their edges in the
    // layer.
    std::vector<std::pair<GridEdge, std::uint64_t>> vertices; // edge in the layer, vertex of the mesh
    for (const Face& face : faces_)
      for (const std::uint64_t vertex : face.sorted) vertices.emplace_back(edge_in_layer(vertex), vertex);
    std::ranges::sort(vertices);
    vertices.erase(std::unique(vertices.begin(), vertices.end()), vertices.end());

    SimplexMesh<D - 1, K - 1> trace;
    trace.positions.reset(vertices.size() * (D - 1), options.precision == Precision::f64);
    for (std::size_t vertex = 0; vertex < vertices.size(); ++vertex) {
      std::array<double, D> point;
      for (std::size_t k = 0; k < D; ++k) point[k] = mesh_.positions[vertices[vertex].second * D + k];
      const auto in_layer = without(point, layer_.axis);
      for (std::size_t k = 0; k < D - 1; ++k) trace.positions.set(vertex * (D - 1) + k, in_layer[k]);
      trace.edges.push_back(vertices[vertex].first);
    }
    trace.simplices.reset(faces_.size() * K, vertices.size() > UINT32_MAX);
    std::size_t corner = 0;
    for (const Face& face : faces_)
      for (const std::uint64_t vertex : face.oriented) {
        const std::pair key{edge_in_layer(vertex), vertex};
        trace.simplices.set(
            corner++, static_cast<std::uint64_t>(std::ranges::lower_bound(vertices, key) - vertices.begin()));
      }
    for (int from = 0; from < N; ++from)
      if (from != layer_.axis) trace.grid_axes.push_back(mesh_.grid_axes[static_cast<std::size_t>(from)]);
    Array<MeshEdge<std::uint64_t>> ends; // each vertex is one of the mesh: an edge without length
    Array<double> weights;
    for (const auto& [edge, vertex] : vertices) {
      ends.push_back({vertex, vertex});
      weights.push_back(0);
    }
    Array<std::uint64_t> sources;
    for (const Face& face : faces_) sources.push_back(face.source);
    carry_attributes<std::uint64_t>(mesh_, ends, weights, sources, trace);
    turn_normals<D>(trace, Frame<D>(Hyperplane<D>::at(layer_.axis, 0), options.frame).directions);
    return trace;
  }

 private:
  struct Face {
    std::array<std::uint64_t, K> sorted, oriented;
    std::uint64_t source; // the simplex
  };

  bool in_layer(std::uint64_t vertex) const {
    if (mesh_.positions[vertex * D + static_cast<std::size_t>(layer_.axis)] != stored_coordinate_)
      return false;
    const auto ends = grid_edge_ends<N>(dims_, mesh_.edges[vertex]);
    return ends.upper[layer_.axis] == layer_.index && ends.lower[layer_.axis] == layer_.index;
  }

  // A simplex with one corner off the layer has a face in it: the cut just beside the layer, its vertices
  // moved along the edges to that corner until they reach the layer.
  void add_face_of(std::uint64_t simplex, const SortedSimplex<std::uint64_t, N>& sorted) {
    std::size_t off = 0, count_off = 0;
    for (std::size_t corner = 0; corner < N; ++corner)
      if (!in_layer(sorted.corners[corner])) off = corner, ++count_off;
    if (count_off != 1) return;
    const auto ends = grid_edge_ends<N>(dims_, mesh_.edges[sorted.corners[off]]);
    const bool beyond = (ends.upper[layer_.axis] > layer_.index) == axis_.increasing();
    const unsigned positive = beyond ? 1u << off : ((1u << N) - 1) ^ 1u << off;
    Face face;
    face.source = simplex;
    const auto& cut = simplex_cut<K>().simplices(positive)[0];
    for (std::size_t corner = 0; corner < K; ++corner)
      face.oriented[corner] =
          sorted.corners[cut[corner].lower == off ? cut[corner].upper : cut[corner].lower];
    // As cut_simplices turns its pieces.
    if ((sorted.even != (layer_.axis % 2 == 0)) != (K == D)) std::swap(face.oriented[0], face.oriented[1]);
    face.sorted = face.oriented;
    std::ranges::sort(face.sorted);
    faces_.push_back(face);
  }

  GridEdge edge_in_layer(std::uint64_t vertex) const {
    const auto ends = grid_edge_ends<N>(dims_, mesh_.edges[vertex]);
    std::array<std::int64_t, N - 1> dims, upper;
    unsigned direction = 0;
    for (int from = 0, to = 0; from < N; ++from) {
      if (from == layer_.axis) continue;
      dims[to] = dims_[from];
      upper[to] = ends.upper[from];
      direction |= (ends.direction >> from & 1) << to;
      ++to;
    }
    return grid_edge<N - 1>(dims, upper, direction);
  }

  const SimplexMesh<D, K>& mesh_;
  Layer layer_;
  const Axis& axis_; // that the layer lies across
  std::array<std::int64_t, N> dims_;
  double stored_coordinate_; // of the layer, rounded as the positions are
  std::vector<Face> faces_;
};

} // namespace hyperiso
