// Measures against shapes whose answer is known, and against damage that they must notice.

#include "hyperiso/measure.hpp"

#include <cmath>
#include <gtest/gtest.h>
#include <random>

using namespace hyperiso;

namespace {

Mesh make_mesh(int D, int K, const std::vector<double>& positions,
               const std::vector<std::uint64_t>& simplices, bool wide = false) {
  Mesh mesh(D, K);
  mesh.positions.reset(positions.size(), true);
  for (std::size_t i = 0; i < positions.size(); ++i) mesh.positions.set(i, positions[i]);
  mesh.simplices.reset(simplices.size(), wide);
  for (std::size_t i = 0; i < simplices.size(); ++i) mesh.simplices.set(i, simplices[i]);
  return mesh;
}

// The boundary of the standard D-simplex (corners 0, e1, ..., eD), oriented outward.
Mesh simplex_boundary(int D) {
  std::vector<double> positions(static_cast<std::size_t>(D), 0.0);
  for (int corner = 0; corner < D; ++corner)
    for (int k = 0; k < D; ++k) positions.push_back(corner == k);
  std::vector<std::uint64_t> simplices;
  for (int left_out = 0; left_out <= D; ++left_out) {
    std::vector<std::uint64_t> facet;
    for (int corner = 0; corner <= D; ++corner)
      if (corner != left_out) facet.push_back(static_cast<std::uint64_t>(corner));
    if (left_out % 2 == 1) std::swap(facet[0], facet[1]);
    simplices.insert(simplices.end(), facet.begin(), facet.end());
  }
  return make_mesh(D, D - 1, positions, simplices);
}

double factorial(int n) { return n <= 1 ? 1 : n * factorial(n - 1); }

} // namespace

TEST(Measure, boundary_of_a_simplex_in_every_dimension) {
  for (int D = 2; D <= 8; ++D) {
    const auto found = measure(simplex_boundary(D));
    ASSERT_TRUE(found);
    EXPECT_EQ(found->components, 1u);
    EXPECT_EQ(found->euler_characteristic, D % 2 == 1 ? 2 : 0) << D; // the sphere S^(D-1)
    EXPECT_EQ(found->boundary_facets, 0u);
    EXPECT_EQ(found->bad_facets, 0u) << D;
    EXPECT_TRUE(found->closed);
    EXPECT_EQ(found->zero_content_simplices, 0u);
    const double corner_facets = D / factorial(D - 1), far_facet = std::sqrt(D) / factorial(D - 1);
    EXPECT_NEAR(found->content, corner_facets + far_facet, 1e-12);
    for (const double component : found->vector_area) EXPECT_NEAR(component, 0, 1e-12);
  }
}

TEST(Measure, normals_point_outward_from_an_outward_boundary) {
  for (int D = 2; D <= 8;
       ++D) { // all facets but the far one: their area vectors point along the negative axes
    Mesh mesh = simplex_boundary(D);
    const auto corners = static_cast<std::size_t>(D);
    IndexArray without_first;
    without_first.reset(mesh.simplices.size() - corners, false);
    for (std::size_t i = corners; i < mesh.simplices.size(); ++i)
      without_first.set(i - corners, mesh.simplices[i]);
    mesh.simplices = without_first;
    const auto found = measure(mesh);
    ASSERT_TRUE(found);
    EXPECT_EQ(found->boundary_facets, corners);
    EXPECT_FALSE(found->closed);
    for (const double component : found->vector_area) EXPECT_NEAR(component, -1 / factorial(D - 1), 1e-12);
  }
}

TEST(Measure, a_turned_simplex_is_noticed) {
  for (int D = 2; D <= 8; ++D) {
    Mesh mesh = simplex_boundary(D);
    const auto first = mesh.simplices[0];
    mesh.simplices.set(0, mesh.simplices[1]);
    mesh.simplices.set(1, first);
    EXPECT_EQ(measure(mesh)->bad_facets, static_cast<std::uint64_t>(D)) << D;
  }
}

