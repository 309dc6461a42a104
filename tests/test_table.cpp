#include "hyperiso/table.hpp"

#include <algorithm>
#include <array>
#include <cstdint>
#include <gtest/gtest.h>
#include <numeric>
#include <set>
#include <vector>

using namespace hyperiso;

namespace {

template <int D>
void expect_totals(std::size_t simplices, std::size_t largest, std::size_t largest_entries) {
  std::vector<std::size_t> counts;
  for (CubeLabels labels = 0; labels < HullTable<D>::entries; ++labels)
    counts.push_back(hull_table<D>().simplex_count(labels));
  EXPECT_EQ(std::accumulate(counts.begin(), counts.end(), std::size_t{0}), simplices);
  EXPECT_EQ(*std::max_element(counts.begin(), counts.end()), largest);
  EXPECT_EQ(static_cast<std::size_t>(std::count(counts.begin(), counts.end(), largest)), largest_entries);
}

template <int D>
std::vector<CubeLabels> entries_of_size(std::size_t simplices) {
  std::vector<CubeLabels> found;
  for (CubeLabels labels = 0; labels < HullTable<D>::entries; ++labels)
    if (hull_table<D>().simplex_count(labels) == simplices) found.push_back(labels);
  return found;
}

template <int D>
CubeLabels complement(CubeLabels labels) {
  return static_cast<CubeLabels>(HullTable<D>::entries - 1) ^ labels;
}

template <int D>
CubeLabels permuted(CubeLabels labels, const std::array<int, 1 << D>& image) {
  CubeLabels result = 0;
  for (std::size_t vertex = 0; vertex < 1 << D; ++vertex) result |= (labels >> vertex & 1) << image[vertex];
  return result;
}

// Generators of the cube's symmetries: reflections, and exchanges of neighbouring axes.
template <int D>
std::vector<std::array<int, 1 << D>> cube_symmetries() {
  std::vector<std::array<int, 1 << D>> generators;
  for (int k = 0; k < D; ++k) {
    auto& reflection = generators.emplace_back();
    for (int i = 0; i < 1 << D; ++i) reflection[static_cast<std::size_t>(i)] = i ^ 1 << k;
  }
  for (int k = 0; k + 1 < D; ++k) {
    auto& exchange = generators.emplace_back();
    for (int i = 0; i < 1 << D; ++i)
      exchange[static_cast<std::size_t>(i)] =
          (i & ~(3 << k)) | (i >> k & 1) << (k + 1) | (i >> (k + 1) & 1) << k;
  }
  return generators;
}

// For each labelling the least one that the cube's symmetries take it to, complements included if asked for.
template <int D>
std::vector<CubeLabels> classes(bool with_complement) {
  constexpr auto none = static_cast<CubeLabels>(HullTable<D>::entries);
  const auto symmetries = cube_symmetries<D>();
  std::vector<CubeLabels> least(HullTable<D>::entries, none);
  for (CubeLabels first = 0; first < HullTable<D>::entries; ++first) {
    if (least[first] != none) continue;
    least[first] = first;
    for (std::vector<CubeLabels> reached{first}; !reached.empty();) {
      const CubeLabels labels = reached.back();
      reached.pop_back();
      std::vector<CubeLabels> images;
      for (const auto& symmetry : symmetries) images.push_back(permuted<D>(labels, symmetry));
      if (with_complement) images.push_back(complement<D>(labels));
      for (const CubeLabels image : images) {
        if (least[image] != none) continue;
        least[image] = first;
        reached.push_back(image);
      }
    }
  }
  return least;
}

template <int D>
std::size_t class_count(bool with_complement) {
  const auto least = classes<D>(with_complement);
  return std::set(least.begin(), least.end()).size();
}

// Euler characteristics of the connected pieces of a 3D entry, sorted.
std::vector<int> euler_characteristics_of_pieces(CubeLabels labels) {
  std::vector<std::set<int>> pieces; // of cube edges
  const auto edges = hull_table<3>().simplices(labels);
  for (std::size_t i = 0; i < edges.size(); i += 3) {
    std::set<int> joined(edges.begin() + i, edges.begin() + i + 3);
    std::erase_if(pieces, [&](const std::set<int>& piece) {
      const bool touches = std::any_of(piece.begin(), piece.end(), [&](int e) { return joined.contains(e); });
      if (touches) joined.insert(piece.begin(), piece.end());
      return touches;
    });
    pieces.push_back(joined);
  }
  std::vector<int> characteristics;
  for (const auto& piece : pieces) {
    int triangles = 0;
    std::set<std::set<int>> sides;
    for (std::size_t i = 0; i < edges.size(); i += 3) {
      if (!piece.contains(edges[i])) continue;
      ++triangles;
      for (std::size_t k = 0; k < 3; ++k) sides.insert({edges[i + k], edges[i + (k + 1) % 3]});
    }
    characteristics.push_back(static_cast<int>(piece.size()) - static_cast<int>(sides.size()) + triangles);
  }
  std::sort(characteristics.begin(), characteristics.end());
  return characteristics;
}

} // namespace

