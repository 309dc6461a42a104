#include "io/text_mesh.hpp"

namespace hyperiso {
namespace {

// The vertex number in `word`, which may go on with /texture/normal: counted from 1, or from the last vertex
// backwards if negative. Counted from 0 here; too large if there is no such vertex.
std::optional<std::uint64_t> corner_from(std::string_view word, std::uint64_t vertices) {
  const auto number = number_from<std::int64_t>(word.substr(0, word.find('/')));
  if (!number || *number == 0) return std::nullopt;
  if (*number > 0) return static_cast<std::uint64_t>(*number) - 1;
  return vertices + static_cast<std::uint64_t>(*number);
}

} // namespace

void write_obj(AtomicFile& file, const Mesh& mesh) {
  file.write("# written by hyperiso\n");
  visit_arrays(mesh, [&](auto positions, auto simplices) {
    write_points(file, positions, mesh.dimension, "v ");
    const auto corners = static_cast<std::size_t>(mesh.simplex_dimension + 1);
    write_simplices(file, simplices, corners, corners == 2 ? "l " : "f ", 1);
  });
}

Result<Mesh> read_obj(std::string_view rest, const std::string& name) {
  std::vector<double> positions;
  std::vector<std::uint64_t> corners;
  int simplex_dimension = 0; // not known yet
  bool only_comments = true; // an empty mesh; else text without vertices is something else than OBJ
  for (std::uint64_t number = 1; !rest.empty(); ++number) {
    std::string_view line = next_line(rest);
    const auto problem = [&](Code code, const char* what) {
      return Error{code, text(name, ": line ", number, ": ", in_quotes(line), " ", what)};
    };
    std::string_view words = line;
    const std::string_view kind = next_word(words, is_space);
    only_comments = only_comments && (kind.empty() || kind.starts_with('#'));
    if (kind == "v" && !read_point(words, positions))
      return problem(Code::file_malformed, "is no vertex with three numbers");
    if (kind != "f" && kind != "l") continue;
    const int dimension = kind == "f" ? 2 : 1;
    const auto list = split(words);
    if (list.size() != static_cast<std::size_t>(dimension) + 1)
      return problem(Code::file_unsupported,
                     "is neither a triangle nor a segment; triangulate the faces first");
    if (simplex_dimension != 0 && simplex_dimension != dimension)
      return problem(Code::file_unsupported, "mixes segments and triangles; keep one kind");
    simplex_dimension = dimension;
    for (const std::string_view word : list) {
      const auto corner = corner_from(word, positions.size() / 3);
      if (!corner) return problem(Code::file_malformed, "names a vertex by something else than its number");
      corners.push_back(*corner);
    }
  }
  if (positions.empty() && !only_comments)
    return Error{Code::file_malformed, text(name, ": holds no vertex: not an OBJ file")};
  return mesh_of_text(simplex_dimension == 1 ? 1 : 2, positions, corners, name);
}

} // namespace hyperiso
