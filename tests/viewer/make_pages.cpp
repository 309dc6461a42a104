// Makes the pages that the viewer's tests open.
//
//   make_viewer_pages FOLDER          the pages of the tests
//   make_viewer_pages FILE.html N     one page of a morphing torus, N samples along each axis of space

#include "hyperiso/extract.hpp"
#include "hyperiso/sample.hpp"
#include "hyperiso/view.hpp"

#include <cstdlib>
#include <filesystem>
#include <iostream>
#include <string>

using namespace hyperiso;

namespace {

template <class T>
T take(Result<T> result) {
  if (result) return *std::move(result);
  std::cerr << result.error().message << '\n';
  std::exit(1);
}

struct Page {
  std::unique_ptr<Mesh> mesh;
  PageOptions options;
};

template <int D>
Page sample_page(const std::string& name, std::vector<std::int64_t> dims, bool time) {
  SampleOptions sample;
  sample.dims = std::move(dims);
  sample.time = time;
  const Field field = take(make_sample(name, sample));
  Page page;
  page.options.axes = field.info.axes;
  for (Axis& axis : page.options.axes) axis.unit = axis.name == "t" ? "s" : "mm";
  page.options.has_time = time;
  page.options.field_name = "density";
  page.options.isovalue = sample_isovalue(name, sample);
  page.options.title = name;
  page.mesh = std::make_unique<SimplexMesh<D>>(take(extract(field.view<float, D>(), *page.options.isovalue)));
  return page;
}

// Two blobs, their tracks by the side they are on, until they merge at 0.6 into the first of them.
Page tracked_page() {
  Page page = sample_page<4>("gaussians", {24, 24, 24, 21}, true);
  std::vector<std::int32_t> track;
  std::vector<float> height;
  for (std::size_t i = 0; i < page.mesh->vertex_count(); ++i) {
    const bool second = page.mesh->positions[4 * i] > 0 && page.mesh->positions[4 * i + 3] < 0.6;
    track.push_back(second ? 2 : 1);
    height.push_back(static_cast<float>(page.mesh->positions[4 * i + 2]));
  }
  page.mesh->attributes.push_back({"track", Attribute::Location::vertex, 1, track});
  page.mesh->attributes.push_back({"height", Attribute::Location::vertex, 1, height});
  page.options.tracking = R"({"steps": 21, "tracks": [
    {"id": 1, "start_time": 0, "end_time": 1, "parents": [], "children": [], "max_volume": 2},
    {"id": 2, "start_time": 0, "end_time": 0.6, "parents": [], "children": [1], "max_volume": 1}],
    "events": [
    {"time": 0, "type": "open_start", "position": [-0.5, 0, 0], "in": [], "out": [1], "delta_euler": 0},
    {"time": 0, "type": "open_start", "position": [0.5, 0, 0], "in": [], "out": [2], "delta_euler": 0},
    {"time": 0.6, "type": "merge", "position": [0, 0, 0], "in": [1, 2], "out": [1], "delta_euler": -2},
    {"time": 0.8, "type": "genus", "position": [0.2, 0.1, 0], "in": [1], "out": [1], "delta_euler": 2},
    {"time": 1, "type": "open_end", "position": [0, 0, 0], "in": [1], "out": [], "delta_euler": 0}]})";
  return page;
}

void write(const Page& page, const std::filesystem::path& path) {
  const Status status = write_page(*page.mesh, page.options, path);
  if (status) return;
  std::cerr << status.error().message << '\n';
  std::exit(1);
}

} // namespace

int main(int count, char** arguments) {
  if (count == 3) {
    const std::int64_t samples = std::atoll(arguments[2]);
    const Page page = sample_page<4>("torus-morph", {samples, samples, samples, samples * 5 / 8}, true);
    write(page, arguments[1]);
    std::cout << page.mesh->simplex_count() << '\n';
    return 0;
  }
  if (count != 2) return std::cerr << "usage: make_viewer_pages FOLDER | FILE.html N\n", 2;
  const std::filesystem::path folder = arguments[1];
  std::filesystem::create_directories(folder);

  Page blobs = sample_page<4>("gaussians", {24, 24, 24, 21}, true);
  blobs.options.notes = {"Every second sample was left out."};
  write(blobs, folder / "blobs.html");
  write(tracked_page(), folder / "tracks.html");
  write(sample_page<3>("gaussians", {40, 40, 21}, true), folder / "spacetime.html");
  write(sample_page<3>("gyroid", {24, 24, 24}, false), folder / "still.html");
  write({std::make_unique<SimplexMesh<4>>(), {}}, folder / "empty.html");
}
