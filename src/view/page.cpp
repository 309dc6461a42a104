#include "hyperiso/view.hpp"

#include "core/text.hpp"
#include "view/lift.hpp"
#include "view/page_parts.hpp"
#include "view/shell.hpp"
#include "view/track_labels.hpp"

#include <new>

namespace hyperiso {
namespace {

Status write_surface(const Mesh& mesh, const PageOptions& options, bool has_levels,
                     const std::filesystem::path& path) {
  Result<PageFile> page = PageFile::create(options, path);
  if (!page) return page.error();
  const Ranges ranges = ranges_of(mesh, options);
  const Payload payload(mesh, ranges.quantisers(), options.has_time && mesh.dimension == 4);
  std::vector<EncodedAttribute> attributes = encode_attributes(mesh);
  if (options.tracking)
    attributes.push_back(encode_labels("track", tracks_of_vertices(mesh, *options.tracking)));

  Result<Json> made =
      metadata_of(mesh.dimension, mesh.simplex_dimension, options, ranges, payload.quantisers(), attributes);
  if (!made) return made.error();
  Json& metadata = *made;
  metadata["levels"] = has_levels;
  metadata["vertices"] = payload.vertex_count();
  metadata["simplices"] = payload.simplex_count();
  metadata["blocks"] = Json::array();
  for (const Payload::Block& block : payload.blocks())
    metadata["blocks"].push_back({{"vertices", block.vertices}, {"simplices", block.simplices}});
  bool fits = page->write_metadata(metadata);
  std::size_t done = 0;
  for (const Payload::Block& block : payload.blocks()) {
    if (!fits) break;
    if (options.progress &&
        !options.progress(static_cast<double>(done++) / static_cast<double>(payload.blocks().size())))
      return Error{Code::cancelled, "cancelled while the page was written"};
    fits = page->write_block(payload.encode(block, attributes));
  }
  if (!fits) return page->too_large(text(mesh.simplex_count(), " simplices"));
  return page->finish();
}

Status write_volume(const Mesh& volume, const PageOptions& options, const std::filesystem::path& path) {
  try {
    const std::optional<Mesh> surface = lifted(volume);
    if (!surface)
      return Error{Code::file_unsupported,
                   text("a page shows an interval volume in R^2 or R^3 whose vertices have the attribute "
                        "`isovalue`, not simplices of dimension ",
                        volume.simplex_dimension, " in R^", volume.dimension, " without it")};
    if (Status status = check_size(surface->simplex_count(), surface->vertex_count()); !status) return status;
    PageOptions lifted_options = options;
    lifted_options.axes.resize(static_cast<std::size_t>(volume.dimension));
    lifted_options.axes.push_back(isovalue_axis(volume));
    lifted_options.has_time = false; // not along the axis that is played
    return write_surface(*surface, lifted_options, true, path);
  } catch (const std::bad_alloc&) {
    return Error{Code::out_of_memory, "not enough memory to write the page"};
  }
}

} // namespace

bool has_viewer() { return !compressed_shell().empty(); }

Status write_page(const Mesh& mesh, const PageOptions& options, const std::filesystem::path& path) {
  if (!has_viewer())
    return Error{Code::file_unsupported,
                 "this build of hyperiso has no viewer; configure it with -D HYPERISO_WITH_VIEWER=ON"};
  if (mesh.simplex_dimension == mesh.dimension) return write_volume(mesh, options, path);
  const bool shown =
      mesh.simplex_dimension == mesh.dimension - 1 && (mesh.dimension == 3 || mesh.dimension == 4);
  if (!shown)
    return Error{
        Code::file_unsupported,
        text("a page shows triangles in R^3, tetrahedra in R^4 and interval volumes in R^2 and R^3, not "
             "simplices of dimension ",
             mesh.simplex_dimension, " in R^", mesh.dimension)};
  if (Status status = check_size(mesh.simplex_count(), mesh.vertex_count()); !status) return status;
  try {
    return write_surface(mesh, options, false, path);
  } catch (const std::bad_alloc&) {
    return Error{Code::out_of_memory, "not enough memory to write the page"};
  }
}

} // namespace hyperiso
