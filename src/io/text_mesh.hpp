#pragma once
// What the text formats of meshes, OBJ and OFF, have in common.

#include "core/text.hpp"
#include "io/mesh_formats.hpp"
#include "io/parse.hpp"

#include <algorithm>
#include <vector>

namespace hyperiso {

// Writes a line for each vertex: `prefix`, then its three coordinates.
template <class Positions>
void write_points(AtomicFile& file, Positions positions, int dimension, std::string_view prefix) {
  std::string line;
  for (std::size_t vertex = 0; vertex < positions.size() / static_cast<std::size_t>(dimension); ++vertex) {
    if (file.failed()) return;
    line = prefix;
    for (int axis = 0; axis < 3; ++axis) {
      append_number(line, coordinate_of(positions, dimension, vertex, axis));
      line += axis < 2 ? ' ' : '\n';
    }
    file.write(line);
  }
}

// Writes a line for each simplex: `prefix`, then its corners, counted from `first`.
template <class Simplices>
void write_simplices(AtomicFile& file, Simplices simplices, std::size_t corners, std::string_view prefix,
                     std::uint64_t first) {
  std::string line;
  for (std::size_t start = 0; start < simplices.size() && !file.failed(); start += corners) {
    line = prefix;
    for (std::size_t corner = 0; corner < corners; ++corner) {
      append_number(line, simplices[start + corner] + first);
      line += corner + 1 < corners ? ' ' : '\n';
    }
    file.write(line);
  }
}

// Takes three numbers off the front of `rest` and adds them to `positions`; false if they are not there.
inline bool read_point(std::string_view& rest, std::vector<double>& positions) {
  for (int axis = 0; axis < 3; ++axis) {
    const auto number = number_from<double>(next_word(rest, is_space));
    if (!number) return false;
    positions.push_back(*number);
  }
  return true;
}

// A mesh in R^3. Text does not say how precise its numbers are: positions are f64. Errors of set_simplices.
inline Result<Mesh> mesh_of_text(int simplex_dimension, const std::vector<double>& positions,
                                 const std::vector<std::uint64_t>& corners, const std::string& name) {
  Mesh mesh(3, simplex_dimension);
  mesh.positions.reset(positions.size(), true);
  std::copy(positions.begin(), positions.end(), static_cast<double*>(mesh.positions.data()));
  if (auto status = set_simplices(mesh, corners, name); !status) return status.error();
  return mesh;
}

} // namespace hyperiso
