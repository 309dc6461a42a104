#pragma once
// The region that a surface bounds, or the volume between two levels, as a mesh of D-simplices.

#include "core/cell.hpp"
#include "core/sign.hpp"
#include "core/text.hpp"
#include "extract/engine.hpp"

#include <algorithm>
#include <bit>
#include <numeric>
#include <optional>

namespace hyperiso::track_detail {

// The region: inside the first level, not inside the second if there is one.
struct RegionLevels {
  double first = 0;
  std::optional<double> second;
  Inside inside = Inside::above;

  double value(std::int64_t layer) const { return layer == 0 ? first : *second; }
};

// Inside of the surface at `isovalue`; or between that and another isovalue above it, whichever side is
// inside.
inline RegionLevels region_levels(double isovalue, const std::optional<double>& upper, Inside inside) {
  if (!upper || inside == Inside::above) return {isovalue, upper, inside};
  return {*upper, isovalue, inside};
}

// The field lifted by an axis of two levels; nothing is inside of a second one that the region does not have.
template <class T, int D>
Samples<D + 1> samples_between(const FieldView<const T, D>& field, const RegionLevels& levels) {
  auto samples = lifted_samples(
      field, std::vector<double>{levels.first, levels.second.value_or(levels.first)}, levels.inside);
  if (!levels.second) samples.level_tests[1].never = true;
  return samples;
}

// A vertex of the mesh has the number of an edge of the lifted grid, whose last axis is that of the levels:
// an edge along that axis is the sample itself, one within a layer the crossing with that level.
template <int D>
std::array<std::int64_t, D + 1> in_layer(const std::array<std::int64_t, D>& sample, std::int64_t layer) {
  std::array<std::int64_t, D + 1> lifted;
  std::ranges::copy(sample, lifted.begin());
  lifted[D] = layer;
  return lifted;
}
template <int D>
std::array<std::int64_t, D + 1> lifted_dims(const std::array<std::int64_t, D>& dims) {
  return in_layer<D>(dims, 2); // of two levels
}
// The edge of the lifted grid that stands for a sample; and that of a crossing of the first level between two
// samples.
template <int D>
GridEdge sample_edge(const std::array<std::int64_t, D + 1>& dims, const std::array<std::int64_t, D>& sample) {
  return grid_edge<D + 1>(dims, in_layer<D>(sample, 1), 1u << D);
}
template <int D>
GridEdge first_crossing(const std::array<std::int64_t, D + 1>& dims, const std::array<std::int64_t, D>& a,
                        const std::array<std::int64_t, D>& b) {
  unsigned direction = 0;
  std::array<std::int64_t, D> upper;
  for (int axis = 0; axis < D; ++axis) {
    direction |= static_cast<unsigned>(a[axis] != b[axis]) << axis;
    upper[axis] = std::max(a[axis], b[axis]);
  }
  return grid_edge<D + 1>(dims, in_layer<D>(upper, 0), direction);
}

// The inside of each Kuhn simplex of a cell, which is combinatorially the product of the simplex of its
// inside corners p with one whose corners say "p itself" or "on the way from p to the outside corner n": cut
// along staircases in the order of the corners.
template <class T, int D, class Rule>
class KuhnRegion {
 public:
  KuhnRegion(const FieldView<const T, D>& field, const Rule& rule) : field_(field), rule_(rule) {
    dims_ = lifted_dims<D>(field.dims());
  }

  Result<SimplexMesh<D + 1>> mesh(std::uint64_t memory_limit) {
    std::array<std::int64_t, D> cell{};
    for (bool more = true; more;) {
      add_cell(cell);
      if (edges_.size() > memory_limit / bytes_per_corner)
        return Error{Code::out_of_memory,
                     text("the region has more than ", edges_.size() / (D + 1),
                          " simplices, which need more than the limit of ", byte_size(memory_limit))};
      int axis = 0;
      while (axis < D && ++cell[axis] > field_.dims()[axis] - 2) cell[axis] = 0, ++axis;
      more = axis < D;
    }
    return welded();
  }

 private:
  using Sample = std::array<std::int64_t, D>;
  static constexpr std::uint64_t bytes_per_corner = 3 * sizeof(GridEdge); // while it is welded

  void add_cell(const Sample& cell) {
    unsigned positive = 0;
    for (unsigned corner = 0; corner < 1u << D; ++corner) {
      const T value = field_.at(corner_of(cell, corner));
      if (is_missing(value)) return;
      if (rule_.inside(value)) positive |= 1u << corner;
    }
    if (positive == 0) return;
    std::array<int, D> order;
    std::iota(order.begin(), order.end(), 0);
    do {
      std::array<Sample, D + 1> in, out;
      std::size_t inner = 0, outer = 0;
      unsigned corner = 0;
      for (std::size_t k = 0; k <= D; ++k) {
        (positive >> corner & 1 ? in[inner++] : out[outer++]) = corner_of(cell, corner);
        if (k < D) corner |= 1u << order[k];
      }
      if (inner > 0) add_staircases(std::span(in).first(inner), std::span(out).first(outer));
    } while (std::ranges::next_permutation(order).found);
  }

