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
#include <map>
#include <utility>

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
TEST(PagePayload, gives_back_every_simplex_with_its_orientation) {
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
TEST(PagePayload, several_blocks_share_vertices) {
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
TEST(PagePayload, samples_of_even_axes_fall_on_whole_levels) {
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
TEST(PagePayload, a_chunk_lies_in_one_step_of_time_or_where_two_meet) {
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

TEST(PagePayload, attributes_keep_their_values_per_vertex) {
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
TEST(PagePayload, attributes_that_are_not_finite_leave_the_range_alone) {
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

TEST(PagePayload, an_axis_without_samples_spans_the_mesh) {
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

TEST(PageTracks, those_at_steps_are_those_of_the_steps) {
  SampleOptions options;
  options.dims = {16, 15, 14, 9};
  expect_tracks_of_steps<4>(*make_sample("gaussians", options), 0.5);
  options.dims = {9, 8, 7, 6};
  expect_tracks_of_steps<4>(*make_sample("noise", options), 0.8);
  options.dims = {20, 18, 12};
  options.time = true;
  expect_tracks_of_steps<3>(*make_sample("noise", options), 0.7);
}

// A field by a function of the place, time last: -1 to 1 along each axis of space, 0 to 1 in time.
template <class Function>
Field field_of(std::vector<std::int64_t> dims, Function&& function) {
  FieldInfo info;
  const std::size_t time = dims.size() - 1;
  for (std::size_t k = 0; k <= time; ++k) {
    const double low = k == time ? 0 : -1;
    info.axes.push_back(
        {.count = dims[k], .origin = low, .spacing = (1 - low) / static_cast<double>(dims[k] - 1)});
  }
  info.has_time = true;
  const NewField made = *allocate_field(info);
  auto* sample = reinterpret_cast<float*>(made.samples);
  std::vector<std::int64_t> index(dims.size(), 0);
  for (bool more = true; more;) {
    std::vector<double> place;
    for (std::size_t k = 0; k <= time; ++k) place.push_back(info.axes[k].coordinate(index[k]));
    *sample++ = static_cast<float>(function(place));
    std::size_t k = 0;
    while (k <= time && ++index[k] == dims[k]) index[k++] = 0;
    more = k <= time;
  }
  return made.field;
}

std::vector<std::int32_t> tracks_of_regions(const Field& field, double isovalue, Method method,
                                            const SimplexMesh<4>& surface) {
  FieldSteps steps(field);
  TrackOptions options;
  options.extraction.method = method;
  options.tracked = Tracked::region;
  TrackingGraph graph = *track(steps, isovalue, options);
  EXPECT_TRUE(use_boundary_pieces(graph, steps, options));
  return tracks_of_vertices(surface, graph);
}

// The two surfaces of a shell bound one region; a ball in its middle is another.
TEST(PageTracks, walls_of_a_cavity_go_by_the_region_around_it) {
  const Field shell = field_of({17, 17, 17, 3}, [](const std::vector<double>& at) {
    const double radius = std::hypot(at[0], at[1], at[2]) - 0.05 * at[3];
    return std::max(0.2 - std::abs(radius - 0.65), 0.2 - radius);
  });
  for (const Method method : {Method::hull, Method::simplicial}) {
    ExtractOptions extraction;
    extraction.method = method;
    const auto surface = *extract(shell.view<float, 4>(), 0.05, extraction);
    const auto tracks = tracks_of_regions(shell, 0.05, method, surface);
    std::array<std::int32_t, 3> found{-2, -2, -2}; // ball, inner wall, outer wall
    for (std::size_t vertex = 0; vertex < tracks.size(); ++vertex) {
      const auto at = [&](std::size_t axis) { return surface.positions[4 * vertex + axis]; };
      const double radius = std::hypot(at(0), at(1), at(2)) - 0.05 * at(3);
      std::int32_t& track = found[radius < 0.3 ? 0 : radius < 0.65 ? 1 : 2];
      if (track == -2) track = tracks[vertex];
      ASSERT_EQ(track, tracks[vertex]) << radius;
    }
    EXPECT_EQ(found[1], found[2]);
    EXPECT_NE(found[0], found[1]);
    EXPECT_GE(std::min(found[0], found[1]), 0);
  }
}

// What hangs together at a step, found by search among the samples: `hull` joins all that is inside of a
// cell.
class InsideOfStep {
 public:
  InsideOfStep(const Field& field, std::int64_t step, double isovalue) {
    const auto view = field.view<float, 4>();
    for (int axis = 0; axis < 3; ++axis) dims_[axis] = view.dims()[axis];
    body_.assign(static_cast<std::size_t>(dims_[0] * dims_[1] * dims_[2]), -1);
    const auto inside = [&](const Sample& at) { return view.at({at[0], at[1], at[2], step}) >= isovalue; };
    for (std::size_t first = 0; first < body_.size(); ++first) {
      if (body_[first] >= 0 || !inside(sample(first))) continue;
      const auto body = static_cast<std::int32_t>(first);
      std::vector<std::size_t> next{first};
      body_[first] = body;
      while (!next.empty()) {
        const Sample from = sample(next.back());
        next.pop_back();
        for (int way = 0; way < 27; ++way) {
          const Sample to{from[0] + way % 3 - 1, from[1] + way / 3 % 3 - 1, from[2] + way / 9 - 1};
          bool is_there = true;
          for (int axis = 0; axis < 3; ++axis) is_there &= to[axis] >= 0 && to[axis] < dims_[axis];
          if (!is_there || !inside(to) || body_[number(to)] >= 0) continue;
          body_[number(to)] = body;
          next.push_back(number(to));
        }
      }
    }
  }

  using Sample = std::array<std::int64_t, 3>;
  std::int32_t body(const Sample& at) const { return body_[number(at)]; } // -1: outside

 private:
  std::size_t number(const Sample& at) const {
    return static_cast<std::size_t>((at[2] * dims_[1] + at[1]) * dims_[0] + at[0]);
  }
  Sample sample(std::size_t number) const {
    const auto at = static_cast<std::int64_t>(number);
    return {at % dims_[0], at / dims_[0] % dims_[1], at / dims_[0] / dims_[1]};
  }

  Sample dims_{};
  std::vector<std::int32_t> body_;
};

TEST(PageTracks, those_of_regions_are_those_of_what_hangs_together_inside) {
  SampleOptions options;
  options.dims = {11, 10, 9, 5};
  const Field field = *make_sample("noise", options);
  for (const double isovalue : {0.6, 0.9}) {
    const auto surface = *extract(field.view<float, 4>(), isovalue);
    const auto tracks = tracks_of_regions(field, isovalue, Method::hull, surface);
    std::array<std::int64_t, 4> dims;
    for (int axis = 0; axis < 4; ++axis) dims[axis] = field.info.axes[axis].count;
    std::vector<InsideOfStep> steps;
    for (std::int64_t step = 0; step < dims[3]; ++step) steps.emplace_back(field, step, isovalue);
    std::map<std::pair<std::int64_t, std::int32_t>, std::int32_t> track_of_body, body_of_track;
    for (std::size_t vertex = 0; vertex < tracks.size(); ++vertex) {
      const auto ends = grid_edge_ends<4>(dims, surface.edges[vertex]);
      if (ends.direction >> 3 & 1) continue; // between steps
      const std::int64_t step = ends.upper[3];
      const auto body_at = [&](const std::array<std::int64_t, 4>& at) {
        return steps[static_cast<std::size_t>(step)].body({at[0], at[1], at[2]});
      };
      const std::int32_t body = std::max(body_at(ends.lower), body_at(ends.upper));
      ASSERT_EQ(track_of_body.emplace(std::pair{step, body}, tracks[vertex]).first->second, tracks[vertex]);
      ASSERT_EQ(body_of_track.emplace(std::pair{step, tracks[vertex]}, body).first->second, body);
    }
    EXPECT_GT(track_of_body.size(), 5u) << isovalue;
  }
}

TEST(PageTracks, regions_between_two_isovalues_have_no_one_surface) {
  SampleOptions options;
  options.dims = {6, 6, 6, 3};
  FieldSteps steps(*make_sample("gaussians", options));
  TrackOptions tracking;
  tracking.tracked = Tracked::region;
  tracking.upper_isovalue = 0.8;
  TrackingGraph graph = *track(steps, 0.4, tracking);
  const Status status = use_boundary_pieces(graph, steps, tracking);
  ASSERT_FALSE(status);
  EXPECT_EQ(status.error().code, Code::invalid_argument);
}

TEST(PageTracks, without_edges_there_are_none) {
  Surface surface = blobs();
  surface.mesh.edges = {};
  for (const std::int32_t label : tracks_of_vertices(surface.mesh, {})) ASSERT_EQ(label, -1);
}

class WrittenPage : public testing::Test {
 protected:
  void SetUp() override {
    if (!has_viewer()) GTEST_SKIP() << "built without the viewer";
  }
  TemporaryFolder folder;
};

// A name from a file must never become a part of the page's code.
TEST_F(WrittenPage, names_cannot_end_a_script) {
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

TEST_F(WrittenPage, the_same_surface_gives_the_same_bytes) {
  const Surface surface = blobs();
  PageOptions options;
  options.axes = surface.axes;
  options.has_time = true;
  ASSERT_TRUE(write_page(surface.mesh, options, folder / "a.html"));
  ASSERT_TRUE(write_page(surface.mesh, options, folder / "b.html"));
  EXPECT_EQ(content_of(folder / "a.html"), content_of(folder / "b.html"));
}

TEST_F(WrittenPage, refers_to_nothing_outside) {
  const Surface surface = blobs();
  ASSERT_TRUE(write_page(surface.mesh, {}, folder / "page.html"));
  const std::string page = content_of(folder / "page.html");
  for (const char* outside : {"src=\"http", "href=\"http", "@import", "url(http"})
    EXPECT_EQ(page.find(outside), std::string::npos) << outside;
}

TEST_F(WrittenPage, one_that_would_be_too_large_leaves_nothing) {
  const Surface surface = blobs();
  PageOptions options;
  options.size_limit = 700'000;
  const Status status = write_page(surface.mesh, options, folder / "page.html");
  ASSERT_FALSE(status);
  EXPECT_EQ(status.error().code, Code::invalid_argument);
  EXPECT_NE(status.error().message.find("683.6 KiB"), std::string::npos) << status.error().message;
  EXPECT_TRUE(folder.names().empty());
}

TEST_F(WrittenPage, a_cancelled_one_leaves_nothing) {
  const Surface surface = blobs();
  PageOptions options;
  options.progress = [](double) { return false; };
  const Status status = write_page(surface.mesh, options, folder / "page.html");
  ASSERT_FALSE(status);
  EXPECT_EQ(status.error().code, Code::cancelled);
  EXPECT_TRUE(folder.names().empty());
}

TEST_F(WrittenPage, an_empty_surface_is_a_page_all_the_same) {
  ASSERT_TRUE(write_page(SimplexMesh<4>(), {}, folder / "page.html"));
  EXPECT_NE(content_of(folder / "page.html").find("\"simplices\":0"), std::string::npos);
}

TEST_F(WrittenPage, meshes_it_cannot_show_are_refused) {
  for (const Mesh& mesh : {Mesh(2, 1), Mesh(3, 3), Mesh(4, 2)}) {
    const Status status = write_page(mesh, {}, folder / "page.html");
    ASSERT_FALSE(status);
    EXPECT_EQ(status.error().code, Code::file_unsupported);
  }
}

} // namespace
} // namespace hyperiso
