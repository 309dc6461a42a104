#include "hyperiso/table.hpp"
#include "table/verify.hpp"
#include "table/vertex_hulls.hpp"

#include <algorithm>
#include <array>
#include <cstdint>
#include <gtest/gtest.h>
#include <random>
#include <utility>
#include <vector>

using namespace hyperiso;

namespace {

std::uint64_t failures(const TableVerification& counts) {
  return counts.facet_mismatches + counts.manifold_failures + counts.vertex_link_failures +
         counts.edge_use_failures + counts.orientation_failures + counts.face_intersections;
}

template <int D>
TableVerification verified(CubeLabels labels, const std::vector<std::uint8_t>& simplices) {
  TableVerification counts;
  EntryVerifier<D>().verify(labels, simplices, counts);
  return counts;
}

template <int D>
std::vector<std::uint8_t> entry(CubeLabels labels) {
  const auto simplices = hull_table<D>().simplices(labels);
  return {simplices.begin(), simplices.end()};
}

// Whether values[v] <= 0 on one set, >= 0 on the other, not all 0.
template <std::size_t N>
bool separates_properly(const std::array<int, N>& values, CubeLabels a, CubeLabels b) {
  bool strict = false;
  for (std::size_t v = 0; v < N; ++v) {
    if ((a >> v & 1 && values[v] > 0) || (b >> v & 1 && values[v] < 0)) return false;
    strict |= ((a | b) >> v & 1) && values[v] != 0;
  }
  return strict;
}

} // namespace

TEST(VerifyTable, whole_2d_and_3d_tables) {
  const TableVerification two = verify_hull_table(hull_table<2>()),
                          three = verify_hull_table(hull_table<3>());
  EXPECT_EQ(failures(two), 0u);
  EXPECT_EQ(two.entries, 16u);
  EXPECT_EQ(two.facet_checks, 64u);
  EXPECT_EQ(two.vertex_links, 32u);
  EXPECT_EQ(two.orientation_checks, 32u);
  EXPECT_EQ(failures(three), 0u);
  EXPECT_EQ(three.entries, 256u);
  EXPECT_EQ(three.facet_checks, 1536u);
  EXPECT_EQ(three.vertex_links, 1536u); // 12 edges, crossed by half of the labellings
  EXPECT_EQ(three.orientation_checks, 3u * 836u);
  EXPECT_GT(three.interior_faces, 0u);
  EXPECT_GT(three.face_pairs, 0u);
}

// All of them: hyperiso table 4 --verify.
TEST(VerifyTable, sampled_4d_entries) {
  TableVerification counts;
  EntryVerifier<4> verifier;
  std::mt19937 random(3);
  std::uniform_int_distribution<CubeLabels> any(0, 0xffff);
  for (int i = 0; i < 1000; ++i) {
    const CubeLabels labels = any(random);
    verifier.verify(labels, hull_table<4>().simplices(labels), counts);
  }
  EXPECT_EQ(failures(counts), 0u);
  EXPECT_EQ(counts.facet_checks, 8000u);
  EXPECT_GT(counts.face_pairs, 3000000u);
}

TEST(VerifyTable, notices_a_missing_simplex) {
  for (const CubeLabels labels : {0x2184u, 0x0001u, 0x6996u}) {
    auto simplices = entry<4>(labels);
    simplices.resize(simplices.size() - 4);
    EXPECT_GT(verified<4>(labels, simplices).facet_mismatches, 0u) << labels;
  }
  auto simplices = entry<4>(0x2184);
  simplices.resize(simplices.size() - 4);
  EXPECT_GT(verified<4>(0x2184, simplices).manifold_failures, 0u);
  EXPECT_EQ(verified<3>(0x01, {}).edge_use_failures, 1u);
}

TEST(VerifyTable, notices_a_simplex_turned_round) {
  auto simplices = entry<4>(0x2184);
  std::swap(simplices[0], simplices[1]);
  const TableVerification counts = verified<4>(0x2184, simplices);
  EXPECT_EQ(counts.orientation_failures, 4u);
  EXPECT_GT(counts.manifold_failures, 0u);
}

TEST(VerifyTable, notices_a_surface_turned_round) {
  auto simplices = entry<3>(0x0f); // a square: its diagonal is still traversed both ways
  for (std::size_t i = 0; i < simplices.size(); i += 3) std::swap(simplices[i], simplices[i + 1]);
  const TableVerification counts = verified<3>(0x0f, simplices);
  EXPECT_EQ(counts.manifold_failures, 0u);
  EXPECT_EQ(counts.facet_mismatches, 4u);
  EXPECT_EQ(counts.orientation_failures, 6u);
}

// Vertices 1 and 2 of the square are +: pairing the edges wrongly joins opposite sides and crosses.
TEST(VerifyTable, notices_simplices_that_cross) {
  const auto right = entry<2>(0b0110);
  ASSERT_EQ(right.size(), 4u);
  EXPECT_EQ(verified<2>(0b0110, right).face_intersections, 0u);
  // Edges 0 and 1 run along axis 0, 2 and 3 along axis 1; 0 and 1 are opposite, and 2 and 3.
  EXPECT_GT(verified<2>(0b0110, {0, 1, 2, 3}).face_intersections, 0u);
}

TEST(VerifyTable, notices_a_pinched_vertex) {
  // Two triangles of the 3-cube that share one vertex only.
  EXPECT_GT(verified<3>(0x01, {0, 4, 8, 0, 5, 9}).vertex_link_failures, 0u);
}

// The hyperplanes spanned by cube vertices against all functionals of a wider family.
TEST(VertexHulls, no_other_hyperplane_separates_sets_that_spanned_ones_do_not) {
  const VertexHulls<3> hulls;
  std::vector<std::array<int, 8>> functionals;
  for (int a = -2; a <= 2; ++a)
    for (int b = -2; b <= 2; ++b)
      for (int c = -2; c <= 2; ++c)
        for (int offset = -6; offset <= 6; ++offset) {
          auto& values = functionals.emplace_back();
          for (int v = 0; v < 8; ++v)
            values[static_cast<std::size_t>(v)] = a * (v & 1) + b * (v >> 1 & 1) + c * (v >> 2) - offset;
        }
  for (CubeLabels a = 1; a < 256; ++a)
    for (CubeLabels b = a; b < 256; b += 3) {
      const bool separated = std::any_of(functionals.begin(), functionals.end(), [&](const auto& values) {
        return separates_properly(values, a, b);
      });
      ASSERT_EQ(VertexHulls<3>::meet(hulls.sides(a), hulls.sides(b)), !separated) << a << " " << b;
    }
}

TEST(VertexHulls, touching_boundaries_are_not_a_meeting) {
  const VertexHulls<2> hulls;
  const auto meet = [&](CubeLabels a, CubeLabels b) {
    return VertexHulls<2>::meet(hulls.sides(a), hulls.sides(b));
  };
  EXPECT_TRUE(meet(0b1001, 0b0110));  // the diagonals
  EXPECT_TRUE(meet(0b0001, 0b0001));  // a point and itself
  EXPECT_TRUE(meet(0b1001, 0b1111));  // a diagonal within the square
  EXPECT_FALSE(meet(0b0011, 0b1111)); // a side bounds it
  EXPECT_FALSE(meet(0b0001, 0b0011)); // a vertex ends its side
  EXPECT_FALSE(meet(0b0011, 0b1100)); // opposite sides
  EXPECT_FALSE(meet(0b0111, 0b1110)); // two triangles share a side only
  EXPECT_TRUE(meet(0b0111, 0b1011));  // two triangles overlap
}
