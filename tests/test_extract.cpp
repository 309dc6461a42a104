// What a user relies on in an isosurface, whatever the field: closed, oriented, matching, welded, in the
// right place.

#include "check.hpp"

#include <cmath>
#include <limits>
#include <numbers>

using namespace hyperiso;
using namespace hyperiso::check;

namespace {

// True if a cell that holds all these grid edges touches NaN.
template <class T, int D>
bool beside_missing_data(const FieldView<const T, D>& field, const std::vector<GridEdgeEnds<D>>& facet) {
  std::array<std::int64_t, D> low = facet[0].lower, high = facet[0].upper;
  for (const auto& ends : facet)
    for (int axis = 0; axis < D; ++axis) {
      low[axis] = std::min(low[axis], ends.lower[axis]);
      high[axis] = std::max(high[axis], ends.upper[axis]);
    }
  bool missing = false;
  for_each_index<D>(field.dims(), [&](const std::array<std::int64_t, D>& index) {
    bool near = true;
    for (int axis = 0; axis < D; ++axis)
      near &= index[axis] >= high[axis] - 1 && index[axis] <= low[axis] + 1;
    missing |= near && std::isnan(static_cast<double>(field.at(index)));
  });
  return missing;
}

// Each facet of one simplex lies in a wall of the grid, or beside missing data.
template <class T, int D>
void expect_boundary_on_walls(const OwnedField<T, D>& field, const SimplexMesh<D>& mesh) {
  const auto dims = field.view.dims();
  for (const auto& facet : boundary_facets(mesh)) {
    std::vector<GridEdgeEnds<D>> edges;
    for (const auto vertex : facet) edges.push_back(grid_edge_ends<D>(dims, mesh.edges[vertex]));
    bool on_wall = false;
    for (int axis = 0; axis < D; ++axis)
      for (const std::int64_t wall : {std::int64_t{0}, dims[axis] - 1})
        on_wall |= std::ranges::all_of(
            edges, [&](const auto& ends) { return ends.lower[axis] == wall && ends.upper[axis] == wall; });
    ASSERT_TRUE(on_wall || beside_missing_data(field.view, edges));
  }
}

template <class T, int D>
void expect_sound(const OwnedField<T, D>& field, double isovalue, Inside inside) {
  for (const Method method : {Method::hull, Method::simplicial}) {
    const auto mesh = extracted(field, isovalue, {.method = method, .inside = inside});
    const auto found = measure(mesh);
    ASSERT_TRUE(found);
    EXPECT_EQ(found->bad_facets, 0u);
    const auto is_inside = [&](T value) {
      return inside == Inside::above ? value >= isovalue : value <= isovalue;
    };
    EXPECT_EQ(mesh.vertex_count(),
              (crossed_edges<T, D>(field.view, is_inside, method == Method::simplicial)));
    EXPECT_TRUE(std::ranges::is_sorted(mesh.edges));
    EXPECT_EQ(std::ranges::adjacent_find(mesh.edges), mesh.edges.end()) << "one crossed edge, one vertex";
    expect_boundary_on_walls(field, mesh);
  }
}

template <int D>
void expect_sound_on_random_fields(const std::array<std::int64_t, D>& dims) {
  for (unsigned seed = 0; seed < 6; ++seed)
    for (const Inside inside : {Inside::above, Inside::below}) {
      expect_sound(random_field<float, D>(dims, 1000, seed), 0.5, inside);  // no ties
      expect_sound(random_field<float, D>(dims, 2, seed), 0, inside);       // a fifth of the samples tie
      expect_sound(random_field<std::int8_t, D>(dims, 1, seed), 1, inside); // a third ties
      auto holes = random_field<double, D>(dims, 3, seed);
      for (std::size_t i = seed; i < holes.samples.size(); i += 17)
        holes.samples[i] = std::numeric_limits<double>::quiet_NaN();
      expect_sound(holes, 0, inside);
    }
}

template <int D>
double ball(const std::array<double, D>& point, double radius) {
  double squared = 0;
  for (const double x : point) squared += x * x;
  return radius - std::sqrt(squared);
}

} // namespace

TEST(Extract, random_fields_with_ties_and_holes_2d) { expect_sound_on_random_fields<2>({9, 7}); }
TEST(Extract, random_fields_with_ties_and_holes_3d) { expect_sound_on_random_fields<3>({6, 5, 4}); }
TEST(Extract, random_fields_with_ties_and_holes_4d) { expect_sound_on_random_fields<4>({4, 3, 5, 3}); }

TEST(Extract, one_cell_grids_of_every_labelling) {
  for (unsigned labels = 0; labels < 256; ++labels) {
    unsigned bit = 0;
    expect_sound(make_field<float, 3>(unit_grid<3>({2, 2, 2}),
                                      [&](const auto&) { return labels >> bit++ & 1 ? 1 : -1; }),
                 0, Inside::above);
  }
}

