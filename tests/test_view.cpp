#include "hyperiso/view.hpp"

#include "hyperiso/extract.hpp"
#include "hyperiso/sample.hpp"
#include "temporary_folder.hpp"
#include "view/payload.hpp"
#include "view/track_labels.hpp"

#include <gtest/gtest.h>
#include <zlib.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace hyperiso {
namespace {

struct Surface {
  SimplexMesh<4> mesh;
  std::vector<Axis> axes;
};

Surface blobs() {
  SampleOptions options;
  options.dims = {24, 23, 22, 12};
  const Field field = *make_sample("gaussians", options);
  return {*extract(field.view<float, 4>(), sample_isovalue("gaussians", options)), field.info.axes};
}

std::vector<Quantiser> quantisers_of(const std::vector<Axis>& axes) {
  std::vector<Quantiser> quantisers;
  for (const Axis& axis : axes) quantisers.push_back(quantiser_of(axis, 0, 0));
  return quantisers;
}

std::vector<unsigned char> inflated(const std::vector<unsigned char>& bytes, std::size_t size) {
  std::vector<unsigned char> result(size + 1);
  z_stream stream{};
  inflateInit2(&stream, -15);
  stream.next_in = const_cast<unsigned char*>(bytes.data());
  stream.avail_in = static_cast<uInt>(bytes.size());
  stream.next_out = result.data();
  stream.avail_out = static_cast<uInt>(result.size());
  EXPECT_EQ(inflate(&stream, Z_FINISH), Z_STREAM_END);
  result.resize(stream.total_out);
  inflateEnd(&stream);
  return result;
}

// What a page would read: per vertex its levels and attributes, per simplex its corners.
struct Decoded {
  std::size_t columns, corners;
  std::vector<std::uint16_t> levels;
  std::vector<std::uint32_t> simplices;

