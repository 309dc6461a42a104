// Slices that move: every vertex along its edge of the mesh, against the slices at the times between.

#include "check.hpp"
#include "hyperiso/slice.hpp"

#include <cmath>
#include <numeric>

using namespace hyperiso;
using namespace hyperiso::check;

namespace {

constexpr auto f64 = Precision::f64;

template <int D>
MovingSlice<D> moving(const SimplexMesh<D>& mesh, double start, double end, int axis = D - 1) {
  auto slice = moving_slice(mesh, start, end, f64, axis);
  EXPECT_TRUE(slice) << slice.error().message;
  return *std::move(slice);
}

// At the share `w` of the way.
template <int D>
Mesh between(const MovingSlice<D>& slice, double w) {
  Mesh mesh = slice.start;
  for (std::size_t k = 0; k < mesh.positions.size(); ++k)
    mesh.positions.set(k, slice.start.positions[k] + w * (slice.end.positions[k] - slice.start.positions[k]));
  return mesh;
}

std::vector<double> rounded(std::vector<double> numbers) {
  for (double& number : numbers) number = std::round(number * 1e9) / 1e9 + 0.0;
  return numbers;
}

// The simplices to nine digits; those that have shrunk to fewer points are left out.
std::multiset<std::vector<std::vector<double>>> rounded_simplices(Mesh mesh) {
  for (std::size_t k = 0; k < mesh.positions.size(); ++k)
    mesh.positions.set(k, std::round(mesh.positions[k] * 1e9) / 1e9 + 0.0);
  auto set = simplex_set(mesh);
  std::erase_if(set, [](const auto& corners) {
    return std::set(corners.begin(), corners.end()).size() < corners.size();
  });
  return set;
}

template <int D>
std::vector<double> times_of(const SimplexMesh<D>& mesh, int axis) {
  std::set<double> times;
  for (std::size_t vertex = 0; vertex < mesh.vertex_count(); ++vertex)
    times.insert(mesh.positions[vertex * D + static_cast<std::size_t>(axis)]);
  return {times.begin(), times.end()};
}

// Where each edge of the mesh that is there just after `start` has its point then and at `end`, computed from
// the edges alone; a point on several edges as often.
template <int D>
std::multiset<std::vector<double>> ways_along_edges(const SimplexMesh<D>& mesh, double start, double end,
                                                    std::size_t axis) {
  std::set<std::pair<std::uint64_t, std::uint64_t>> edges;
  for (std::size_t simplex = 0; simplex < mesh.simplex_count(); ++simplex)
    for (std::size_t a = 0; a < D; ++a)
      for (std::size_t b = 0; b < D; ++b) {
        const std::uint64_t early = mesh.simplices[simplex * D + a], late = mesh.simplices[simplex * D + b];
        const double from = mesh.positions[early * D + axis], to = mesh.positions[late * D + axis];
        const bool there = start < end ? from <= start && start < to : from < start && start <= to;
        if (there) edges.emplace(early, late);
      }
  std::multiset<std::vector<double>> ways;
  for (const auto& [early, late] : edges) {
    const double from = mesh.positions[early * D + axis], to = mesh.positions[late * D + axis];
    std::vector<double> way;
    for (const double time : {start, std::clamp(end, from, to)})
      for (std::size_t k = 0; k < D; ++k)
        if (k != axis) {
          const double share = (time - from) / (to - from);
          way.push_back((1 - share) * mesh.positions[early * D + k] + share * mesh.positions[late * D + k]);
        }
    ways.insert(rounded(way));
  }
  return ways;
}

template <int D>
std::multiset<std::vector<double>> ways_of(const MovingSlice<D>& slice) {
  std::multiset<std::vector<double>> ways;
  for (std::size_t vertex = 0; vertex < slice.start.vertex_count(); ++vertex) {
    std::vector<double> way;
    for (const Mesh* mesh : {&static_cast<const Mesh&>(slice.start), &static_cast<const Mesh&>(slice.end)})
      for (std::size_t k = 0; k < D - 1; ++k) way.push_back(mesh->positions[vertex * (D - 1) + k]);
    ways.insert(rounded(way));
  }
  return ways;
}

} // namespace