TEST(Measure, a_third_simplex_on_a_facet_is_noticed) {
  const Mesh fan =
      make_mesh(3, 2, {0, 0, 0, 0, 0, 1, 1, 0, 0, 0, 1, 0, -1, -1, 0}, {0, 1, 2, 1, 0, 3, 0, 1, 4});
  EXPECT_EQ(measure(fan)->bad_facets, 1u);
  EXPECT_EQ(measure(fan)->boundary_facets, 6u);
}

TEST(Measure, zero_content_and_wide_indices) {
  const Mesh mesh = make_mesh(3, 2, {0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 0}, {0, 1, 2, 0, 2, 3}, true);
  EXPECT_EQ(measure(mesh)->zero_content_simplices, 1u);
  EXPECT_EQ(measure(mesh)->content, 0.5);
}

TEST(Measure, volumes_count_inverted_simplices) {
  const Mesh mesh = make_mesh(2, 2, {0, 0, 1, 0, 0, 1, 1, 1}, {0, 1, 2, 1, 2, 3});
  const auto found = measure(mesh);
  EXPECT_EQ(found->content, 1);
  EXPECT_EQ(found->inverted_simplices, 1u);
  EXPECT_EQ(found->bad_facets, 1u);
  EXPECT_TRUE(found->vector_area.empty());
}

// A simplex of an interval volume beside samples that equal the level: flat, but for the rounding of its
// corners, and a much smaller one that is turned indeed.
TEST(Measure, flat_simplices_are_not_inverted) {
  const double x = 0.9791666739999999, y = 0.52083333700000001, z = 0.0625;
  Mesh flat = make_mesh(3, 3,
                        {x, y, z, 0.93750000699999991, y, 0.020833333000000055, x, 0.562500004, z,
                         0.97916666569810318, 0.56249999569810327, 0.062499991698103316},
                        {0, 1, 2, 3});
  for (int turn = 0; turn < 2; ++turn) {
    EXPECT_EQ(measure(flat)->inverted_simplices, 0u);
    flat.simplices.set(0, 1);
    flat.simplices.set(1, 0);
  }
  const double s = 1e-12;
  EXPECT_EQ(measure(make_mesh(3, 3, {0, 0, 0, 0, s, 0, s, 0, 0, 0, 0, s}, {0, 1, 2, 3}))->inverted_simplices,
            1u);
}

TEST(Measure, contents_alone_are_those_of_the_whole) {
  for (const Mesh& mesh : {simplex_boundary(4), make_mesh(2, 2, {0, 0, 1, 0, 0, 1, 1, 1}, {0, 1, 2, 1, 2, 3}),
                           make_mesh(2, 1, {0, 0, 1, 1}, {0, 1, 1, 1})}) {
    const auto whole = measure(mesh);
    const auto alone = measure_contents(mesh);
    ASSERT_TRUE(whole && alone);
    EXPECT_EQ(alone->content, whole->content);
    EXPECT_EQ(alone->vector_area, whole->vector_area);
    EXPECT_EQ(alone->inverted_simplices, whole->inverted_simplices);
    EXPECT_EQ(alone->zero_content_simplices, whole->zero_content_simplices);
  }
  EXPECT_EQ(measure_contents(make_mesh(2, 1, {0, 0, 1, 1}, {0, 2})).error().code, Code::invalid_argument);
}

