#include "table/hull_facet.hpp"

#include <algorithm>
#include <numeric>

namespace hyperiso {

namespace {

// What the points of a facet span: the directions that were new when they turned up.
template <int D>
class SpannedSpace {
 public:
  // Whether `direction` is new; if so, it is kept.
  bool add(IntegerVector<D> direction) {
    IntegerVector<D> rest = direction;
    for (std::size_t i = 0; i < rank_; ++i) {
      const std::int64_t factor = rest[pivots_[i]], pivot = reduced_[i][pivots_[i]];
      for (std::size_t k = 0; k < D; ++k) rest[k] = rest[k] * pivot - reduced_[i][k] * factor;
    }
    const auto nonzero = std::find_if(rest.begin(), rest.end(), [](std::int64_t x) { return x != 0; });
    if (nonzero == rest.end()) return false;
    pivots_[rank_] = static_cast<std::size_t>(nonzero - rest.begin());
    reduced_[rank_] = rest;
    directions_[rank_++] = direction;
    return true;
  }
  std::size_t rank() const { return rank_; }
  const IntegerVector<D>& direction(std::size_t i) const { return directions_[i]; }

 private:
  std::array<IntegerVector<D>, D> directions_, reduced_;
  std::array<std::size_t, D> pivots_;
  std::size_t rank_ = 0;
};

// Places the points of one facet one after the other. Points go by their place; simplices and faces keep
// theirs ascending.
template <int D>
class Placing {
 public:
  Placing(const IntegerVector<D>& outward, std::span<const std::uint8_t> edges) : outward_(outward) {
    for (const std::uint8_t edge : edges) points_.push_back(edge_midpoint<D>(edge));
    for (const auto& point : points_) raises_rank_.push_back(space_.add(difference(point, points_[0])));
  }

  bool spans_hyperplane() const { return space_.rank() == D - 1; }

  const std::vector<EdgeSimplex<D>>& triangulate() {
    simplices_.push_back({0});
    boundary_.push_back({{}, 0, {}, 0});
    for (std::size_t point = 1; point < points_.size(); ++point)
      if (raises_rank_[point])
        raise(static_cast<std::uint8_t>(point));
      else
        extend(static_cast<std::uint8_t>(point));
    std::sort(simplices_.begin(), simplices_.end());
    return simplices_;
  }

  bool is_positive(const EdgeSimplex<D>& simplex) const {
    std::array<IntegerVector<D>, D - 1> sides;
    for (std::size_t i = 1; i < D; ++i) sides[i - 1] = difference(points_[simplex[i]], points_[simplex[0]]);
    return determinant(outward_, sides) > 0;
  }

 private:
  // A face of the boundary of what is placed: rank_ points, and the one opposite in their simplex.
  struct Face {
    std::array<std::uint8_t, D - 1> points;
    std::uint8_t opposite;
    IntegerVector<D> away; // within the span of the points placed so far, normal to the face, from `opposite`
    std::int64_t offset;   // of the face along it
  };

  // A point outside the span of the others makes a cone of them all.
  void raise(std::uint8_t point) {
    std::vector<Face> bases;
    for (auto& simplex : simplices_) {
      Face& base = bases.emplace_back(Face{{}, point, {}, 0});
      std::copy_n(simplex.begin(), rank_ + 1, base.points.begin());
      simplex[rank_ + 1] = point;
    }
    for (Face& face : boundary_) face.points[rank_] = point;
    boundary_.insert(boundary_.end(), bases.begin(), bases.end());
    ++rank_;
    for (Face& face : boundary_) find_normal(face);
  }

