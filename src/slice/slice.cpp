// Two ways to cut: through the inside of cells (cut_inside), and along a layer of samples (trace).

#include "hyperiso/slice.hpp"

#include "core/text.hpp"
#include "slice/frame.hpp"
#include "table/simplex_cut.hpp"

#include <algorithm>
#include <new>
#include <numeric>

namespace hyperiso {
namespace {

template <int D>
using Corners = std::array<std::uint64_t, D>;

// The corners of a simplex in ascending order, and whether that is an even permutation of the order they are
// in.
template <int D>
struct SortedSimplex {
  Corners<D> corners;
  bool even = true;

  SortedSimplex(const Mesh& mesh, std::size_t simplex) {
    for (std::size_t corner = 0; corner < D; ++corner) {
      const std::uint64_t vertex = mesh.simplices[simplex * D + corner];
      std::size_t place = corner;
      for (; place > 0 && corners[place - 1] > vertex; --place) {
        corners[place] = corners[place - 1];
        even = !even;
      }
      corners[place] = vertex;
    }
  }
};

template <int D>
std::array<double, D> position_of(const Mesh& mesh, std::uint64_t vertex) {
  std::array<double, D> position;
  for (std::size_t k = 0; k < D; ++k) position[k] = mesh.positions[vertex * D + k];
  return position;
}

template <int D>
std::array<std::int64_t, D> grid_dims(const Mesh& mesh) {
  std::array<std::int64_t, D> dims;
  for (std::size_t axis = 0; axis < D; ++axis) dims[axis] = mesh.grid_axes[axis].count;
  return dims;
}

template <std::size_t N>
std::array<double, N - 1> without(const std::array<double, N>& point, int axis) {
  std::array<double, N - 1> rest;
  for (int from = 0, to = 0; from < static_cast<int>(N); ++from)
    if (from != axis) rest[to++] = point[from];
  return rest;
}

// How far each vertex lies beyond the plane. A vertex on a grid edge along the plane has the exact coordinate
// of its samples and one on an edge across it lies between two of them, however its stored position was
// rounded.
template <int D>
std::vector<double> distances_beyond(const SimplexMesh<D>& mesh, const Hyperplane<D>& plane) {
  const std::optional<int> across = axis_across(plane);
  const bool exact = across && !mesh.edges.empty();
  std::vector<double> distances(mesh.vertex_count());
  for (std::size_t vertex = 0; vertex < distances.size(); ++vertex) {
    const auto position = position_of<D>(mesh, vertex);
    double distance = -plane.offset;
    for (int k = 0; k < D; ++k) distance += plane.normal[k] * position[k];
    if (exact) {
      const auto ends = grid_edge_ends<D>(grid_dims<D>(mesh), mesh.edges[vertex]);
      const Axis& axis = mesh.grid_axes[static_cast<std::size_t>(*across)];
      const double value = plane.offset / plane.normal[*across];
      const double lower = axis.coordinate(ends.lower[*across]), upper = axis.coordinate(ends.upper[*across]);
      const double between = std::clamp(position[*across], std::min(lower, upper), std::max(lower, upper));
      distance = (between - value) * plane.normal[*across];
    }
    distances[vertex] = distance;
  }
  return distances;
}

template <int D>
SimplexMesh<D - 1> cut_inside(const SimplexMesh<D>& mesh, const Hyperplane<D>& plane,
                              const SliceOptions& options) {
  const std::vector<double> beyond = distances_beyond(mesh, plane);
  const std::optional<int> across = axis_across(plane);
  const Frame<D> frame(plane);

  // Each corner of the cut is an edge of the mesh: its two vertices, ascending.
  using Edge = std::pair<std::uint64_t, std::uint64_t>;
  std::vector<Edge> corners;
  const auto& table = simplex_cut<D - 1>();
  for (std::size_t simplex = 0; simplex < mesh.simplex_count(); ++simplex) {
    const SortedSimplex<D> sorted(mesh, simplex);
    unsigned positive = 0;
    for (std::size_t corner = 0; corner < D; ++corner)
      positive |= (beyond[sorted.corners[corner]] >= 0 ? 1u : 0u) << corner;
    for (const auto& cut : table.simplices(positive)) {
      const std::size_t start = corners.size();
      for (const CornerPair pair : cut)
        corners.emplace_back(sorted.corners[pair.lower], sorted.corners[pair.upper]);
      if (sorted.even != frame.positive) std::swap(corners[start], corners[start + 1]);
    }
  }

  std::vector<Edge> edges = corners;
  std::ranges::sort(edges);
  edges.erase(std::unique(edges.begin(), edges.end()), edges.end());

  SimplexMesh<D - 1> cut;
  cut.positions.reset(edges.size() * (D - 1), options.precision == Precision::f64);
  for (std::size_t vertex = 0; vertex < edges.size(); ++vertex) {
    const auto [first, second] = edges[vertex];
    const auto start = position_of<D>(mesh, first), end = position_of<D>(mesh, second);
    const double weight = beyond[first] / (beyond[first] - beyond[second]);
    std::array<double, D> point;
    for (int k = 0; k < D; ++k) point[k] = start[k] + weight * (end[k] - start[k]);
    const auto coordinates = across ? without(point, *across) : frame.coordinates(point);
    for (std::size_t k = 0; k < D - 1; ++k) cut.positions.set(vertex * (D - 1) + k, coordinates[k]);
  }
  cut.simplices.reset(corners.size(), edges.size() > UINT32_MAX);
  for (std::size_t corner = 0; corner < corners.size(); ++corner)
    cut.simplices.set(
        corner, static_cast<std::uint64_t>(std::ranges::lower_bound(edges, corners[corner]) - edges.begin()));
  return cut;
}

// The simplices of the mesh's boundary on a layer of samples: the faces whose vertices all lie on grid edges
// within it. Cells on both sides have the same (paper 000, lemma 2); one may be missing at the ends and at
// NaN.
template <int D>
class Trace {
 public:
  Trace(const SimplexMesh<D>& mesh, int axis, std::int64_t layer)
      : mesh_(mesh), axis_(axis), dims_(grid_dims<D>(mesh)) {
    in_layer_.resize(mesh.vertex_count());
    for (std::size_t vertex = 0; vertex < in_layer_.size(); ++vertex) {
      const auto ends = grid_edge_ends<D>(dims_, mesh.edges[vertex]);
      in_layer_[vertex] = ends.upper[axis] == layer && ends.lower[axis] == layer;
    }
    for (std::size_t simplex = 0; simplex < mesh.simplex_count(); ++simplex) add_face_of(simplex, layer);
    std::ranges::sort(faces_, {}, &Face::sorted);
    const auto repeats = std::ranges::unique(faces_, {}, &Face::sorted);
    faces_.erase(repeats.begin(), repeats.end());
  }

