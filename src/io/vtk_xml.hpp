#pragma once
// The XML files of VTK (.vti, .vtu, .vtp, ...): their tree, and the arrays in it.

#include "hyperiso/result.hpp"

#include <bit>
#include <cstddef>
#include <cstdint>
#include <pugixml.hpp>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

namespace hyperiso {

enum class VtkType { i8, u8, i16, u16, i32, u32, i64, u64, f32, f64 };

// Calls `use(T{})` with a value of the type's C++ type.
template <class Use>
decltype(auto) visit_vtk_type(VtkType type, Use&& use) {
  switch (type) {
  case VtkType::i8:
    return use(std::int8_t{});
  case VtkType::u8:
    return use(std::uint8_t{});
  case VtkType::i16:
    return use(std::int16_t{});
  case VtkType::u16:
    return use(std::uint16_t{});
  case VtkType::i32:
    return use(std::int32_t{});
  case VtkType::u32:
    return use(std::uint32_t{});
  case VtkType::i64:
    return use(std::int64_t{});
  case VtkType::u64:
    return use(std::uint64_t{});
  case VtkType::f32:
    return use(float{});
  case VtkType::f64:
    break;
  }
  return use(double{});
}

template <class T>
constexpr VtkType vtk_type_of() {
  if constexpr (std::is_floating_point_v<T>) {
    return sizeof(T) == 4 ? VtkType::f32 : VtkType::f64;
  } else {
    constexpr VtkType of_size[][2] = {{VtkType::i8, VtkType::u8},
                                      {VtkType::i16, VtkType::u16},
                                      {VtkType::i32, VtkType::u32},
                                      {VtkType::i64, VtkType::u64}};
    return of_size[std::countr_zero(sizeof(T))][std::is_unsigned_v<T>];
  }
}

std::size_t size_of(VtkType type);
const char* name_of(VtkType type); // "Int8", ..., "Float64"

// One <DataArray> or <Array>, found but not yet decoded. The file has been seen to be able to hold
// `values`: memory for them is at most some 1030 times the size of the file, the most that zlib compresses.
struct VtkArray {
  std::string name;         // may be empty
  VtkType type;             // strings: u8, each string ended by a 0
  std::uint64_t components; // at least 1
  std::uint64_t values;     // a multiple of `components`
  std::uint64_t bytes() const { return values * size_of(type); }

  enum class Encoding { ascii, base64, raw };
  Encoding encoding;
  std::string_view content;                    // encoded, without the header
  std::vector<std::uint64_t> compressed_sizes; // of the blocks, where compressed
  std::uint64_t block_bytes = 0;               // of each block but the last, where compressed
  std::size_t header_bytes = 0; // to pass over, base64 without compression: one text with the data
};

// Reads ascii, inline base64 and appended raw or base64 arrays, with zlib or uncompressed, headers of 32 or
// 64 bits, either byte order. Never allocates more than the file accounts for.
//
// Only the markup goes through the XML parser: the text between the tags, which may be most of a large file,
// and the appended section, which need not be XML, stay where they are until `read` decodes them.
class VtkXml {
 public:
  // `file` is the content of the file called `name` and must outlive the result.
  // Errors: file_malformed (not XML, not VTK's, cut short), file_unsupported.
  static Result<VtkXml> parse(std::string_view file, std::string name);

  // The <VTKFile> element; its attribute `type` says what the file holds. Elements that hold text have a
  // number there instead, for `array` only.
  pugi::xml_node root() const { return document_.child("VTKFile"); }

  // Looks at a <DataArray> or <Array>. Errors: file_malformed; file_unsupported for a compressor other than
  // zlib or a type without an equal here.
  Result<VtkArray> array(pugi::xml_node node) const;

  // Decodes into `destination`, which has room for array.bytes(), in this machine's byte order.
  // Error: file_malformed.
  Status read(const VtkArray& array, void* destination) const;

  // An error about this file: its name, then `what`.
  Error malformed(const std::string& what) const;
  Error unsupported(const std::string& what) const;

 private:
  VtkXml() = default;
  Status check_header();
  Status locate(pugi::xml_node node, VtkArray& array) const;
  Status measure_binary(VtkArray& array) const;

  std::string name_;
  pugi::xml_document document_;
  std::vector<std::string_view> texts_; // the text runs, by the numbers that stand for them
  std::string_view appended_;           // the section behind its `_`
  bool appended_raw_ = false;
  bool big_endian_ = false;
  bool wide_header_ = false;
  std::string compressor_;
};

} // namespace hyperiso
