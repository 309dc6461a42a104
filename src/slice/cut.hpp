#pragma once
// A cut through the inside of cells: every simplex with corners on both sides of the plane gives a few
// simplices of one dimension less, by table, whose corners lie on its edges.

#include "slice/carry.hpp"
#include "slice/edge_numbers.hpp"
#include "slice/frame.hpp"
#include "slice/simplex_corners.hpp"
#include "table/simplex_cut.hpp"

namespace hyperiso {

// A hyperplane as positions stored in a mesh see it.
template <int D>
class CutPlane {
 public:
  CutPlane(const Mesh& mesh, const Hyperplane<D>& plane, SliceFrame frame)
      : plane_(plane), across_(axis_across(plane)), frame_(plane, frame) {
    if (!across_) return;
    // x[axis] = value; so that rounding keeps to one side what lies on one side.
    plane_ = Hyperplane<D>::at(*across_, plane.offset / plane.normal[*across_]);
    if (!mesh.grid_axes.empty() && !mesh.positions.wide())
      plane_.offset =
          among_rounded_samples(mesh.grid_axes[static_cast<std::size_t>(*across_)], plane_.offset);
    frame_ = Frame<D>(plane_, frame);
  }

  // How far a point lies beyond the plane.
  template <class Real>
  double beyond(const Real* point) const {
    if (across_) return static_cast<double>(point[*across_]) - plane_.offset;
    double distance = -plane_.offset;
    for (int k = 0; k < D; ++k) distance += plane_.normal[k] * static_cast<double>(point[k]);
    return distance;
  }
  // The same of many points, given axis by axis: in the same order of operations, to the same bits.
  template <class Real>
  void beyond_all(const Real* positions, std::size_t count, double* distances) const {
    if (across_) {
      const Real* along = positions + static_cast<std::size_t>(*across_) * count;
      for (std::size_t i = 0; i < count; ++i) distances[i] = static_cast<double>(along[i]) - plane_.offset;
      return;
    }
    const Hyperplane<D> plane = plane_; // so that it stays in registers
    for (std::size_t i = 0; i < count; ++i) {
      double distance = -plane.offset;
      for (std::size_t k = 0; k < D; ++k)
        distance += plane.normal[k] * static_cast<double>(positions[k * count + i]);
      distances[i] = distance;
    }
  }
  std::array<double, D - 1> coordinates(const std::array<double, D>& point) const {
    return across_ ? without(point, *across_) : frame_.coordinates(point);
  }
  // The same of several points, given and found axis by axis: to the same bits.
  template <std::size_t N>
  void coordinates_all(const std::array<std::array<double, N>, D>& points,
                       std::array<std::array<double, N>, D - 1>& coordinates) const {
    if (across_) {
      for (int from = 0, to = 0; from < D; ++from)
        if (from != *across_) coordinates[to++] = points[from];
      return;
    }
    for (std::size_t row = 0; row < D - 1; ++row) {
      coordinates[row].fill(0);
      for (std::size_t k = 0; k < D; ++k)
        for (std::size_t i = 0; i < N; ++i) coordinates[row][i] += frame_.rows[row][k] * points[k][i];
    }
  }
  // Across an axis: where it is, and the plane next to it that points on this one lie before.
  double value() const { return plane_.offset; }
  CutPlane just_after() const {
    CutPlane after = *this;
    after.plane_.offset = std::nextafter(value(), HUGE_VAL);
    return after;
  }
  bool positive() const { return frame_.positive; }
  const auto& directions() const { return frame_.directions; }

  bool meets(const std::array<double, D>& low, const std::array<double, D>& high) const {
    double least = -plane_.offset, most = -plane_.offset;
    for (int k = 0; k < D; ++k) {
      const bool rises = plane_.normal[k] >= 0;
      least += plane_.normal[k] * (rises ? low[k] : high[k]);
      most += plane_.normal[k] * (rises ? high[k] : low[k]);
    }
    // Sums of the corners' products round like this one or better; the margin covers what they may differ.
    const double margin = 1e-12 * (std::abs(least) + std::abs(most) + std::abs(plane_.offset));
    return (least <= margin) & (most >= -margin);
  }

 private:
  // Rounding positions to f32 may move them past the plane. Moves a plane that holds samples to where they
  // are stored, and one between two samples to where these are stored on the sides on which they are.
  static double among_rounded_samples(const Axis& axis, double value) {
    const auto around = samples_around(axis, value);
    if (!around) return value;
    if (around->end - around->begin == 1) return static_cast<double>(static_cast<float>(value));
    const double first = axis.coordinate(around->begin), second = axis.coordinate(around->begin + 1);
    const auto low = static_cast<float>(std::min(first, second)),
               high = static_cast<float>(std::max(first, second));
    if (value <= low) return std::nextafter(low, high);
    return std::min(value, static_cast<double>(high));
  }

