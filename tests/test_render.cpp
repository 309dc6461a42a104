// Pictures against an independent rasteriser: nothing missing, nothing turned, nothing that flickers.

#include "check.hpp"
#include "hyperiso/render.hpp"
#include "hyperiso/sample.hpp"
#include "hyperiso/slice.hpp"
#include "temporary_folder.hpp"

#include <cmath>

using namespace hyperiso;
using namespace hyperiso::check;

namespace {

// Sphere, torus, two spheres: the frames of a film through both changes of topology.
class TorusMorph {
 public:
  TorusMorph() : steps_(*make_sample("torus-morph", {.dims = {24, 24, 24, 9}})), slicer_(steps_, 0.5) {}
  Mesh at(double time) { return *slicer_.slice(Hyperplane<4>::at(3, time)); }

 private:
  FieldSteps steps_;
  FieldSlicer<4> slicer_;
};

RenderOptions small_pictures() {
  RenderOptions options;
  options.width = 320, options.height = 240;
  options.low = {-0.8, -0.8, -0.8}, options.high = {0.8, 0.8, 0.8};
  return options;
}

// The way of a point into a picture, written down again from what RenderOptions says.
struct Projection {
  double width, height, distance = 0;
  std::array<double, 3> back, right, up;
  static constexpr double tangent = 0.2679;

  explicit Projection(const RenderOptions& options) : width(options.width), height(options.height) {
    const double az = options.azimuth * std::numbers::pi / 180,
                 el = options.elevation * std::numbers::pi / 180;
    back = {std::cos(el) * std::cos(az), std::cos(el) * std::sin(az), std::sin(el)};
    right = {-std::sin(az), std::cos(az), 0};
    up = {-std::sin(el) * std::cos(az), -std::sin(el) * std::sin(az), std::cos(el)};
    for (const double x : {-0.8, 0.8})
      for (const double y : {-0.8, 0.8})
        for (const double z : {-0.8, 0.8}) {
          const std::array<double, 3> p{x, y, z};
          distance = std::max({distance,
                               along(p, back) + std::abs(along(p, right)) / (tangent * width / height * 0.78),
                               along(p, back) + std::abs(along(p, up)) / (tangent * 0.8)});
        }
  }
  static double along(const std::array<double, 3>& a, const std::array<double, 3>& b) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
  }
  std::array<double, 2> operator()(const std::array<double, 3>& p) const {
    const double depth = distance - along(p, back);
    return {(1 + along(p, right) / (depth * tangent * width / height)) * width / 2,
            (1 - along(p, up) / (depth * tangent)) * height / 2};
  }
};

// How many of the four samples of each pixel the triangles of a mesh cover.
std::vector<int> coverage(const Mesh& mesh, const RenderOptions& options) {
  const Projection project(options);
  std::vector<unsigned> covered(static_cast<std::size_t>(options.width * options.height), 0);
  for (std::size_t triangle = 0; triangle < mesh.simplex_count(); ++triangle) {
    std::array<std::array<double, 2>, 3> c;
    for (std::size_t corner = 0; corner < 3; ++corner) {
      const std::size_t vertex = mesh.simplices[3 * triangle + corner];
      c[corner] = project(
          {mesh.positions[3 * vertex], mesh.positions[3 * vertex + 1], mesh.positions[3 * vertex + 2]});
    }
    const auto [left, right] = std::minmax({c[0][0], c[1][0], c[2][0]});
    const auto [top, bottom] = std::minmax({c[0][1], c[1][1], c[2][1]});
    for (int y = static_cast<int>(top); y <= static_cast<int>(bottom); ++y)
      for (int x = static_cast<int>(left); x <= static_cast<int>(right); ++x)
        for (unsigned sample = 0; sample < 4; ++sample) {
          const double px = x + (sample % 2 ? 0.75 : 0.25), py = y + (sample / 2 ? 0.75 : 0.25);
          const auto side = [&](std::size_t i, std::size_t j) {
            return (c[j][0] - c[i][0]) * (py - c[i][1]) - (c[j][1] - c[i][1]) * (px - c[i][0]);
          };
          const double a = side(0, 1), b = side(1, 2), d = side(2, 0);
          if ((a >= 0 && b >= 0 && d >= 0) || (a <= 0 && b <= 0 && d <= 0))
            covered[static_cast<std::size_t>(y * options.width + x)] |= 1u << sample;
        }
  }
  std::vector<int> counts;
  for (const unsigned samples : covered) counts.push_back(std::popcount(samples));
  return counts;
}

