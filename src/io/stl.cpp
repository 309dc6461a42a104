#include "core/text.hpp"
#include "io/mesh_formats.hpp"
#include "io/parse.hpp"
#include "mesh/normals.hpp"

#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <numeric>
#include <vector>

namespace hyperiso {
namespace {

static_assert(std::endian::native == std::endian::little, "binary STL is little endian");

using Point = std::array<double, 3>;

constexpr std::size_t header_bytes = 84; // 80 of text, then the number of facets
constexpr std::size_t facet_bytes = 50;  // normal and corners, 12 floats, then 2 bytes without meaning

// Of length 1, or 0 where the facet has no area.
Point unit_normal(const std::array<Point, 3>& corners) {
  const Point normal = triangle_normal(corners);
  const double length = std::hypot(normal[0], normal[1], normal[2]);
  if (!(length > 0) || !std::isfinite(length)) return {0, 0, 0};
  return {normal[0] / length, normal[1] / length, normal[2] / length};
}

void append(std::string& record, const Point& point) {
  for (const double coordinate : point) {
    const auto stored = static_cast<float>(coordinate);
    record.append(reinterpret_cast<const char*>(&stored), sizeof stored);
  }
}

// Three positions a facet, none shared.
Mesh unwelded(const std::vector<float>& positions) {
  Mesh mesh(3, 2);
  mesh.positions.reset(positions.size(), false);
  if (!positions.empty()) std::memcpy(mesh.positions.data(), positions.data(), mesh.positions.bytes());
  const std::size_t vertices = positions.size() / 3;
  mesh.simplices.reset(vertices, vertices > UINT32_MAX);
  mesh.simplices.visit([](auto simplices) { std::iota(simplices.begin(), simplices.end(), 0); });
  return mesh;
}

std::vector<float> binary_positions(std::string_view content, std::size_t facets) {
  std::vector<float> positions(9 * facets);
  for (std::size_t facet = 0; facet < facets; ++facet)
    std::memcpy(positions.data() + 9 * facet, content.data() + header_bytes + facet_bytes * facet + 12, 36);
  return positions;
}

// solid NAME, then for each facet `facet normal x y z outer loop`, three `vertex x y z`, `endloop endfacet`,
// then endsolid.
Result<std::vector<float>> text_positions(std::string_view rest, const std::string& name) {
  std::vector<float> positions;
  const auto next = [&] { return next_word(rest, is_space); };
  const auto expect = [&](std::initializer_list<std::string_view> words) {
    for (const std::string_view word : words)
      if (lower_case(next()) != word) return false;
    return true;
  };
  const auto numbers = [&](bool keep) {
    for (int axis = 0; axis < 3; ++axis) {
      const auto number = number_from<float>(next());
      if (!number) return false;
      if (keep) positions.push_back(*number);
    }
    return true;
  };
  const auto vertex = [&] { return expect({"vertex"}) && numbers(true); };
  rest.remove_prefix(std::min(rest.find('\n'), rest.size()));
  for (;;) {
    const std::string word = lower_case(next());
    if (word == "endsolid") return positions;
    if (word != "facet" || !expect({"normal"}) || !numbers(false) || !expect({"outer", "loop"}) ||
        !vertex() || !vertex() || !vertex() || !expect({"endloop", "endfacet"}))
      return Error{Code::file_malformed, text(name, ": facet ", positions.size() / 9,
                                              " is not as STL has it, or the file is cut short")};
  }
}

} // namespace

void write_stl(AtomicFile& file, const Mesh& mesh) {
  std::string record = "hyperiso: binary STL";
  record.resize(80, ' ');
  const auto facets = static_cast<std::uint32_t>(mesh.simplex_count());
  record.append(reinterpret_cast<const char*>(&facets), sizeof facets);
  file.write(record);
  visit_arrays(mesh, [&](auto positions, auto simplices) {
    for (std::size_t facet = 0; facet < facets && !file.failed(); ++facet) {
      std::array<Point, 3> corners;
      for (std::size_t corner = 0; corner < 3; ++corner)
        for (int axis = 0; axis < 3; ++axis)
          corners[corner][static_cast<std::size_t>(axis)] =
              coordinate_of(positions, mesh.dimension, simplices[3 * facet + corner], axis);
      record.clear();
      append(record, unit_normal(corners));
      for (const Point& corner : corners) append(record, corner);
      record.append(2, '\0');
      file.write(record);
    }
  });
}

Result<Mesh> read_stl(std::string_view content, const std::string& name) {
  std::uint32_t facets = 0;
  if (content.size() >= header_bytes) std::memcpy(&facets, content.data() + 80, sizeof facets);
  // Binary files may begin with the word solid, too: their size tells.
  if (content.size() >= header_bytes && content.size() == header_bytes + facet_bytes * std::size_t{facets})
    return unwelded(binary_positions(content, facets));
  if (!trimmed(content.substr(0, 80)).starts_with("solid"))
    return Error{Code::file_malformed,
                 text(name, ": neither begins with the word solid, as a text STL does, nor has the ",
                      header_bytes + facet_bytes * std::size_t{facets}, " bytes of a binary STL of ", facets,
                      " facets")};
  auto positions = text_positions(content, name);
  if (!positions) return positions.error();
  return unwelded(*positions);
}

} // namespace hyperiso
