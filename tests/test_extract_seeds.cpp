// The surface from seeds: what a full extraction gives of their components, and no more work than they need.

#include "check.hpp"
#include "hyperiso/seeds.hpp"

#include "core/union_find.hpp"

#include <cmath>

using namespace hyperiso;
using namespace hyperiso::check;

namespace {

// The components of `mesh` that have a vertex in `wanted`, vertices and simplices in their order.
template <int D>
SimplexMesh<D> components_with(const SimplexMesh<D>& mesh, const std::set<GridEdge>& wanted) {
  UnionFind joined(mesh.vertex_count());
  for (std::size_t corner = 0; corner < mesh.simplices.size(); ++corner)
    joined.unite(mesh.simplices[corner / D * D], mesh.simplices[corner]);
  std::set<std::uint64_t> roots;
  for (std::size_t vertex = 0; vertex < mesh.vertex_count(); ++vertex)
    if (wanted.contains(mesh.edges[vertex])) roots.insert(joined.find(vertex));

  SimplexMesh<D> part;
  std::vector<std::uint64_t> number(mesh.vertex_count());
  std::vector<double> positions;
  for (std::size_t vertex = 0; vertex < mesh.vertex_count(); ++vertex) {
    if (!roots.contains(joined.find(vertex))) continue;
    number[vertex] = part.edges.size();
    part.edges.push_back(mesh.edges[vertex]);
    for (std::size_t k = 0; k < D; ++k) positions.push_back(mesh.positions[vertex * D + k]);
  }
  part.positions.reset(positions.size(), false);
  for (std::size_t i = 0; i < positions.size(); ++i) part.positions.set(i, positions[i]);
  std::vector<std::uint64_t> corners;
  for (std::size_t corner = 0; corner < mesh.simplices.size(); ++corner)
    if (roots.contains(joined.find(mesh.simplices[corner])))
      corners.push_back(number[mesh.simplices[corner]]);
  part.simplices.reset(corners.size(), false);
  for (std::size_t i = 0; i < corners.size(); ++i) part.simplices.set(i, corners[i]);
  return part;
}

template <int D>
void expect_identical(const SimplexMesh<D>& a, const SimplexMesh<D>& b) {
  ASSERT_EQ(a.vertex_count(), b.vertex_count());
  ASSERT_EQ(a.simplex_count(), b.simplex_count());
  EXPECT_TRUE(a.edges == b.edges);
  for (std::size_t i = 0; i < a.positions.size(); ++i) ASSERT_EQ(a.positions[i], b.positions[i]);
  for (std::size_t i = 0; i < a.simplices.size(); ++i) ASSERT_EQ(a.simplices[i], b.simplices[i]);
}

// From every cell of a random field: the components through it, simplex for simplex.
template <class T, int D>
void expect_the_components_of_extract(const OwnedField<T, D>& field, double isovalue,
                                      const ExtractOptions& options) {
  const auto surface = *extract(field.view, isovalue, options);
  const auto dims = field.view.dims();
  int cells = 0;
  for_each_index<D>(dims, [&](const std::array<std::int64_t, D>& cell) {
    for (int axis = 0; axis < D; ++axis)
      if (cell[axis] == dims[axis] - 1) return;
    std::set<GridEdge> in_cell;
    for (const GridEdge edge : surface.edges) {
      const auto ends = grid_edge_ends<D>(dims, edge);
      bool inside = true;
      for (int axis = 0; axis < D; ++axis)
        inside &= ends.lower[axis] >= cell[axis] && ends.upper[axis] <= cell[axis] + 1;
      if (inside) in_cell.insert(edge);
    }
    bool missing = false;
    for (unsigned vertex = 0; vertex < 1u << D; ++vertex) {
      auto sample = cell;
      for (int axis = 0; axis < D; ++axis) sample[axis] += vertex >> axis & 1;
      missing |= std::isnan(static_cast<double>(field.view.at(sample)));
    }
    const auto traced = extract_from_seeds(field.view, isovalue, {.cells = {cell}, .pairs = {}}, options);
    if (missing || in_cell.empty()) {
      ASSERT_FALSE(traced);
      EXPECT_EQ(traced.error().code, Code::outside_domain);
      return;
    }
    ASSERT_TRUE(traced) << traced.error().message;
    if (++cells % 7 == 0) expect_identical(traced->mesh, components_with(surface, in_cell));
  });
  EXPECT_GT(cells, 0);
}

} // namespace

