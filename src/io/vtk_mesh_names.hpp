#pragma once
// The names under which .vtu and .vtp files hold what VTK has no place for.

#include <cstddef>
#include <string>

namespace hyperiso::vtk_names {

// Point data.
// All coordinates, from four on; the points themselves hold the first three.
inline std::string coordinates(int dimension) { return dimension == 4 ? "xyzt" : "coordinates"; }
inline const std::string grid_edge = "grid_edge"; // Mesh::edges

// Field data.
inline const std::string space_dimension = "space_dimension";
inline const std::string simplex_dimension = "simplex_dimension";
inline const std::string active_cells = "active_cells";
inline const std::string grid_count = "grid_count"; // Mesh::grid_axes: a number or string for each
inline const std::string grid_first = "grid_first";
inline const std::string grid_origin = "grid_origin";
inline const std::string grid_spacing = "grid_spacing";
inline const std::string grid_names = "grid_names";
inline const std::string grid_units = "grid_units";
inline std::string grid_coordinates(std::size_t axis) { // of the axes that have them
  return "grid_coordinates_" + std::to_string(axis);
}

// VTK's number for segments, triangles and tetrahedra. It has none for larger simplices: they are its "poly
// vertex", a cell of any number of points that are not joined.
constexpr int largest_simplex = 7, largest_dimension = 8;
constexpr int cell_type(int K) { return K == 1 ? 3 : K == 2 ? 5 : K == 3 ? 10 : 2; }

} // namespace hyperiso::vtk_names