TEST(HullTable, totals_are_those_of_paper_000) {
  expect_totals<2>(16, 2, 2);
  expect_totals<3>(836, 6, 4);
  expect_totals<4>(856960, 26, 4);
  EXPECT_EQ(entries_of_size<4>(26), (std::vector<CubeLabels>{0x2184, 0x4182, 0x8241, 0x8421}));
}

TEST(HullTable, labellings_fall_into_the_papers_classes) {
  EXPECT_EQ(class_count<2>(false), 6u);
  EXPECT_EQ(class_count<2>(true), 4u);
  EXPECT_EQ(class_count<3>(false), 22u);
  EXPECT_EQ(class_count<3>(true), 14u);
  EXPECT_EQ(class_count<4>(false), 402u);
  EXPECT_EQ(class_count<4>(true), 222u);
}

// Modified marching cubes cuts a cube into discs only. The hull joins two opposite + vertices.
TEST(HullTable, only_two_opposite_positive_vertices_make_a_tunnel) {
  std::vector<CubeLabels> tunnels;
  for (CubeLabels labels = 1; labels < 0xff; ++labels) {
    const auto pieces = euler_characteristics_of_pieces(labels);
    if (pieces == std::vector{0})
      tunnels.push_back(labels);
    else
      EXPECT_EQ(pieces, std::vector<int>(pieces.size(), 1)) << labels;
  }
  EXPECT_EQ(tunnels, (std::vector<CubeLabels>{0x18, 0x24, 0x42, 0x81}));
  EXPECT_EQ(tunnels, entries_of_size<3>(6));
}

// Neither complements nor symmetries of the cube carry one entry to another: the table cannot be folded.
TEST(HullTable, complements_and_mirror_images_differ_in_size) {
  std::size_t differing_complements = 0;
  const auto least = classes<4>(false);
  std::set<CubeLabels> broken_classes;
  for (CubeLabels labels = 0; labels < HullTable<4>::entries; ++labels) {
    const std::size_t size = hull_table<4>().simplex_count(labels);
    differing_complements += size != hull_table<4>().simplex_count(complement<4>(labels));
    if (size != hull_table<4>().simplex_count(least[labels])) broken_classes.insert(least[labels]);
  }
  EXPECT_EQ(differing_complements, 57304u);
  EXPECT_EQ(broken_classes.size(), 123u);
}

TEST(HullTable, generated_again_it_is_the_same) {
  const HullTable<4> again;
  for (CubeLabels labels = 0; labels < HullTable<4>::entries; ++labels)
    ASSERT_TRUE(std::ranges::equal(again.simplices(labels), hull_table<4>().simplices(labels))) << labels;
}