  SimplexMesh<D - 1> mesh(const SliceOptions& options) const {
    // Leaving out an axis may change the order of grid edges: number the vertices by their edges in the
    // layer.
    std::vector<std::pair<GridEdge, std::uint64_t>> vertices; // edge in the layer, vertex of the mesh
    for (const Face& face : faces_)
      for (const std::uint64_t vertex : face.sorted) vertices.emplace_back(edge_in_layer(vertex), vertex);
    std::ranges::sort(vertices);
    vertices.erase(std::unique(vertices.begin(), vertices.end()), vertices.end());

    SimplexMesh<D - 1> trace;
    trace.positions.reset(vertices.size() * (D - 1), options.precision == Precision::f64);
    std::vector<std::uint64_t> number(in_layer_.size());
    for (std::size_t vertex = 0; vertex < vertices.size(); ++vertex) {
      number[vertices[vertex].second] = vertex;
      trace.edges.push_back(vertices[vertex].first);
      const auto point = without(position_of<D>(mesh_, vertices[vertex].second), axis_);
      for (std::size_t k = 0; k < D - 1; ++k) trace.positions.set(vertex * (D - 1) + k, point[k]);
    }
    trace.simplices.reset(faces_.size() * (D - 1), vertices.size() > UINT32_MAX);
    std::size_t corner = 0;
    for (const Face& face : faces_)
      for (const std::uint64_t vertex : face.oriented) trace.simplices.set(corner++, number[vertex]);
    for (int from = 0; from < D; ++from)
      if (from != axis_) trace.grid_axes.push_back(mesh_.grid_axes[static_cast<std::size_t>(from)]);
    return trace;
  }

 private:
  struct Face {
    Corners<D - 1> sorted, oriented;
  };

  // A simplex with one corner off the layer has a face in it: the cut just beside the layer, its vertices
  // moved along the edges to that corner until they reach the layer.
  void add_face_of(std::size_t simplex, std::int64_t layer) {
    const SortedSimplex<D> sorted(mesh_, simplex);
    std::size_t off = 0, count_off = 0;
    for (std::size_t corner = 0; corner < D; ++corner)
      if (!in_layer_[sorted.corners[corner]]) off = corner, ++count_off;
    if (count_off != 1) return;
    const auto ends = grid_edge_ends<D>(dims_, mesh_.edges[sorted.corners[off]]);
    const bool beyond =
        (ends.upper[axis_] > layer) == mesh_.grid_axes[static_cast<std::size_t>(axis_)].increasing();
    const unsigned positive = beyond ? 1u << off : ((1u << D) - 1) ^ 1u << off;
    Face face;
    const auto& cut = simplex_cut<D - 1>().simplices(positive)[0];
    for (std::size_t corner = 0; corner < D - 1; ++corner)
      face.oriented[corner] =
          sorted.corners[cut[corner].lower == off ? cut[corner].upper : cut[corner].lower];
    if (sorted.even != (axis_ % 2 == 0)) std::swap(face.oriented[0], face.oriented[1]);
    face.sorted = face.oriented;
    std::ranges::sort(face.sorted);
    faces_.push_back(face);
  }

