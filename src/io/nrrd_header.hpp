#pragma once
// The header of an NRRD file: its fields and what they say of the axes.

#include "hyperiso/field.hpp"
#include "hyperiso/result.hpp"
#include "io/stored_field.hpp"

#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace hyperiso {

// The lines of a header, by name.
struct NrrdHeader {
  std::map<std::string, std::string> fields;     // by their usual spelling, in lower case
  std::map<std::string, std::string> key_values; // key:=value
  std::vector<std::string> data_files;           // the lines after "data file: LIST"
  std::uint64_t end = 0;                         // of the header in the file: where attached data begin

  const std::string* field(const std::string& name) const {
    const auto found = fields.find(name);
    return found == fields.end() ? nullptr : &found->second;
  }
};

// Errors: file_malformed, naming the line.
Result<NrrdHeader> parse_nrrd_header(std::string_view file, const std::filesystem::path& path);

enum class NrrdEncoding { raw, gzip, bzip2, text, hex };

// Where the samples are: `files` data files (0: attached) of equally many samples each.
struct NrrdData {
  NrrdEncoding encoding = NrrdEncoding::raw;
  bool big_endian = false;
  std::int64_t line_skip = 0, byte_skip = 0;

  std::uint64_t files = 0;
  std::vector<std::string> list; // their names, or
  std::string pattern;           // with one %d in it, replaced by first_number + i * number_step
  std::int64_t first_number = 0, number_step = 1;
  std::string file_name(std::uint64_t i) const;
};

struct NrrdContent {
  StoredField field;
  NrrdData data;
};

// Errors: file_malformed; file_unsupported (vectors, 64-bit integers, unknown encodings).
Result<NrrdContent> interpret_nrrd_header(const NrrdHeader& header, const std::filesystem::path& path);

// What the header says of each axis: sizes, names, units, positions, orientation and which axis is time.
// Axes of one sample that hold no position (kinds stub, scalar and the like) are left out.
Status interpret_nrrd_axes(const NrrdHeader& header, const std::filesystem::path& path, StoredField& field);

} // namespace hyperiso