TEST(Seeds, every_cell_gives_the_components_through_it) {
  for (const Method method : {Method::hull, Method::simplicial})
    for (const Inside inside : {Inside::above, Inside::below}) {
      const ExtractOptions options{.method = method, .inside = inside};
      // Few samples inside: many components, some of them sharing cells.
      expect_the_components_of_extract(random_field<float, 2>({9, 8}, 4, 1), 2, options);
      expect_the_components_of_extract(random_field<float, 3>({6, 7, 5}, 4, 2), 3, options);
      expect_the_components_of_extract(random_field<std::int8_t, 4>({4, 4, 5, 3}, 9, 3), 8, options);
    }
}

TEST(Seeds, missing_data_and_falling_axes) {
  auto field = random_field<float, 3>({6, 7, 5}, 4, 2);
  for (std::size_t i = 5; i < field.samples.size(); i += 31) field.samples[i] = NAN;
  field.view.grid.axes[1].spacing = -2;
  expect_the_components_of_extract(field, 2, {});
}

// A ball far inside a grid that no memory holds: what is looked at follows its surface.
TEST(Seeds, a_small_ball_in_a_grid_of_2_to_the_80_samples) {
  const std::int64_t n = std::int64_t{1} << 20;
  LazyField<4> field{unit_grid<4>({n, n, n, n}), {}};
  std::set<std::array<std::int64_t, 4>> asked;
  std::size_t calls = 0;
  const std::array<double, 4> centre{500000.3, 400000.1, 300000.2, 777777.4};
  field.sample = [&](const std::array<std::int64_t, 4>& index) {
    ++calls;
    asked.insert(index);
    double squared = 0;
    for (std::size_t k = 0; k < 4; ++k) squared += std::pow(static_cast<double>(index[k]) - centre[k], 2);
    return 6.2 - std::sqrt(squared);
  };
  const auto traced = extract_from_seeds<4>(
      field, 0, {.cells = {}, .pairs = {{{0, 0, 0, 0}, {500000, 400000, 300000, 777777}}}},
      {.precision = Precision::f64});
  ASSERT_TRUE(traced) << traced.error().message;
  const auto found = measure(traced->mesh);
  EXPECT_TRUE(found->closed);
  EXPECT_EQ(found->components, 1u);
  EXPECT_EQ(found->euler_characteristic, 0);
  EXPECT_EQ(calls, asked.size()) << "each sample once";
  EXPECT_EQ(calls, traced->samples);
  EXPECT_LT(traced->cells, 4 * traced->mesh.active_cells);
  EXPECT_LT(traced->samples, 4 * traced->mesh.active_cells);
  EXPECT_TRUE(traced->mesh.edges.empty()) << "their numbers would not fit";
}

TEST(Seeds, seeds_that_name_no_surface) {
  const auto field = random_field<float, 3>({4, 4, 4}, 1, 1);
  const auto error_of = [&](const Seeds<3>& seeds, double isovalue) {
    const auto traced = extract_from_seeds(field.view, isovalue, seeds);
    EXPECT_FALSE(traced);
    return traced.error().code;
  };
  EXPECT_EQ(error_of({{{3, 0, 0}}, {}}, 0), Code::outside_domain);
  EXPECT_EQ(error_of({{{-1, 0, 0}}, {}}, 0), Code::outside_domain);
  EXPECT_EQ(error_of({{{0, 0, 0}}, {}}, 5), Code::outside_domain);
  EXPECT_EQ(error_of({{}, {{{0, 0, 0}, {4, 0, 0}}}}, 0), Code::outside_domain);
  EXPECT_EQ(error_of({{}, {{{0, 0, 0}, {1, 1, 1}}}}, 5), Code::invalid_argument);
  EXPECT_EQ(error_of({{{0, 0, 0}}, {}}, NAN), Code::invalid_isovalue);
}