  GridEdge edge_in_layer(std::uint64_t vertex) const {
    const auto ends = grid_edge_ends<D>(dims_, mesh_.edges[vertex]);
    std::array<std::int64_t, D - 1> dims, upper;
    unsigned direction = 0;
    for (int from = 0, to = 0; from < D; ++from) {
      if (from == axis_) continue;
      dims[to] = dims_[from];
      upper[to] = ends.upper[from];
      direction |= (ends.direction >> from & 1) << to;
      ++to;
    }
    return grid_edge<D - 1>(dims, upper, direction);
  }

  const SimplexMesh<D>& mesh_;
  int axis_;
  std::array<std::int64_t, D> dims_;
  std::vector<bool> in_layer_; // per vertex
  std::vector<Face> faces_;
};

template <int D>
Status check_plane(const Hyperplane<D>& plane) {
  bool finite = std::isfinite(plane.offset), zero = true;
  for (const double component : plane.normal) {
    finite &= std::isfinite(component);
    zero &= component == 0;
  }
  if (!finite || zero)
    return Error{Code::invalid_argument, "a hyperplane needs a normal that is not 0, and finite numbers"};
  return {};
}

} // namespace

template <int D>
Result<SimplexMesh<D - 1>> slice(const SimplexMesh<D>& mesh, const Hyperplane<D>& plane,
                                 const SliceOptions& options) {
  if (const Status valid = check_plane(plane); !valid) return valid.error();
  try {
    const std::optional<int> across = axis_across(plane);
    if (across && !mesh.edges.empty()) {
      const auto around = samples_around(mesh.grid_axes[static_cast<std::size_t>(*across)],
                                         plane.offset / plane.normal[*across]);
      if (around && around->end - around->begin == 1)
        return Trace<D>(mesh, *across, around->begin).mesh(options);
    }
    return cut_inside(mesh, plane, options);
  } catch (const std::bad_alloc&) {
    return Error{Code::out_of_memory,
                 text("not enough memory to slice ", mesh.simplex_count(), " simplices")};
  }
}

template <class T, int D>
Result<SimplexMesh<D - 1>> slice(const FieldView<const T, D>& field, double isovalue,
                                 const Hyperplane<D>& plane, const ExtractOptions& options) {
  if (const Status valid = check_plane(plane); !valid) return valid.error();
  FieldView<const T, D> slab = field;
  if (const std::optional<int> across = axis_across(plane)) {
    const auto around = samples_around(field.grid.axes[*across], plane.offset / plane.normal[*across]);
    if (!around) return around.error();
    if (around->end - around->begin == 1)
      return extract(field.at_index(*across, around->begin), isovalue, options);
    slab = field.cropped(*across, around->begin, around->end);
  }
  ExtractOptions slab_options = options;
  slab_options.keep_edges = true;
  const auto mesh = extract(slab, isovalue, slab_options);
  if (!mesh) return mesh.error();
  return slice(*mesh, plane, {options.precision});
}

template Result<SimplexMesh<2>> slice(const SimplexMesh<3>&, const Hyperplane<3>&, const SliceOptions&);
template Result<SimplexMesh<3>> slice(const SimplexMesh<4>&, const Hyperplane<4>&, const SliceOptions&);

#define HYPERISO_INSTANTIATE_SLICE(T)                                                                        \
  template Result<SimplexMesh<2>> slice(const FieldView<const T, 3>&, double, const Hyperplane<3>&,          \
                                        const ExtractOptions&);                                              \
  template Result<SimplexMesh<3>> slice(const FieldView<const T, 4>&, double, const Hyperplane<4>&,          \
                                        const ExtractOptions&);
HYPERISO_INSTANTIATE_SLICE(std::uint8_t)
HYPERISO_INSTANTIATE_SLICE(std::int8_t)
HYPERISO_INSTANTIATE_SLICE(std::uint16_t)
HYPERISO_INSTANTIATE_SLICE(std::int16_t)
HYPERISO_INSTANTIATE_SLICE(std::uint32_t)
HYPERISO_INSTANTIATE_SLICE(std::int32_t)
HYPERISO_INSTANTIATE_SLICE(float)
HYPERISO_INSTANTIATE_SLICE(double)

} // namespace hyperiso