  void add(const Payload::Block& block, const std::vector<unsigned char>& bytes) {
    const std::size_t codes = block.simplices * corners;
    ASSERT_EQ(bytes.size(), 2 * columns * block.vertices + 3 * codes);
    levels.resize((block.first_vertex + block.vertices) * columns);
    const unsigned char* at = bytes.data();
    for (std::size_t column = 0; column < columns; ++column, at += 2 * block.vertices) {
      std::uint16_t level = 0;
      for (std::size_t i = 0; i < block.vertices; ++i) {
        const int zigzag = at[i] | at[block.vertices + i] << 8;
        level = static_cast<std::uint16_t>(level + ((zigzag >> 1) ^ -(zigzag & 1)));
        levels[(block.first_vertex + i) * columns + column] = level;
      }
    }
    auto vertices = static_cast<std::uint32_t>(block.first_vertex);
    for (std::size_t i = 0; i < codes; ++i) {
      const auto code = static_cast<std::uint32_t>(at[i] | at[codes + i] << 8 | at[2 * codes + i] << 16);
      simplices.push_back(vertices - code);
      if (code == 0) ++vertices;
    }
    EXPECT_EQ(vertices, block.first_vertex + block.vertices);
  }
};

Decoded decoded(const Mesh& mesh, const Payload& payload,
                const std::vector<EncodedAttribute>& attributes = {}) {
  Decoded result{static_cast<std::size_t>(mesh.dimension) + attributes.size(),
                 static_cast<std::size_t>(mesh.simplex_dimension) + 1,
                 {},
                 {}};
  for (const Payload::Block& block : payload.blocks()) {
    const std::size_t size = 2 * result.columns * block.vertices + 3 * block.simplices * result.corners;
    result.add(block, inflated(payload.encode(block, attributes), size));
  }
  return result;
}

// A lost, doubled or turned simplex would be a hole, or a wrong normal, on the page.
TEST(view_payload, gives_back_every_simplex_with_its_orientation) {
  const Surface surface = blobs();
  const Payload payload(surface.mesh, quantisers_of(surface.axes), true);
  const Decoded page = decoded(surface.mesh, payload);
  ASSERT_GT(payload.blocks().size(), 0u);
  EXPECT_EQ(payload.vertex_count(), surface.mesh.vertex_count());

  using Simplex = std::array<std::uint16_t, 16>;
  std::vector<Simplex> expected, found;
  for (std::size_t i = 0; i < surface.mesh.simplex_count(); ++i) {
    Simplex original{}, read{};
    for (std::size_t corner = 0; corner < 4; ++corner)
      for (std::size_t axis = 0; axis < 4; ++axis) {
        const double position = surface.mesh.positions[4 * surface.mesh.simplices[4 * i + corner] + axis];
        original[4 * corner + axis] = payload.quantisers()[axis].level(position);
        read[4 * corner + axis] = page.levels[4 * page.simplices[4 * i + corner] + axis];
      }
    expected.push_back(original);
    found.push_back(read);
  }
  std::sort(expected.begin(), expected.end());
  std::sort(found.begin(), found.end());
  EXPECT_EQ(expected, found);
}

// Blocks share vertices: numbers have to run on from one to the next.
TEST(view_payload, several_blocks_share_vertices) {
  SampleOptions options;
  options.dims = {34, 34, 34, 16};
  const Field field = *make_sample("gyroid", options);
  const auto mesh = *extract(field.view<float, 4>(), sample_isovalue("gyroid", options));
  const Payload payload(mesh, quantisers_of(field.info.axes), true);
  ASSERT_GT(payload.blocks().size(), 2u);
  const Decoded page = decoded(mesh, payload);
  EXPECT_EQ(page.simplices.size(), 4 * mesh.simplex_count());
  EXPECT_EQ(page.levels.size(), 4 * mesh.vertex_count());
  const std::size_t second = 4 * payload.blocks()[1].first_simplex;
  EXPECT_LT(
      *std::min_element(page.simplices.begin() + static_cast<std::ptrdiff_t>(second), page.simplices.end()),
      payload.blocks()[1].first_vertex);
}

// A slice at a stored step has to be that step's surface, not one a rounding error away.
TEST(view_payload, samples_of_even_axes_fall_on_whole_levels) {
  for (const std::int64_t count : {2, 41, 1000, 65536}) {
    Axis axis;
    axis.count = count;
    axis.origin = 0.3;
    axis.spacing = -0.025;
    const Quantiser quantiser = quantiser_of(axis, 0, 0);
    for (const std::int64_t index : {std::int64_t{0}, std::int64_t{1}, count / 2, count - 1}) {
      const double level = (axis.coordinate(index) - quantiser.origin) / quantiser.scale;
      EXPECT_NEAR(level, std::round(level), 1e-6) << count << " " << index;
      EXPECT_EQ(quantiser.level(axis.coordinate(index)), std::round(level));
    }
  }
}

// Playing through time redraws few chunks only if each holds simplices of one moment.
TEST(view_payload, a_chunk_lies_in_one_step_of_time_or_where_two_meet) {
  const Surface surface = blobs();
  const Payload payload(surface.mesh, quantisers_of(surface.axes), true);
  const Decoded page = decoded(surface.mesh, payload);
  const std::uint16_t cell = payload.quantisers()[3].cell;
  std::size_t chunks = 0, crossing = 0;
  for (std::size_t begin = 0; begin < page.simplices.size();
       begin += 4 * Payload::chunk_simplices, ++chunks) {
    const std::size_t end = std::min(begin + 4 * Payload::chunk_simplices, page.simplices.size());
    std::uint16_t low = UINT16_MAX, high = 0;
    for (std::size_t i = begin; i < end; ++i) {
      low = std::min(low, page.levels[4 * page.simplices[i] + 3]);
      high = std::max(high, page.levels[4 * page.simplices[i] + 3]);
    }
    if (high - low > cell) ++crossing;
  }
  EXPECT_LE(crossing, static_cast<std::size_t>(surface.axes[3].count));
  EXPECT_GT(chunks, 5 * crossing);
}

TEST(view_payload, attributes_keep_their_values_per_vertex) {
  Surface surface = blobs();
  const std::size_t vertices = surface.mesh.vertex_count(), simplices = surface.mesh.simplex_count();
  Attribute height{"height", Attribute::Location::vertex, 1, std::vector<float>(vertices)};
  for (std::size_t i = 0; i < vertices; ++i)
    std::get<std::vector<float>>(height.values)[i] = static_cast<float>(surface.mesh.positions[4 * i + 2]);
  Attribute label{"track", Attribute::Location::simplex, 1, std::vector<std::int32_t>(simplices, 7)};
  std::get<std::vector<std::int32_t>>(label.values)[0] = -3;
  Attribute pair{"pair", Attribute::Location::vertex, 2, std::vector<float>(2 * vertices)};
  surface.mesh.attributes = {height, label, pair};

  const std::vector<EncodedAttribute> encoded = encode_attributes(surface.mesh);
  ASSERT_EQ(encoded.size(), 2u); // one with two components cannot be a colour
  EXPECT_EQ(encoded[1].labels, (std::vector<std::int64_t>{-3, 7}));
  EXPECT_EQ(encoded[1].levels[surface.mesh.simplices[0]], 0);
  const double step = (encoded[0].maximum - encoded[0].minimum) / 65535;
  for (std::size_t i = 0; i < vertices; ++i)
    ASSERT_NEAR(encoded[0].minimum + encoded[0].levels[i] * step, surface.mesh.positions[4 * i + 2], step);

  const Payload payload(surface.mesh, quantisers_of(surface.axes), true);
  const Decoded page = decoded(surface.mesh, payload, encoded);
  EXPECT_EQ(page.levels.size(), 6 * vertices);
}

// NaN and infinities in an attribute must not spread to what can be shown.
TEST(view_payload, attributes_that_are_not_finite_leave_the_range_alone) {
  Surface surface = blobs();
  std::vector<double> values(surface.mesh.vertex_count(), 2.0);
  values[0] = std::numeric_limits<double>::quiet_NaN();
  values[1] = std::numeric_limits<double>::infinity();
  values[2] = 5;
  surface.mesh.attributes = {{"value", Attribute::Location::vertex, 1, values}};
  const EncodedAttribute encoded = encode_attributes(surface.mesh)[0];
  EXPECT_EQ(encoded.minimum, 2);
  EXPECT_EQ(encoded.maximum, 5);
  EXPECT_EQ(encoded.levels[1], 65535);
}

TEST(view_payload, an_axis_without_samples_spans_the_mesh) {
  const Quantiser quantiser = quantiser_of(Axis{}, -2, 3);
  EXPECT_EQ(quantiser.level(-2), 0);
  EXPECT_EQ(quantiser.level(3), 65535);
  EXPECT_EQ(quantiser.level(99), 65535);
  EXPECT_EQ(quantiser_of(Axis{}, 1, 1).level(1), 0); // no extent
}

// The labels go by what the graph knows of each step; extracting the steps again is the other way to them.
template <int D>
void expect_tracks_of_steps(const Field& field, double isovalue) {
  FieldSteps steps(field);
  const TrackingGraph graph = *track(steps, isovalue);
  const auto surface = *extract(field.view<float, D>(), isovalue);
  const std::vector<std::int32_t> tracks = tracks_of_vertices(surface, graph);
  std::array<std::int64_t, D> dims;
  std::array<std::int64_t, D - 1> space;
  for (int axis = 0; axis < D; ++axis) dims[axis] = field.info.axes[axis].count;
  std::copy_n(dims.begin(), D - 1, space.begin());
  std::size_t compared = 0;
  for (std::int64_t number = 0; number < dims[D - 1]; ++number) {
    const Mesh step = *tracked_surface(graph, *steps.read(number, number + 1), number);
    const auto& expected = std::get<std::vector<std::int32_t>>(step.attributes[0].values);
    for (std::size_t corner = 0; corner < step.simplices.size(); ++corner) {
      const auto ends = grid_edge_ends<D - 1>(space, step.edges[step.simplices[corner]]);
      std::array<std::int64_t, D> upper;
      std::copy_n(ends.upper.begin(), D - 1, upper.begin());
      upper[D - 1] = number;
      const auto* vertex = std::lower_bound(surface.edges.begin(), surface.edges.end(),
                                            grid_edge<D>(dims, upper, ends.direction));
      ASSERT_NE(vertex, surface.edges.end());
      ASSERT_EQ(tracks[static_cast<std::size_t>(vertex - surface.edges.begin())], expected[corner / (D - 1)]);
      ++compared;
    }
  }
  EXPECT_GT(compared, 100u);
  // Between steps: a surface that reaches a step leaves no vertex without a track.
  std::size_t without = 0;
  for (const std::int32_t label : tracks) without += label < 0;
  EXPECT_LT(without, tracks.size() / 10);
}

TEST(view_tracks, those_at_steps_are_those_of_the_steps) {
  SampleOptions options;
  options.dims = {16, 15, 14, 9};
  expect_tracks_of_steps<4>(*make_sample("gaussians", options), 0.5);
  options.dims = {9, 8, 7, 6};
  expect_tracks_of_steps<4>(*make_sample("noise", options), 0.8);
  options.dims = {20, 18, 12};
  options.time = true;
  expect_tracks_of_steps<3>(*make_sample("noise", options), 0.7);
}

TEST(view_tracks, without_edges_there_are_none) {
  Surface surface = blobs();
  surface.mesh.edges = {};
  for (const std::int32_t label : tracks_of_vertices(surface.mesh, {})) ASSERT_EQ(label, -1);
}

class view_page : public testing::Test {
 protected:
  void SetUp() override {
    if (!has_viewer()) GTEST_SKIP() << "built without the viewer";
  }
  TemporaryFolder folder;
};

// A name from a file must never become a part of the page's code.
TEST_F(view_page, names_cannot_end_a_script) {
  const Surface surface = blobs();
  PageOptions options;
  options.axes = surface.axes;
  options.axes[0].unit = "</script><img src=x>";
  options.title = "<b>&amp;";
  options.field_name = "</script><script>alert(1)</script>";
  const auto path = folder / "page.html";
  ASSERT_TRUE(write_page(surface.mesh, options, path));
  const std::string page = content_of(path);
  EXPECT_EQ(page.find("<script>alert"), std::string::npos);
  EXPECT_EQ(page.find("<img src=x>"), std::string::npos);
  EXPECT_NE(page.find("<title>&lt;b>&amp;amp;</title>"), std::string::npos);
}

TEST_F(view_page, the_same_surface_gives_the_same_bytes) {
  const Surface surface = blobs();
  PageOptions options;
  options.axes = surface.axes;
  options.has_time = true;
  ASSERT_TRUE(write_page(surface.mesh, options, folder / "a.html"));
  ASSERT_TRUE(write_page(surface.mesh, options, folder / "b.html"));
  EXPECT_EQ(content_of(folder / "a.html"), content_of(folder / "b.html"));
}

TEST_F(view_page, refers_to_nothing_outside) {
  const Surface surface = blobs();
  ASSERT_TRUE(write_page(surface.mesh, {}, folder / "page.html"));
  const std::string page = content_of(folder / "page.html");
  for (const char* outside : {"src=\"http", "href=\"http", "@import", "url(http"})
    EXPECT_EQ(page.find(outside), std::string::npos) << outside;
}

TEST_F(view_page, one_that_would_be_too_large_leaves_nothing) {
  const Surface surface = blobs();
  PageOptions options;
  options.size_limit = 700'000;
  const Status status = write_page(surface.mesh, options, folder / "page.html");
  ASSERT_FALSE(status);
  EXPECT_EQ(status.error().code, Code::invalid_argument);
  EXPECT_NE(status.error().message.find("683.6 KiB"), std::string::npos) << status.error().message;
  EXPECT_TRUE(folder.names().empty());
}

TEST_F(view_page, a_cancelled_one_leaves_nothing) {
  const Surface surface = blobs();
  PageOptions options;
  options.progress = [](double) { return false; };
  const Status status = write_page(surface.mesh, options, folder / "page.html");
  ASSERT_FALSE(status);
  EXPECT_EQ(status.error().code, Code::cancelled);
  EXPECT_TRUE(folder.names().empty());
}

TEST_F(view_page, an_empty_surface_is_a_page_all_the_same) {
  ASSERT_TRUE(write_page(SimplexMesh<4>(), {}, folder / "page.html"));
  EXPECT_NE(content_of(folder / "page.html").find("\"simplices\":0"), std::string::npos);
}

TEST_F(view_page, meshes_it_cannot_show_are_refused) {
  for (const Mesh& mesh : {Mesh(2, 1), Mesh(3, 3), Mesh(4, 2)}) {
    const Status status = write_page(mesh, {}, folder / "page.html");
    ASSERT_FALSE(status);
    EXPECT_EQ(status.error().code, Code::file_unsupported);
  }
}

} // namespace
} // namespace hyperiso
