#include "io/nrrd_header.hpp"

#include "core/text.hpp"
#include "io/parse.hpp"

#include <algorithm>
#include <bit>

namespace hyperiso {
namespace {

Error malformed(const std::filesystem::path& path, std::string_view what) {
  return {Code::file_malformed, text(path.string(), ": ", what)};
}
Error unsupported(const std::filesystem::path& path, std::string_view what) {
  return {Code::file_unsupported, text(path.string(), ": ", what)};
}

// The fields of the format, each with its other spelling.
constexpr std::pair<std::string_view, std::string_view> known_fields[] = {
    {"content", ""},
    {"number", ""},
    {"type", ""},
    {"block size", "blocksize"},
    {"dimension", ""},
    {"space", ""},
    {"space dimension", "spacedimension"},
    {"sizes", ""},
    {"spacings", ""},
    {"thicknesses", ""},
    {"axis mins", "axismins"},
    {"axis maxs", "axismaxs"},
    {"space directions", "spacedirections"},
    {"centers", "centerings"},
    {"kinds", ""},
    {"labels", ""},
    {"units", ""},
    {"min", ""},
    {"max", ""},
    {"old min", "oldmin"},
    {"old max", "oldmax"},
    {"endian", ""},
    {"encoding", ""},
    {"line skip", "lineskip"},
    {"byte skip", "byteskip"},
    {"sample units", "sampleunits"},
    {"space units", "spaceunits"},
    {"space origin", "spaceorigin"},
    {"measurement frame", "measurementframe"},
    {"data file", "datafile"},
};

std::string_view usual_spelling(std::string_view name) {
  for (const auto& [usual, other] : known_fields)
    if (name == usual || (!other.empty() && name == other)) return usual;
  return {};
}

// \n and \\ in keys and values.
std::string unescaped(std::string_view words) {
  std::string result;
  for (std::size_t i = 0; i < words.size(); ++i) {
    const bool escape =
        words[i] == '\\' && i + 1 < words.size() && (words[i + 1] == 'n' || words[i + 1] == '\\');
    if (escape) ++i;
    result += escape && words[i] == 'n' ? '\n' : words[i];
  }
  return result;
}

struct TypeNames {
  std::optional<SampleType> type; // none: a type of the format that hyperiso does not read
  std::vector<std::string_view> names;
};

const std::vector<TypeNames>& types() {
  static const std::vector<TypeNames> all = {
      {SampleType::i8, {"signed char", "int8", "int8_t"}},
      {SampleType::u8, {"uchar", "unsigned char", "uint8", "uint8_t"}},
      {SampleType::i16, {"short", "short int", "signed short", "signed short int", "int16", "int16_t"}},
      {SampleType::u16, {"ushort", "unsigned short", "unsigned short int", "uint16", "uint16_t"}},
      {SampleType::i32, {"int", "signed int", "int32", "int32_t"}},
      {SampleType::u32, {"uint", "unsigned int", "uint32", "uint32_t"}},
      {SampleType::f32, {"float"}},
      {SampleType::f64, {"double"}},
      {std::nullopt,
       {"longlong", "long long", "long long int", "signed long long", "signed long long int", "int64",
        "int64_t", "ulonglong", "unsigned long long", "unsigned long long int", "uint64", "uint64_t",
        "block"}},
  };
  return all;
}

Result<SampleType> interpret_type(const NrrdHeader& header, const std::filesystem::path& path) {
  const std::string* type = header.field("type");
  if (!type) return malformed(path, "the header has no line \"type:\"");
  const std::string name = lower_case(*type);
  for (const TypeNames& candidate : types())
    if (std::find(candidate.names.begin(), candidate.names.end(), name) != candidate.names.end()) {
      if (candidate.type) return *candidate.type;
      return unsupported(path, text("samples of type ", name,
                                    " are not read; convert them to double or a type of at most 32 bits "
                                    "(unu convert -t double)"));
    }
  return malformed(path, text(in_quotes(*type), " is not a type of NRRD"));
}

Result<NrrdEncoding> interpret_encoding(const NrrdHeader& header, const std::filesystem::path& path) {
  const std::string* encoding = header.field("encoding");
  if (!encoding) return malformed(path, "the header has no line \"encoding:\"");
  const std::string name = lower_case(*encoding);
  if (name == "raw") return NrrdEncoding::raw;
  if (name == "gz" || name == "gzip") return NrrdEncoding::gzip;
  if (name == "bz2" || name == "bzip2") return NrrdEncoding::bzip2;
  if (name == "txt" || name == "text" || name == "ascii") return NrrdEncoding::text;
  if (name == "hex") return NrrdEncoding::hex;
  return unsupported(
      path, text("the encoding ", in_quotes(*encoding), " is not read; raw, gzip, bzip2, text and hex are"));
}

Result<bool> interpret_endian(const NrrdHeader& header, bool matters, const std::filesystem::path& path) {
  const std::string* endian = header.field("endian");
  if (!endian) {
    if (matters) return malformed(path, "the header has no line \"endian:\", which its samples need");
    return false;
  }
  const std::string name = lower_case(*endian);
  if (name != "big" && name != "little")
    return malformed(path, text("\"endian:\" is ", in_quotes(*endian), ", neither big nor little"));
  return name == "big";
}

Result<std::int64_t> interpret_skip(const NrrdHeader& header, const std::string& field, std::int64_t lowest,
                                    const std::filesystem::path& path) {
  const std::string* words = header.field(field);
  if (!words) return std::int64_t{0};
  const auto skip = number_from<std::int64_t>(*words);
  if (!skip || *skip < lowest)
    return malformed(path,
                     text("\"", field, ":\" is ", in_quotes(*words), ", not a number of at least ", lowest));
  return *skip;
}

// Position after "%", "%0" and the width of the pattern's one number; 0 if there is none.
std::size_t end_of_number(std::string_view pattern) {
  const std::size_t percent = pattern.find('%');
  if (percent == std::string_view::npos) return 0;
  std::size_t end = percent + 1;
  while (end < pattern.size() && pattern[end] >= '0' && pattern[end] <= '9') ++end;
  return end < pattern.size() && pattern[end] == 'd' ? end + 1 : 0;
}

// Samples of the field from the file's axis `first` on: how many data files there are with axes below it.
Result<std::uint64_t> number_of_files(const std::vector<std::int64_t>& sizes, std::int64_t subdimension,
                                      std::uint64_t named, const std::filesystem::path& path) {
  const auto dimension = static_cast<std::int64_t>(sizes.size());
  if (subdimension < 1 || subdimension > dimension)
    return malformed(path,
                     text("data files of dimension ", subdimension, " in a field of dimension ", dimension));
  if (subdimension == dimension) { // slabs of the last axis
    if (named > 0 && sizes.back() % static_cast<std::int64_t>(named) == 0) return named;
    return malformed(path, text("the size ", sizes.back(), " of the last axis does not divide into ", named,
                                " data files"));
  }
  std::uint64_t files = 1;
  for (auto axis = static_cast<std::size_t>(subdimension); axis < sizes.size(); ++axis)
    files *= static_cast<std::uint64_t>(sizes[axis]); // sizes were checked not to overflow
  if (files == named) return files;
  return malformed(path, text("the sizes need ", files, " data files, but the header names ", named));
}

Status interpret_list(const NrrdHeader& header, const std::vector<std::string_view>& words,
                      const std::vector<std::int64_t>& sizes, const std::filesystem::path& path,
                      NrrdData& data) {
  std::int64_t subdimension = static_cast<std::int64_t>(sizes.size()) - 1;
  if (words.size() > 1) subdimension = number_from<std::int64_t>(words[1]).value_or(0);
  data.list = header.data_files;
  const auto files = number_of_files(sizes, subdimension, data.list.size(), path);
  if (!files) return files.error();
  data.files = *files;
  return {};
}

Status interpret_pattern(const std::vector<std::string_view>& words, const std::vector<std::int64_t>& sizes,
                         const std::filesystem::path& path, NrrdData& data) {
  std::int64_t numbers[4] = {0, 0, 0, static_cast<std::int64_t>(sizes.size()) - 1};
  for (std::size_t i = 1; i < words.size(); ++i) {
    const auto number = number_from<std::int32_t>(words[i]);
    if (!number) return malformed(path, text(in_quotes(words[i]), " in \"data file:\" is not a number"));
    numbers[i - 1] = *number;
  }
  const auto [first, last, step, subdimension] = numbers;
  if (step == 0 || (last - first) / step < 0 || (last != first && (last > first) != (step > 0)))
    return malformed(path,
                     text("\"data file:\" cannot count from ", first, " to ", last, " in steps of ", step));
  data.pattern = words[0];
  data.first_number = first;
  data.number_step = step;
  const auto named = static_cast<std::uint64_t>((last - first) / step) + 1;
  const auto files = number_of_files(sizes, subdimension, named, path);
  if (!files) return files.error();
  data.files = *files;
  return {};
}

Status interpret_data_file(const NrrdHeader& header, const std::vector<std::int64_t>& sizes,
                           const std::filesystem::path& path, NrrdData& data) {
  const std::string* value = header.field("data file");
  if (!value) return {};
  const auto words = split(*value);
  if (words.empty()) return malformed(path, "\"data file:\" names no file");
  if (words[0] == "LIST" && words.size() <= 2) return interpret_list(header, words, sizes, path, data);
  if ((words.size() == 4 || words.size() == 5) && end_of_number(words[0]) > 0)
    return interpret_pattern(words, sizes, path, data);
  data.list = {*value}; // one file, whose name may have spaces in it
  data.files = 1;
  return {};
}

} // namespace

std::string NrrdData::file_name(std::uint64_t i) const {
  if (pattern.empty()) return list[i];
  const std::size_t percent = pattern.find('%'), end = end_of_number(pattern);
  const std::string_view flags = std::string_view(pattern).substr(percent + 1, end - percent - 2);
  const std::int64_t number = first_number + static_cast<std::int64_t>(i) * number_step;
  std::string digits = std::to_string(number < 0 ? -number : number);
  const std::size_t sign = number < 0 ? 1 : 0;
  // A width past that of any number is of no use in a file name, and must not cost memory.
  const auto width = std::min<std::size_t>(number_from<std::size_t>(flags).value_or(0), 64);
  const bool zeros = !flags.empty() && flags[0] == '0';
  const std::string padding(width > digits.size() + sign ? width - digits.size() - sign : 0,
                            zeros ? '0' : ' ');
  const std::string minus(sign, '-');
  const std::string words = zeros ? minus + padding + digits : padding + minus + digits;
  return pattern.substr(0, percent) + words + pattern.substr(end);
}

Result<NrrdHeader> parse_nrrd_header(std::string_view file, const std::filesystem::path& path) {
  std::string_view rest = file;
  const std::string_view magic = next_line(rest);
  if (magic.size() > 16 || !magic.starts_with("NRRD0"))
    return malformed(path, "this is not an NRRD file: it does not begin with NRRD000 and a version");
  if (magic != "NRRD00.01" &&
      (magic.size() != 8 || !magic.starts_with("NRRD000") || magic[7] < '1' || magic[7] > '5'))
    return unsupported(path, text(in_quotes(magic), " is not a version of NRRD that is read (1 to 5)"));

  NrrdHeader header;
  bool ended = false;
  while (!rest.empty() && !ended) {
    const std::string_view line = next_line(rest);
    if (line.empty()) ended = true;
    if (line.empty() || line[0] == '#') continue;
    const std::size_t colon = line.find(':');
    if (colon == std::string_view::npos)
      return malformed(path, text("the header line ", in_quotes(line), " is neither a field nor a comment"));
    std::string_view name;
    if (!line.substr(colon).starts_with(":="))
      name = usual_spelling(lower_case(trimmed(line.substr(0, colon))));
    if (name.empty()) { // keys may have colons in them
      const std::size_t separator = line.find(":=");
      if (separator == std::string_view::npos)
        return malformed(path, text("the header line ", in_quotes(line), " is no field of NRRD"));
      header.key_values[unescaped(line.substr(0, separator))] = unescaped(line.substr(separator + 2));
      continue;
    }
    const std::string_view value = trimmed(line.substr(colon + 1));
    if (!header.fields.emplace(name, value).second)
      return malformed(path, text("the header has two lines \"", name, ":\""));
    // The names of a list take the rest of the header.
    if (name == "data file" && (value == "LIST" || value.starts_with("LIST ")))
      while (!rest.empty()) {
        const std::string_view data_file = next_line(rest);
        if (!data_file.empty()) header.data_files.emplace_back(data_file);
      }
  }
  // Only a header whose data are elsewhere may end with the file.
  if (!ended && !header.field("data file"))
    return malformed(path, "the header is truncated: no empty line ends it, and no data follow");
  header.end = file.size() - rest.size();
  return header;
}

Result<NrrdContent> interpret_nrrd_header(const NrrdHeader& header, const std::filesystem::path& path) {
  NrrdContent content;
  StoredField& field = content.field;
  NrrdData& data = content.data;

  const auto type = interpret_type(header, path);
  if (!type) return type.error();
  field.type = *type;
  if (Status status = interpret_nrrd_axes(header, path, field); !status) return status.error();
  if (const std::string* name = header.field("content")) field.name = *name;

  const auto encoding = interpret_encoding(header, path);
  if (!encoding) return encoding.error();
  data.encoding = *encoding;
  const auto big_endian =
      interpret_endian(header, size_of(field.type) > 1 && data.encoding != NrrdEncoding::text, path);
  if (!big_endian) return big_endian.error();
  data.big_endian = *big_endian;
  if (data.encoding == NrrdEncoding::text) data.big_endian = std::endian::native == std::endian::big;

  const auto line_skip = interpret_skip(header, "line skip", 0, path);
  if (!line_skip) return line_skip.error();
  data.line_skip = *line_skip;
  const bool from_end = data.encoding == NrrdEncoding::raw;
  const auto byte_skip = interpret_skip(header, "byte skip", from_end ? INT64_MIN : 0, path);
  if (!byte_skip) return byte_skip.error();
  data.byte_skip = *byte_skip;

  // Before axes of one sample were left out: the number of files goes by the header's own dimension.
  const auto sizes = numbers_from<std::int64_t>(*header.field("sizes"));
  if (Status status = interpret_data_file(header, *sizes, path, data); !status) return status.error();
  return content;
}

} // namespace hyperiso
