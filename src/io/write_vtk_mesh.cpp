// .vtu and .vtp. What a mesh is beyond VTK's cells goes into field data and point data under the names of
// vtk_mesh_names.hpp; read_vtk_mesh.cpp takes it from there.

#include "core/text.hpp"
#include "hyperiso/polylines.hpp"
#include "io/encoding.hpp"
#include "io/mesh_formats.hpp"
#include "io/vtk_mesh_names.hpp"
#include "io/vtk_xml.hpp"

#include <algorithm>
#include <array>
#include <limits>
#include <optional>

namespace hyperiso {
namespace {

// `value_at(i)` gives the value i of `count`; they are converted and compressed a piece at a time.
template <class T, class ValueAt>
void write_values(AtomicFile& file, std::uint64_t count, ValueAt value_at) {
  CompressedArrayWriter writer(file, count * sizeof(T));
  std::array<T, 4096> piece;
  for (std::uint64_t start = 0; start < count && !file.failed(); start += piece.size()) {
    const std::uint64_t size = std::min<std::uint64_t>(piece.size(), count - start);
    for (std::uint64_t i = 0; i < size; ++i) piece[i] = static_cast<T>(value_at(start + i));
    writer.append(piece.data(), size * sizeof(T));
  }
  writer.finish();
}

template <class T, class ValueAt>
void write_array(AtomicFile& file, const std::string& name, std::uint64_t tuples, int components,
                 ValueAt value_at) {
  file.write(text("<DataArray type=\"", name_of(vtk_type_of<T>()), "\" Name=\"", xml_escaped(name),
                  "\" NumberOfComponents=\"", components, "\" format=\"binary\">"));
  write_values<T>(file, tuples * static_cast<std::uint64_t>(components), value_at);
  file.write("</DataArray>\n");
}

// Field data: its length is known from no count of points or cells.
template <class T>
void write_field_array(AtomicFile& file, const std::string& name, const std::vector<T>& values) {
  file.write(text("<DataArray type=\"", name_of(vtk_type_of<T>()), "\" Name=\"", name, "\" NumberOfTuples=\"",
                  values.size(), "\" format=\"binary\">"));
  write_values<T>(file, values.size(), [&](std::uint64_t i) { return values[i]; });
  file.write("</DataArray>\n");
}

void write_field_strings(AtomicFile& file, const std::string& name, const std::vector<std::string>& strings) {
  std::string bytes;
  for (const std::string& string : strings) bytes.append(string.c_str(), string.size() + 1);
  file.write(text("<Array type=\"String\" Name=\"", name, "\" NumberOfTuples=\"", strings.size(),
                  "\" format=\"binary\">"));
  write_values<char>(file, bytes.size(), [&](std::uint64_t i) { return bytes[i]; });
  file.write("</Array>\n");
}

template <class Value>
auto of_each_axis(const Mesh& mesh, Value value) {
  std::vector<std::decay_t<decltype(value(Axis{}))>> values;
  for (const Axis& axis : mesh.grid_axes) values.push_back(value(axis));
  return values;
}

void write_field_data(AtomicFile& file, const Mesh& mesh, bool keep_edges) {
  file.write("<FieldData>\n");
  write_field_array<std::int64_t>(file, vtk_names::space_dimension, {mesh.dimension});
  write_field_array<std::int64_t>(file, vtk_names::simplex_dimension, {mesh.simplex_dimension});
  if (mesh.active_cells > 0)
    write_field_array<std::uint64_t>(file, vtk_names::active_cells, {mesh.active_cells});
  if (keep_edges) {
    write_field_array(file, vtk_names::grid_count,
                      of_each_axis(mesh, [](const Axis& axis) { return axis.count; }));
    write_field_array(file, vtk_names::grid_first,
                      of_each_axis(mesh, [](const Axis& axis) { return axis.first; }));
    write_field_array(file, vtk_names::grid_origin,
                      of_each_axis(mesh, [](const Axis& axis) { return axis.origin; }));
    write_field_array(file, vtk_names::grid_spacing,
                      of_each_axis(mesh, [](const Axis& axis) { return axis.spacing; }));
    for (std::size_t axis = 0; axis < mesh.grid_axes.size(); ++axis)
      if (!mesh.grid_axes[axis].coordinates.empty())
        write_field_array(file, vtk_names::grid_coordinates(axis), mesh.grid_axes[axis].coordinates);
    write_field_strings(file, vtk_names::grid_names,
                        of_each_axis(mesh, [](const Axis& axis) { return axis.name; }));
    write_field_strings(file, vtk_names::grid_units,
                        of_each_axis(mesh, [](const Axis& axis) { return axis.unit; }));
  }
  file.write("</FieldData>\n");
}

void write_attributes(AtomicFile& file, const Mesh& mesh, Attribute::Location location) {
  const bool at_vertices = location == Attribute::Location::vertex;
  for (const Attribute& attribute : mesh.attributes) {
    if (attribute.location != location) continue;
    std::visit(
        [&]<class T>(const std::vector<T>& values) {
          write_array<T>(file, attribute.name, at_vertices ? mesh.vertex_count() : mesh.simplex_count(),
                         attribute.components, [&](std::uint64_t i) { return values[i]; });
        },
        attribute.values);
  }
}

void write_point_data(AtomicFile& file, const Mesh& mesh, const std::string& last_axis, bool keep_edges) {
  const bool beyond_points = mesh.dimension > 3;
  const auto D = static_cast<std::uint64_t>(mesh.dimension);
  file.write(beyond_points ? text("<PointData Scalars=\"", xml_escaped(last_axis), "\">\n")
                           : "<PointData>\n");
  if (beyond_points)
    mesh.positions.visit([&]<class Real>(std::span<Real> positions) {
      using T = std::remove_const_t<Real>;
      write_array<T>(file, last_axis, mesh.vertex_count(), 1,
                     [&](std::uint64_t i) { return positions[D * i + D - 1]; });
      write_array<T>(file, vtk_names::coordinates(mesh.dimension), mesh.vertex_count(), mesh.dimension,
                     [&](std::uint64_t i) { return positions[i]; });
    });
  if (keep_edges)
    write_array<GridEdge>(file, vtk_names::grid_edge, mesh.vertex_count(), 1,
                          [&](std::uint64_t i) { return mesh.edges[i]; });
  write_attributes(file, mesh, Attribute::Location::vertex);
  file.write("</PointData>\n<CellData>\n");
  write_attributes(file, mesh, Attribute::Location::simplex);
  file.write("</CellData>\n");
}

void write_points(AtomicFile& file, const Mesh& mesh) {
  file.write("<Points>\n");
  mesh.positions.visit([&]<class Real>(std::span<Real> positions) {
    write_array<std::remove_const_t<Real>>(file, "Points", mesh.vertex_count(), 3, [&](std::uint64_t i) {
      return coordinate_of(positions, mesh.dimension, i / 3, static_cast<int>(i % 3));
    });
  });
  file.write("</Points>\n");
}

std::string name_of_last_axis(const Mesh& mesh, const WriteMeshOptions& options) {
  const bool named = options.axis_names.size() == static_cast<std::size_t>(mesh.dimension) &&
                     !options.axis_names.back().empty();
  return named ? options.axis_names.back() : "t";
}

template <class T>
void write_cell_arrays(AtomicFile& file, const Mesh& mesh) {
  const auto corners = static_cast<std::uint64_t>(mesh.simplex_dimension + 1);
  mesh.simplices.visit([&](auto simplices) {
    write_array<T>(file, "connectivity", simplices.size(), 1, [&](std::uint64_t i) { return simplices[i]; });
  });
  write_array<T>(file, "offsets", mesh.simplex_count(), 1,
                 [&](std::uint64_t i) { return (i + 1) * corners; });
}

// VTK wants both arrays in one type, and has no unsigned ones here.
void write_cells(AtomicFile& file, const Mesh& mesh, const char* element, bool with_types) {
  file.write(text("<", element, ">\n"));
  if (std::max(mesh.vertex_count(), mesh.simplices.size()) <= std::numeric_limits<std::int32_t>::max())
    write_cell_arrays<std::int32_t>(file, mesh);
  else
    write_cell_arrays<std::int64_t>(file, mesh);
  if (with_types)
    write_array<std::uint8_t>(file, "types", mesh.simplex_count(), 1,
                              [&](std::uint64_t) { return vtk_names::cell_type(mesh.simplex_dimension); });
  file.write(text("</", element, ">\n"));
}

// The parts common to both formats; `piece_counts` and `write_all_cells` are what differs.
template <class WriteAllCells>
void write_vtk(AtomicFile& file, const Mesh& mesh, const WriteMeshOptions& options, const char* type,
               const std::string& piece_counts, WriteAllCells write_all_cells) {
  const bool keep_edges =
      options.keep_edges && !mesh.grid_axes.empty() && mesh.edges.size() == mesh.vertex_count();
  file.write(
      text("<?xml version=\"1.0\"?>\n<VTKFile type=\"", type, "\" version=\"1.0\" ",
           "byte_order=\"LittleEndian\" header_type=\"UInt64\" compressor=\"vtkZLibDataCompressor\">\n<",
           type, ">\n"));
  write_field_data(file, mesh, keep_edges);
  file.write(text("<Piece NumberOfPoints=\"", mesh.vertex_count(), "\" ", piece_counts, ">\n"));
  write_point_data(file, mesh, name_of_last_axis(mesh, options), keep_edges);
  write_points(file, mesh);
  write_all_cells();
  file.write(text("</Piece>\n</", type, ">\n</VTKFile>\n"));
}

} // namespace

std::vector<std::string> names_of_point_data(const Mesh& mesh, const WriteMeshOptions& options) {
  if (mesh.dimension < 4) return {vtk_names::grid_edge};
  return {vtk_names::grid_edge, vtk_names::coordinates(mesh.dimension), name_of_last_axis(mesh, options)};
}

void write_vtu(AtomicFile& file, const Mesh& mesh, const WriteMeshOptions& options) {
  write_vtk(file, mesh, options, "UnstructuredGrid", text("NumberOfCells=\"", mesh.simplex_count(), "\""),
            [&] { write_cells(file, mesh, "Cells", true); });
}

namespace {

// The lines that segments join to, unless they have something of their own to tell or branch.
std::optional<std::vector<Polyline>> lines_of(const Mesh& mesh) {
  const bool told_apart = std::ranges::any_of(mesh.attributes, [](const Attribute& attribute) {
    return attribute.location == Attribute::Location::simplex;
  });
  if (mesh.simplex_dimension != 1 || told_apart) return std::nullopt;
  auto lines = polylines(mesh);
  return lines ? std::optional(*std::move(lines)) : std::nullopt;
}

template <class T>
void write_line_arrays(AtomicFile& file, const std::vector<Polyline>& lines) {
  std::vector<T> corners, ends;
  for (const Polyline& line : lines) {
    corners.insert(corners.end(), line.vertices.begin(), line.vertices.end());
    if (line.closed) corners.push_back(static_cast<T>(line.vertices.front()));
    ends.push_back(static_cast<T>(corners.size()));
  }
  write_array<T>(file, "connectivity", corners.size(), 1, [&](std::uint64_t i) { return corners[i]; });
  write_array<T>(file, "offsets", ends.size(), 1, [&](std::uint64_t i) { return ends[i]; });
}

void write_lines(AtomicFile& file, const Mesh& mesh, const std::vector<Polyline>& lines) {
  file.write("<Lines>\n");
  if (mesh.vertex_count() + lines.size() <= std::numeric_limits<std::int32_t>::max())
    write_line_arrays<std::int32_t>(file, lines);
  else
    write_line_arrays<std::int64_t>(file, lines);
  file.write("</Lines>\n");
}

} // namespace

void write_vtp(AtomicFile& file, const Mesh& mesh, const WriteMeshOptions& options) {
  if (const auto lines = lines_of(mesh))
    return write_vtk(file, mesh, options, "PolyData",
                     text("NumberOfVerts=\"0\" NumberOfLines=\"", lines->size(),
                          "\" NumberOfStrips=\"0\" NumberOfPolys=\"0\""),
                     [&] { write_lines(file, mesh, *lines); });
  const bool segments = mesh.simplex_dimension == 1;
  const auto counts =
      text("NumberOfVerts=\"0\" NumberOfLines=\"", segments ? mesh.simplex_count() : 0,
           "\" NumberOfStrips=\"0\" NumberOfPolys=\"", segments ? 0 : mesh.simplex_count(), "\"");
  write_vtk(file, mesh, options, "PolyData", counts,
            [&] { write_cells(file, mesh, segments ? "Lines" : "Polys", false); });
}

} // namespace hyperiso