// Enough simplices for several blocks, the last of which is not full.
TEST(Measure, sums_do_not_depend_on_the_threads) {
  constexpr std::size_t count = 50'001, vertices = 100;
  for (const int corners : {3, 4}) {
    std::mt19937 random(1);
    std::uniform_real_distribution<double> coordinate(-1, 1);
    std::uniform_int_distribution<std::uint64_t> vertex(0, vertices - 1);
    Mesh mesh(3, corners - 1);
    mesh.positions.reset(3 * vertices, true);
    for (std::size_t k = 0; k < 3 * vertices; ++k) mesh.positions.set(k, coordinate(random));
    mesh.simplices.reset(count * static_cast<std::size_t>(corners), false);
    for (std::size_t k = 0; k < mesh.simplices.size(); ++k) mesh.simplices.set(k, vertex(random));
    const auto one = measure_contents(mesh, 1);
    double expected = 0; // one after the other
    for (std::size_t first = 0; first < mesh.simplices.size(); first += static_cast<std::size_t>(corners)) {
      Mesh alone(3, corners - 1);
      alone.positions = mesh.positions;
      alone.simplices.reset(static_cast<std::size_t>(corners), false);
      for (std::size_t k = 0; k < alone.simplices.size(); ++k)
        alone.simplices.set(k, mesh.simplices[first + k]);
      expected += measure_contents(alone)->content;
    }
    EXPECT_NEAR(one->content, expected, 1e-9 * expected);
    for (const int threads : {0, 2, 3, 7}) {
      const auto many = measure_contents(mesh, threads);
      EXPECT_EQ(many->content, one->content);
      EXPECT_EQ(many->vector_area, one->vector_area);
      EXPECT_EQ(many->inverted_simplices, one->inverted_simplices);
      EXPECT_EQ(many->zero_content_simplices, one->zero_content_simplices);
    }
    EXPECT_GT(one->zero_content_simplices, 0u); // corners that coincide
  }
}

TEST(Measure, empty_mesh_and_bad_index) {
  const auto found = measure(Mesh(4, 3));
  ASSERT_TRUE(found);
  EXPECT_EQ(found->components, 0u);
  EXPECT_TRUE(found->closed);
  const auto broken = measure(make_mesh(2, 1, {0, 0, 1, 1}, {0, 2}));
  ASSERT_FALSE(broken);
  EXPECT_EQ(broken.error().code, Code::invalid_argument);
}

TEST(Transform, a_reflection_keeps_normals_pointing_outward) {
  Mesh mesh = simplex_boundary(3);
  transform(mesh, Affine{{-2, 0, 0, 0, 1, 0, 0, 0, 1}, {5, 0, 0}});
  const auto found = measure(mesh);
  EXPECT_EQ(found->bad_facets, 0u);
  double volume = 0; // positive if outward
  for (std::size_t s = 0; s < 12; s += 3) {
    const auto p = [&](std::size_t corner, std::size_t k) {
      return mesh.positions[mesh.simplices[s + corner] * 3 + k];
    };
    volume += p(0, 0) * (p(1, 1) * p(2, 2) - p(1, 2) * p(2, 1)) -
              p(0, 1) * (p(1, 0) * p(2, 2) - p(1, 2) * p(2, 0)) +
              p(0, 2) * (p(1, 0) * p(2, 1) - p(1, 1) * p(2, 0));
  }
  EXPECT_NEAR(volume / 6, 2.0 / 6, 1e-12);
}

// Normals turn by the inverse transpose: they stay perpendicular to a triangle whatever the map does to it.
TEST(Transform, normals_stay_normal) {
  Mesh mesh = make_mesh(3, 2, {0, 0, 0, 1, 0, 0, 0, 1, 0}, {0, 1, 2});
  mesh.attributes.push_back(
      {normal_attribute, Attribute::Location::vertex, 3, std::vector<double>{0, 0, 1, 0, 0, 1, 0, 0, 1}});
  mesh.attributes.push_back({"speed", Attribute::Location::vertex, 1, std::vector<float>{1, 2, 3}});
  transform(mesh, Affine{{2, 0, 1, 0.5, -3, 0, 1, 1, -1}, {5, 6, 7}}); // reflects, shears and stretches
  const auto& normals = std::get<std::vector<double>>(mesh.attributes[0].values);
  const auto area = measure(mesh)->vector_area;
  const double length = std::hypot(area[0], area[1], area[2]);
  for (std::size_t vertex = 0; vertex < 3; ++vertex)
    for (std::size_t k = 0; k < 3; ++k) EXPECT_NEAR(normals[vertex * 3 + k], area[k] / length, 1e-12);
  EXPECT_EQ(std::get<std::vector<float>>(mesh.attributes[1].values)[2], 3);
}
