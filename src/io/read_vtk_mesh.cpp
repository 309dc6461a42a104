// .vtu and .vtp, by whichever program.

#include "core/text.hpp"
#include "io/mesh_formats.hpp"
#include "io/parse.hpp"
#include "io/vtk_mesh_names.hpp"
#include "io/vtk_xml.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <string>
#include <vector>

namespace hyperiso {
namespace {

bool is_valid(const Axis& axis) {
  const auto& c = axis.coordinates;
  if (axis.count < 1) return false;
  // An origin that is NaN stands for an axis that a transform has mixed with others.
  if (c.empty()) return !std::isinf(axis.origin) && std::isfinite(axis.spacing) && axis.spacing != 0;
  const bool finite = std::all_of(c.begin(), c.end(), [](double x) { return std::isfinite(x); });
  const bool rising = std::adjacent_find(c.begin(), c.end(), std::greater_equal()) == c.end();
  const bool falling = std::adjacent_find(c.begin(), c.end(), std::less_equal()) == c.end();
  return c.size() == static_cast<std::size_t>(axis.count) && finite && (rising || falling);
}

template <int D>
bool are_edges_of(const std::vector<Axis>& axes, const std::vector<GridEdge>& edges) {
  std::array<std::int64_t, D> dims;
  std::int64_t numbers = 1 << D; // of edges: beyond every edge of the grid
  for (std::size_t axis = 0; axis < D; ++axis)
    if (__builtin_mul_overflow(numbers, dims[axis] = axes[axis].count, &numbers)) return false;
  for (std::size_t i = 0; i < edges.size(); ++i) {
    if (edges[i] >= static_cast<std::uint64_t>(numbers) || (i > 0 && edges[i] <= edges[i - 1])) return false;
    const auto ends = grid_edge_ends<D>(dims, edges[i]);
    const bool inside =
        std::all_of(ends.lower.begin(), ends.lower.end(), [](auto index) { return index >= 0; });
    if (ends.direction == 0 || !inside) return false;
  }
  return true;
}

bool are_edges_of(const std::vector<Axis>& axes, const std::vector<GridEdge>& edges) {
  switch (axes.size()) {
  case 2:
    return are_edges_of<2>(axes, edges);
  case 3:
    return are_edges_of<3>(axes, edges);
  case 4:
    return are_edges_of<4>(axes, edges);
  case 5: // of a volume in R^4 and its levels
    return are_edges_of<5>(axes, edges);
  default:
    return false;
  }
}

// Reads one file. The first thing found wrong is kept in `status_`, and everything after it comes out empty.
class Reader {
 public:
  explicit Reader(const VtkXml& xml) : xml_(xml) {}

  Result<Mesh> read() {
    const std::string type = xml_.root().attribute("type").as_string();
    if (type != "UnstructuredGrid" && type != "PolyData")
      return xml_.unsupported(
          text("holds VTK's ", in_quotes(type), ", not a mesh (UnstructuredGrid or PolyData)"));
    const auto data = xml_.root().child(type.c_str());
    const auto piece = data.child("Piece");
    if (!piece) return xml_.malformed("has no <Piece>");
    if (piece.next_sibling("Piece")) return xml_.unsupported("has several pieces; merge them first");
    field_data_ = data.child("FieldData");
    vertex_count_ = count(piece, "NumberOfPoints");

    const Cells cells = type == "PolyData" ? polygons(piece) : unstructured(piece);
    Mesh mesh(3, cells.simplex_dimension);
    read_positions(mesh, piece);
    read_simplices(mesh, cells);
    read_provenance(mesh, piece.child("PointData"));
    read_attributes(mesh, piece.child("PointData"), Attribute::Location::vertex, mesh.vertex_count());
    read_attributes(mesh, piece.child("CellData"), Attribute::Location::simplex, mesh.simplex_count());
    if (!status_) return status_.error();
    return mesh;
  }

 private:
  void fail(Error error) {
    if (status_) status_ = std::move(error);
  }

  std::uint64_t count(pugi::xml_node node, const char* attribute) {
    const std::string_view word = node.attribute(attribute).as_string("0");
    const auto number = number_from<std::uint64_t>(word);
    if (!number) fail(xml_.malformed(text(attribute, " is ", in_quotes(word))));
    return number.value_or(0);
  }

  pugi::xml_node array_named(pugi::xml_node parent, const std::string& name) const {
    return parent.find_child_by_attribute("Name", name.c_str());
  }

  // Decodes an array and gives its values to `use`, in a vector of the type they are stored in.
  template <class Use>
  void with_values(const VtkArray& array, Use&& use) {
    visit_vtk_type(array.type, [&]<class Stored>(Stored) {
      if (!status_) return;
      std::vector<Stored> values(array.values);
      status_ = xml_.read(array, values.data());
      if (status_) use(std::move(values));
    });
  }

