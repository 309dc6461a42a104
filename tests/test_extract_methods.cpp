// The methods beside each other, in all dimensions.
#include "check.hpp"
#include "extract/cell_corners.hpp"

#include <bit>
#include <cmath>
#include <limits>
#include <numbers>

using namespace hyperiso;
using namespace hyperiso::check;

namespace {

// Simplices of one cell as lists of edges (two cube vertices).
using Edge = std::pair<unsigned, unsigned>;
template <int D>
std::vector<std::array<Edge, D>> cell_simplices(Method method, LabelSet<D> labels) {
  std::vector<Edge> corners;
  for_each_cell_corner<D>(method, labels, [&](unsigned a, unsigned b) { corners.emplace_back(a, b); });
  std::vector<std::array<Edge, D>> simplices(corners.size() / D);
  for (std::size_t i = 0; i < corners.size(); ++i) simplices[i / D][i % D] = corners[i];
  return simplices;
}

// Sorted, with the orientation kept by exchanging the first two where sorting was odd.
template <int D>
void normalize(std::vector<std::array<Edge, D>>& simplices) {
  for (auto& simplex : simplices) {
    bool odd = false;
    for (std::size_t i = 1; i < D; ++i)
      for (std::size_t j = i; j > 0 && simplex[j] < simplex[j - 1]; --j) {
        std::swap(simplex[j], simplex[j - 1]);
        odd = !odd;
      }
    if (odd) std::swap(simplex[0], simplex[1]);
  }
  std::ranges::sort(simplices);
}

// The connected components of the + vertices, as labels.
template <int D>
std::vector<LabelSet<D>> components(LabelSet<D> labels) {
  std::vector<LabelSet<D>> found;
  while (labels != 0) {
    LabelSet<D> component = labels & (~labels + 1), before = 0;
    while (component != before) {
      before = component;
      for (unsigned vertex = 0; vertex < 1u << D; ++vertex)
        for (int axis = 0; axis < D; ++axis)
          if (before >> vertex & 1) component |= LabelSet<D>{1} << (vertex ^ 1u << axis) & labels;
    }
    found.push_back(component);
    labels &= ~component;
  }
  return found;
}

// Paper 002 section 2 says that the components' surfaces can be made one by one or all at once.
template <int D>
void expect_one_hull_per_component() {
  constexpr std::uint64_t all = (std::uint64_t{1} << (1 << D)) - 1;
  for (std::uint64_t labels = 1; labels < all; labels += D < 4 ? 1 : 7) {
    auto together = cell_simplices<D>(Method::component, static_cast<LabelSet<D>>(labels));
    std::vector<std::array<Edge, D>> one_by_one;
    for (const LabelSet<D> component : components<D>(static_cast<LabelSet<D>>(labels))) {
      const auto part = cell_simplices<D>(Method::component, component);
      one_by_one.insert(one_by_one.end(), part.begin(), part.end());
    }
    normalize<D>(together);
    normalize<D>(one_by_one);
    ASSERT_EQ(together, one_by_one) << labels;
  }
}

// Paper 002 in 3D to the letter: the hull of the displaced midpoints of a component, by trying every three.
// The point of rank i is 8^i units off the middle of its edge of 2^31.
class DisplacedHull {
 public:
  explicit DisplacedHull(LabelSet<3> component) : component_(component) {
    std::vector<std::pair<std::array<int, 3>, Edge>> middles;
    for (unsigned lower = 0; lower < 8; ++lower)
      for (int axis = 0; axis < 3; ++axis) {
        const unsigned upper = lower | 1u << axis;
        if (lower >> axis & 1 || (component >> lower & 1) == (component >> upper & 1)) continue;
        std::array<int, 3> middle;
        for (int k = 0; k < 3; ++k) middle[k] = static_cast<int>((lower >> k & 1) + (upper >> k & 1));
        middles.emplace_back(middle, Edge(lower, upper));
      }
    std::ranges::sort(middles);
    Integer displacement = 1;
    for (const auto& [middle, edge] : middles) {
      Point point;
      for (int k = 0; k < 3; ++k) point[k] = middle[k] * half;
      const int axis = std::countr_zero(edge.first ^ edge.second);
      point[axis] += component >> edge.first & 1 ? displacement : -displacement; // away from the component
      displacement *= 8;
      points_.push_back(point);
      edges_.push_back(edge);
    }
  }

