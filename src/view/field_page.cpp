#include "hyperiso/view.hpp"

#include "core/text.hpp"
#include "view/deflate.hpp"
#include "view/pack_field.hpp"
#include "view/page_parts.hpp"
#include "view/shell.hpp"
#include "view/surface_of_codes.hpp"
#include "view/track_labels.hpp"

#include <algorithm>
#include <new>

namespace hyperiso {
namespace {

constexpr std::size_t block_samples = std::size_t{1} << 21;

std::vector<std::int64_t> layers_of_blocks(const SampleLayers& layers) {
  const auto most =
      std::max<std::int64_t>(1, static_cast<std::int64_t>(block_samples / layers.layer_samples()));
  std::vector<std::int64_t> result;
  for (std::int64_t done = 0; done < layers.layers(); done += most)
    result.push_back(std::min(most, layers.layers() - done));
  return result;
}

// What the worker of the page is told (viewer/src/metadata.ts).
Json samples_json(const Field& field, const SampleLayers& layers, const FieldPageOptions& options) {
  const CodeScale& scale = layers.scale();
  Json axes = Json::array();
  for (const Axis& axis : field.info.axes) {
    Json json = {
        {"count", axis.count}, {"first", axis.first}, {"origin", axis.origin}, {"spacing", axis.spacing}};
    if (!axis.coordinates.empty()) json["coordinates"] = axis.coordinates;
    axes.push_back(std::move(json));
  }
  Json json = {{"band", scale.band},
               {"narrow", scale.narrow},
               {"special", scale.special},
               {"inside", options.inside == Inside::below ? "below" : "above"},
               {"method", static_cast<int>(options.method)},
               {"firstClass", static_cast<int>(layers.first_class())},
               {"origin", scale.origin},
               {"step", scale.step},
               {"isovalue", scale.isovalue},
               {"axes", std::move(axes)},
               {"blocks", layers_of_blocks(layers)}};
  if (field.info.world)
    json["world"] = {{"linear", field.info.world->linear}, {"offset", field.info.world->offset}};
  return json;
}

template <int D>
Result<PageSurface> write_field(const Field& field, const FieldPageOptions& options,
                                const std::filesystem::path& path) {
  const SampleLayers layers =
      pack_field(field, *options.isovalue, options.inside, options.samples == PageSamples::band);
  ExtractOptions extraction;
  extraction.method = options.method;
  extraction.inside = options.inside;
  extraction.threads = options.threads;
  extraction.memory_limit = options.memory_limit;
  Grid<D> grid;
  std::copy(field.info.axes.begin(), field.info.axes.end(), grid.axes.begin());
  SimplexMesh<D> mesh;
  if (Status status = surface_of_codes(layers, grid, layers.scale().isovalue, extraction, mesh); !status)
    return status.error();
  if (Status status = check_size(mesh.simplex_count(), mesh.vertex_count()); !status) return status.error();

  std::vector<EncodedAttribute> attributes;
  if (options.tracking)
    attributes.push_back(encode_labels("track", tracks_of_vertices(mesh, *options.tracking)));
  const Ranges ranges = ranges_of(mesh, options);
  if (options.world) transform(mesh, *options.world);
  const Payload payload(mesh, ranges.quantisers(), options.has_time && D == 4);

  Result<Json> made = metadata_of(D, D - 1, options, ranges, payload.quantisers(), attributes);
  if (!made) return made.error();
  Json& metadata = *made;
  metadata["vertices"] = payload.vertex_count();
  metadata["simplices"] = payload.simplex_count();
  metadata["samples"] = samples_json(field, layers, options);
  Result<PageFile> page = PageFile::create(options, path);
  if (!page) return page.error();
  bool fits = page->write_metadata(metadata) && page->write_block(compressed_core());
  std::int64_t done = 0;
  for (const std::int64_t count : layers_of_blocks(layers)) {
    if (!fits) break;
    if (options.progress &&
        !options.progress(static_cast<double>(done) / static_cast<double>(layers.layers())))
      return Error{Code::cancelled, "cancelled while the page was written"};
    fits = page->write_block(deflated(layers.encode(done, count)));
    done += count;
  }
  if (fits && !attributes.empty()) fits = page->write_block(payload.encode(attributes));
  if (!fits) return page->too_large(text(layers.samples(), " samples"));
  if (Status status = page->finish(); !status) return status.error();
  return PageSurface{payload.vertex_count(), payload.simplex_count()};
}

Status check(const Field& field, double isovalue, const FieldPageOptions& options) {
  if (!has_field_pages())
    return Error{
        Code::file_unsupported,
        "this build of hyperiso has no pages that extract; configure it with -D HYPERISO_WITH_VIEWER=ON "
        "-D HYPERISO_WITH_WASM=ON"};
  if (options.method == Method::barycentric)
    return Error{Code::invalid_argument, "a page extracts by the methods hull, component and simplicial"};
  if (const int dimension = field.info.dimension(); dimension != 3 && dimension != 4)
    return Error{Code::unsupported_dimension,
                 text("a page shows surfaces of fields of 3 or 4 dimensions, not ", dimension)};
  if (!std::isfinite(isovalue))
    return Error{Code::invalid_isovalue, text("the isovalue is ", isovalue, "; it must be a finite number")};
  return {};
}

} // namespace

bool has_field_pages() { return has_viewer() && !compressed_core().empty(); }

Result<PageSurface> write_field_page(const Field& field, double isovalue, const FieldPageOptions& options,
                                     const std::filesystem::path& path) {
  if (Status status = check(field, isovalue, options); !status) return status.error();
  FieldPageOptions complete = options;
  complete.isovalue = isovalue;
  complete.axes = field.info.axes;
  complete.has_time = field.info.has_time;
  complete.field_name = field.info.name;
  complete.world = field.info.world;
  try {
    return field.info.dimension() == 3 ? write_field<3>(field, complete, path)
                                       : write_field<4>(field, complete, path);
  } catch (const std::bad_alloc&) {
    return Error{Code::out_of_memory, "not enough memory to write the page"};
  }
}

} // namespace hyperiso
