// Entries made one by one: equal to those of the full tables where there are any, and above four dimensions
// what a table has to be.
#include "table/cube.hpp"
#include "table/cube_facet.hpp"
#include "table/hull_entry.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <gtest/gtest.h>
#include <map>
#include <random>
#include <set>
#include <utility>
#include <vector>

using namespace hyperiso;

namespace {

template <int D>
void expect_full_table() {
  HullEntryMaker<D> maker;
  for (CubeLabels labels = 0; labels < HullTable<D>::entries; ++labels)
    ASSERT_TRUE(std::ranges::equal(maker.make(labels), hull_table<D>().simplices(labels))) << labels;
}

// Oriented faces: ascending edges -> how often they occur, counted with sign.
template <std::size_t N>
using Chain = std::map<std::array<std::uint8_t, N>, int>;

template <std::size_t N>
void add(Chain<N>& chain, std::array<std::uint8_t, N> face, int sign) {
  for (std::size_t i = 1; i < N; ++i)
    for (std::size_t j = i; j > 0 && face[j] < face[j - 1]; --j) {
      std::swap(face[j], face[j - 1]);
      sign = -sign;
    }
  chain[face] += sign;
}

template <int D>
std::vector<std::array<std::uint8_t, D>> simplices_of(std::span<const std::uint8_t> edges) {
  std::vector<std::array<std::uint8_t, D>> simplices(edges.size() / D);
  for (std::size_t i = 0; i < edges.size(); ++i) simplices[i / D][i % D] = edges[i];
  return simplices;
}

// The boundary of the surface: faces that cancel are not part of it, but must occur exactly twice.
template <int D>
Chain<D - 1> boundary_of(std::span<const std::uint8_t> edges) {
  Chain<D - 1> boundary, uses;
  for (const auto& simplex : simplices_of<D>(edges))
    for (std::size_t left_out = 0; left_out < D; ++left_out) {
      std::array<std::uint8_t, D - 1> face;
      std::copy_n(simplex.begin(), left_out, face.begin());
      std::copy(simplex.begin() + left_out + 1, simplex.end(), face.begin() + left_out);
      add<D - 1>(boundary, face, left_out % 2 == 0 ? 1 : -1);
      std::ranges::sort(face);
      ++uses[face];
    }
  for (const auto& [face, count] : uses) EXPECT_EQ(count, boundary[face] == 0 ? 2 : 1);
  std::erase_if(boundary, [](const auto& face) { return face.second == 0; });
  return boundary;
}

// What neighbours have to leave on the facets of the cube: the entries of the table below.
template <int D, class LowerEntry>
Chain<D - 1> lower_entries(LabelSet<D> labels, LowerEntry&& lower_entry) {
  Chain<D - 1> chain;
  for (const CubeFacet<D>& facet : cube_facets<D>)
    for (auto simplex : simplices_of<D - 1>(lower_entry(facet.labels_within(labels)))) {
      for (std::uint8_t& edge : simplex) edge = facet.edge_of_cube(edge);
      add<D - 1>(chain, simplex, facet.trace_keeps_orientation() ? 1 : -1);
    }
  return chain;
}

template <int D>
void expect_crossed_edges_used(LabelSet<D> labels, std::span<const std::uint8_t> edges) {
  std::set<int> used(edges.begin(), edges.end()), crossed;
  for (int edge = 0; edge < cube_edge_count<D>; ++edge) {
    const auto [lower, axis] = cube_edge_ends<D>(edge);
    if ((labels >> lower & 1) != (labels >> (lower | 1 << axis) & 1)) crossed.insert(edge);
  }
  EXPECT_EQ(used, crossed);
}

// With all vertices at the midpoints of their edges.
template <int D>
void expect_normals_from_positive_to_negative(LabelSet<D> labels, std::span<const std::uint8_t> edges) {
  for (const auto& simplex : simplices_of<D>(edges)) {
    std::array<IntegerVector<D>, D - 1> sides;
    for (std::size_t i = 1; i < D; ++i)
      sides[i - 1] = difference(edge_midpoint<D>(simplex[i]), edge_midpoint<D>(simplex[0]));
    const IntegerVector<D> normal = cross_product<D>(sides);
    for (const int edge : simplex) {
      const auto [lower, axis] = cube_edge_ends<D>(edge);
      const std::int64_t rise = normal[static_cast<std::size_t>(axis)];
      EXPECT_TRUE(labels >> lower & 1 ? rise > 0 : rise < 0);
    }
  }
}

// Labellings of every density, and those that a plane makes.
std::vector<std::uint64_t> sampled_labellings(int dimension, int count) {
  std::mt19937_64 random(5);
  std::normal_distribution<double> normal;
  const int vertices = 1 << dimension;
  std::vector<std::uint64_t> labellings;
  for (int i = 0; i < count; ++i) {
    std::uint64_t labels = 0;
    std::array<double, 6> gradient;
    for (double& component : gradient) component = normal(random);
    const double level = normal(random);
    for (int vertex = 0; vertex < vertices; ++vertex) {
      double value = level;
      for (int axis = 0; axis < dimension; ++axis)
        value += (vertex >> axis & 1 ? 0.5 : -0.5) * gradient[static_cast<std::size_t>(axis)];
      const bool positive =
          i % 2 == 0 ? value > 0 : random() % static_cast<unsigned>(count) < static_cast<unsigned>(i);
      labels |= std::uint64_t{positive} << vertex;
    }
    labellings.push_back(labels);
  }
  return labellings;
}

} // namespace

