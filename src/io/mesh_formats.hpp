#pragma once
// The formats of meshes, one file each, with the writer and the reader of the format side by side.
//
// Writers get a mesh that fits the format and contradicts itself nowhere (write_mesh.cpp checks both); what
// fails goes to the AtomicFile. Readers get the content of a file and its name for messages, and trust
// nothing: errors as read_mesh says.

#include "hyperiso/io.hpp"
#include "io/atomic_file.hpp"

#include <charconv>
#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace hyperiso {

void write_vtu(AtomicFile& file, const Mesh& mesh, const WriteMeshOptions& options);
void write_vtp(AtomicFile& file, const Mesh& mesh, const WriteMeshOptions& options);
void write_ply(AtomicFile& file, const Mesh& mesh);
void write_stl(AtomicFile& file, const Mesh& mesh);
void write_obj(AtomicFile& file, const Mesh& mesh);
void write_off(AtomicFile& file, const Mesh& mesh);

// Lines in R^2. Errors: invalid_argument if the segments branch or a coordinate is not finite.
Status write_svg(AtomicFile& file, const Mesh& mesh, const WriteMeshOptions& options);
Status write_geojson(AtomicFile& file, const Mesh& mesh, const WriteMeshOptions& options);

// write_mesh of a mesh that contradicts itself nowhere. `on_flush` as in AtomicFile. Throws std::bad_alloc.
Status write_checked_mesh(const Mesh& mesh, const std::filesystem::path& path,
                          const WriteMeshOptions& options, std::function<void()> on_flush);

// The point data that write_vtu makes of the mesh itself: no attribute may have such a name.
std::vector<std::string> names_of_point_data(const Mesh& mesh, const WriteMeshOptions& options);

Result<Mesh> read_vtk_mesh(std::string_view content, const std::string& name);
Result<Mesh> read_ply(std::string_view content, const std::string& name);
Result<Mesh> read_stl(std::string_view content, const std::string& name);
Result<Mesh> read_obj(std::string_view content, const std::string& name);
Result<Mesh> read_off(std::string_view content, const std::string& name);

// Gives `mesh`, whose positions are set, its simplices.
// Error: file_malformed if one uses a vertex that is not there.
Status set_simplices(Mesh& mesh, std::span<const std::uint64_t> corners, const std::string& name);

// Calls `use` with the positions and the simplices as spans of the types they are stored in.
template <class Use>
void visit_arrays(const Mesh& mesh, Use&& use) {
  mesh.positions.visit(
      [&](auto positions) { mesh.simplices.visit([&](auto simplices) { use(positions, simplices); }); });
}

// Coordinate `axis` of a vertex, for formats whose points have three: 0 where the mesh has none.
template <class Positions>
auto coordinate_of(Positions positions, int dimension, std::size_t vertex, int axis) {
  using Real = typename Positions::value_type;
  return axis < dimension
             ? positions[vertex * static_cast<std::size_t>(dimension) + static_cast<std::size_t>(axis)]
             : Real(0);
}

// Appends a number, floating point in the fewest digits that read back as the same bits.
template <class Number>
void append_number(std::string& line, Number number) {
  char digits[32];
  line.append(digits, std::to_chars(digits, digits + sizeof digits, number).ptr);
}

} // namespace hyperiso
