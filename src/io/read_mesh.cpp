#include "core/text.hpp"
#include "io/input_file.hpp"
#include "io/mesh_formats.hpp"
#include "io/parse.hpp"

#include <new>

namespace hyperiso {
namespace {

struct Format {
  const char* suffix;
  Result<Mesh> (*read)(std::string_view content, const std::string& name);
};
constexpr Format formats[] = {{".vtu", read_vtk_mesh}, {".vtp", read_vtk_mesh}, {".ply", read_ply},
                              {".stl", read_stl},      {".obj", read_obj},      {".off", read_off}};

} // namespace

Status set_simplices(Mesh& mesh, std::span<const std::uint64_t> corners, const std::string& name) {
  const std::uint64_t vertices = mesh.vertex_count();
  mesh.simplices.reset(corners.size(), vertices > UINT32_MAX);
  for (std::size_t i = 0; i < corners.size(); ++i) {
    if (corners[i] >= vertices)
      return Error{Code::file_malformed,
                   text(name, ": simplex ", i / static_cast<std::size_t>(mesh.simplex_dimension + 1),
                        " uses a vertex that is not among the ", vertices, " of the file")};
    mesh.simplices.set(i, corners[i]);
  }
  return {};
}

Result<Mesh> read_mesh(const std::filesystem::path& path) {
  try {
    const std::string suffix = lower_case(path.extension().string());
    for (const Format& format : formats)
      if (suffix == format.suffix) {
        const auto file = InputFile::open(path);
        if (!file) return file.error();
        return format.read((*file)->characters(), path.string());
      }
    return Error{Code::file_unsupported,
                 text(path.string(), ": the suffix names no format of meshes; hyperiso "
                                     "reads .vtu, .vtp, .ply, .stl, .obj and .off")};
  } catch (const std::bad_alloc&) {
    return Error{Code::out_of_memory, text("no memory for the mesh in ", path.string())};
  }
}

} // namespace hyperiso
