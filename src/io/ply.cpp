#include "core/text.hpp"
#include "io/mesh_formats.hpp"
#include "io/parse.hpp"
#include "io/vtk_xml.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cstring>
#include <functional>
#include <optional>
#include <set>

namespace hyperiso {
namespace {

// The types of a property, in VtkType's order.
struct TypeNames {
  const char *plain, *sized;
  VtkType type;
};
constexpr TypeNames type_names[] = {
    {"char", "int8", VtkType::i8},      {"uchar", "uint8", VtkType::u8},     {"short", "int16", VtkType::i16},
    {"ushort", "uint16", VtkType::u16}, {"int", "int32", VtkType::i32},      {"uint", "uint32", VtkType::u32},
    {"float", "float32", VtkType::f32}, {"double", "float64", VtkType::f64},
};

std::optional<VtkType> type_named(std::string_view name) {
  for (const TypeNames& names : type_names)
    if (name == names.plain || name == names.sized) return names.type;
  return std::nullopt;
}

const char* plain_name(VtkType type) {
  for (const TypeNames& names : type_names)
    if (type == names.type) return names.plain;
  return "double"; // PLY has no 64-bit integers: exact up to 2^53
}

// ---- writing

template <class T>
void append_bytes(std::string& record, T value) {
  record.append(reinterpret_cast<const char*>(&value), sizeof value);
}

// One number per vertex or per face.
struct Column {
  std::string name;
  VtkType type;
  std::function<void(std::string& record, std::size_t element)> append;
};

// Property names are single words and differ.
std::string property_name(std::string name, std::set<std::string>& taken) {
  std::replace_if(
      name.begin(), name.end(), [](char c) { return c <= ' '; }, '_');
  while (name.empty() || !taken.insert(name).second) name += '_';
  return name;
}

template <class T>
bool all_fit_int(const std::vector<T>& values) {
  return std::all_of(values.begin(), values.end(),
                     [](T value) { return value == static_cast<std::int32_t>(value); });
}

template <class T, class Stored>
Column column_of(const std::vector<T>& values, std::size_t first, std::size_t step) {
  return {{}, vtk_type_of<Stored>(), [&values, first, step](std::string& record, std::size_t element) {
            append_bytes(record, static_cast<Stored>(values[element * step + first]));
          }};
}

// What programs take for the colours of vertices, if it comes in bytes.
template <class T>
bool is_colour(const std::string& name, const std::vector<T>& values) {
  return std::is_integral_v<T> && (name == "red" || name == "green" || name == "blue") &&
         std::ranges::all_of(values, [](T value) { return value >= 0 && value <= 255; });
}

// What programs take for normals is called nx, ny, nz.
bool is_normal(const Attribute& attribute) {
  return attribute.name == normal_attribute && attribute.components == 3;
}

std::vector<Column> columns_of(const Mesh& mesh, Attribute::Location location, std::set<std::string> taken) {
  std::vector<Column> columns;
  for (const Attribute& attribute : mesh.attributes) {
    if (attribute.location != location) continue;
    const auto components = static_cast<std::size_t>(attribute.components);
    for (std::size_t component = 0; component < components; ++component) {
      columns.push_back(std::visit(
          [&]<class T>(const std::vector<T>& values) {
            if (components == 1 && is_colour(attribute.name, values))
              return column_of<T, std::uint8_t>(values, 0, 1);
            if constexpr (std::is_same_v<T, std::int64_t>)
              return all_fit_int(values) ? column_of<T, std::int32_t>(values, component, components)
                                         : column_of<T, double>(values, component, components);
            else
              return column_of<T, T>(values, component, components);
          },
          attribute.values));
      const std::string name = components == 1        ? attribute.name
                               : is_normal(attribute) ? text("n", "xyz"[component])
                                                      : text(attribute.name, "_", component);
      columns.back().name = property_name(name, taken);
    }
  }
  return columns;
}

std::string declarations(const std::vector<Column>& columns) {
  std::string lines;
  for (const Column& column : columns)
    lines += text("property ", plain_name(column.type), " ", column.name, "\n");
  return lines;
}

// ---- reading

struct Property {
  std::string name;
  VtkType type;
  std::optional<VtkType> count_type; // of a list
};

struct Element {
  std::string name;
  std::uint64_t count = 0;
  std::vector<Property> properties;
};

enum class Format { ascii, little_endian, big_endian };

struct Header {
  std::optional<Format> format;
  std::vector<Element> elements;
};

bool add_property(Header& header, const std::vector<std::string_view>& words) {
  if (header.elements.empty()) return false;
  const bool list = words.size() == 5 && words[1] == "list";
  if (!list && words.size() != 3) return false;
  const auto type = type_named(words[words.size() - 2]);
  const auto count_type = list ? type_named(words[2]) : std::nullopt;
  if (!type || (list && !count_type)) return false;
  header.elements.back().properties.push_back({std::string(words.back()), *type, count_type});
  return true;
}

bool add_line(Header& header, const std::vector<std::string_view>& words) {
  if (words.empty() || words[0] == "comment" || words[0] == "obj_info") return true;
  if (words[0] == "property") return add_property(header, words);
  if (words.size() != 3) return false;
  if (words[0] == "element") {
    const auto count = number_from<std::uint64_t>(words[2]);
    if (count) header.elements.push_back({std::string(words[1]), *count, {}});
    return count.has_value();
  }
  if (words[0] != "format" || words[2] != "1.0") return false;
  if (words[1] == "ascii") header.format = Format::ascii;
  if (words[1] == "binary_little_endian") header.format = Format::little_endian;
  if (words[1] == "binary_big_endian") header.format = Format::big_endian;
  return header.format.has_value();
}

// Takes the header off the front of `rest`.
Result<Header> read_header(std::string_view& rest, const std::string& name) {
  const auto malformed = [&](const auto&... pieces) {
    return Error{Code::file_malformed, text(name, ": ", pieces...)};
  };
  if (trimmed(next_line(rest)) != "ply") return malformed("does not begin with the line ply");
  Header header;
  for (;;) {
    if (rest.empty()) return malformed("ends within the header");
    const std::string_view line = trimmed(next_line(rest));
    if (line == "end_header") break;
    if (!add_line(header, split(line)))
      return malformed("the header line ", in_quotes(line), " is not PLY's");
  }
  if (!header.format) return malformed("the header names no format");
  return header;
}

// The numbers after the header, one after the other. All of PLY's types fit a double.
class Body {
 public:
  Body(std::string_view rest, Format format) : rest_(rest), format_(format) {}