TEST(HullEntry, every_3d_and_4d_entry_is_that_of_the_full_table) {
  expect_full_table<3>();
  expect_full_table<4>();
}

TEST(HullEntry, sampled_5d_entries_match_their_neighbours_and_are_manifold_and_oriented) {
  HullEntryMaker<5> maker;
  for (const std::uint64_t any : sampled_labellings(5, 400)) {
    const auto labels = static_cast<CubeLabels>(any);
    const auto entry = maker.make(labels);
    EXPECT_EQ(boundary_of<5>(entry),
              lower_entries<5>(labels, [](CubeLabels lower) { return hull_table<4>().simplices(lower); }))
        << labels;
    expect_crossed_edges_used<5>(labels, entry);
    expect_normals_from_positive_to_negative<5>(labels, entry);
    if (HasFailure()) return;
  }
}

TEST(HullEntry, sampled_6d_entries_match_their_neighbours_and_are_manifold_and_oriented) {
  HullEntryMaker<6> maker;
  HullEntryMaker<5> lower_maker;
  for (const std::uint64_t labels : sampled_labellings(6, 24)) {
    const auto entry = maker.make(labels);
    EXPECT_EQ(boundary_of<6>(entry),
              lower_entries<6>(labels, [&](CubeLabels lower) { return lower_maker.make(lower); }))
        << labels;
    expect_crossed_edges_used<6>(labels, entry);
    expect_normals_from_positive_to_negative<6>(labels, entry);
    if (HasFailure()) return;
  }
}

// The extremes: no surface, one corner cut off, every edge crossed.
TEST(HullEntry, uniform_single_and_checkered_labellings) {
  HullEntryMaker<5> maker;
  EXPECT_TRUE(maker.make(0).empty());
  EXPECT_TRUE(maker.make(0xffffffff).empty());
  EXPECT_EQ(maker.make(1).size(), 5u);
  EXPECT_EQ(maker.make(0xfffffffe).size(), 5u);
  CubeLabels checkered = 0;
  for (unsigned vertex = 0; vertex < 32; ++vertex)
    checkered |= CubeLabels(std::popcount(vertex) % 2) << vertex;
  expect_crossed_edges_used<5>(checkered, maker.make(checkered));
  boundary_of<5>(maker.make(checkered));
  EXPECT_TRUE(HullEntryMaker<6>().make(~std::uint64_t{0}).empty());
  EXPECT_EQ(HullEntryMaker<6>().make(1).size(), 6u);
}