TEST(Extract, grids_without_a_cell_have_no_surface) {
  EXPECT_EQ(extracted(random_field<float, 3>({5, 1, 5}, 9, 1), 0).simplex_count(), 0u);
  EXPECT_EQ(extracted(random_field<float, 3>({5, 0, 5}, 9, 1), 0).simplex_count(), 0u);
  EXPECT_EQ(extracted(random_field<float, 2>({1, 1}, 9, 1), 0).vertex_count(), 0u);
}

// A field that is constant on the outer layer has a surface without boundary.
template <int D>
void expect_closed_inside_a_constant_layer(const std::array<std::int64_t, D>& dims) {
  for (const double border : {-5.0, 5.0, 0.0}) {
    auto field = random_field<float, D>(dims, 3, 7);
    std::size_t sample = 0;
    for_each_index<D>(dims, [&](const auto& index) {
      for (int axis = 0; axis < D; ++axis)
        if (index[axis] == 0 || index[axis] == dims[axis] - 1)
          field.samples[sample] = static_cast<float>(border);
      ++sample;
    });
    const auto found = measure(extracted(field, 0));
    EXPECT_TRUE(found->closed);
    EXPECT_EQ(found->bad_facets, 0u);
    EXPECT_GT(found->content, 0);
    for (const double component : found->vector_area) EXPECT_NEAR(component, 0, 1e-6 * found->content);
  }
}

TEST(Extract, closed_inside_a_constant_layer) {
  expect_closed_inside_a_constant_layer<2>({11, 8});
  expect_closed_inside_a_constant_layer<3>({7, 6, 8});
  expect_closed_inside_a_constant_layer<4>({6, 5, 6, 5});
}

// The axes are alike: turning or mirroring the grid changes neither vertices nor active cells (simplices may
// differ: the table's order breaks the symmetry).
template <int D>
void expect_same_counts_when_axes_are_permuted_or_mirrored(const std::array<std::int64_t, D>& dims) {
  const auto field = random_field<float, D>(dims, 3, 3);
  const auto whole = extracted(field, 0);
  std::array<int, D> order;
  std::iota(order.begin(), order.end(), 0);
  do {
    auto turned = field;
    for (int axis = 0; axis < D; ++axis) {
      turned.view.grid.axes[axis] = field.view.grid.axes[order[axis]];
      turned.view.strides[axis] = field.view.strides[order[axis]];
    }
    const auto mesh = extracted(turned, 0);
    EXPECT_EQ(mesh.vertex_count(), whole.vertex_count());
    EXPECT_EQ(mesh.active_cells, whole.active_cells);
  } while (std::ranges::next_permutation(order).found);
  for (int axis = 0; axis < D; ++axis) {
    auto mirrored = field;
    mirrored.view.samples += mirrored.view.strides[axis] * (dims[axis] - 1);
    mirrored.view.strides[axis] *= -1;
    const auto mesh = extracted(mirrored, 0);
    EXPECT_EQ(mesh.vertex_count(), whole.vertex_count());
    EXPECT_EQ(mesh.active_cells, whole.active_cells);
  }
}

TEST(Extract, permuted_and_mirrored_axes) {
  expect_same_counts_when_axes_are_permuted_or_mirrored<2>({9, 6});
  expect_same_counts_when_axes_are_permuted_or_mirrored<3>({5, 6, 4});
  expect_same_counts_when_axes_are_permuted_or_mirrored<4>({3, 4, 5, 3});
}

// Content of the sphere of radius r, approached at second order; Euler characteristic 0, 2, 0 for D = 2,
// 3, 4.
template <int D>
void expect_ball(std::int64_t coarse, double radius, double exact) {
  for (const Method method : {Method::hull, Method::simplicial}) {
    std::array<double, 2> error;
    for (int level = 0; level < 2; ++level) {
      const auto field = make_field<double, D>(box_grid<D>((coarse << level) + 1, -1.6, 1.6),
                                               [&](const auto& p) { return ball<D>(p, radius); });
      const auto mesh = extracted(field, 0, {.method = method, .precision = Precision::f64});
      const auto found = measure(mesh);
      EXPECT_EQ(found->euler_characteristic, D % 2 == 1 ? 2 : 0);
      EXPECT_EQ(found->components, 1u);
      EXPECT_TRUE(found->closed);
      EXPECT_GT(enclosed_volume(mesh), 0) << "normals point outward";
      error[static_cast<std::size_t>(level)] = std::abs(found->content - exact);
    }
    EXPECT_LT(error[1] / exact, 0.01);
    const double order = std::log2(error[0] / error[1]);
    EXPECT_GT(order, 1.8) << "errors " << error[0] << ", " << error[1];
    EXPECT_LT(order, 2.2) << "errors " << error[0] << ", " << error[1];
  }
}