  std::optional<double> next(VtkType type) {
    if (format_ == Format::ascii) return number_from<double>(next_word(rest_, is_space));
    return visit_vtk_type(type, [&]<class T>(T value) -> std::optional<double> {
      std::array<char, sizeof(T)> bytes;
      if (rest_.size() < bytes.size()) return std::nullopt;
      std::copy_n(rest_.begin(), bytes.size(), bytes.begin());
      rest_.remove_prefix(bytes.size());
      if ((format_ == Format::big_endian) != (std::endian::native == std::endian::big))
        std::reverse(bytes.begin(), bytes.end());
      std::memcpy(&value, bytes.data(), sizeof value);
      return static_cast<double>(value);
    });
  }
  // False if the rest is too short for so many elements.
  bool can_hold(const Element& element) const {
    std::uint64_t smallest = 0;
    for (const Property& property : element.properties)
      smallest += format_ == Format::ascii ? 1 : size_of(property.count_type.value_or(property.type));
    return element.count == 0 || (smallest > 0 && element.count <= rest_.size() / smallest);
  }

 private:
  std::string_view rest_;
  Format format_;
};

// Numbers of one scalar property, in the attribute type that holds its type.
Attribute attribute_for(const Property& property, Attribute::Location location) {
  Attribute attribute{property.name, location, 1, std::vector<std::int32_t>()};
  if (property.type == VtkType::f32) attribute.values = std::vector<float>();
  if (property.type == VtkType::f64) attribute.values = std::vector<double>();
  if (property.type == VtkType::u32) attribute.values = std::vector<std::int64_t>();
  return attribute;
}

class Reader {
 public:
  Reader(Header header, Body body, const std::string& name)
      : header_(std::move(header)), body_(body), name_(name) {}

  Result<Mesh> read() {
    for (const Element& element : header_.elements) {
      if (!body_.can_hold(element)) return cut_short(element);
      if (auto status = read(element); !status) return status.error();
    }
    if (!has_vertices_) return malformed("has no element vertex with the properties x, y, z");
    if (auto status = set_simplices(mesh_, corners_, name_); !status) return status.error();
    return std::move(mesh_);
  }

 private:
  template <class... Pieces>
  Error malformed(const Pieces&... pieces) const {
    return Error{Code::file_malformed, text(name_, ": ", pieces...)};
  }
  Error cut_short(const Element& element) const {
    return malformed("ends before its ", element.count, " elements ", in_quotes(element.name),
                     " do, or holds something else than numbers there");
  }

  Status read(const Element& element) {
    if (element.name == "vertex") return read_vertices(element);
    if (element.name == "face") return read_faces(element);
    for (std::uint64_t i = 0; i < element.count; ++i)
      for (const Property& property : element.properties)
        if (!read_property(property, [](double) {})) return cut_short(element);
    return {};
  }

  // Calls `use` with each value of the property.
  template <class Use>
  bool read_property(const Property& property, Use use) {
    std::uint64_t count = 1;
    if (property.count_type) {
      const auto length = body_.next(*property.count_type);
      if (!length || !(*length >= 0 && *length <= UINT32_MAX)) return false;
      count = static_cast<std::uint64_t>(*length);
    }
    for (std::uint64_t i = 0; i < count; ++i) {
      const auto value = body_.next(property.type);
      if (!value) return false;
      use(*value);
    }
    return true;
  }

  // Reads a property into the attribute where it is a scalar; lists are passed over.
  bool read_attribute(const Property& property, Attribute& attribute) {
    return read_property(property, [&](double value) {
      if (property.count_type) return;
      std::visit([&]<class T>(std::vector<T>& values) { values.push_back(static_cast<T>(value)); },
                 attribute.values);
    });
  }

