// Pieces that move: at every time the slice, whatever ties there are.

#include "check.hpp"
#include "hyperiso/morph.hpp"
#include "hyperiso/slice.hpp"

#include <cmath>

using namespace hyperiso;
using namespace hyperiso::check;

namespace {

template <class T, int D>
SimplexMesh<D> extracted(const OwnedField<T, D>& field, Method method = Method::hull) {
  auto mesh = extract(field.view, 0, {.method = method, .precision = Precision::f64});
  EXPECT_TRUE(mesh) << mesh.error().message;
  return *std::move(mesh);
}

template <int D>
MorphPieces<D> pieces_of(const SimplexMesh<D>& mesh, int axis = D - 1) {
  auto pieces = morph_pieces(mesh, axis);
  EXPECT_TRUE(pieces) << pieces.error().message;
  return *std::move(pieces);
}

// The corners of each simplex to nine digits, from its smallest corner on in its orientation; those of a
// simplex that has shrunk to fewer points are left out.
std::multiset<std::vector<std::vector<double>>> rounded_simplices(const Mesh& mesh) {
  Mesh rounded = mesh;
  for (std::size_t k = 0; k < mesh.positions.size(); ++k)
    rounded.positions.set(k, std::round(mesh.positions[k] * 1e9) / 1e9 + 0.0);
  auto set = simplex_set(rounded);
  std::erase_if(set,
                [](const auto& corners) { return std::ranges::adjacent_find(corners) != corners.end(); });
  return set;
}

template <int D>
void expect_slices_everywhere(const SimplexMesh<D>& mesh, int axis, std::vector<double> times) {
  const auto pieces = pieces_of(mesh, axis);
  for (const double time : times) {
    SCOPED_TRACE(time);
    const auto cut = slice(mesh, Hyperplane<D>::at(axis, time), {.precision = Precision::f64});
    EXPECT_TRUE(rounded_simplices(pieces_at(pieces, time)) == rounded_simplices(*cut));
  }
}

} // namespace

// The promise: simplex for simplex the slice, oriented alike, on random data with many ties, along any axis.
TEST(SliceMorph, pieces_at_a_time_are_the_slice_at_that_time) {
  for (unsigned seed = 0; seed < 3; ++seed)
    for (const int range : {1, 2, 1000}) {
      const auto surface = extracted(random_field<float, 4>({4, 3, 4, 4}, range, seed));
      for (int axis = 0; axis < 4; ++axis)
        expect_slices_everywhere(surface, axis, {0.1, 0.5, 1.25, 2 - 1e-6});
    }
}

TEST(SliceMorph, pieces_of_a_2d_field_through_time_are_segments) {
  for (const int range : {1, 3, 1000}) {
    const auto surface = extracted(random_field<float, 3>({5, 6, 5}, range, 7));
    for (int axis = 0; axis < 3; ++axis) expect_slices_everywhere(surface, axis, {0.2, 1.5, 3.75});
  }
}

TEST(SliceMorph, pieces_of_the_simplicial_method) {
  expect_slices_everywhere(extracted(random_field<float, 4>({3, 4, 3, 3}, 2, 3), Method::simplicial), 3,
                           {0.3, 1.6});
}

// At a stored step the slice is put together otherwise; the points are the same: so is every measure of them.
TEST(SliceMorph, content_at_a_stored_step_is_that_of_the_slice) {
  const auto field = random_field<float, 4>({5, 5, 5, 4}, 1000, 11);
  const auto surface = extracted(field);
  const auto pieces = pieces_of(surface);
  for (const double step : {1.0, 2.0, 3.0}) {
    const auto cut = slice(surface, Hyperplane<4>::at(3, step), {.precision = Precision::f64});
    const auto expected = measure(*cut), found = measure(pieces_at(pieces, step));
    EXPECT_NEAR(found->content, expected->content, 1e-9 * expected->content);
    for (std::size_t k = 0; k < 3; ++k) EXPECT_NEAR(found->vector_area[k], expected->vector_area[k], 1e-9);
  }
}

// Neighbouring pieces hand over: a corner ends where the next interval of its simplex starts.
TEST(SliceMorph, every_simplex_is_covered_from_its_first_time_to_its_last) {
  const auto surface = extracted(random_field<float, 4>({4, 4, 4, 3}, 5, 2));
  const auto pieces = pieces_of(surface);
  EXPECT_TRUE(std::ranges::is_sorted(pieces.start_times));
  std::map<std::uint64_t, std::set<std::pair<double, double>>> intervals;
  for (std::size_t piece = 0; piece < pieces.count(); ++piece) {
    EXPECT_LT(pieces.start_times[piece], pieces.end_times[piece]);
    intervals[pieces.simplices[piece]].emplace(pieces.start_times[piece], pieces.end_times[piece]);
  }
  for (std::uint64_t simplex = 0; simplex < surface.simplex_count(); ++simplex) {
    double first = HUGE_VAL, last = -HUGE_VAL;
    for (std::size_t corner = 0; corner < 4; ++corner) {
      const double time = surface.positions[surface.simplices[simplex * 4 + corner] * 4 + 3];
      first = std::min(first, time), last = std::max(last, time);
    }
    const auto covered = intervals.find(simplex);
    ASSERT_EQ(covered == intervals.end(), first == last);
    if (first == last) continue;
    for (const auto& [start, end] : covered->second) {
      EXPECT_EQ(start, first);
      first = end;
    }
    EXPECT_EQ(first, last);
  }
}

TEST(SliceMorph, positions_stay_as_narrow_as_those_of_the_mesh) {
  const auto field = random_field<float, 4>({4, 4, 4, 3}, 100, 4);
  const auto pieces = pieces_of(*extract(field.view, 0));
  EXPECT_FALSE(pieces.starts.wide());
  const auto mesh = morph_mesh(pieces);
  EXPECT_EQ(mesh.simplex_count(), pieces.count());
  EXPECT_EQ(mesh.vertex_count(), 3 * pieces.count());
  EXPECT_EQ(mesh.attributes.size(), 4u);
}

TEST(SliceMorph, an_empty_surface_has_no_pieces) {
  const auto pieces = pieces_of(SimplexMesh<4>());
  EXPECT_EQ(pieces.count(), 0u);
  EXPECT_EQ(pieces_at(pieces, 0).simplex_count(), 0u);
  EXPECT_EQ(morph_mesh(pieces).vertex_count(), 0u);
}

TEST(SliceMorph, an_axis_that_is_none_and_too_little_memory_are_errors) {
  const auto surface = extracted(random_field<float, 4>({4, 4, 4, 3}, 5, 2));
  EXPECT_EQ(morph_pieces(surface, 4).error().code, Code::invalid_argument);
  EXPECT_EQ(morph_pieces(surface, 3, 1000).error().code, Code::out_of_memory);
}