std::array<int, 3> pixel(const Image& image, std::size_t place) {
  return {image.pixels[3 * place], image.pixels[3 * place + 1], image.pixels[3 * place + 2]};
}

// Differences between neighbouring frames: pixels that show the surface in one of the two only.
int differing(const std::vector<int>& a, const std::vector<int>& b) {
  int count = 0;
  for (std::size_t place = 0; place < a.size(); ++place) count += (a[place] > 0) != (b[place] > 0);
  return count;
}

} // namespace

class Render : public testing::Test {
 protected:
  void SetUp() override {
    if (const Status there = check_rendering(); !there) GTEST_SKIP() << there.error().message;
  }
};

// Frames on both sides of the changes of topology, and at steps. The surface is closed: its inside, which has
// a colour of its own, must not be seen anywhere, and where it is in front of a pixel's samples the pixel
// must show it.
TEST_F(Render, silhouettes_are_those_of_the_slices_and_no_triangle_is_missing_or_turned) {
  TorusMorph film;
  const RenderOptions options = small_pictures();
  for (const double time : {0.0, 0.31, 0.62, 1.0, 1.37, 1.6, 2.0}) {
    SCOPED_TRACE(time);
    const Mesh frame = film.at(time);
    ASSERT_TRUE(measure(frame)->closed);
    const Image with = *render(frame, "", options), without = *render(SimplexMesh<3>(), "", options);
    const std::vector<int> expected = coverage(frame, options);
    int unlike = 0, seen = 0;
    for (std::size_t place = 0; place < expected.size(); ++place) {
      const bool shown = pixel(with, place) != pixel(without, place);
      seen += shown;
      unlike += shown != (expected[place] > 0);
      if (expected[place] < 4) continue;
      const auto [red, green, blue] = pixel(with, place);
      ASSERT_GE(blue, red) << "the inside is seen at pixel " << place;
    }
    EXPECT_GT(seen, 2000);
    EXPECT_LE(unlike, 2); // a sample on the very edge of a triangle, in single precision
  }
}

// Nothing pops: between close moments the silhouette changes by as much as the surface moves, also through
// the moments at which its topology changes.
TEST_F(Render, silhouettes_change_little_between_close_frames) {
  TorusMorph film;
  const RenderOptions options = small_pictures();
  std::vector<int> before;
  for (int frame = 0; frame <= 80; ++frame) {
    const std::vector<int> now = coverage(film.at(frame * 0.025), options);
    if (!before.empty()) {
      EXPECT_LT(differing(before, now), 700) << "frame " << frame;
    }
    before = now;
  }
}

TEST_F(Render, the_picture_does_not_depend_on_the_number_of_threads) {
  TorusMorph film;
  const Mesh frame = film.at(0.7);
  RenderOptions options = small_pictures();
  options.threads = 1;
  const Image one = *render(frame, "t = 0.7", options);
  options.threads = 5;
  EXPECT_EQ(render(frame, "t = 0.7", options)->pixels, one.pixels);
}

TEST_F(Render, an_open_surface_shows_its_inside_in_another_colour) {
  Mesh square(3, 2); // seen from above and from below
  square.positions.reset(12, false);
  const float corners[]{-1, -1, 0, 1, -1, 0, 1, 1, 0, -1, 1, 0};
  for (std::size_t k = 0; k < 12; ++k) square.positions.set(k, corners[k]);
  square.simplices.reset(6, false);
  const std::uint32_t triangles[]{0, 1, 2, 0, 2, 3};
  for (std::size_t k = 0; k < 6; ++k) square.simplices.set(k, triangles[k]);
  RenderOptions options = small_pictures();
  options.low = {-1, -1, 0}, options.high = {1, 1, 0};
  const std::size_t middle = 120 * 320 + 160;
  options.elevation = 90;
  const auto above = pixel(*render(square, "", options), middle);
  options.elevation = -90;
  const auto below = pixel(*render(square, "", options), middle);
  EXPECT_GT(above[2], above[0]);
  EXPECT_GT(below[0], below[2]);
}

