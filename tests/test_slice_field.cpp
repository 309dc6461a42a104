// Slices of a field that is read slab by slab are those of its whole surface.

#include "hyperiso/interpolate.hpp"
#include "hyperiso/interval.hpp"
#include "slice_fields.hpp"

using namespace hyperiso;
using namespace hyperiso::check;

// A field that is read slab by slab must give what its whole mesh gives, to the bit: on planes in general
// position, through samples, along faces of cells, and where rounding decides.
TEST(FieldSlicer, any_plane_gives_what_the_whole_mesh_gives) {
  const std::vector<Hyperplane<4>> planes{
      {{0.3, -0.2, 0.5, 0.1}, 1.2}, {{1, 1, 0, 0}, 4},         {{1, 1, 1, 0}, 6},  {{1, 0, 0, 1}, 3},
      {{1, -1, 0.5, -0.25}, 0},     {{1e-3, 0, 1e-3, 1}, 1.5}, {{0, 0, 1, -1}, 0}, {{1, 2, 3, 40}, 90},
      {{0, 1, 0, 0}, 1.5},          {{0, 0, -2, 0}, 2.000001}, {{1, 1, 1, 1}, 99}, {{1, 1, 1, 1}, 0}};
  for (unsigned seed = 0; seed < 2; ++seed)
    for (const int range : {1, 1000})
      for (const Method method : {Method::hull, Method::simplicial, Method::barycentric}) {
        if (method == Method::barycentric && seed > 0) continue;
        auto field = random_field<float, 4>({5, 4, 5, 4}, range, seed);
        field.view.grid.axes[0].origin = -0.3;
        field.view.grid.axes[2].spacing = -0.7;
        field.view.grid.axes[3].coordinates = {0, 0.9, 2.1, 3};
        FieldSliceOptions options;
        options.method = method;
        const auto surface = extracted(field, 0.5, options);
        FieldSteps steps(unowned_field(field.view));
        FieldSlicer<4> slicer(steps, 0.5, options);
        for (const auto& plane : planes) {
          const auto cut = slicer.slice(plane);
          ASSERT_TRUE(cut) << cut.error().message;
          expect_same_mesh(*cut, sliced(surface, plane));
        }
      }
}

// The same for volumes, whose grid edges are those of the lifted field.
TEST(FieldSlicer, any_plane_of_a_volume_gives_what_the_whole_volume_gives) {
  const std::vector<Hyperplane<4>> planes{{{0.3, -0.2, 0.5, 0.1}, 1.2},
                                          {{1, 1, 0, 0}, 4},
                                          {{1, 0, 0, 1}, 3},
                                          {{1, -1, 0.5, -0.25}, 0},
                                          {{0, 1, 0, 0}, 1.5},
                                          {{0, 0, 0, 1}, 1.5},
                                          {{0, 0, 0, 1}, 2},
                                          {{0, 0, 1, 0}, 2},
                                          {{1, 1, 1, 1}, 99}};
  const auto field = random_field<float, 4>({4, 4, 4, 4}, 1000, 7);
  for (const std::vector<double>& levels : {std::vector<double>{-200, 300}, {-500, 0, 100}})
    for (const Method method : {Method::hull, Method::simplicial}) {
      IntervalOptions filling;
      filling.method = method;
      const auto volume = *interval(field.view, std::span<const double>(levels), filling);
      FieldSliceOptions options;
      options.method = method;
      FieldSteps steps(unowned_field(field.view));
      FieldSlicer<4, 4> slicer(steps, levels, options);
      for (const auto& plane : planes) {
        const auto cut = slicer.slice(plane);
        ASSERT_TRUE(cut) << cut.error().message;
        expect_same_mesh(*cut, sliced(volume, plane));
        EXPECT_EQ(cut->attributes.size(), cut->simplex_count() > 0 ? 2u : cut->attributes.size());
      }
    }
}

// A series of moments shares the surface of each slab.
TEST(FieldSlicer, many_moments_in_any_order) {
  const auto field = random_field<float, 4>({5, 4, 5, 4}, 9, 3);
  const auto surface = extracted(field, 0.5);
  FieldSteps steps(unowned_field(field.view));
  FieldSlicer<4> slicer(steps, 0.5);
  for (const double time : {0., 0.25, 0.5, 0.75, 1., 1.5, 0.3, 0.4, 2.9, 3.}) {
    const auto cut = slicer.slice(Hyperplane<4>::at(3, time));
    ASSERT_TRUE(cut);
    expect_same_mesh(*cut, sliced(surface, Hyperplane<4>::at(3, time)));
  }
}

