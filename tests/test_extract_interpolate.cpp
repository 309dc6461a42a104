// What the vertices of a surface carry: other fields, and normals.

#include "check.hpp"
#include "hyperiso/interpolate.hpp"
#include "hyperiso/step_source.hpp"

#include <cmath>
#include <limits>

using namespace hyperiso;
using namespace hyperiso::check;

namespace {

const std::vector<double>& doubles(const Attribute& attribute) {
  return std::get<std::vector<double>>(attribute.values);
}

} // namespace

// The field itself is the isovalue wherever its surface is, along diagonals too; the places are those of f64
// even where the positions are f32.
TEST(Interpolate, the_field_itself_is_the_isovalue) {
  const auto field = random_field<std::int16_t, 4>({4, 5, 4, 4}, 1000, 3);
  for (const Method method : {Method::hull, Method::component, Method::simplicial}) {
    const auto mesh = *extract(field.view, 0.5, {.method = method});
    const auto weights = vertex_weights(mesh, unowned_field(field.view), 0.5);
    ASSERT_TRUE(weights);
    const auto values = interpolate(mesh, *weights, unowned_field(field.view), "f");
    ASSERT_TRUE(values);
    for (const float value : std::get<std::vector<float>>(values->values)) EXPECT_NEAR(value, 0.5, 1e-6);
  }
}

// A surface of a crop finds its samples in the whole, and in another crop that holds them.
TEST(Interpolate, crops_are_parts_of_the_whole) {
  auto field = random_field<float, 3>({8, 7, 6}, 50, 4);
  field.view.grid.axes[1].coordinates = {0, 1, 3, 4, 6, 7, 9};
  const auto other = random_field<double, 3>({8, 7, 6}, 50, 5);
  const auto crop = [](const auto& view, std::int64_t by) {
    return view.cropped(0, 2 - by, 6 + by).cropped(1, 1, 5).cropped(2, 2 - by, 5);
  };
  const auto mesh = *extract(crop(field.view, 0), 0.5, {.precision = Precision::f64});
  ASSERT_GT(mesh.vertex_count(), 50u);
  const auto weights = *vertex_weights(mesh, unowned_field(field.view), 0.5);
  EXPECT_EQ(weights, *vertex_weights(mesh, unowned_field(crop(field.view, 0)), 0.5));
  const auto whole = doubles(*interpolate(mesh, weights, unowned_field(other.view), "g"));
  EXPECT_EQ(whole, doubles(*interpolate(mesh, weights, unowned_field(crop(other.view, 1)), "g")));
  EXPECT_FALSE(interpolate(mesh, weights, unowned_field(other.view.cropped(0, 3, 8)), "g"));
  // Normals need one sample more on each side.
  EXPECT_EQ(doubles(*normals(mesh, weights, unowned_field(field.view))).size(), mesh.vertex_count() * 3);
}

TEST(Interpolate, missing_and_infinite_values) {
  const auto field = make_field<double, 2>(unit_grid<2>({3, 2}), [](const auto& p) { return p[0]; });
  auto other = make_field<double, 2>(unit_grid<2>({3, 2}), [](const auto& p) { return p[1]; });
  other.samples[1] = std::nan("");
  other.samples[3] = std::numeric_limits<double>::infinity();
  const auto mesh = *extract(field.view, 1, {.precision = Precision::f64}); // at samples 1 and 4, to the bit
  const auto weights = *vertex_weights(mesh, unowned_field(field.view), 1);
  EXPECT_EQ(weights, (std::vector<double>{1, 1}));
  const auto values = doubles(*interpolate(mesh, weights, unowned_field(other.view), "g"));
  EXPECT_TRUE(std::isnan(values[0]));
  EXPECT_EQ(values[1], 1);
}

// Second order on uneven and falling axes: exact for a quadratic field away from the walls, and for a linear
// one everywhere, beside missing data too.
TEST(Normals, of_linear_and_quadratic_fields) {
  Grid<3> grid = unit_grid<3>({7, 6, 8});
  grid.axes[0].coordinates = {0, 1, 1.5, 3, 3.25, 5, 6};
  grid.axes[1].spacing = -0.5;
  auto linear = make_field<double, 3>(grid, [](const auto& p) { return 2 * p[0] - p[1] + 2 * p[2]; });
  linear.samples[60] = std::nan("");
  for (const Inside inside : {Inside::above, Inside::below}) {
    const auto mesh = *extract(linear.view, 9.3, {.inside = inside, .precision = Precision::f64});
    const auto weights = *vertex_weights(mesh, unowned_field(linear.view), 9.3);
    const auto found = normals(mesh, weights, unowned_field(linear.view), inside);
    const double sign = inside == Inside::above ? -1 : 1;
    for (std::size_t vertex = 0; vertex < mesh.vertex_count(); ++vertex) {
      EXPECT_NEAR(doubles(*found)[3 * vertex], sign * 2 / 3, 1e-12);
      EXPECT_NEAR(doubles(*found)[3 * vertex + 1], -sign / 3, 1e-12);
      EXPECT_NEAR(doubles(*found)[3 * vertex + 2], sign * 2 / 3, 1e-12);
    }
  }
  const auto quadratic = make_field<double, 3>(grid, [](const auto& p) { return p[0] * p[0] + 3 * p[2]; });
  const auto mesh = *extract(quadratic.view, 14, {.precision = Precision::f64});
  const auto found = doubles(*normals(mesh, *vertex_weights(mesh, unowned_field(quadratic.view), 14),
                                      unowned_field(quadratic.view)));
  for (std::size_t vertex = 0; vertex < mesh.vertex_count(); ++vertex) {
    const double x = mesh.positions[3 * vertex];
    if (x < 1 || x > 5) continue;
    const double length = std::hypot(2 * x, 3);
    EXPECT_NEAR(found[3 * vertex], -2 * x / length, 0.05);
    EXPECT_NEAR(found[3 * vertex + 1], 0, 1e-12);
    EXPECT_NEAR(found[3 * vertex + 2], -3 / length, 0.05);
  }
}

TEST(PointData, what_does_not_fit) {
  const auto field = random_field<float, 3>({4, 4, 4}, 9, 3), small = random_field<float, 3>({4, 4, 3}, 9, 3);
  auto mesh = *extract(field.view, 0.5);
  const auto refused = [&](const std::vector<NamedField>& others, bool with_normals) {
    auto copy = mesh;
    const Status added =
        add_point_data(copy, unowned_field(field.view), 0.5, Inside::above, others, with_normals);
    return !added && added.error().code == Code::invalid_argument;
  };
  const NamedField same{"g", unowned_field(field.view)};
  EXPECT_FALSE(refused({same}, true));
  EXPECT_TRUE(refused({same, same}, false));                           // one name for two
  EXPECT_TRUE(refused({{"normal", unowned_field(field.view)}}, true)); // another one's name
  EXPECT_TRUE(refused({{"h", unowned_field(small.view)}}, false));     // another grid
  mesh.edges.clear();
  EXPECT_TRUE(refused({same}, false)); // no grid edges
}
