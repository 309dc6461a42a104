#include "core/text.hpp"
#include "io/mesh_formats.hpp"
#include "io/parse.hpp"

#include <algorithm>
#include <limits>
#include <new>
#include <set>

namespace hyperiso {
namespace {

struct Format {
  const char* name;
  const char* holds;
  int simplex_dimension[2]; // smallest and largest
  int largest_dimension;
  std::uint64_t largest_count; // of vertices, and of simplices
  Status (*write)(AtomicFile&, const Mesh&, const WriteMeshOptions&);
};

template <auto write>
Status write_any(AtomicFile& file, const Mesh& mesh, const WriteMeshOptions& options) {
  if constexpr (std::is_invocable_v<decltype(write), AtomicFile&, const Mesh&>)
    write(file, mesh);
  else
    write(file, mesh, options);
  return {};
}

constexpr std::uint64_t any_count = UINT64_MAX;
constexpr std::uint64_t int_count = std::numeric_limits<std::int32_t>::max();

constexpr Format formats[] = {
    {"vtu", "segments to 7-simplices in up to 8 dimensions", {1, 7}, 8, any_count, write_any<write_vtu>},
    {"vtp", "segments and triangles in 2 or 3 dimensions", {1, 2}, 3, any_count, write_any<write_vtp>},
    {"ply", "triangles in 2 or 3 dimensions", {2, 2}, 3, int_count, write_any<write_ply>},
    {"stl", "triangles in 2 or 3 dimensions", {2, 2}, 3, UINT32_MAX, write_any<write_stl>},
    {"obj", "segments and triangles in 2 or 3 dimensions", {1, 2}, 3, any_count, write_any<write_obj>},
    {"off", "triangles in 2 or 3 dimensions", {2, 2}, 3, any_count, write_any<write_off>},
    {"svg", "lines in 2 dimensions", {1, 1}, 2, any_count, write_svg},
    {"geojson", "lines in 2 dimensions", {1, 1}, 2, any_count, write_geojson},
};

// "vtu, vtp, ..." of those that `wanted` takes.
template <class Wanted>
std::string names_of_formats(const Wanted& wanted) {
  std::string names;
  for (const Format& format : formats)
    if (wanted(format)) names += text(names.empty() ? "" : ", ", format.name);
  return names;
}

std::string format_name(const std::filesystem::path& path, const WriteMeshOptions& options) {
  std::string name = options.format.empty() ? path.extension().string() : options.format;
  if (name.starts_with('.')) name.erase(0, 1);
  return lower_case(name);
}

const char* name_of_simplices(int dimension) {
  constexpr const char* names[] = {"points",      "segments",    "triangles",   "tetrahedra",
                                   "4-simplices", "5-simplices", "6-simplices", "7-simplices"};
  return dimension >= 0 && dimension <= 7 ? names[dimension] : "simplices";
}

bool fits(const Format& format, int dimension, int simplex_dimension) {
  return simplex_dimension >= format.simplex_dimension[0] &&
         simplex_dimension <= format.simplex_dimension[1] && dimension >= 2 &&
         dimension <= format.largest_dimension;
}

Error does_not_fit(const Format& format, int dimension, int simplex_dimension,
                   const std::filesystem::path& path) {
  const std::string others =
      names_of_formats([&](const Format& other) { return fits(other, dimension, simplex_dimension); });
  const std::string advice =
      others.empty() ? "no format here does; slice the mesh first" : "formats that do: " + others;
  return Error{Code::file_unsupported,
               text(path.string(), ": ", format.name, " holds ", format.holds, ", not ",
                    name_of_simplices(simplex_dimension), " in ", dimension, " dimensions; ", advice)};
}

Result<const Format*> find_format(int dimension, int simplex_dimension, const std::filesystem::path& path,
                                  const WriteMeshOptions& options) {
  const std::string name = format_name(path, options);
  const auto* format = std::find_if(std::begin(formats), std::end(formats),
                                    [&](const Format& candidate) { return candidate.name == name; });
  if (format == std::end(formats))
    return Error{Code::file_unsupported,
                 text(path.string(), ": ",
                      name.empty() ? "its name has no suffix to tell the format"
                                   : text("\"", name, "\" is no format for meshes here"),
                      "; there are ", names_of_formats([](const Format&) { return true; }))};
  if (!fits(*format, dimension, simplex_dimension))
    return does_not_fit(*format, dimension, simplex_dimension, path);
  return format;
}

// A file that contradicts itself could crash the program that reads it.
Status check(const Mesh& mesh, const WriteMeshOptions& options) {
  const auto wrong = [](const auto&... pieces) { return Error{Code::invalid_argument, text(pieces...)}; };
  const std::size_t vertices = mesh.vertex_count(), simplices = mesh.simplex_count();
  if (mesh.positions.size() != vertices * static_cast<std::size_t>(mesh.dimension) ||
      mesh.simplices.size() != simplices * static_cast<std::size_t>(mesh.simplex_dimension + 1))
    return wrong("the mesh ends within a vertex or a simplex");
  const bool in_range = mesh.simplices.visit([&](auto corners) {
    return std::all_of(corners.begin(), corners.end(), [&](auto vertex) { return vertex < vertices; });
  });
  if (!in_range)
    return wrong("a simplex uses a vertex that the mesh of ", vertices, " vertices does not have");
  if (!mesh.edges.empty() && mesh.edges.size() != vertices)
    return wrong("the mesh has ", mesh.edges.size(), " grid edges for ", vertices, " vertices");
  std::set<std::pair<Attribute::Location, std::string>> names;
  for (const std::string& name : names_of_point_data(mesh, options))
    names.emplace(Attribute::Location::vertex, name);
  for (const Attribute& attribute : mesh.attributes) {
    const std::size_t count = attribute.location == Attribute::Location::vertex ? vertices : simplices;
    const std::size_t values = std::visit([](const auto& v) { return v.size(); }, attribute.values);
    if (attribute.components < 1 || values != count * static_cast<std::size_t>(attribute.components))
      return wrong("attribute \"", attribute.name, "\" has ", values, " values where ", count, " times ",
                   attribute.components, " are due");
    if (!names.emplace(attribute.location, attribute.name).second)
      return wrong("the name of attribute \"", attribute.name, "\" is taken");
  }
  return {};
}

} // namespace

Status write_checked_mesh(const Mesh& mesh, const std::filesystem::path& path,
                          const WriteMeshOptions& options, std::function<void()> on_flush) {
  const auto found = find_format(mesh.dimension, mesh.simplex_dimension, path, options);
  if (!found) return found.error();
  const Format& format = **found;
  if (mesh.vertex_count() > format.largest_count || mesh.simplex_count() > format.largest_count)
    return Error{Code::file_unsupported,
                 text(path.string(), ": ", format.name, " counts to ", format.largest_count,
                      ", the mesh has ", mesh.vertex_count(), " vertices and ", mesh.simplex_count(),
                      " simplices; vtu holds any number")};
  auto file = AtomicFile::create(path);
  if (!file) return file.error();
  file->set_on_flush(std::move(on_flush));
  if (const Status written = format.write(*file, mesh, options); !written)
    return Error{written.error().code, text(path.string(), ": ", written.error().message)};
  file->set_on_flush({});
  return file->commit(options.group);
}

Status write_mesh(const Mesh& mesh, const std::filesystem::path& path, const WriteMeshOptions& options) {
  try {
    const auto found = find_format(mesh.dimension, mesh.simplex_dimension, path, options);
    if (!found) return found.error();
    if (const auto checked = check(mesh, options); !checked) return checked;
    return write_checked_mesh(mesh, path, options, {});
  } catch (const std::bad_alloc&) {
    return no_memory_to_write(path);
  }
}

Status check_mesh_format(int dimension, int simplex_dimension, const std::filesystem::path& path,
                         const WriteMeshOptions& options) {
  if (const auto found = find_format(dimension, simplex_dimension, path, options); !found)
    return found.error();
  return {};
}

} // namespace hyperiso