  Hyperplane<D> plane_;
  std::optional<int> across_;
  Frame<D> frame_;
};

// A cut of a simplex, its corners in ascending order: the edges that are cut, each once, and the pieces as
// positions in that list.
template <int K>
struct CutShape {
  static constexpr std::size_t most_edges = (K + 1) * (K + 1) / 4;
  std::array<CornerPair, most_edges> edges;
  std::size_t edge_count = 0;
  std::vector<std::array<std::uint8_t, K>> pieces;

  explicit CutShape(std::span<const typename SimplexCut<K>::Simplex> simplices) {
    for (const auto& simplex : simplices) {
      auto& piece = pieces.emplace_back();
      for (std::size_t corner = 0; corner < K; ++corner) {
        const auto known =
            std::find(edges.begin(), edges.begin() + edge_count, simplex[corner]) - edges.begin();
        if (known == static_cast<std::ptrdiff_t>(edge_count)) edges[edge_count++] = simplex[corner];
        piece[corner] = static_cast<std::uint8_t>(known);
      }
    }
  }
};

// By the pattern of corners beyond the plane.
template <int K>
const std::vector<CutShape<K>>& cut_shapes() {
  static const std::vector<CutShape<K>> shapes = [] {
    std::vector<CutShape<K>> all;
    for (unsigned pattern = 0; pattern < SimplexCut<K>::patterns; ++pattern)
      all.emplace_back(simplex_cut<K>().simplices(pattern));
    return all;
  }();
  return shapes;
}

// What a cut is made of, before it has positions.
template <class Index>
struct CutCorners {
  Array<MeshEdge<Index>> vertices; // the edge of the mesh that each vertex lies on
  Array<Index> corners;            // K vertices for each simplex
  Array<std::uint64_t> sources;    // the simplex of the mesh that each simplex lies in
};

// Cuts the simplices that `for_each_simplex` calls its argument with. `number` gives the vertex on an edge.
template <int D, int K, class Real, class Index, class ForEachSimplex, class Number, class CutIndex>
void cut_simplices(std::span<const Real> positions, std::span<const Index> simplices,
                   const CutPlane<D>& plane, const ForEachSimplex& for_each_simplex, const Number& number,
                   CutCorners<CutIndex>& cut) {
  const auto& shapes = cut_shapes<K>();
  for_each_simplex([&](std::uint64_t simplex) {
    const Index* corners = &simplices[simplex * (K + 1)];
    unsigned beyond = 0;
    for (unsigned corner = 0; corner <= K; ++corner)
      beyond |= (plane.beyond(&positions[std::size_t{corners[corner]} * D]) >= 0 ? 1u : 0u) << corner;
    if (beyond == 0 || beyond == (1u << (K + 1)) - 1) return;

    const SortedSimplex<Index, K + 1> sorted(corners);
    unsigned pattern = 0;
    for (unsigned place = 0; place <= K; ++place) pattern |= (beyond >> sorted.from[place] & 1) << place;
    const CutShape<K>& shape = shapes[pattern];
    std::array<CutIndex, CutShape<K>::most_edges> vertices;
    for (std::size_t edge = 0; edge < shape.edge_count; ++edge)
      vertices[edge] =
          number({sorted.corners[shape.edges[edge].lower], sorted.corners[shape.edges[edge].upper]});

    // The normals of a piece point from beyond the plane to before it, along a surface and across a volume.
    const bool turned = (sorted.even != plane.positive()) != (K == D);
    for (const auto& piece : shape.pieces) {
      const std::size_t start = cut.corners.size();
      cut.corners.resize(start + K);
      for (std::size_t corner = 0; corner < K; ++corner)
        cut.corners[start + corner] = vertices[piece[corner]];
      if (turned) std::swap(cut.corners[start], cut.corners[start + 1]);
      cut.sources.push_back(simplex);
    }
  });
}

template <int D, int K, class Real, class Index, class ForEachSimplex>
CutCorners<Index> cut_corners(std::span<const Real> positions, std::span<const Index> simplices,
                              const CutPlane<D>& plane, bool welded, const ForEachSimplex& for_each_simplex) {
  CutCorners<Index> cut;
  if (welded) {
    EdgeNumbers<Index> numbers(cut.vertices);
    cut_simplices<D, K>(
        positions, simplices, plane, for_each_simplex,
        [&](MeshEdge<Index> edge) { return numbers.number(edge); }, cut);
  } else {
    const auto own_vertex = [&](MeshEdge<Index> edge) {
      cut.vertices.push_back(edge);
      return static_cast<Index>(cut.vertices.size() - 1);
    };
    cut_simplices<D, K>(positions, simplices, plane, for_each_simplex, own_vertex, cut);
  }
  if (cut.vertices.size() > std::numeric_limits<Index>::max()) throw std::bad_alloc();
  return cut;
}

// The point of the plane on an edge: its weight from the lower end and its coordinates in the plane.
template <int D>
struct PointOnEdge {
  double weight;
  std::array<double, D - 1> coordinates;

