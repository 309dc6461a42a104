#include "table/midpoint_cut.hpp"

#include <gtest/gtest.h>
#include <map>
#include <vector>

using namespace hyperiso;

namespace {

using Chain = std::map<std::vector<unsigned>, int>; // sorted simplices and how often they occur, with sign

void add(Chain& chain, std::vector<unsigned> simplex, int coefficient) {
  for (std::size_t i = 1; i < simplex.size(); ++i)
    for (std::size_t j = i; j > 0 && simplex[j] < simplex[j - 1]; --j) {
      std::swap(simplex[j], simplex[j - 1]);
      coefficient = -coefficient;
    }
  if ((chain[simplex] += coefficient) == 0) chain.erase(simplex);
}

// A corner of the facet opposite `left_out`, or a set of them, as corners of the whole.
unsigned in_whole(unsigned set, unsigned left_out) {
  const unsigned low = set & ((1u << left_out) - 1);
  return low | (set ^ low) << 1;
}

template <int K>
void expect_boundary_is_the_facets_cuts() {
  for (unsigned positive = 0; positive < 1u << (K + 1); ++positive) {
    Chain boundary, facets;
    for (const auto& simplex : midpoint_cut<K>().simplices(positive))
      for (unsigned i = 0; i < K; ++i) {
        std::vector<unsigned> face(simplex.begin(), simplex.end());
        face.erase(face.begin() + i);
        add(boundary, face, i % 2 == 0 ? 1 : -1);
      }
    for (unsigned left_out = 0; left_out <= K; ++left_out) {
      const unsigned low = positive & ((1u << left_out) - 1);
      for (const auto& simplex :
           midpoint_cut<K - 1>().simplices(low | (positive >> (left_out + 1)) << left_out)) {
        std::vector<unsigned> face;
        for (const unsigned vertex : simplex) face.push_back(in_whole(vertex, left_out));
        add(facets, face, left_out % 2 == 0 ? -1 : 1);
      }
    }
    EXPECT_EQ(boundary, facets) << "K = " << K << ", + corners " << positive;
  }
}

} // namespace

// Simplices that share a facet agree on it, in opposite orientation.
TEST(MidpointCut, boundary_is_the_cuts_of_the_facets) {
  expect_boundary_is_the_facets_cuts<3>();
  expect_boundary_is_the_facets_cuts<4>();
  expect_boundary_is_the_facets_cuts<5>();
}

TEST(MidpointCut, sizes) {
  EXPECT_EQ(midpoint_cut<2>().simplices(0b010).size(), 1u);
  EXPECT_EQ(midpoint_cut<3>().simplices(0b0100).size(), 1u);
  EXPECT_EQ(midpoint_cut<3>().simplices(0b0110).size(), 4u);
  EXPECT_EQ(midpoint_cut<4>().simplices(0b11110).size(), 1u);
  EXPECT_EQ(midpoint_cut<4>().simplices(0b10100).size(), 14u);
  EXPECT_EQ(midpoint_cut<5>().simplices(0).size(), 0u);
}