  // Steps over the inside corners: bit k says whether step k goes to the next one.
  void add_staircases(std::span<const Sample> in, std::span<const Sample> out) {
    for (unsigned steps = 0; steps < 1u << D; ++steps) {
      if (std::popcount(steps) != static_cast<int>(in.size()) - 1) continue;
      std::size_t p = 0, n = 0;
      for (int step = 0;; ++step) {
        edges_.push_back(n == 0 ? sample_edge<D>(dims_, in[p]) : first_crossing<D>(dims_, in[p], out[n - 1]));
        if (step == D) break;
        (steps >> step & 1 ? p : n) += 1;
      }
    }
  }

  SimplexMesh<D + 1> welded() {
    SimplexMesh<D + 1> mesh;
    std::vector<GridEdge> vertices = edges_;
    std::ranges::sort(vertices);
    vertices.erase(std::unique(vertices.begin(), vertices.end()), vertices.end());
    mesh.edges.assign(vertices.begin(), vertices.end());
    mesh.simplices.reset(edges_.size(), true);
    for (std::size_t corner = 0; corner < edges_.size(); ++corner)
      mesh.simplices.set(corner, static_cast<std::uint64_t>(
                                     std::ranges::lower_bound(vertices, edges_[corner]) - vertices.begin()));
    return mesh;
  }

  FieldView<const T, D> field_;
  Rule rule_;
  std::array<std::int64_t, D + 1> dims_;
  std::vector<GridEdge> edges_; // of each corner of the simplices
};

// The mesh of the region: D + 1 corners a simplex, and the edges of the lifted grid that its vertices lie on,
// ascending; no positions. With `hull` it is that of the interval volume (interval.hpp): the region of a
// surface is the volume up to a level that no sample reaches. Simplices that face the same way come with the
// same sign; those of KuhnRegion in no order.
template <class T, int D>
Result<SimplexMesh<D + 1>> mesh_region(const FieldView<const T, D>& field, const RegionLevels& levels,
                                       const ExtractOptions& options) {
  SimplexMesh<D + 1> mesh;
  if (std::ranges::any_of(field.dims(), [](std::int64_t count) { return count < 2; })) return mesh;
  if (options.method == Method::simplicial && !levels.second)
    return levels.inside == Inside::above
               ? KuhnRegion(field, SignRule<T, true>(levels.first)).mesh(options.memory_limit)
               : KuhnRegion(field, SignRule<T, false>(levels.first)).mesh(options.memory_limit);
  const Samples<D + 1> samples = samples_between(field, levels);
  if (const Status made = run_engine(samples, TableForm{}, options, EngineOptions{}, mesh); !made)
    return made.error();
  return mesh;
}

// What a vertex of the mesh is: decodes its number.
template <class T, int D>
class RegionVertices {
 public:
  RegionVertices(const FieldView<const T, D>& field, const RegionLevels& levels)
      : field_(field), levels_(levels) {
    dims_ = lifted_dims<D>(field.dims());
  }

  // Where it is, `weight` of the way from one sample to another, or at both; and the field's value there.
  struct Location {
    std::array<std::int64_t, D> lower, upper;
    double weight = 0;
    double value = 0;
  };
  Location locate(GridEdge edge) const { return locate(grid_edge_ends<D + 1>(dims_, edge)); }
  Location locate(const GridEdgeEnds<D + 1>& ends) const {
    Location location;
    std::copy_n(ends.lower.begin(), D, location.lower.begin());
    std::copy_n(ends.upper.begin(), D, location.upper.begin());
    const auto a = static_cast<double>(field_.at(location.lower));
    const auto b = static_cast<double>(field_.at(location.upper));
    if (ends.direction == 1u << D) {
      location.value = a;
    } else if (ends.lower[D] == ends.upper[D]) {
      location.value = levels_.value(ends.lower[D]);
      location.weight = crossing(a, b, location.value);
    } else {
      location.weight = crossing(a - levels_.value(0), b - levels_.value(1), 0);
      location.value = std::lerp(a, b, location.weight);
    }
    return location;
  }
  bool is_sample(GridEdge edge) const {
    const auto row_and_direction = edge / static_cast<GridEdge>(dims_[0]);
    return (row_and_direction & ((2u << D) - 1)) == 1u << D;
  }

  double coordinate(const Location& at, int axis) const {
    const Axis& of = field_.grid.axes[axis];
    return std::lerp(of.coordinate(at.lower[axis]), of.coordinate(at.upper[axis]), at.weight);
  }

  const FieldView<const T, D>& field() const { return field_; }
  const std::array<std::int64_t, D + 1>& dims() const { return dims_; }

 private:
  FieldView<const T, D> field_;
  RegionLevels levels_;
  std::array<std::int64_t, D + 1> dims_; // of the lifted grid
};

} // namespace hyperiso::track_detail
