// Simplices that pass through each other are found, and only these, to the last bit.
#include "hyperiso/extract.hpp"
#include "hyperiso/self_intersections.hpp"

#include "check.hpp"

#include <cmath>
#include <gtest/gtest.h>
#include <initializer_list>
#include <limits>
#include <vector>

using namespace hyperiso;

namespace {

Mesh make_mesh(int dimension, int simplex_dimension, const std::vector<double>& positions,
               const std::vector<std::uint64_t>& simplices) {
  Mesh mesh(dimension, simplex_dimension);
  mesh.positions.reset(positions.size(), true);
  for (std::size_t i = 0; i < positions.size(); ++i) mesh.positions.set(i, positions[i]);
  mesh.simplices.reset(simplices.size(), false);
  for (std::size_t i = 0; i < simplices.size(); ++i) mesh.simplices.set(i, simplices[i]);
  return mesh;
}

std::uint64_t pairs(const Mesh& mesh) {
  const auto found = find_self_intersections(mesh);
  EXPECT_TRUE(found) << found.error().message;
  return found->pairs;
}

} // namespace

TEST(SelfIntersections, segments) {
  const auto count = [](std::initializer_list<double> c,
                        std::vector<std::uint64_t> simplices = {0, 1, 2, 3}) {
    return pairs(make_mesh(2, 1, c, simplices));
  };
  EXPECT_EQ(count({0, 0, 2, 2, 0, 2, 2, 0}), 1u) << "crossing";
  EXPECT_EQ(count({0, 0, 2, 2, 1, 1, 2, 0}), 0u) << "an end touches the other segment";
  EXPECT_EQ(count({0, 0, 2, 2, 2, 2, 3, 5}), 0u) << "ends touch";
  EXPECT_EQ(count({0, 0, 2, 2, 1, 1, 3, 3}), 1u) << "overlapping on one line";
  EXPECT_EQ(count({0, 0, 1, 1, 1, 1, 3, 3}), 0u) << "one behind the other on one line";
  EXPECT_EQ(count({0, 0, 2, 2, 0, 0, 2, 2}), 1u) << "the same place";
  EXPECT_EQ(count({1, 1, 1, 1, 0, 0, 2, 2}), 0u) << "a segment of length 0";
  EXPECT_EQ(count({0, 0, 2, 0, 1, 0}, {0, 1, 0, 2}), 1u) << "folded onto each other at a common end";
  EXPECT_EQ(count({0, 0, 2, 0, -1, 0}, {0, 1, 0, 2}), 0u) << "straight on at a common end";
  EXPECT_EQ(count({0, 0, 2, 0, 1, 1e-300}, {0, 1, 0, 2}), 0u) << "hardly apart at a common end";
}

TEST(SelfIntersections, triangles) {
  const std::vector<double> flat = {0, 0, 0, 4, 0, 0, 0, 4, 0};
  const auto with = [&](std::vector<double> more, std::vector<std::uint64_t> second) {
    std::vector<double> positions = flat;
    positions.insert(positions.end(), more.begin(), more.end());
    std::vector<std::uint64_t> simplices = {0, 1, 2};
    simplices.insert(simplices.end(), second.begin(), second.end());
    return pairs(make_mesh(3, 2, positions, simplices));
  };
  EXPECT_EQ(with({1, 1, -1, 1, 1, 1, 9, 9, 0}, {3, 4, 5}), 1u) << "an edge pierces";
  EXPECT_EQ(with({1, 1, 0, 1, 1, 1, 9, 9, 1}, {3, 4, 5}), 0u) << "a corner touches";
  EXPECT_EQ(with({1, 1, -1, 1, 1, 1}, {0, 3, 4}), 1u) << "pierced although they share a corner";
  EXPECT_EQ(with({-1, -1, -1, -1, -1, 1}, {0, 3, 4}), 0u) << "only the corner";
  EXPECT_EQ(with({4, 4, 0}, {1, 2, 3}), 0u) << "neighbours in a plane";
  EXPECT_EQ(with({1, 1, 0}, {1, 2, 3}), 1u) << "folded onto each other at a common edge";
  EXPECT_EQ(with({1, 1, 1e-30}, {1, 2, 3}), 0u) << "folded, but for the last bit";
}

TEST(SelfIntersections, tetrahedra_that_overlap) {
  const std::vector<double> corner = {0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1};
  const auto with = [&](std::vector<double> more, std::vector<std::uint64_t> second) {
    std::vector<double> positions = corner;
    positions.insert(positions.end(), more.begin(), more.end());
    std::vector<std::uint64_t> simplices = {0, 1, 2, 3};
    simplices.insert(simplices.end(), second.begin(), second.end());
    return pairs(make_mesh(3, 3, positions, simplices));
  };
  EXPECT_EQ(with({1, 1, 1}, {1, 2, 3, 4}), 0u) << "on both sides of a triangle";
  EXPECT_EQ(with({0.1, 0.1, 0.1}, {1, 2, 3, 4}), 1u) << "on the same side";
  EXPECT_EQ(with({0.2, 0.2, 0.2, 2, 0, 2, 0, 2, 2, 2, 2, 0}, {4, 5, 6, 7}), 1u) << "a corner inside";
}

// An orientation that doubles get wrong: three points on one line through 0.1 and 0.3, by one unit or not.
TEST(SelfIntersections, the_last_bit_decides) {
  const double x = 0.1, y = 0.3, up = std::nextafter(0.3, 1), down = std::nextafter(0.3, 0);
  for (const double end : {up, y, down}) {
    // A segment along the line of slope 3, and one from a point of it, or beside it, back over it.
    const auto mesh = make_mesh(2, 1, {0, 0, 2 * x, 2 * y, x, end, 1, 0}, {0, 1, 2, 3});
    EXPECT_EQ(pairs(mesh), end > y ? 1u : 0u);
  }
}

TEST(SelfIntersections, reports_the_first_pairs_and_bad_input) {
  std::vector<double> positions;
  std::vector<std::uint64_t> simplices;
  for (int i = 0; i < 10; ++i) { // a star: all cross in the middle
    const double angle = 0.3 * i;
    for (const double r : {-1.0, 1.0}) {
      positions.push_back(r * std::cos(angle));
      positions.push_back(r * std::sin(angle));
      simplices.push_back(simplices.size());
    }
  }
  const auto found = find_self_intersections(make_mesh(2, 1, positions, simplices));
  ASSERT_TRUE(found);
  EXPECT_EQ(found->pairs, 45u);
  ASSERT_EQ(found->examples.size(), SelfIntersections::kept);
  EXPECT_EQ(found->examples[0], (std::array<std::uint64_t, 2>{0, 1}));
  EXPECT_EQ(found->examples[9], (std::array<std::uint64_t, 2>{1, 2}));

  EXPECT_EQ(pairs(make_mesh(3, 2, {}, {})), 0u);
  positions[3] = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(find_self_intersections(make_mesh(2, 1, positions, simplices)).error().code,
            Code::invalid_argument);
  EXPECT_EQ(find_self_intersections(make_mesh(2, 1, {0, 0}, {0, 1})).error().code, Code::invalid_argument);
  EXPECT_EQ(find_self_intersections(make_mesh(3, 1, {0, 0, 0}, {0, 0})).error().code, Code::invalid_argument);
}
