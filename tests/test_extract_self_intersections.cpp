// Which surfaces pass through themselves, and which never do.
#include "check.hpp"
#include "hyperiso/self_intersections.hpp"

using namespace hyperiso;
using namespace hyperiso::check;

namespace {

template <int D>
std::uint64_t pairs(const OwnedField<double, D>& field, const ExtractOptions& options) {
  const auto mesh = extract(field.view, 0.0, options);
  EXPECT_TRUE(mesh);
  const auto found = find_self_intersections(*mesh);
  EXPECT_TRUE(found);
  return found->pairs;
}

// Values of all sizes, so that vertices come close to the ends of their edges.
template <int D>
OwnedField<double, D> random_values(const std::array<std::int64_t, D>& dims, unsigned seed) {
  std::mt19937 random(seed);
  std::normal_distribution<double> size(0, 3), sign;
  return make_field<double, D>(
      unit_grid<D>(dims), [&](const auto&) { return std::copysign(std::exp(size(random)), sign(random)); });
}

template <int D>
void expect_embedded(const std::array<std::int64_t, D>& dims) {
  for (const Method method : {Method::hull, Method::component, Method::simplicial})
    for (unsigned seed = 0; seed < 5; ++seed)
      EXPECT_EQ(pairs<D>(random_values<D>(dims, seed), {.method = method, .precision = Precision::f64}), 0u)
          << "method " << static_cast<int>(method) << ", seed " << seed;
}

} // namespace

// docs/tables.md proves it for the hull tables.
TEST(SelfIntersections, none_in_up_to_four_dimensions) {
  expect_embedded<2>({20, 20});
  expect_embedded<3>({7, 7, 6});
  expect_embedded<4>({3, 4, 3, 3});
}

// In five dimensions the hull table's surface can; the simplicial one cannot.
TEST(SelfIntersections, a_cell_in_five_dimensions) {
  const std::vector<double> values = {-2,  -6,   -20,  196,  -329, -217, 217, -7, 54, -33, 296,
                                      -4,  -344, -373, 6,    -29,  2,    8,   37, 2,  60,  -5,
                                      188, 1,    -1,   -112, -6,   3,    128, -2, -7, -140};
  std::size_t vertex = 0;
  const auto field =
      make_field<double, 5>(unit_grid<5>({2, 2, 2, 2, 2}), [&](const auto&) { return values[vertex++]; });
  std::uint32_t labels = 0;
  for (vertex = 0; vertex < 32; ++vertex) labels |= std::uint32_t{values[vertex] >= 0} << vertex;
  EXPECT_EQ(labels, 0x18df4548u);
  EXPECT_GT(pairs<5>(field, {}), 0u);
  EXPECT_GT(pairs<5>(field, {.precision = Precision::f64}), 0u);
  EXPECT_EQ(pairs<5>(field, {.method = Method::simplicial, .precision = Precision::f64}), 0u);
}
