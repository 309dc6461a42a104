// Slices by an index are plain slices.

#include "hyperiso/interval.hpp"
#include "slice_fields.hpp"

using namespace hyperiso;
using namespace hyperiso::check;

// An index leaves out what the plane does not meet and nothing else, on every kind of plane.
TEST(SliceIndex, gives_what_a_plain_slice_gives) {
  Grid<4> grid = unit_grid<4>({7, 6, 8, 5});
  for (Axis& axis : grid.axes) axis.origin = 0.1, axis.spacing = 0.3; // not representable: stored rounded
  std::mt19937 random(3);
  const auto field =
      make_field<float, 4>(grid, [&](const auto&) { return static_cast<double>(random() % 100); });
  for (const Precision precision : {Precision::f32, Precision::f64}) {
    const auto surface = extracted(field, 50, {.precision = precision});
    const SliceIndex<4> index(surface);
    std::vector<Hyperplane<4>> planes{{{1, 2, 3, 4}, 8}, {{1, -1, 0.5, -0.25}, 0.1}, {{0, 0, 0, 1}, 99}};
    for (int axis = 0; axis < 4; ++axis)
      for (const double place : {0., 1., 1.3, 2., 3.9999999999, 4.}) {
        const double step = std::floor(place);
        const double low = grid.axes[axis].coordinate(static_cast<std::int64_t>(step));
        planes.push_back(Hyperplane<4>::at(axis, low + (place - step) * 0.3));
      }
    for (const auto& plane : planes) {
      const auto expected = sliced(surface, plane);
      const auto cut = index.slice(surface, plane);
      ASSERT_TRUE(cut);
      expect_same_mesh(*cut, expected);
      EXPECT_EQ(measure(*cut)->bad_facets, 0u);
    }
  }
}

// The same for what is not a surface in space and time: volumes, surfaces in space, soups, attributes, chunks
// of all sizes.
TEST(SliceIndex, volumes_soups_and_attributes) {
  const auto check = [](auto mesh, const auto& planes) {
    std::vector<double> heights;
    const auto D = static_cast<std::size_t>(mesh.dimension);
    for (std::size_t vertex = 0; vertex < mesh.vertex_count(); ++vertex)
      heights.push_back(mesh.positions[vertex * D] - 3 * mesh.positions[vertex * D + 1]);
    std::vector<std::int32_t> numbers(mesh.simplex_count());
    std::iota(numbers.begin(), numbers.end(), 0);
    mesh.attributes = {{"height", Attribute::Location::vertex, 1, heights},
                       {"number", Attribute::Location::simplex, 1, numbers}};
    const SliceIndex index(mesh);
    auto reused = *index.slice(mesh, planes.back());
    for (const auto& plane : planes)
      for (const bool welded : {true, false}) {
        const SliceOptions options{.precision = Precision::f64, .welded = welded};
        const auto expected = slice(mesh, plane, options);
        ASSERT_TRUE(expected);
        ASSERT_TRUE(index.slice_into(mesh, plane, options, reused));
        EXPECT_GT(reused.simplex_count(), 0u);
        EXPECT_TRUE(simplex_set(reused) == simplex_set(*expected));
        EXPECT_EQ(measure(reused)->bad_facets, 0u);
        if (!welded) continue; // the numbers of vertices differ
        EXPECT_TRUE(vertex_set(reused) == vertex_set(*expected));
        for (std::size_t number = 0; number < 2; ++number)
          std::visit(
              [&]<class Values>(Values values) {
                auto others = std::get<Values>(expected->attributes[number].values);
                std::ranges::sort(values);
                std::ranges::sort(others);
                EXPECT_TRUE(values == others);
              },
              reused.attributes[number].values);
      }
  };
  const auto in_space = random_field<float, 3>({9, 8, 9}, 1000, 4);
  const auto in_time = random_field<float, 4>({6, 6, 6, 5}, 1000, 4);
  check(extracted(in_space, 0),
        std::vector<Hyperplane<3>>{{{1, 2, -1}, 3.3}, {{0, 1, 0}, 2.5}, {{0, 0, 1}, 2.25}});
  check(extracted(in_time, 0), std::vector<Hyperplane<4>>{{{1, 2, -1, 1}, 3.3}, {{0, 0, 0, 1}, 2.5}});
  check(*interval(in_space.view, -300, 400),
        std::vector<Hyperplane<3>>{{{1, 2, -1}, 3.3}, {{0, 1, 0}, 2.5}, {{0, 0, 1}, 2.25}});
  const SimplexMesh<4> nothing;
  EXPECT_EQ(SliceIndex<4>(nothing).slice(nothing, Hyperplane<4>::at(3, 0))->simplex_count(), 0u);
}