// The promise: where no vertex of the mesh comes between, the way from start to end passes through the
// slices.
TEST(SliceMoving, is_the_slice_at_every_time_before_the_next_vertex) {
  for (const int range : {1, 2, 1000}) {
    const auto surface =
        extracted(random_field<float, 4>({4, 3, 4, 3}, range, 5), range < 9 ? 0 : 0.25, {.precision = f64});
    for (int axis = 0; axis < 4; ++axis) {
      const auto times = times_of(surface, axis);
      const std::size_t stride = times.size() / 5 + 1;
      for (std::size_t i = 0; i + 1 < times.size(); i += stride) {
        SCOPED_TRACE(times[i]);
        if (times[i + 1] - times[i] < 1e-3) continue; // nine digits would not tell its simplices apart
        for (const auto& [start, end] :
             {std::pair{times[i], times[i + 1]}, std::pair{times[i + 1], times[i]}}) {
          const auto found = moving(surface, start, end, axis);
          for (const double w : {0.25, 0.5, 0.9}) {
            const auto cut =
                slice(surface, Hyperplane<4>::at(axis, start + w * (end - start)), {.precision = f64});
            EXPECT_TRUE(rounded_simplices(between(found, w)) == rounded_simplices(*cut));
          }
        }
      }
    }
  }
}

// However far the end is: no vertex leaves its edge, and all edges have theirs, over many steps too.
TEST(SliceMoving, vertices_slide_along_their_edges_and_stop_where_these_end) {
  for (const int range : {1, 3, 1000}) {
    const auto surface =
        extracted(random_field<float, 4>({4, 4, 3, 4}, range, 8), range < 9 ? 0 : 0.25, {.precision = f64});
    for (std::size_t axis = 0; axis < 4; ++axis)
      for (const auto& [start, end] : {std::pair{0.0, 0.4}, std::pair{0.3, 1.7}, std::pair{1.0, 2.0},
                                       std::pair{1.6, 0.2}, std::pair{1.0, 0.0}})
        EXPECT_TRUE(ways_of(moving(surface, start, end, static_cast<int>(axis))) ==
                    ways_along_edges(surface, start, end, axis));
  }
  const auto curves = extracted(random_field<float, 3>({6, 5, 4}, 4, 1), 0.25, {.precision = f64});
  for (std::size_t axis = 0; axis < 3; ++axis)
    EXPECT_TRUE(ways_of(moving(curves, 1, 1.8, static_cast<int>(axis))) ==
                ways_along_edges(curves, 1, 1.8, axis));
}

// At a stored step, where the slice is put together otherwise, and with positions rounded to f32 on an axis
// whose samples are no f32.
TEST(SliceMoving, starts_as_the_slice_at_and_between_stored_steps) {
  auto field = random_field<float, 4>({5, 4, 4, 5}, 3, 11);
  field.view.grid.axes[3].origin = 0.1;
  field.view.grid.axes[3].spacing = 0.1;
  for (const Precision precision : {Precision::f32, f64}) {
    const auto surface = extracted(field, 0.25, {.precision = precision, .keep_edges = true});
    const Axis& time = surface.grid_axes[3];
    for (const double start :
         {time.coordinate(0), time.coordinate(1), time.coordinate(2), time.coordinate(3), 0.15, 0.3777}) {
      SCOPED_TRACE(start);
      const auto cut = slice(surface, Hyperplane<4>::at(3, start), {.precision = f64});
      EXPECT_TRUE(rounded_simplices(moving(surface, start, 0.5).start) == rounded_simplices(*cut));
      if (start > time.coordinate(0)) {
        EXPECT_TRUE(rounded_simplices(moving(surface, start, 0.1).start) == rounded_simplices(*cut));
      }
    }
  }
}

TEST(SliceMoving, has_no_cracks_at_any_share_of_the_way) {
  const auto surface =
      extracted(random_field<float, 4>({5, 5, 5, 4}, 2, 3), 0.25, {.precision = f64, .keep_edges = true});
  for (const double start : {1.0, 1.5}) {
    const auto found = moving(surface, start, 2.0);
    EXPECT_EQ(found.start.simplex_count(), found.end.simplex_count());
    EXPECT_EQ(measure(found.start)->bad_facets, 0u);
    EXPECT_EQ(boundary_facets(found.start).size() > 0, true); // at the walls, and there only
    for (const auto& facet : boundary_facets(found.start)) {
      bool on_a_wall = false;
      for (std::size_t k = 0; k < 3; ++k)
        for (const double wall : {0.0, 4.0}) {
          bool on_this = true;
          for (const std::uint64_t vertex : facet)
            on_this &=
                found.start.positions[vertex * 3 + k] == wall && found.end.positions[vertex * 3 + k] == wall;
          on_a_wall |= on_this;
        }
      EXPECT_TRUE(on_a_wall);
    }
  }
}