TEST(Extract, ball_converges_at_second_order) {
  using std::numbers::pi;
  const double r = 1.03;
  expect_ball<2>(40, r, 2 * pi * r);
  expect_ball<3>(24, r, 4 * pi * r * r);
  expect_ball<4>(14, r, 2 * pi * pi * r * r * r);
}

TEST(Extract, below_is_above_of_the_negated_field) {
  const auto field = random_field<float, 4>({4, 3, 4, 3}, 2, 11);
  auto negated = field;
  for (float& sample : negated.samples) sample = -sample;
  negated.view.samples = negated.samples.data();
  expect_same_mesh(extracted(field, 1, {.inside = Inside::below}), extracted(negated, -1));
}

// Coordinates that fall with the index must not turn the surface inside out.
TEST(Extract, falling_coordinates_keep_normals_outward) {
  for (unsigned reversed = 0; reversed < 8; ++reversed) {
    Grid<3> grid = box_grid<3>(8, -1.5, 1.5);
    for (int axis = 0; axis < 3; ++axis)
      if (reversed >> axis & 1) {
        grid.axes[axis].origin *= -1;
        grid.axes[axis].spacing *= -1;
      }
    const auto mesh = extracted(make_field<float, 3>(grid, [](const auto& p) { return ball<3>(p, 1); }), 0);
    EXPECT_GT(enclosed_volume(mesh), 3);
    EXPECT_EQ(measure(mesh)->bad_facets, 0u);
  }
}

TEST(Extract, rectilinear_axes_place_vertices_at_their_coordinates) {
  Grid<2> grid = unit_grid<2>({3, 3});
  grid.axes[0].coordinates = {0, 10, 11};
  grid.axes[1].coordinates = {-4, 0, 1};
  const auto mesh = extracted(make_field<double, 2>(grid, [](const auto& p) { return p[0]; }), 10.25,
                              {.precision = Precision::f64});
  EXPECT_EQ(vertex_set(mesh), (std::multiset<std::vector<double>>{{10.25, -4}, {10.25, 0}, {10.25, 1}}));
}

TEST(Extract, infinite_samples_are_ordered_data) {
  auto field = make_field<float, 2>(unit_grid<2>({2, 2}), [](const auto& p) { return p[0] * 2; });
  field.samples = {-HUGE_VALF, 2, -HUGE_VALF, HUGE_VALF};
  field.view.samples = field.samples.data();
  EXPECT_EQ(vertex_set(extracted(field, 1)), (std::multiset<std::vector<double>>{{1, 0}, {0.5, 1}}));
}

// Each type gives the surface that its samples have as doubles.
TEST(Extract, every_sample_type) {
  const auto as_double = random_field<double, 3>({5, 4, 6}, 3, 5);
  const auto expect_same = [&](auto type) {
    using T = decltype(type);
    const double shift = std::is_unsigned_v<T> ? 3 : 0;
    OwnedField<T, 3> field;
    for (const double sample : as_double.samples) field.samples.push_back(static_cast<T>(sample + shift));
    field.view = contiguous_view<const T, 3>(field.samples.data(), as_double.view.grid);
    for (const double isovalue : {0.0, 0.5, -1.0})
      expect_same_mesh(extracted(field, isovalue + shift), extracted(as_double, isovalue));
  };
  for (int type = 0; type < 8; ++type) visit_sample_type(static_cast<SampleType>(type), expect_same);
}

// A crop keeps the coordinates of the whole to the bit, so slabs can be joined.
TEST(Extract, a_crop_has_the_vertices_of_the_whole) {
  Grid<3> grid = unit_grid<3>({6, 5, 7});
  for (Axis& axis : grid.axes) axis.origin = 0.1, axis.spacing = 1.0 / 3;
  std::mt19937 random(1);
  const auto field =
      make_field<float, 3>(grid, [&](const auto&) { return static_cast<double>(random() % 1000); });
  const auto whole = vertex_set(extracted(field, 500.5));
  auto slab = extract(field.view.cropped(2, 3, 5), 500.5);
  ASSERT_TRUE(slab);
  const auto part = vertex_set(*slab);
  EXPECT_TRUE(std::ranges::includes(whole, part));
  EXPECT_GT(part.size(), 0u);
}

TEST(Extract, isovalues_that_mean_nothing_or_meet_nothing) {
  const auto field = random_field<float, 3>({4, 4, 4}, 9, 1);
  for (const double bad : {std::nan(""), HUGE_VAL, -HUGE_VAL}) {
    const auto mesh = extract(field.view, bad);
    ASSERT_FALSE(mesh);
    EXPECT_EQ(mesh.error().code, Code::invalid_isovalue);
  }
  EXPECT_EQ(extracted(field, 9.5).simplex_count(), 0u);
  EXPECT_EQ(extracted(field, -9.5).vertex_count(), 0u);
}