// What vertices carry, from the field and from the mesh: an affine field stays affine, normals of the cut are
// perpendicular to it, and both ways give the same.
TEST(FieldSlicer, other_fields_and_normals) {
  const auto ball = make_field<double, 4>(box_grid<4>(13, -1.5, 1.5), [](const auto& p) {
    return 1.2 - std::sqrt(p[0] * p[0] + p[1] * p[1] + p[2] * p[2] + p[3] * p[3]);
  });
  const auto affine = make_field<float, 4>(
      box_grid<4>(13, -1.5, 1.5), [](const auto& p) { return 2 * p[0] - p[1] + 4 * p[2] + 8 * p[3]; });
  FieldSteps steps(unowned_field(ball.view)), other(unowned_field(affine.view));
  FieldSliceOptions options;
  options.precision = Precision::f64;
  options.with_normals = true;
  options.others.push_back({"affine", &other});
  FieldSlicer<4> slicer(steps, 0, options);
  auto surface = extracted(ball, 0, options);
  const NamedField named{"affine", unowned_field(affine.view)};
  ASSERT_TRUE(add_point_data(surface, unowned_field(ball.view), 0, Inside::above, {&named, 1}, true));
  for (const Hyperplane<4>& plane :
       {Hyperplane<4>::at(3, 0.3), Hyperplane<4>::at(3, -0.5), Hyperplane<4>::at(1, 0.3),
        Hyperplane<4>::at(0, 0.25), Hyperplane<4>{{1, 1, -1, 1}, 0.4}, Hyperplane<4>{{0.1, 0, 0, -1}, 0.4}}) {
    const auto cut = slicer.slice(plane);
    ASSERT_TRUE(cut) << cut.error().message;
    const auto of_mesh = sliced(surface, plane, {.precision = Precision::f64});
    expect_same_mesh(*cut, of_mesh);
    ASSERT_EQ(cut->attributes.size(), 2u);
    const auto& normals = std::get<std::vector<double>>(cut->attributes[0].values);
    const auto& values = std::get<std::vector<double>>(cut->attributes[1].values);
    ASSERT_EQ(normals.size(), cut->vertex_count() * 3);

    // The same data at the same places, whichever way.
    std::multiset<std::vector<double>> from_field, from_mesh;
    for (const auto& [mesh, set] : {std::pair{&*cut, &from_field}, std::pair{&of_mesh, &from_mesh}})
      for (std::size_t vertex = 0; vertex < mesh->vertex_count(); ++vertex) {
        std::vector<double> row{std::get<std::vector<double>>(mesh->attributes[1].values)[vertex]};
        for (std::size_t k = 0; k < 3; ++k) {
          row.push_back(mesh->positions[vertex * 3 + k]);
          const double component = std::get<std::vector<double>>(mesh->attributes[0].values)[vertex * 3 + k];
          row.push_back(std::round(component * 1e9)); // at a stored step rounded once less
        }
        set->insert(row);
      }
    EXPECT_TRUE(from_field == from_mesh);

    // The cut is a ball around the foot of the origin, and the field is affine on it.
    const auto directions = plane_coordinates(plane, SliceFrame::orthonormal).directions;
    double squared = 0;
    for (const double component : plane.normal) squared += component * component;
    for (std::size_t vertex = 0; vertex < cut->vertex_count(); ++vertex) {
      double expected = 0, along = 0, length = 0;
      constexpr double factors[] = {2, -1, 4, 8};
      for (std::size_t k = 0; k < 4; ++k) {
        double coordinate = plane.offset / squared * plane.normal[k];
        for (std::size_t row = 0; row < 3; ++row)
          coordinate += cut->positions[vertex * 3 + row] * directions[row][k];
        expected += factors[k] * coordinate;
      }
      EXPECT_NEAR(values[vertex], expected, 1e-5);
      for (std::size_t row = 0; row < 3; ++row) {
        along += normals[vertex * 3 + row] * cut->positions[vertex * 3 + row];
        length = std::hypot(length, cut->positions[vertex * 3 + row]);
      }
      EXPECT_GT(along / length, 0.995); // outward
    }
  }
}

TEST(SamplesAround, every_coordinate_of_even_uneven_and_falling_axes) {
  Axis even{.count = 40, .first = 3, .origin = 0.1, .spacing = 1.0 / 3}, falling = even, uneven;
  falling.spacing = -0.7;
  uneven.count = 4;
  uneven.coordinates = {-1, 0, 5, 5.5};
  for (const Axis& axis : {even, falling, uneven})
    for (std::int64_t i = 0; i < axis.count; ++i) {
      const auto at = samples_around(axis, axis.coordinate(i));
      ASSERT_TRUE(at);
      EXPECT_EQ(at->begin, i);
      EXPECT_EQ(at->end, i + 1);
      if (i + 1 == axis.count) break;
      const auto between = samples_around(axis, (axis.coordinate(i) + axis.coordinate(i + 1)) / 2);
      EXPECT_EQ(between->begin, i);
      EXPECT_EQ(between->end, i + 2);
    }
  EXPECT_FALSE(samples_around(even, 0));
  EXPECT_FALSE(samples_around(even, std::nan("")));
}