// Attributes are those of the places: the coordinates, given along as attributes, say where the vertices are.
TEST(SliceMoving, carries_attributes_of_the_start_and_of_the_end) {
  auto surface = extracted(random_field<float, 4>({4, 4, 4, 3}, 50, 2), 0.25, {.precision = f64});
  std::vector<double> first, last;
  std::vector<std::int32_t> numbers(surface.simplex_count());
  for (std::size_t vertex = 0; vertex < surface.vertex_count(); ++vertex) {
    first.push_back(surface.positions[vertex * 4]);
    last.push_back(surface.positions[vertex * 4 + 3]);
  }
  std::iota(numbers.begin(), numbers.end(), 0);
  surface.attributes.push_back({"first", Attribute::Location::vertex, 1, first});
  surface.attributes.push_back({"last", Attribute::Location::vertex, 1, last});
  surface.attributes.push_back({"number", Attribute::Location::simplex, 1, numbers});
  const auto found = moving(surface, 0.5, 0.75);
  for (const SimplexMesh<3>* mesh : {&found.start, &found.end}) {
    const auto& along = std::get<std::vector<double>>(mesh->attributes[0].values);
    const auto& at = std::get<std::vector<double>>(mesh->attributes[1].values);
    for (std::size_t vertex = 0; vertex < mesh->vertex_count(); ++vertex) {
      EXPECT_NEAR(along[vertex], mesh->positions[vertex * 3], 1e-12);
      EXPECT_GE(at[vertex], 0.5 - 1e-12);
      EXPECT_LE(at[vertex], mesh == &found.start ? 0.5 + 1e-12 : 0.75 + 1e-12);
    }
    EXPECT_EQ(std::get<std::vector<std::int32_t>>(mesh->attributes[2].values).size(), mesh->simplex_count());
  }
}

// From the field slab by slab: the same as from the whole surface.
TEST(SliceMoving, of_a_field_is_that_of_its_surface) {
  for (const bool falling : {false, true}) {
    auto field = random_field<float, 4>({4, 4, 5, 5}, 3, 21);
    if (falling) field.view.grid.axes[3].spacing = -1, field.view.grid.axes[3].origin = 4;
    const auto surface = extracted(field, 0.25, {.precision = f64, .keep_edges = true});
    FieldSteps steps(unowned_field(field.view));
    FieldSliceOptions options;
    options.precision = f64;
    FieldSlicer<4> slicer(steps, 0.25, options);
    for (const auto& [start, end] :
         {std::pair{0.0, 0.5}, std::pair{0.5, 0.7}, std::pair{0.7, 3.0}, std::pair{3.0, 4.0},
          std::pair{4.0, 3.5}, std::pair{2.0, 1.0}, std::pair{1.5, 0.0}}) {
      SCOPED_TRACE(start);
      const auto found = slicer.moving_slice(start, end);
      ASSERT_TRUE(found) << found.error().message;
      EXPECT_TRUE(ways_of(*found) == ways_of(moving(surface, start, end)));
      EXPECT_TRUE(rounded_simplices(found->start) ==
                  rounded_simplices(*slicer.slice(Hyperplane<4>::at(3, start))));
    }
    EXPECT_EQ(slicer.moving_slice(4, 5).error().code, Code::outside_domain);
    EXPECT_EQ(slicer.moving_slice(-1, 2).error().code, Code::outside_domain);
  }
}

TEST(SliceMoving, an_empty_surface_and_a_time_without_surface) {
  EXPECT_EQ(moving(SimplexMesh<4>(), 0, 1).start.simplex_count(), 0u);
  const auto surface = extracted(random_field<float, 4>({4, 4, 4, 3}, 5, 2), 0.25);
  const auto found = moving(surface, 7, 8);
  EXPECT_EQ(found.start.simplex_count(), 0u);
  EXPECT_EQ(found.end.vertex_count(), 0u);
}

TEST(SliceMoving, no_way_to_go_and_an_axis_that_is_none_are_errors) {
  const SimplexMesh<4> surface;
  EXPECT_EQ(moving_slice(surface, 1, 1).error().code, Code::invalid_argument);
  EXPECT_EQ(moving_slice(surface, 0, HUGE_VAL).error().code, Code::invalid_argument);
  EXPECT_EQ(moving_slice(surface, 0, 1, f64, 4).error().code, Code::invalid_argument);
}
