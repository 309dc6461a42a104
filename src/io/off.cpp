#include "io/text_mesh.hpp"

namespace hyperiso {
namespace {

// The next line that holds more than a comment.
std::string_view next_content(std::string_view& rest) {
  while (!rest.empty()) {
    const std::string_view line = next_line(rest);
    if (const auto content = trimmed(line.substr(0, line.find('#'))); !content.empty()) return content;
  }
  return {};
}

} // namespace

void write_off(AtomicFile& file, const Mesh& mesh) {
  file.write(text("OFF\n", mesh.vertex_count(), " ", mesh.simplex_count(), " 0\n"));
  visit_arrays(mesh, [&](auto positions, auto simplices) {
    write_points(file, positions, mesh.dimension, "");
    write_simplices(file, simplices, 3, "3 ", 0);
  });
}

// OFF, then the numbers of vertices, faces and edges, on the same line or the next; a line for each vertex
// and each face, which may go on with a colour.
Result<Mesh> read_off(std::string_view rest, const std::string& name) {
  const auto malformed = [&](const auto&... pieces) {
    return Error{Code::file_malformed, text(name, ": ", pieces...)};
  };
  std::string_view line = next_content(rest);
  if (next_word(line, is_space) != "OFF")
    return Error{Code::file_unsupported,
                 text(name, ": does not begin with OFF; hyperiso reads text OFF files of "
                            "positions, without normals or further coordinates")};
  if (trimmed(line).empty()) line = next_content(rest);
  const auto vertices = number_from<std::uint64_t>(next_word(line, is_space));
  const auto faces = number_from<std::uint64_t>(next_word(line, is_space));
  if (!vertices || !faces) return malformed("has no numbers of vertices and faces after OFF");

  std::vector<double> positions;
  for (std::uint64_t vertex = 0; vertex < *vertices; ++vertex)
    if (line = next_content(rest); !read_point(line, positions))
      return malformed("vertex ", vertex, " of ", *vertices, " is missing or not three numbers");
  std::vector<std::uint64_t> corners;
  for (std::uint64_t face = 0; face < *faces; ++face) {
    line = next_content(rest);
    const auto count = number_from<std::uint64_t>(next_word(line, is_space));
    if (!count) return malformed("face ", face, " of ", *faces, " is missing or no list of vertices");
    if (*count != 3)
      return Error{Code::file_unsupported,
                   text(name, ": face ", face, " has ", *count, " corners; triangulate the faces first")};
    for (int i = 0; i < 3; ++i) {
      const auto corner = number_from<std::uint64_t>(next_word(line, is_space));
      if (!corner) return malformed("face ", face, " does not list three vertices");
      corners.push_back(*corner);
    }
  }
  return mesh_of_text(2, positions, corners, name);
}

} // namespace hyperiso
