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
    boundary_.push_back({{}, 0});
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
  };

  // A point outside the span of the others makes a cone of them all.
  void raise(std::uint8_t point) {
    std::vector<Face> bases;
    for (auto& simplex : simplices_) {
      Face& base = bases.emplace_back(Face{{}, point});
      std::copy_n(simplex.begin(), rank_ + 1, base.points.begin());
      simplex[rank_ + 1] = point;
    }
    for (Face& face : boundary_) face.points[rank_] = point;
    boundary_.insert(boundary_.end(), bases.begin(), bases.end());
    ++rank_;
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
    const std::int64_t side = side_of(point, face);
    return side != 0 && (side > 0) != (side_of(face.opposite, face) > 0);
  }

  // Which side of a face a point is on, within the span of the points placed so far. The directions that
  // later points add complete it to a determinant.
  std::int64_t side_of(std::size_t point, const Face& face) const {
    const IntegerVector<D>& origin = points_[face.points[0]];
    std::array<IntegerVector<D>, D - 1> sides;
    for (std::size_t i = 1; i < rank_; ++i) sides[i - 1] = difference(points_[face.points[i]], origin);
    sides[rank_ - 1] = difference(points_[point], origin);
    for (std::size_t i = rank_; i < D - 1; ++i) sides[i] = space_.direction(i);
    return determinant(outward_, sides);
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
  Placing<D> placing(outward, edges);
  if (!placing.spans_hyperplane()) return {};
  std::vector<EdgeSimplex<D>> simplices = placing.triangulate();
  for (EdgeSimplex<D>& simplex : simplices) {
    if (!placing.is_positive(simplex)) std::swap(simplex[D - 2], simplex[D - 1]);
    for (std::uint8_t& vertex : simplex) vertex = edges[vertex];
  }
  return simplices;
}

template std::array<std::uint8_t, 4> edges_in_placing_order<2>();
template std::array<std::uint8_t, 12> edges_in_placing_order<3>();
template std::array<std::uint8_t, 32> edges_in_placing_order<4>();
template std::vector<EdgeSimplex<2>> triangulate_facet<2>(const IntegerVector<2>&,
                                                          std::span<const std::uint8_t>);
template std::vector<EdgeSimplex<3>> triangulate_facet<3>(const IntegerVector<3>&,
                                                          std::span<const std::uint8_t>);
template std::vector<EdgeSimplex<4>> triangulate_facet<4>(const IntegerVector<4>&,
                                                          std::span<const std::uint8_t>);

} // namespace hyperiso