  template <class T>
  std::vector<T> values_as(const VtkArray& array) {
    std::vector<T> result;
    with_values(array, [&]<class Stored>(std::vector<Stored>&& values) {
      if constexpr (std::is_same_v<T, Stored>)
        result = std::move(values);
      else if (are_whole_numbers_of<T>(array, values))
        result.assign(values.begin(), values.end());
    });
    return result;
  }

  template <class T, class Stored>
  bool are_whole_numbers_of(const VtkArray& array, const std::vector<Stored>& values) {
    if constexpr (std::is_floating_point_v<T>) {
      return true;
    } else if constexpr (std::is_floating_point_v<Stored>) {
      fail(xml_.malformed(text("array \"", array.name, "\" should hold whole numbers")));
      return false;
    } else {
      const auto wrong =
          std::find_if(values.begin(), values.end(), [](Stored v) { return !std::in_range<T>(v); });
      if (wrong != values.end())
        fail(xml_.unsupported(text("array \"", array.name, "\" holds ", +*wrong, ", which does not fit")));
      return wrong == values.end();
    }
  }

  // Empty if there is no such array.
  template <class T>
  std::vector<T> values_named(pugi::xml_node parent, const std::string& name) {
    const auto node = array_named(parent, name);
    if (!node) return {};
    const auto array = xml_.array(node);
    if (array) return values_as<T>(*array);
    fail(array.error());
    return {};
  }

  std::vector<std::string> strings_named(pugi::xml_node parent, const std::string& name) {
    std::vector<std::string> result(1);
    for (const std::uint8_t c : values_named<std::uint8_t>(parent, name))
      if (c == 0)
        result.emplace_back();
      else
        result.back() += static_cast<char>(c);
    result.pop_back();
    return result;
  }

  // The number called `name` in the field data, or 0.
  std::uint64_t number_named(const std::string& name) {
    const auto values = values_named<std::uint64_t>(field_data_, name);
    return values.size() == 1 ? values[0] : 0;
  }

  struct Cells {
    int simplex_dimension;
    std::uint64_t count;
    pugi::xml_node arrays;
    bool may_be_long = false; // lines of more than two points
  };

  // For a mesh without simplices: as its writer noted it down, else a surface.
  int noted_simplex_dimension() {
    const std::uint64_t noted = number_named(vtk_names::simplex_dimension);
    return noted >= 1 && noted <= vtk_names::largest_simplex ? static_cast<int>(noted) : 2;
  }

  Cells unstructured(pugi::xml_node piece) {
    const Cells cells{noted_simplex_dimension(), count(piece, "NumberOfCells"), piece.child("Cells")};
    const auto types = values_named<std::uint8_t>(cells.arrays, "types");
    if (types.size() != cells.count)
      fail(xml_.malformed(text("has ", types.size(), " cell types for ", cells.count, " cells")));
    for (int K = 1; K <= vtk_names::largest_simplex; ++K) {
      if (K > 3 && cells.simplex_dimension != K) continue; // another program's points
      if (!types.empty() &&
          std::count(types.begin(), types.end(), vtk_names::cell_type(K)) == std::ssize(types))
        return {K, cells.count, cells.arrays};
    }
    if (!types.empty())
      fail(xml_.unsupported(
          "holds other cells than segments only, triangles only or tetrahedra only (VTK's cell "
          "types 3, 5, 10); triangulate it first"));
    return cells;
  }

  Cells polygons(pugi::xml_node piece) {
    const std::uint64_t lines = count(piece, "NumberOfLines"), polys = count(piece, "NumberOfPolys");
    if (count(piece, "NumberOfVerts") > 0 || count(piece, "NumberOfStrips") > 0 || (lines > 0 && polys > 0))
      fail(xml_.unsupported("holds other cells than segments only or triangles only (vertices, strips or a "
                            "mixture); triangulate it first"));
    const int K = lines > 0 ? 1 : polys > 0 ? 2 : noted_simplex_dimension();
    return K == 1 ? Cells{1, lines, piece.child("Lines"), !piece.child("CellData").child("DataArray")}
                  : Cells{2, polys, piece.child("Polys")};
  }

  // Lines of any number of points, as segments in their order.
  void read_lines(Mesh& mesh, const Cells& cells, const std::vector<std::uint64_t>& offsets) {
    const auto points = values_named<std::uint64_t>(cells.arrays, "connectivity");
    std::vector<std::uint64_t> corners;
    std::uint64_t begin = 0;
    for (const std::uint64_t end : offsets) {
      if (end < begin || end > points.size())
        return fail(xml_.malformed(text("a line ends at corner ", end, " of ", points.size())));
      for (std::uint64_t i = begin; i + 1 < end; ++i)
        corners.insert(corners.end(), {points[i], points[i + 1]});
      begin = end;
    }
    set_corners(mesh, corners);
  }

