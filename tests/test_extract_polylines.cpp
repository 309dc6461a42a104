// Isolines joined into lines: every segment once, none left, closed or from wall to wall.

#include "check.hpp"
#include "hyperiso/polylines.hpp"

#include <cmath>

using namespace hyperiso;
using namespace hyperiso::check;

namespace {

using Segments = std::multiset<std::pair<std::uint64_t, std::uint64_t>>;

Segments segments_of(const Mesh& mesh) {
  Segments segments;
  for (std::size_t segment = 0; segment < mesh.simplex_count(); ++segment)
    segments.emplace(mesh.simplices[2 * segment], mesh.simplices[2 * segment + 1]);
  return segments;
}

Segments segments_of(const std::vector<Polyline>& lines) {
  Segments segments;
  for (const Polyline& line : lines) {
    for (std::size_t i = 0; i + 1 < line.vertices.size(); ++i)
      segments.emplace(line.vertices[i], line.vertices[i + 1]);
    if (line.closed) segments.emplace(line.vertices.back(), line.vertices.front());
  }
  return segments;
}

} // namespace

TEST(Polylines, of_random_fields_hold_every_segment_once) {
  for (unsigned seed = 0; seed < 8; ++seed)
    for (const int range : {1, 1000}) {
      const auto mesh = *extract(random_field<float, 2>({17, 23}, range, seed).view, 0);
      const auto lines = *polylines(mesh);
      EXPECT_TRUE(segments_of(lines) == segments_of(mesh));
      const auto found = measure(mesh);
      std::size_t open = 0;
      for (const Polyline& line : lines) open += !line.closed;
      EXPECT_EQ(2 * open, found->boundary_facets);
      EXPECT_EQ(lines.size(), found->components);
      EXPECT_TRUE(
          std::ranges::is_sorted(lines, {}, [](const Polyline& line) { return line.vertices.front(); }));
    }
}

TEST(Polylines, a_circle_is_one_closed_line_with_its_inside_on_the_left) {
  const auto field = make_field<double, 2>(box_grid<2>(30, -1, 1),
                                           [](const auto& p) { return 0.8 - std::hypot(p[0], p[1]); });
  const auto mesh = *extract(field.view, 0);
  const auto lines = *polylines(mesh);
  ASSERT_EQ(lines.size(), 1u);
  EXPECT_TRUE(lines[0].closed);
  EXPECT_EQ(lines[0].vertices.front(), 0u);
  double twice_area = 0;
  for (std::size_t i = 0; i < lines[0].vertices.size(); ++i) {
    const auto a = lines[0].vertices[i], b = lines[0].vertices[(i + 1) % lines[0].vertices.size()];
    twice_area +=
        mesh.positions[2 * a] * mesh.positions[2 * b + 1] - mesh.positions[2 * b] * mesh.positions[2 * a + 1];
  }
  EXPECT_NEAR(twice_area / 2, 3.14159 * 0.64, 0.01);
}

TEST(Polylines, what_is_no_line_is_an_error) {
  Mesh fork(2, 1);
  fork.positions.reset(6, false);
  fork.simplices.reset(4, false);
  for (std::size_t i = 0; i < 4; ++i) fork.simplices.set(i, std::array<std::uint64_t, 4>{0, 1, 0, 2}[i]);
  EXPECT_EQ(polylines(fork).error().code, Code::invalid_argument);
  fork.simplices.set(2, 7);
  EXPECT_EQ(polylines(fork).error().code, Code::invalid_argument);
  EXPECT_EQ(polylines(Mesh(3, 2)).error().code, Code::invalid_argument);
  EXPECT_TRUE(polylines(Mesh(2, 1))->empty());
}
