// Makes the pages that the viewer's tests open.
//
//   make_viewer_pages FOLDER          the pages of the tests
//   make_viewer_pages FILE.html N     one page of a morphing torus, N samples along each axis of space; of
//                                     samples if FILE ends in _band or _field

#include "hyperiso/convert.hpp"
#include "hyperiso/extract.hpp"
#include "hyperiso/interval.hpp"
#include "hyperiso/sample.hpp"
#include "hyperiso/view.hpp"

#include <cmath>
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

// Two blobs and their tracks.
struct TrackedPage {
  Page page;
  TrackingGraph graph;
};

template <int D>
TrackedPage tracked_page(std::vector<std::int64_t> dims) {
  TrackedPage tracked{sample_page<D>("gaussians", dims, true), {}};
  SampleOptions sample;
  sample.dims = std::move(dims);
  sample.time = true;
  FieldSteps steps(take(make_sample("gaussians", sample)));
  tracked.graph = take(track(steps, *tracked.page.options.isovalue));
  return tracked;
}

// With the height as an attribute.
TrackedPage tracked_page_with_height() {
  TrackedPage tracked = tracked_page<4>({24, 24, 24, 21});
  const Mesh& mesh = *tracked.page.mesh;
  std::vector<float> height;
  for (std::size_t i = 0; i < mesh.vertex_count(); ++i)
    height.push_back(static_cast<float>(mesh.positions[4 * i + 2]));
  tracked.page.mesh->attributes.push_back({"height", Attribute::Location::vertex, 1, height});
  return tracked;
}

void write(const Page& page, const std::filesystem::path& path) {
  const Status status = write_page(*page.mesh, page.options, path);
  if (status) return;
  std::cerr << status.error().message << '\n';
  std::exit(1);
}

// The balls of radius 1 - isovalue for the isovalues from 0.2 to 0.6, with a level at 0.4.
Page levels_page() {
  FieldInfo info;
  for (const char* name : {"x", "y", "z"})
    info.axes.push_back({.count = 33, .origin = -1, .spacing = 2.0 / 32, .name = name, .unit = "mm"});
  const NewField made = take(allocate_field(info));
  const FieldView<const float, 3> view = made.field.view<float, 3>();
  auto* sample = reinterpret_cast<float*>(made.samples);
  for (std::int64_t z = 0; z < 33; ++z)
    for (std::int64_t y = 0; y < 33; ++y)
      for (std::int64_t x = 0; x < 33; ++x)
        *sample++ = static_cast<float>(1 - std::hypot(info.axes[0].coordinate(x), info.axes[1].coordinate(y),
                                                      info.axes[2].coordinate(z)));
  const double levels[] = {0.2, 0.4, 0.6};
  Page page;
  page.options.title = "levels";
  page.options.axes = info.axes;
  page.mesh = std::make_unique<VolumeMesh<3>>(take(interval(view, levels)));
  return page;
}

// The blobs in whole numbers, which all kinds of pages keep as they are.
Field exact_blobs() {
  SampleOptions sample;
  sample.dims = {24, 24, 24, 21};
  Field field = take(make_sample("gaussians", sample));
  field.info.name = "density";
  for (Axis& axis : field.info.axes) axis.unit = axis.name == "t" ? "s" : "mm";
  return take(convert(field, {.type = SampleType::u8, .rescale = ConvertOptions::Range{0, 1}})).field;
}

// Of one field, its tracks and a moving world: a page of each kind.
void write_kinds(const Field& field, double isovalue, const std::string& name,
                 const std::filesystem::path& folder) {
  FieldSteps steps(field);
  const TrackingGraph graph = take(track(steps, isovalue));
  FieldPageOptions options;
  options.title = name;
  options.tracking = &graph;
  for (const PageSamples samples : {PageSamples::band, PageSamples::all}) {
    options.samples = samples;
    take(write_field_page(field, isovalue, options,
                          folder / (name + (samples == PageSamples::all ? "_field.html" : "_band.html"))));
  }
  Page page;
  static_cast<PageOptions&>(options).title = name;
  page.options = options;
  page.options.axes = field.info.axes;
  page.options.has_time = true;
  page.options.field_name = field.info.name;
  page.options.isovalue = isovalue;
  page.options.world = field.info.world;
  visit_sample_type(field.info.type, [&](auto sample) {
    page.mesh = std::make_unique<SimplexMesh<4>>(take(extract(field.view<decltype(sample), 4>(), isovalue)));
  });
  if (field.info.world) transform(*page.mesh, *field.info.world);
  write(page, folder / (name + "_mesh.html"));
}

} // namespace

int main(int count, char** arguments) {
  if (count == 3) {
    const std::int64_t samples = std::atoll(arguments[2]);
    const std::string path = arguments[1];
    if (path.find("_field") != std::string::npos || path.find("_band") != std::string::npos) {
      SampleOptions sample;
      sample.dims = {samples, samples, samples, samples * 5 / 8};
      const Field field = take(make_sample("torus-morph", sample));
      FieldPageOptions options;
      options.title = "torus-morph";
      options.samples = path.find("_band") != std::string::npos ? PageSamples::band : PageSamples::all;
      const PageSurface surface =
          take(write_field_page(field, sample_isovalue("torus-morph", sample), options, path));
      std::cout << surface.simplices << '\n';
      return 0;
    }
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
  TrackedPage tracked = tracked_page_with_height();
  tracked.page.options.tracking = &tracked.graph;
  write(tracked.page, folder / "tracks.html");
  TrackedPage flat = tracked_page<3>({40, 40, 21});
  flat.page.options.tracking = &flat.graph;
  write(flat.page, folder / "spacetime.html");
  write(sample_page<3>("gyroid", {24, 24, 24}, false), folder / "still.html");
  write({std::make_unique<SimplexMesh<4>>(), {}}, folder / "empty.html");
  write(levels_page(), folder / "levels.html");
  if (!has_field_pages()) return 0;
  write_kinds(exact_blobs(), 127.5, "exact", folder);
  write_kinds(exact_blobs(), 300, "beyond", folder); // no sample reaches it
  Field turned = exact_blobs();                      // by an eighth, and reflected; twice as fast, from 7 on
  turned.info.world = Affine{{1, 1, 0, 0, 1, -1, 0, 0, 0, 0, 2, 0, 0, 0, 0, 0.5}, {10, 20, 30, 7}};
  write_kinds(turned, 127.5, "turned", folder);
  const Field exact = exact_blobs();
  Page other;
  other.options.axes = exact.info.axes;
  other.options.has_time = true;
  other.options.isovalue = 60;
  other.mesh = std::make_unique<SimplexMesh<4>>(take(extract(exact.view<std::uint8_t, 4>(), 60)));
  write(other, folder / "exact_60.html");
  SampleOptions sample;
  sample.dims = {24, 24, 24, 21};
  write_kinds(take(make_sample("gaussians", sample)), 0.5, "rounded", folder);
}
