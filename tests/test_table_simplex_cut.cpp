#include "core/determinant.hpp"
#include "table/simplex_cut.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <gtest/gtest.h>
#include <map>
#include <random>
#include <string>
#include <utility>
#include <vector>

using namespace hyperiso;

namespace {

using Edge = std::pair<int, int>;               // corners of the uncut simplex, ascending
using Chain = std::map<std::vector<Edge>, int>; // sorted simplices and how often they occur, with sign

// Adds `coefficient` times an oriented simplex.
void add(Chain& chain, std::vector<Edge> simplex, int coefficient) {
  for (std::size_t i = 0; i < simplex.size(); ++i)
    for (std::size_t j = i + 1; j < simplex.size(); ++j)
      if (simplex[j] < simplex[i]) coefficient = -coefficient;
  std::sort(simplex.begin(), simplex.end());
  if ((chain[simplex] += coefficient) == 0) chain.erase(simplex);
}

Chain boundary(const Chain& chain) {
  Chain result;
  for (const auto& [simplex, coefficient] : chain)
    for (std::size_t i = 0; i < simplex.size(); ++i) {
      std::vector<Edge> face = simplex;
      face.erase(face.begin() + static_cast<std::ptrdiff_t>(i));
      add(result, face, i % 2 == 0 ? coefficient : -coefficient);
    }
  return result;
}

// The cut of the simplex with these corners (ascending numbers of a larger one), as a chain.
template <int K>
void add_cut(Chain& chain, const std::vector<int>& corners, unsigned positive, int coefficient) {
  unsigned pattern = 0;
  for (std::size_t i = 0; i < corners.size(); ++i) pattern |= (positive >> corners[i] & 1) << i;
  if constexpr (K == 1) { // a point; det[n] > 0 iff the edge runs from + to -
    if (pattern == 1 || pattern == 2)
      add(chain, {{corners[0], corners[1]}}, pattern == 1 ? coefficient : -coefficient);
  } else {
    for (const auto& simplex : simplex_cut<K>().simplices(pattern)) {
      std::vector<Edge> edges;
      for (const CornerPair pair : simplex) edges.emplace_back(corners[pair.lower], corners[pair.upper]);
      add(chain, edges, coefficient);
    }
  }
}

template <int K>
std::vector<int> corners_without(int left_out) {
  std::vector<int> corners;
  for (int i = 0; i <= K; ++i)
    if (i != left_out) corners.push_back(i);
  return corners;
}

template <class K>
class SimplexCutOf : public testing::Test {};
template <int K>
using Dimension = std::integral_constant<int, K>;
using Dimensions = testing::Types<Dimension<2>, Dimension<3>, Dimension<4>, Dimension<5>, Dimension<6>,
                                  Dimension<7>, Dimension<8>>;
struct DimensionName {
  template <class K>
  static std::string GetName(int) {
    return std::to_string(K::value);
  }
};
TYPED_TEST_SUITE(SimplexCutOf, Dimensions, DimensionName);

} // namespace

TYPED_TEST(SimplexCutOf, has_a_staircase_for_every_way_through_the_product) {
  constexpr int K = TypeParam::value;
  for (unsigned positive = 0; positive < SimplexCut<K>::patterns; ++positive) {
    const int a = std::popcount(positive) - 1, b = K - 1 - a;
    std::size_t binomial = a < 0 || b < 0 ? 0 : 1;
    for (int i = 1; i <= a && b >= 0; ++i)
      binomial = binomial * static_cast<std::size_t>(b + i) / static_cast<std::size_t>(i);
    EXPECT_EQ(simplex_cut<K>().simplices(positive).size(), binomial);
  }
}

// Inner faces cancel, so the cut is a surface; what is left is exactly the cut of every facet: two simplices
// that share a facet leave no gap there, and their orientations fit together.
TYPED_TEST(SimplexCutOf, boundary_is_the_cut_of_every_facet_with_the_induced_orientation) {
  constexpr int K = TypeParam::value;
  for (unsigned positive = 0; positive < SimplexCut<K>::patterns; ++positive) {
    Chain cut, cuts_of_facets;
    add_cut<K>(cut, corners_without<K>(-1), positive, 1);
    for (int i = 0; i <= K; ++i)
      add_cut<K - 1>(cuts_of_facets, corners_without<K>(i), positive, i % 2 == 0 ? -1 : 1);
    ASSERT_EQ(boundary(cut), cuts_of_facets) << "pattern " << positive;
  }
}

// The points are where a linear function with random values of the right signs is zero, on random simplices.
TYPED_TEST(SimplexCutOf, normals_point_from_positive_to_negative_corners_of_positively_oriented_simplices) {
  constexpr std::size_t K = TypeParam::value;
  using Point = std::array<double, K>;
  std::mt19937 random(7);
  std::uniform_real_distribution<double> uniform(0.1, 1);
  const auto append_difference = [](std::vector<double>& rows, const Point& end, const Point& start) {
    for (std::size_t k = 0; k < K; ++k) rows.push_back(end[k] - start[k]);
  };
  for (unsigned positive = 1; positive + 1 < SimplexCut<K>::patterns; ++positive) {
    std::array<Point, K + 1> corners;
    std::array<double, K + 1> values;
    std::vector<double> sides;
    for (std::size_t i = 0; i <= K; ++i) {
      for (double& coordinate : corners[i]) coordinate = uniform(random);
      values[i] = (positive >> i & 1 ? 1 : -1) * uniform(random);
      if (i > 0) append_difference(sides, corners[i], corners[0]);
    }
    const Point& a_positive = corners[static_cast<std::size_t>(std::countr_one(~positive))];
    const Point& a_negative = corners[static_cast<std::size_t>(std::countr_one(positive))];
    for (const auto& simplex : simplex_cut<K>().simplices(positive)) {
      std::array<Point, K> points;
      std::vector<double> rows;
      append_difference(rows, a_negative, a_positive);
      for (std::size_t i = 0; i < K; ++i) {
        const auto [lower, upper] = simplex[i];
        const double t = values[lower] / (values[lower] - values[upper]);
        for (std::size_t k = 0; k < K; ++k)
          points[i][k] = (1 - t) * corners[lower][k] + t * corners[upper][k];
        if (i > 0) append_difference(rows, points[i], points[0]);
      }
      ASSERT_EQ(determinant(rows, K) > 0, determinant(sides, K) > 0) << "pattern " << positive;
    }
  }
}