  // A point within the span of the others is joined to the faces that it sees.
  void extend(std::uint8_t point) {
    const auto first_seen = std::stable_partition(boundary_.begin(), boundary_.end(),
                                                  [&](const Face& face) { return !sees(point, face); });
    std::vector<Face> sides;
    for (auto face = first_seen; face != boundary_.end(); ++face) {
      EdgeSimplex<D>& simplex = simplices_.emplace_back();
      std::copy_n(face->points.begin(), rank_, simplex.begin());
      simplex[rank_] = point;
      for (std::size_t left_out = 0; left_out < rank_; ++left_out) {
        Face side = *face;
        side.opposite = side.points[left_out];
        std::copy(face->points.begin() + left_out + 1, face->points.begin() + rank_,
                  side.points.begin() + left_out);
        side.points[rank_ - 1] = point;
        add_unless_shared(sides, side);
      }
    }
    for (Face& side : sides) find_normal(side);
    boundary_.erase(first_seen, boundary_.end());
    boundary_.insert(boundary_.end(), sides.begin(), sides.end());
  }

  // Two new simplices that share a face leave none of the boundary there.
  void add_unless_shared(std::vector<Face>& sides, const Face& side) const {
    const auto twin = std::find_if(sides.begin(), sides.end(), [&](const Face& other) {
      return std::equal(side.points.begin(), side.points.begin() + rank_, other.points.begin());
    });
    if (twin == sides.end())
      sides.push_back(side);
    else
      sides.erase(twin);
  }

  bool sees(std::size_t point, const Face& face) const {
    return dot(face.away, points_[point]) > face.offset;
  }

  // The directions that later points add complete the span of those placed so far.
  void find_normal(Face& face) const {
    const IntegerVector<D>& origin = points_[face.points[0]];
    std::array<IntegerVector<D>, D - 1> sides{outward_};
    for (std::size_t i = 1; i < rank_; ++i) sides[i] = difference(points_[face.points[i]], origin);
    for (std::size_t i = rank_; i < D - 1; ++i) sides[i] = space_.direction(i);
    face.away = cross_product<D>(sides);
    face.offset = dot(face.away, origin);
    if (dot(face.away, points_[face.opposite]) < face.offset) return;
    face.away = difference({}, face.away);
    face.offset = -face.offset;
  }

  IntegerVector<D> outward_;
  std::vector<IntegerVector<D>> points_;
  std::vector<bool> raises_rank_;
  SpannedSpace<D> space_;

  std::size_t rank_ = 0; // of the points placed so far
  std::vector<EdgeSimplex<D>> simplices_;
  std::vector<Face> boundary_;
};

} // namespace

template <int D>
std::array<std::uint8_t, cube_edge_count<D>> edges_in_placing_order() {
  std::array<std::uint8_t, cube_edge_count<D>> edges;
  std::iota(edges.begin(), edges.end(), std::uint8_t{0});
  std::sort(edges.begin(), edges.end(),
            [](int a, int b) { return edge_midpoint<D>(a) < edge_midpoint<D>(b); });
  return edges;
}

template <int D>
std::vector<EdgeSimplex<D>> triangulate_facet(const IntegerVector<D>& outward,
                                              std::span<const std::uint8_t> edges) {
  if (edges.size() < D) return {};
  Placing<D> placing(outward, edges);
  if (!placing.spans_hyperplane()) return {};
  std::vector<EdgeSimplex<D>> simplices = placing.triangulate();
  for (EdgeSimplex<D>& simplex : simplices) {
    if (!placing.is_positive(simplex)) std::swap(simplex[D - 2], simplex[D - 1]);
    for (std::uint8_t& vertex : simplex) vertex = edges[vertex];
  }
  return simplices;
}

#define HYPERISO_INSTANTIATE_FACET(D)                                                                        \
  template std::array<std::uint8_t, cube_edge_count<D>> edges_in_placing_order<D>();                         \
  template std::vector<EdgeSimplex<D>> triangulate_facet<D>(const IntegerVector<D>&,                         \
                                                            std::span<const std::uint8_t>);
HYPERISO_INSTANTIATE_FACET(2)
HYPERISO_INSTANTIATE_FACET(3)
HYPERISO_INSTANTIATE_FACET(4)
HYPERISO_INSTANTIATE_FACET(5)
HYPERISO_INSTANTIATE_FACET(6)

} // namespace hyperiso