  // The facets on the side of the component: no other corner of the cube is beyond them.
  std::vector<std::array<Edge, 3>> surface() const {
    std::vector<std::array<Edge, 3>> found;
    for (std::size_t a = 0; a < points_.size(); ++a)
      for (std::size_t b = a + 1; b < points_.size(); ++b)
        for (std::size_t c = b + 1; c < points_.size(); ++c) {
          if (is_facet(a, b, c)) found.push_back({edges_[a], edges_[b], edges_[c]});
          if (is_facet(a, c, b)) found.push_back({edges_[a], edges_[c], edges_[b]});
        }
    return found;
  }

 private:
  __extension__ using Integer = __int128;
  using Point = std::array<Integer, 3>;
  static constexpr Integer half = Integer{1} << 30;

  // Volume of (b-a, c-a, p-a): positive where a, b, c turn counter-clockwise, seen from p.
  static Integer volume(const Point& a, const Point& b, const Point& c, const Point& p) {
    Point u, v, w;
    for (int k = 0; k < 3; ++k) u[k] = b[k] - a[k], v[k] = c[k] - a[k], w[k] = p[k] - a[k];
    return w[0] * (u[1] * v[2] - u[2] * v[1]) + w[1] * (u[2] * v[0] - u[0] * v[2]) +
           w[2] * (u[0] * v[1] - u[1] * v[0]);
  }
  // The component is beyond it, on the side that its normal does not point to: out of the component.
  bool is_facet(std::size_t a, std::size_t b, std::size_t c) const {
    for (std::size_t p = 0; p < points_.size(); ++p)
      if (p != a && p != b && p != c && volume(points_[a], points_[b], points_[c], points_[p]) <= 0)
        return false;
    bool beyond = false;
    for (unsigned vertex = 0; vertex < 8; ++vertex) {
      Point corner;
      for (int k = 0; k < 3; ++k) corner[k] = (vertex >> k & 1) * 2 * half;
      if (volume(points_[a], points_[b], points_[c], corner) >= 0) continue;
      if (!(component_ >> vertex & 1)) return false;
      beyond = true;
    }
    return beyond;
  }

  LabelSet<3> component_;
  std::vector<Point> points_;
  std::vector<Edge> edges_;
};

template <int D>
double ball(const std::array<double, D>& point, double radius) {
  double squared = 0;
  for (const double x : point) squared += x * x;
  return radius - std::sqrt(squared);
}

// On noise with ties and holes: neighbours match, orientations agree, every crossed edge has its vertex; in a
// constant layer the surface is closed.
template <int D>
void expect_sound(Method method, const std::array<std::int64_t, D>& dims, Cut cut = Cut::midpoints) {
  for (const int range : {1, 100}) {
    auto field = random_field<float, D>(dims, range, 3);
    const auto mesh = extracted(field, 0.25, {.method = method, .cut = cut});
    const auto found = measure(mesh);
    ASSERT_TRUE(found) << found.error().message;
    EXPECT_EQ(found->bad_facets, 0u);
    EXPECT_GT(mesh.simplex_count(), 0u);
    if (method != Method::barycentric) {
      EXPECT_EQ(mesh.vertex_count(),
                (crossed_edges<float, D>(
                    field.view, [](float value) { return value >= 0.25; }, method == Method::simplicial)));
    }
    std::size_t sample = 0;
    for_each_index<D>(dims, [&](const auto& index) {
      for (int axis = 0; axis < D; ++axis)
        if (index[axis] == 0 || index[axis] == dims[axis] - 1) field.samples[sample] = -1;
      ++sample;
    });
    const auto closed = measure(extracted(field, 0.25, {.method = method, .cut = cut}));
    EXPECT_TRUE(closed->closed);
    EXPECT_EQ(closed->bad_facets, 0u);
    field.samples[field.samples.size() / 2] = std::numeric_limits<float>::quiet_NaN();
    EXPECT_EQ(measure(extracted(field, 0.25, {.method = method, .cut = cut}))->bad_facets, 0u);
  }
}

} // namespace