TEST_F(Render, colours_of_vertices_and_of_tracks) {
  TorusMorph film;
  Mesh frame = film.at(2);
  const auto count_reddish = [&] {
    const Image image = *render(frame, "", small_pictures());
    int count = 0;
    for (std::size_t place = 0; place < image.pixels.size() / 3; ++place)
      count += pixel(image, place)[0] > pixel(image, place)[2] + 60;
    return count;
  };
  EXPECT_EQ(count_reddish(), 0);
  frame.attributes.push_back(
      {"track_id", Attribute::Location::simplex, 1, std::vector<std::int32_t>(frame.simplex_count(), 2)});
  Colour colour = label_colour(2);
  EXPECT_EQ(count_reddish() > 1000, colour.red > colour.blue + 80);
  for (const auto& [name, value] : {std::pair{"red", 255}, {"green", 0}, {"blue", 0}})
    frame.attributes.push_back(
        {name, Attribute::Location::vertex, 1, std::vector<std::int32_t>(frame.vertex_count(), value)});
  EXPECT_GT(count_reddish(), 1000);
}

TEST_F(Render, curves_of_a_field_in_the_plane) {
  FieldSteps steps(*make_sample("ball", {.dims = {16, 16, 5}, .time = true}));
  FieldSlicer<3> slicer(steps, 0.5);
  RenderOptions options = small_pictures();
  options.low = {-1, -1}, options.high = {1, 1};
  const Mesh curve = *slicer.slice(Hyperplane<3>::at(2, 0.3));
  EXPECT_NE(render(curve, "t = 0.3", options)->pixels, render(SimplexMesh<2>(), "t = 0.3", options)->pixels);
}

TEST_F(Render, an_empty_frame_and_a_box_without_extent_are_ordinary) {
  RenderOptions options = small_pictures();
  options.low = options.high = {5, 5, 5};
  EXPECT_TRUE(render(SimplexMesh<3>(), "t = 0", options));
  options.low = options.high = {5, 5};
  EXPECT_TRUE(render(SimplexMesh<2>(), "t = 0", options));
}

TEST_F(Render, options_that_contradict_themselves) {
  const SimplexMesh<3> frame;
  const auto code = [&](const std::function<void(RenderOptions&)>& change) {
    RenderOptions options = small_pictures();
    change(options);
    return render(frame, "", options).error().code;
  };
  EXPECT_EQ(code([](auto& options) { options.width = 10; }), Code::invalid_argument);
  EXPECT_EQ(code([](auto& options) { options.elevation = 91; }), Code::invalid_argument);
  EXPECT_EQ(code([](auto& options) { options.low = {0, 0}; }), Code::invalid_argument);
  EXPECT_EQ(code([](auto& options) { options.high[1] = -3; }), Code::invalid_argument);
  EXPECT_EQ(render(SimplexMesh<4>(), "", small_pictures()).error().code, Code::invalid_argument);
}

TEST_F(Render, a_picture_that_cannot_be_written_is_an_error) {
  const Image image = *render(SimplexMesh<3>(), "", small_pictures());
  EXPECT_EQ(write_png(image, "/nowhere/a.png").error().code, Code::file_unwritable);
  EXPECT_EQ(FilmWriter::create("/nowhere/a.mp4", 64, 64, 10).error().code, Code::file_unwritable);
  EXPECT_EQ(FilmWriter::create("a.avi", 64, 64, 10).error().code, Code::file_unsupported);
  EXPECT_EQ(FilmWriter::create("a.mp4", 65, 64, 10).error().code, Code::invalid_argument);
}
