// Slices of volumes, and what meshes carry.

#include "hyperiso/interval.hpp"
#include "slice_fields.hpp"

using namespace hyperiso;
using namespace hyperiso::check;

// Attributes that are affine in the position stay so; those of simplices follow their simplex.
TEST(Slice, attributes_come_along) {
  auto surface = extracted(random_field<double, 3>({5, 6, 7}, 9, 6), 0.5, {.precision = Precision::f64});
  std::vector<double> affine;
  for (std::size_t vertex = 0; vertex < surface.vertex_count(); ++vertex)
    for (const double factor : {1., -3.})
      affine.push_back(factor * (surface.positions[vertex * 3] + 10 * surface.positions[vertex * 3 + 1]));
  std::vector<std::int32_t> number(surface.simplex_count());
  std::iota(number.begin(), number.end(), 0);
  surface.attributes = {{"affine", Attribute::Location::vertex, 2, affine},
                        {"number", Attribute::Location::simplex, 1, number}};
  for (const double z : {2.0, 2.4}) { // along samples and between
    const auto cut = sliced(surface, Hyperplane<3>::at(2, z), {.precision = Precision::f64});
    ASSERT_EQ(cut.attributes.size(), 2u);
    const auto& carried = std::get<std::vector<double>>(cut.attributes[0].values);
    ASSERT_EQ(carried.size(), 2 * cut.vertex_count());
    for (std::size_t vertex = 0; vertex < cut.vertex_count(); ++vertex)
      EXPECT_NEAR(carried[2 * vertex + 1],
                  -3 * (cut.positions[2 * vertex] + 10 * cut.positions[2 * vertex + 1]), 1e-12);
    const auto& sources = std::get<std::vector<std::int32_t>>(cut.attributes[1].values);
    ASSERT_EQ(sources.size(), cut.simplex_count());
    for (const auto source : sources) ASSERT_LT(static_cast<std::size_t>(source), surface.simplex_count());
  }
}

// A cube of six tetrahedra: its cut fills the square, every triangle turned the same way.
TEST(Slice, volumes_give_volumes) {
  VolumeMesh<3> cube;
  cube.positions.reset(24, true);
  for (unsigned vertex = 0; vertex < 8; ++vertex)
    for (unsigned k = 0; k < 3; ++k) cube.positions.set(vertex * 3 + k, vertex >> k & 1);
  const std::vector<std::uint64_t> corners{0, 1, 3, 7, 0, 3, 2, 7, 0, 2, 6, 7,
                                           0, 6, 4, 7, 0, 4, 5, 7, 0, 5, 1, 7};
  cube.simplices.reset(corners.size(), false);
  for (std::size_t i = 0; i < corners.size(); ++i) cube.simplices.set(i, corners[i]);
  ASSERT_EQ(measure(cube)->inverted_simplices, 0u);
  for (const auto& [plane, area] :
       std::vector<std::pair<Hyperplane<3>, double>>{{Hyperplane<3>::at(0, 0.5), 1},
                                                     {Hyperplane<3>::at(1, 0.25), 1},
                                                     {Hyperplane<3>{{0, 0, -2}, -0.5}, 1},
                                                     {Hyperplane<3>{{1, 1, 1}, 1.5}, 0.75 * std::sqrt(3)},
                                                     {Hyperplane<3>{{1, -1, 0}, 0}, std::sqrt(2)}}) {
    const auto found = measure(sliced(cube, plane, {.precision = Precision::f64}));
    EXPECT_NEAR(found->content, area, 1e-12);
    EXPECT_EQ(found->inverted_simplices, 0u);
    EXPECT_EQ(found->bad_facets, 0u);
    EXPECT_EQ(found->euler_characteristic, 1);
  }
}