TEST(ComponentMethod, one_hull_per_component) {
  expect_one_hull_per_component<2>();
  expect_one_hull_per_component<3>();
  expect_one_hull_per_component<4>();
}

TEST(ComponentMethod, is_the_hull_of_displaced_midpoints) {
  for (CubeLabels labels = 1; labels < 255; ++labels) {
    std::vector<std::array<Edge, 3>> displaced;
    for (const CubeLabels component : components<3>(labels))
      for (const auto& facet : DisplacedHull(component).surface()) displaced.push_back(facet);
    auto expected = cell_simplices<3>(Method::component, labels);
    normalize<3>(displaced);
    normalize<3>(expected);
    ASSERT_EQ(displaced, expected) << labels;
  }
}

// Where paper 000 joins two opposite + vertices of a cube by a tunnel, paper 002 keeps them apart.
TEST(ComponentMethod, opposite_positive_vertices_stay_apart) {
  for (const CubeLabels labels : {0x18u, 0x24u, 0x42u, 0x81u}) {
    EXPECT_EQ(cell_simplices<3>(Method::hull, labels).size(), 6u);
    EXPECT_EQ(cell_simplices<3>(Method::component, labels).size(), 2u);
  }
}

TEST(ComponentMethod, is_hull_by_the_other_sign_rule) {
  const auto field = random_field<float, 4>({4, 5, 3, 4}, 50, 2);
  auto mesh = extracted(field, 0.5, {.method = Method::component});
  for (std::size_t simplex = 0; simplex < mesh.simplex_count(); ++simplex) {
    const auto first = mesh.simplices[4 * simplex];
    mesh.simplices.set(4 * simplex, mesh.simplices[4 * simplex + 1]);
    mesh.simplices.set(4 * simplex + 1, first);
  }
  expect_same_mesh(mesh, extracted(field, 0.5, {.inside = Inside::below}));
}

TEST(Methods, sound_in_every_dimension) {
  for (const Method method : {Method::hull, Method::component, Method::simplicial}) {
    expect_sound<2>(method, {9, 8});
    expect_sound<3>(method, {5, 6, 4});
    expect_sound<4>(method, {4, 3, 4, 3});
    expect_sound<5>(method, {3, 3, 4, 3, 3});
  }
  for (const Cut cut : {Cut::midpoints, Cut::staircase}) {
    expect_sound<2>(Method::barycentric, {9, 8}, cut);
    expect_sound<3>(Method::barycentric, {5, 6, 4}, cut);
    expect_sound<4>(Method::barycentric, {4, 3, 4, 3}, cut);
    expect_sound<5>(Method::barycentric, {3, 2, 2, 2, 2}, cut);
  }
  expect_sound<6>(Method::hull, {3, 2, 2, 2, 2, 2});
  expect_sound<6>(Method::component, {2, 2, 2, 2, 2, 2});
  expect_sound<6>(Method::simplicial, {2, 2, 2, 2, 2, 2});
}

// One + sample in a grid of two cells per axis: a vertex for each direction of the (Kuhn) grid, twice.
TEST(Methods, one_positive_sample_in_six_dimensions) {
  const auto one_inside = [](auto dimension, Method method, std::size_t vertices) {
    constexpr int D = decltype(dimension)::value;
    std::array<std::int64_t, D> dims;
    dims.fill(3);
    const auto field = make_field<float, D>(unit_grid<D>(dims), [](const auto& p) {
      return std::ranges::all_of(p, [](double x) { return x == 1; }) ? 1 : -1;
    });
    const auto mesh = extracted(field, 0, {.method = method});
    EXPECT_EQ(mesh.vertex_count(), vertices);
    const auto found = measure(mesh);
    ASSERT_TRUE(found);
    EXPECT_EQ(found->bad_facets, 0u);
    EXPECT_TRUE(found->closed);
    EXPECT_EQ(found->euler_characteristic, 0);
  };
  one_inside(std::integral_constant<int, 6>{}, Method::hull, 12);
  one_inside(std::integral_constant<int, 6>{}, Method::component, 12);
  one_inside(std::integral_constant<int, 6>{}, Method::simplicial, 126);
}