  // The ends, and how far each lies beyond the plane.
  PointOnEdge(const CutPlane<D>& plane, const std::array<double, D>& lower, double lower_beyond,
              const std::array<double, D>& upper, double upper_beyond)
      : weight(lower_beyond / (lower_beyond - upper_beyond)) {
    std::array<double, D> point;
    for (int k = 0; k < D; ++k) point[k] = lower[k] + weight * (upper[k] - lower[k]);
    coordinates = plane.coordinates(point);
  }
};

// Several of them at once, to the same bits.
template <int D, class Real>
struct EdgeBatch {
  static constexpr std::size_t size = 16;
  std::array<std::array<Real, size>, D> lower, upper;
  std::array<double, size> lower_beyond, upper_beyond, weights;
  std::array<std::array<double, size>, D - 1> coordinates;

  void place(const CutPlane<D>& plane) {
    for (std::size_t i = 0; i < size; ++i) weights[i] = lower_beyond[i] / (lower_beyond[i] - upper_beyond[i]);
    for (std::size_t k = 0; k < D; ++k)
      for (std::size_t i = 0; i < size; ++i) {
        const auto from = static_cast<double>(lower[k][i]), to = static_cast<double>(upper[k][i]);
        points_[k][i] = from + weights[i] * (to - from);
      }
    plane.coordinates_all(points_, coordinates);
  }

 private:
  std::array<std::array<double, size>, D> points_;
};

// Places the vertices of a cut: their coordinates in the plane, and their weights from the lower end of their
// edge.
template <int D, class Real, class Index, class Stored>
Array<double> place_vertices(std::span<const Real> positions, const Array<MeshEdge<Index>>& edges,
                             const CutPlane<D>& plane, std::span<Stored> coordinates) {
  const auto position_of = [&](std::size_t vertex) {
    std::array<double, D> position;
    for (std::size_t k = 0; k < D; ++k) position[k] = static_cast<double>(positions[vertex * D + k]);
    return position;
  };
  Array<double> weights;
  weights.reset(edges.size());
  for (std::size_t vertex = 0; vertex < edges.size(); ++vertex) {
    const auto lower = position_of(edges[vertex].lower), upper = position_of(edges[vertex].upper);
    const PointOnEdge<D> point(plane, lower, plane.beyond(lower.data()), upper, plane.beyond(upper.data()));
    weights[vertex] = point.weight;
    for (std::size_t k = 0; k < D - 1; ++k)
      coordinates[vertex * (D - 1) + k] = static_cast<Stored>(point.coordinates[k]);
  }
  return weights;
}

// The cut of the simplices that `for_each_simplex` calls its argument with.
template <int D, int K, class ForEachSimplex>
SimplexMesh<D - 1, K - 1> cut_inside(const SimplexMesh<D, K>& mesh, const Hyperplane<D>& hyperplane,
                                     const SliceOptions& options, const ForEachSimplex& for_each_simplex) {
  const CutPlane<D> plane(mesh, hyperplane, options.frame);
  SimplexMesh<D - 1, K - 1> result;
  mesh.positions.visit([&](auto positions) {
    mesh.simplices.visit([&](auto simplices) {
      using Index = std::remove_const_t<typename decltype(simplices)::element_type>;
      const auto cut = cut_corners<D, K>(positions, simplices, plane, options.welded, for_each_simplex);
      result.positions.reset(cut.vertices.size() * (D - 1), options.precision == Precision::f64);
      const auto weights = result.positions.visit(
          [&](auto coordinates) { return place_vertices<D>(positions, cut.vertices, plane, coordinates); });
      result.simplices.reset(cut.corners.size(), sizeof(Index) > sizeof(IndexArray::NarrowType));
      result.simplices.visit([&](auto corners) { std::ranges::copy(cut.corners, corners.begin()); });
      carry_attributes<Index>(mesh, cut.vertices, weights, cut.sources, result);
      turn_normals<D>(result, plane.directions());
    });
  });
  return result;
}

} // namespace hyperiso
