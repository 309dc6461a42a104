#pragma once
// What the tests ask of fields and meshes: shared by every test program.

#include "core/determinant.hpp"
#include "hyperiso/extract.hpp"
#include "hyperiso/measure.hpp"

#include <algorithm>
#include <bit>
#include <functional>
#include <gtest/gtest.h>
#include <map>
#include <numeric>
#include <random>
#include <set>
#include <vector>

namespace hyperiso::check {

// A field with samples of its own.
template <class T, int D>
struct OwnedField {
  std::vector<T> samples;
  FieldView<const T, D> view;
};

template <class T, int D>
OwnedField<T, D> make_field(const Grid<D>& grid,
                            const std::function<double(const std::array<double, D>&)>& value) {
  OwnedField<T, D> field;
  field.samples.resize(static_cast<std::size_t>(grid.samples()));
  field.view = contiguous_view<const T, D>(field.samples.data(), grid);
  std::array<std::int64_t, D> index{};
  for (T& sample : field.samples) {
    std::array<double, D> point;
    for (int axis = 0; axis < D; ++axis) point[axis] = grid.axes[axis].coordinate(index[axis]);
    sample = static_cast<T>(value(point));
    for (int axis = 0; axis < D && ++index[axis] == grid.axes[axis].count; ++axis) index[axis] = 0;
  }
  return field;
}

// n samples per axis on [low, high].
template <int D>
Grid<D> box_grid(std::int64_t n, double low, double high) {
  Grid<D> grid;
  for (Axis& axis : grid.axes) {
    axis.count = n;
    axis.origin = low;
    axis.spacing = (high - low) / static_cast<double>(n - 1);
  }
  return grid;
}

// Whole numbers in [-range, range]: small ranges give many samples equal to an isovalue of 0.
template <class T, int D>
OwnedField<T, D> random_field(const std::array<std::int64_t, D>& dims, int range, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_int_distribution<int> value(-range, range);
  return make_field<T, D>(unit_grid<D>(dims), [&](const auto&) { return value(random); });
}

// The isosurface; an error fails the test.
template <class T, int D>
SimplexMesh<D> extracted(const OwnedField<T, D>& field, double isovalue, const ExtractOptions& options = {}) {
  auto mesh = extract(field.view, isovalue, options);
  EXPECT_TRUE(mesh) << mesh.error().message;
  return *std::move(mesh);
}

// The vertex positions of each simplex, starting from its smallest corner and with its orientation kept by an
// even permutation: equal for meshes that differ in the numbering of vertices and the order of simplices
// only.
using SimplexSet = std::multiset<std::vector<std::vector<double>>>;

inline SimplexSet simplex_set(const Mesh& mesh) {
  const auto D = static_cast<std::size_t>(mesh.dimension);
  const auto corners = static_cast<std::size_t>(mesh.simplex_dimension + 1);
  SimplexSet set;
  for (std::size_t simplex = 0; simplex < mesh.simplex_count(); ++simplex) {
    std::vector<std::vector<double>> points;
    bool even = true;
    for (std::size_t corner = 0; corner < corners; ++corner) {
      std::vector<double> point;
      for (std::size_t k = 0; k < D; ++k)
        point.push_back(mesh.positions[mesh.simplices[simplex * corners + corner] * D + k]);
      auto place = points.end();
      while (place != points.begin() && point < *(place - 1)) {
        --place;
        even = !even;
      }
      points.insert(place, std::move(point));
    }
    const bool flat = std::ranges::adjacent_find(points) != points.end(); // then neither orientation is wrong
    if (!even && !flat) std::swap(points[0], points[1]);
    set.insert(std::move(points));
  }
  return set;
}

inline std::multiset<std::vector<double>> vertex_set(const Mesh& mesh) {
  const auto D = static_cast<std::size_t>(mesh.dimension);
  std::multiset<std::vector<double>> set;
  for (std::size_t vertex = 0; vertex < mesh.vertex_count(); ++vertex) {
    std::vector<double> point;
    for (std::size_t k = 0; k < D; ++k) point.push_back(mesh.positions[vertex * D + k]);
    set.insert(std::move(point));
  }
  return set;
}

// The same vertices and the same oriented simplices, by position.
inline void expect_same_mesh(const Mesh& a, const Mesh& b) {
  ASSERT_EQ(a.dimension, b.dimension);
  EXPECT_EQ(a.vertex_count(), b.vertex_count());
  EXPECT_EQ(a.simplex_count(), b.simplex_count());
  EXPECT_TRUE(vertex_set(a) == vertex_set(b));
  EXPECT_TRUE(simplex_set(a) == simplex_set(b));
}

// Sum over the simplices of (point on it) . (area vector) / D: the volume that a closed surface encloses,
// positive if its normals point outward.
inline double enclosed_volume(const Mesh& mesh) {
  const auto D = static_cast<std::size_t>(mesh.dimension);
  double volume = 0;
  for (std::size_t simplex = 0; simplex < mesh.simplex_count(); ++simplex) {
    std::vector<double> rows;
    for (std::size_t corner = 0; corner < D; ++corner)
      for (std::size_t k = 0; k < D; ++k)
        rows.push_back(mesh.positions[mesh.simplices[simplex * D + corner] * D + k]);
    volume += determinant(rows, mesh.dimension);
  }
  for (int k = 2; k <= mesh.dimension; ++k) volume /= k;
  return volume;
}

// Calls use(index) for every sample, in memory order.
template <int D, class Use>
void for_each_index(const std::array<std::int64_t, D>& dims, Use&& use) {
  if (std::ranges::find(dims, 0) != dims.end()) return;
  std::array<std::int64_t, D> index{};
  for (int axis = 0; axis < D;) {
    use(index);
    for (axis = 0; axis < D && ++index[axis] == dims[axis]; ++axis) index[axis] = 0;
  }
}

// The vertices of each facet that belongs to one simplex only.
inline std::vector<std::vector<std::uint64_t>> boundary_facets(const Mesh& mesh) {
  const auto corners = static_cast<std::size_t>(mesh.simplex_dimension + 1);
  std::map<std::vector<std::uint64_t>, int> uses;
  for (std::size_t simplex = 0; simplex < mesh.simplex_count(); ++simplex)
    for (std::size_t left_out = 0; left_out < corners; ++left_out) {
      std::vector<std::uint64_t> facet;
      for (std::size_t corner = 0; corner < corners; ++corner)
        if (corner != left_out) facet.push_back(mesh.simplices[simplex * corners + corner]);
      std::ranges::sort(facet);
      ++uses[facet];
    }
  std::vector<std::vector<std::uint64_t>> boundary;
  for (const auto& [facet, count] : uses)
    if (count == 1) boundary.push_back(facet);
  return boundary;
}

// Counts the crossed edges of the cells without NaN (with `kuhn`, of their Kuhn simplices), without any
// table.
template <class T, int D>
std::size_t crossed_edges(const FieldView<const T, D>& field, const std::function<bool(T)>& inside,
                          bool kuhn = false) {
  const auto dims = field.dims();
  std::set<std::pair<std::array<std::int64_t, D>, unsigned>> crossed;
  for_each_index<D>(dims, [&](const std::array<std::int64_t, D>& cell) {
    for (int axis = 0; axis < D; ++axis)
      if (cell[axis] == dims[axis] - 1) return;
    const auto sample = [&](unsigned vertex) {
      auto index = cell;
      for (int axis = 0; axis < D; ++axis) index[axis] += vertex >> axis & 1;
      return index;
    };
    for (unsigned vertex = 0; vertex < 1u << D; ++vertex)
      if (field.at(sample(vertex)) != field.at(sample(vertex))) return; // NaN
    for (unsigned lower = 0; lower < 1u << D; ++lower)
      for (unsigned direction = 1; direction < 1u << D; ++direction) {
        if ((lower & direction) != 0 || (!kuhn && !std::has_single_bit(direction))) continue;
        if (inside(field.at(sample(lower))) != inside(field.at(sample(lower | direction))))
          crossed.insert({sample(lower), direction});
      }
  });
  return crossed.size();
}

} // namespace hyperiso::check