// One cell: its D! Kuhn simplices have the lowest corner in common, and 2^D - 1 edges there.
TEST(Methods, simplicial_in_seven_and_eight_dimensions) {
  const auto one_corner = [](auto dimension, std::size_t simplices) {
    constexpr int D = decltype(dimension)::value;
    std::array<std::int64_t, D> dims;
    dims.fill(2);
    const auto field = make_field<float, D>(
        unit_grid<D>(dims), [](const auto& p) { return std::accumulate(p.begin(), p.end(), 0.0); });
    const auto mesh = extracted(field, 0.5, {.method = Method::simplicial, .inside = Inside::below});
    EXPECT_EQ(mesh.vertex_count(), (std::size_t{1} << D) - 1);
    EXPECT_EQ(mesh.simplex_count(), simplices);
    EXPECT_EQ(mesh.active_cells, 1u);
  };
  one_corner(std::integral_constant<int, 7>{}, 5040);
  one_corner(std::integral_constant<int, 8>{}, 40320);
}

TEST(Methods, dimensions_beyond_their_reach_are_errors) {
  const auto field = random_field<float, 7>({2, 2, 2, 2, 2, 2, 2}, 5, 1);
  for (const Method method : {Method::hull, Method::component}) {
    const auto mesh = extract(field.view, 0.5, {.method = method});
    ASSERT_FALSE(mesh);
    EXPECT_EQ(mesh.error().code, Code::unsupported_dimension);
  }
}

// Paper 000 section 6: the interval volume 0.35 <= f <= 0.37 of a squared distance as a surface in 4D.
TEST(Methods, sphere_of_paper_000) {
  const auto count = [](const ExtractOptions& options) {
    Grid<4> grid = box_grid<4>(14, 0, 1);
    grid.axes[3] = Axis{.count = 2};
    const auto lifted = make_field<double, 4>(grid, [](const auto& p) {
      double value = p[3] == 0 ? -0.35 : -0.37;
      for (int axis = 0; axis < 3; ++axis) value += (p[axis] - 0.5) * (p[axis] - 0.5);
      return value;
    });
    const auto mesh = extracted(lifted, 0, options);
    return std::pair(mesh.simplex_count(), mesh.vertex_count());
  };
  using Counts = std::pair<std::size_t, std::size_t>;
  EXPECT_EQ(count({.method = Method::simplicial}), Counts(21108, 5762));
  EXPECT_EQ(count({.method = Method::barycentric, .cut = Cut::staircase}), Counts(92544, 21340));
  EXPECT_EQ(count({.method = Method::barycentric}), Counts(318528, 74680));
  EXPECT_EQ(count({.method = Method::hull}).second, 1496u);
  EXPECT_EQ(count({.method = Method::component}).second, 1496u);
}

// Content of the sphere of radius 1, approached at second order.
TEST(Methods, five_dimensional_ball_converges) {
  const double exact = 8 * std::numbers::pi * std::numbers::pi / 3;
  for (const Method method : {Method::hull, Method::component}) {
    std::array<double, 2> error;
    for (int level = 0; level < 2; ++level) {
      const auto field = make_field<double, 5>(box_grid<5>(level == 0 ? 5 : 9, -1.1, 1.1),
                                               [](const auto& p) { return ball<5>(p, 1); });
      const auto mesh = extracted(field, 0, {.method = method, .precision = Precision::f64});
      EXPECT_GT(enclosed_volume(mesh), 0) << "normals point outward";
      error[static_cast<std::size_t>(level)] = std::abs(measure(mesh)->content - exact);
    }
    EXPECT_GT(error[0] / error[1], 3.3);
    EXPECT_LT(error[0] / error[1], 5.0);
  }
}