  void read_simplices(Mesh& mesh, const Cells& cells) {
    const auto corners = static_cast<std::uint64_t>(cells.simplex_dimension) + 1;
    const auto offsets = values_named<std::uint64_t>(cells.arrays, "offsets");
    if (offsets.size() != cells.count)
      fail(xml_.malformed(text("has ", offsets.size(), " cell offsets for ", cells.count, " cells")));
    const bool segments_only = offsets.empty() || offsets.back() == 2 * cells.count;
    if (status_ && cells.simplex_dimension == 1 && !segments_only && cells.may_be_long)
      return read_lines(mesh, cells, offsets);
    for (std::size_t i = 0; i < offsets.size() && status_; ++i)
      if (offsets[i] != (i + 1) * corners)
        fail(xml_.unsupported(
            text("cell ", i, " does not have ", corners, " corners; triangulate the mesh first")));
    if (const auto node = array_named(cells.arrays, "connectivity")) {
      const auto array = xml_.array(node);
      if (!array) return fail(array.error());
      with_values(*array,
                  [&]<class Stored>(const std::vector<Stored>& values) { set_corners(mesh, values); });
    }
    if (mesh.simplices.size() != cells.count * corners)
      fail(xml_.malformed(text("has ", mesh.simplices.size(), " cell corners where ", cells.count, " times ",
                               corners, " are due")));
  }

  template <class Stored>
  void set_corners(Mesh& mesh, const std::vector<Stored>& values) {
    mesh.simplices.reset(values.size(), vertex_count_ > UINT32_MAX);
    for (std::size_t i = 0; i < values.size(); ++i) {
      if (!(values[i] >= 0 && static_cast<std::uint64_t>(values[i]) < vertex_count_))
        return fail(xml_.malformed(text("a cell uses point ", +values[i], ", which is not among the ",
                                        vertex_count_, " of the file")));
      mesh.simplices.set(i, static_cast<std::uint64_t>(values[i]));
    }
  }

  void read_positions(Mesh& mesh, pugi::xml_node piece) {
    const std::uint64_t noted = number_named(vtk_names::space_dimension);
    const int dimension = noted > 4 && noted <= vtk_names::largest_dimension ? static_cast<int>(noted) : 4;
    const auto all = array_named(piece.child("PointData"), vtk_names::coordinates(dimension));
    if (all && all.attribute("NumberOfComponents").as_int() == dimension) {
      mesh.dimension = dimension;
      return read_positions_of(mesh, all);
    }
    read_positions_of(mesh, piece.child("Points").child("DataArray"));
    if (status_ && is_planar(mesh)) leave_out_z(mesh);
  }

  void read_positions_of(Mesh& mesh, pugi::xml_node node) {
    if (!node && vertex_count_ == 0) return;
    const auto array = xml_.array(node);
    if (!array) return fail(array.error());
    if (array->components != static_cast<std::uint64_t>(mesh.dimension) ||
        array->values / array->components != vertex_count_)
      return fail(xml_.malformed(text("has ", array->values, " coordinates in ", array->components,
                                      " dimensions for ", vertex_count_, " points")));
    if (array->type == VtkType::f32 || array->type == VtkType::f64) {
      mesh.positions.reset(array->values, array->type == VtkType::f64);
      status_ = status_ ? xml_.read(*array, mesh.positions.data()) : status_;
    } else {
      const auto values = values_as<double>(*array);
      mesh.positions.reset(values.size(), true);
      std::copy(values.begin(), values.end(), static_cast<double*>(mesh.positions.data()));
    }
  }

  // VTK's points always have a z. A mesh in the plane is one that its writer noted as such, or segments by
  // another writer.
  bool is_planar(const Mesh& mesh) {
    const std::uint64_t noted = number_named(vtk_names::space_dimension);
    if (mesh.simplex_dimension > 2 || (noted == 0 ? mesh.simplex_dimension != 1 : noted != 2)) return false;
    for (std::size_t i = 2; i < mesh.positions.size(); i += 3)
      if (mesh.positions[i] != 0) return false;
    return true;
  }

  static void leave_out_z(Mesh& mesh) {
    const std::size_t vertices = mesh.vertex_count();
    for (std::size_t vertex = 0; vertex < vertices; ++vertex)
      for (std::size_t axis = 0; axis < 2; ++axis)
        mesh.positions.set(2 * vertex + axis, mesh.positions[3 * vertex + axis]);
    mesh.dimension = 2;
    mesh.positions.resize(2 * vertices);
  }