  Status read_vertices(const Element& element) {
    std::array<std::size_t, 3> xyz;
    bool wide = false;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const auto found =
          std::find_if(element.properties.begin(), element.properties.end(), [&](const auto& p) {
            return !p.count_type && p.name == std::string_view("xyz").substr(axis, 1);
          });
      if (found == element.properties.end()) return {}; // reported at the end
      xyz[axis] = static_cast<std::size_t>(found - element.properties.begin());
      wide = wide || found->type != VtkType::f32;
    }
    has_vertices_ = true;
    mesh_.positions.reset(element.count * 3, wide);
    std::vector<Attribute> attributes = attributes_for(element, Attribute::Location::vertex);
    for (std::uint64_t vertex = 0; vertex < element.count; ++vertex)
      for (std::size_t p = 0; p < element.properties.size(); ++p) {
        const auto axis = static_cast<std::size_t>(std::find(xyz.begin(), xyz.end(), p) - xyz.begin());
        const Property& property = element.properties[p];
        if (axis < 3 ? !read_property(property, [&](double v) { mesh_.positions.set(vertex * 3 + axis, v); })
                     : !read_attribute(property, attributes[p]))
          return cut_short(element);
      }
    for (const std::size_t p : xyz) attributes[p].name.clear();
    keep(std::move(attributes), element);
    return {};
  }

  Status read_faces(const Element& element) {
    std::vector<Attribute> attributes = attributes_for(element, Attribute::Location::simplex);
    for (std::uint64_t face = 0; face < element.count; ++face)
      for (std::size_t p = 0; p < element.properties.size(); ++p) {
        const Property& property = element.properties[p];
        const bool is_corners =
            property.count_type && (property.name == "vertex_indices" || property.name == "vertex_index");
        if (!is_corners) {
          if (!read_attribute(property, attributes[p])) return cut_short(element);
          continue;
        }
        if (!read_property(property, [&](double v) {
              corners_.push_back(v >= 0 && v <= UINT32_MAX ? static_cast<std::uint64_t>(v) : UINT64_MAX);
            }))
          return cut_short(element);
        if (corners_.size() != 3 * (face + 1))
          return Error{Code::file_unsupported,
                       text(name_, ": face ", face, " is not a triangle; triangulate the faces first")};
      }
    keep(std::move(attributes), element);
    return {};
  }

  static std::vector<Attribute> attributes_for(const Element& element, Attribute::Location location) {
    std::vector<Attribute> attributes;
    for (const Property& property : element.properties)
      attributes.push_back(attribute_for(property, location));
    return attributes;
  }

  // The scalars among them; positions have lost their names.
  void keep(std::vector<Attribute> attributes, const Element& element) {
    for (std::size_t p = 0; p < attributes.size(); ++p)
      if (!element.properties[p].count_type && !attributes[p].name.empty())
        mesh_.attributes.push_back(std::move(attributes[p]));
  }

  Header header_;
  Body body_;
  std::string name_;
  Mesh mesh_{3, 2};
  bool has_vertices_ = false;
  std::vector<std::uint64_t> corners_;
};

} // namespace

void write_ply(AtomicFile& file, const Mesh& mesh) {
  const auto vertex_columns = columns_of(mesh, Attribute::Location::vertex, {"x", "y", "z"});
  const auto face_columns = columns_of(mesh, Attribute::Location::simplex, {"vertex_indices"});
  const char* real = mesh.positions.wide() ? "double" : "float";
  file.write(text("ply\nformat binary_little_endian 1.0\ncomment written by hyperiso\nelement vertex ",
                  mesh.vertex_count(), "\nproperty ", real, " x\nproperty ", real, " y\nproperty ", real,
                  " z\n", declarations(vertex_columns), "element face ", mesh.simplex_count(),
                  "\nproperty list uchar int vertex_indices\n", declarations(face_columns), "end_header\n"));
  std::string record;
  visit_arrays(mesh, [&](auto positions, auto simplices) {
    for (std::size_t vertex = 0; vertex < mesh.vertex_count() && !file.failed(); ++vertex) {
      record.clear();
      for (int axis = 0; axis < 3; ++axis)
        append_bytes(record, coordinate_of(positions, mesh.dimension, vertex, axis));
      for (const Column& column : vertex_columns) column.append(record, vertex);
      file.write(record);
    }
    for (std::size_t face = 0; face < mesh.simplex_count() && !file.failed(); ++face) {
      record.assign(1, 3);
      for (std::size_t corner = 0; corner < 3; ++corner)
        append_bytes(record, static_cast<std::int32_t>(simplices[3 * face + corner]));
      for (const Column& column : face_columns) column.append(record, face);
      file.write(record);
    }
  });
}

Result<Mesh> read_ply(std::string_view content, const std::string& name) {
  auto header = read_header(content, name);
  if (!header) return header.error();
  const Format format = *header->format;
  return Reader(*std::move(header), Body(content, format), name).read();
}

} // namespace hyperiso