  // Programs that change a mesh carry along arrays whose meaning they do not know. Where the numbers no
  // longer fit each other, the mesh has no grid edges any more.
  void read_provenance(Mesh& mesh, pugi::xml_node point_data) {
    const bool unchanged =
        number_named(vtk_names::space_dimension) == static_cast<std::uint64_t>(mesh.dimension) &&
        number_named(vtk_names::simplex_dimension) == static_cast<std::uint64_t>(mesh.simplex_dimension);
    if (!unchanged) return;
    mesh.active_cells = number_named(vtk_names::active_cells);
    const bool volume = mesh.simplex_dimension == mesh.dimension; // its grid has an axis of levels besides
    std::vector<Axis> axes = read_axes(static_cast<std::size_t>(mesh.dimension) + (volume ? 1 : 0));
    const auto edges = values_named<GridEdge>(point_data, vtk_names::grid_edge);
    if (axes.empty() || edges.size() != mesh.vertex_count() || !are_edges_of(axes, edges)) return;
    mesh.grid_axes = std::move(axes);
    mesh.edges.assign(edges.begin(), edges.end());
  }

  // None if they do not fit together.
  std::vector<Axis> read_axes(std::size_t dimension) {
    const auto counts = values_named<std::int64_t>(field_data_, vtk_names::grid_count);
    const auto firsts = values_named<std::int64_t>(field_data_, vtk_names::grid_first);
    const auto origins = values_named<double>(field_data_, vtk_names::grid_origin);
    const auto spacings = values_named<double>(field_data_, vtk_names::grid_spacing);
    const auto names = strings_named(field_data_, vtk_names::grid_names);
    const auto units = strings_named(field_data_, vtk_names::grid_units);
    for (const std::size_t size :
         {counts.size(), firsts.size(), origins.size(), spacings.size(), names.size(), units.size()})
      if (size != dimension) return {};
    std::vector<Axis> axes;
    for (std::size_t i = 0; i < dimension; ++i)
      axes.push_back({counts[i], firsts[i], origins[i], spacings[i],
                      values_named<double>(field_data_, vtk_names::grid_coordinates(i)), names[i], units[i]});
    if (!std::all_of(axes.begin(), axes.end(), is_valid)) axes.clear();
    return axes;
  }

  void read_attributes(Mesh& mesh, pugi::xml_node data, Attribute::Location location, std::uint64_t tuples) {
    bool expect_last_coordinate = mesh.dimension > 3 && location == Attribute::Location::vertex;
    for (const auto node : data.children("DataArray")) {
      const std::string name = node.attribute("Name").as_string();
      if (location == Attribute::Location::vertex &&
          (name == vtk_names::grid_edge ||
           (mesh.dimension > 3 && name == vtk_names::coordinates(mesh.dimension))))
        continue;
      const auto array = xml_.array(node);
      if (!array) return fail(array.error());
      if (array->values / array->components != tuples || array->components > INT32_MAX)
        return fail(xml_.malformed(text("array \"", name, "\" has ", array->values, " values where ", tuples,
                                        " times ", array->components, " are due")));
      Attribute attribute{name, location, static_cast<int>(array->components), attribute_values(*array)};
      if (!status_) return;
      if (expect_last_coordinate && is_last_coordinate(mesh, attribute))
        expect_last_coordinate = false; // the array of all coordinates has it
      else
        mesh.attributes.push_back(std::move(attribute));
    }
  }

  // In the narrowest type of attributes that holds the type of the array.
  decltype(Attribute::values) attribute_values(const VtkArray& array) {
    switch (array.type) {
    case VtkType::f32:
      return values_as<float>(array);
    case VtkType::f64:
      return values_as<double>(array);
    case VtkType::i64:
    case VtkType::u64:
    case VtkType::u32:
      return values_as<std::int64_t>(array);
    default:
      return values_as<std::int32_t>(array);
    }
  }

  static bool is_last_coordinate(const Mesh& mesh, const Attribute& attribute) {
    const auto D = static_cast<std::size_t>(mesh.dimension);
    return attribute.components == 1 &&
           std::visit(
               [&]<class T>(const std::vector<T>& values) {
                 if (std::is_integral_v<T>) return false;
                 for (std::size_t i = 0; i < values.size(); ++i)
                   if (static_cast<double>(values[i]) != mesh.positions[i * D + D - 1]) return false;
                 return true;
               },
               attribute.values);
  }

  const VtkXml& xml_;
  Status status_;
  pugi::xml_node field_data_;
  std::uint64_t vertex_count_ = 0;
};

} // namespace

Result<Mesh> read_vtk_mesh(std::string_view content, const std::string& name) {
  const auto xml = VtkXml::parse(content, name);
  if (!xml) return xml.error();
  return Reader(*xml).read();
}

} // namespace hyperiso
