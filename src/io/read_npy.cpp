// NumPy's .npy, versions 1 to 3: a Python dictionary with the type, order and shape, then the samples.
// Format: numpy.org/doc/stable/reference/generated/numpy.lib.format.html

#include "core/text.hpp"
#include "io/formats.hpp"
#include "io/parse.hpp"
#include "io/stored_field.hpp"

#include <algorithm>
#include <bit>

namespace hyperiso {
namespace {

struct NpyHeader {
  std::string type;
  bool fortran_order = false;
  std::vector<std::int64_t> shape;
};

// Reads {'descr': '<f4', 'fortran_order': False, 'shape': (2, 3), }, the keys in any order.
class DictionaryParser {
 public:
  explicit DictionaryParser(std::string_view characters) : rest_(characters) {}

  std::optional<NpyHeader> parse() {
    NpyHeader header;
    bool has_type = false, has_order = false, has_shape = false;
    if (!take('{')) return std::nullopt;
    while (!take('}')) {
      const auto key = string();
      if (!key || !take(':')) return std::nullopt;
      bool& seen = *key == "descr" ? has_type : *key == "fortran_order" ? has_order : has_shape;
      const bool good = !seen && (*key == "descr"           ? parse_type(header.type)
                                  : *key == "fortran_order" ? parse_truth(header.fortran_order)
                                  : *key == "shape"         ? parse_shape(header.shape)
                                                            : false);
      if (!good) return std::nullopt;
      seen = true;
      if (!take(',') && !next_is('}')) return std::nullopt;
    }
    if (!has_type || !has_order || !has_shape || !trimmed(rest_).empty()) return std::nullopt;
    return header;
  }

 private:
  bool next_is(char c) {
    rest_ = trimmed(rest_);
    return !rest_.empty() && rest_.front() == c;
  }
  bool take(char c) {
    const bool found = next_is(c);
    if (found) rest_.remove_prefix(1);
    return found;
  }
  bool take(std::string_view word) {
    rest_ = trimmed(rest_);
    const bool found = rest_.starts_with(word);
    if (found) rest_.remove_prefix(word.size());
    return found;
  }
  std::optional<std::string_view> string() {
    const char quote = next_is('"') ? '"' : '\'';
    if (!take(quote)) return std::nullopt;
    const std::size_t end = rest_.find(quote);
    if (end == std::string_view::npos) return std::nullopt;
    const std::string_view content = rest_.substr(0, end);
    rest_.remove_prefix(end + 1);
    return content;
  }
  // A string, or the list that describes a structured type, which is kept for the message.
  bool parse_type(std::string& type) {
    if (next_is('[')) {
      const std::size_t end = rest_.find(']');
      if (end == std::string_view::npos) return false;
      type = rest_.substr(0, end + 1);
      rest_.remove_prefix(end + 1);
      return true;
    }
    const auto word = string();
    if (word) type = *word;
    return word.has_value();
  }
  bool parse_truth(bool& truth) {
    truth = take("True");
    return truth || take("False");
  }
  bool parse_shape(std::vector<std::int64_t>& shape) {
    if (!take('(')) return false;
    while (!take(')')) {
      std::size_t digits = 0;
      rest_ = trimmed(rest_);
      while (digits < rest_.size() && rest_[digits] >= '0' && rest_[digits] <= '9') ++digits;
      const auto size = number_from<std::int64_t>(rest_.substr(0, digits));
      if (!size || shape.size() == 64) return false; // NumPy's own limit is 64
      shape.push_back(*size);
      rest_.remove_prefix(digits);
      take('L'); // written by Python 2
      if (!take(',') && !next_is(')')) return false;
    }
    return true;
  }

  std::string_view rest_;
};

// "<f4": byte order, kind and size. Booleans are bytes of 0 and 1.
std::optional<SampleType> type_described(std::string_view description) {
  static constexpr std::pair<std::string_view, SampleType> types[] = {
      {"u1", SampleType::u8},  {"b1", SampleType::u8},  {"i1", SampleType::i8},
      {"u2", SampleType::u16}, {"i2", SampleType::i16}, {"u4", SampleType::u32},
      {"i4", SampleType::i32}, {"f4", SampleType::f32}, {"f8", SampleType::f64}};
  if (description.size() != 3 || std::string_view("<>=|").find(description[0]) == std::string_view::npos)
    return std::nullopt;
  for (const auto& [name, type] : types)
    if (description.substr(1) == name) return type;
  return std::nullopt;
}

struct NpyFile {
  std::string_view header;
  std::uint64_t data; // where the samples begin
};

Result<NpyFile> parts_of(std::string_view file, const std::filesystem::path& path) {
  const auto malformed = [&](std::string_view what) {
    return Error{Code::file_malformed, text(path.string(), ": ", what)};
  };
  constexpr std::string_view magic = "\x93NUMPY";
  if (!file.starts_with(magic)) return malformed("this is not an .npy file: it does not begin with NUMPY");
  const auto byte = [&](std::size_t i) {
    return static_cast<std::uint64_t>(static_cast<unsigned char>(file[i]));
  };
  const std::size_t after_version = magic.size() + 2;
  if (file.size() < after_version + 4) return malformed("the header is truncated");
  const std::uint64_t version = byte(magic.size());
  if (version < 1 || version > 3)
    return Error{Code::file_unsupported,
                 text(path.string(), ": version ", version, " of .npy is not read; 1, 2 and 3 are")};
  std::uint64_t length = byte(after_version) | byte(after_version + 1) << 8;
  if (version > 1) length |= byte(after_version + 2) << 16 | byte(after_version + 3) << 24;
  const std::size_t begin = after_version + (version > 1 ? 4 : 2);
  if (length > file.size() - begin) return malformed("the header is truncated");
  return NpyFile{file.substr(begin, length), begin + length};
}

} // namespace

OpenedField open_npy(const std::filesystem::path& path, const ReadOptions& options) {
  auto file = InputFile::open(path);
  if (!file) return file.error();
  const auto parts = parts_of((*file)->characters(), path);
  if (!parts) return parts.error();
  const auto header = DictionaryParser(parts->header).parse();
  if (!header)
    return Error{Code::file_malformed, text(path.string(), ": the header ", in_quotes(parts->header),
                                            " is not that of an .npy file")};
  const auto type = type_described(header->type);
  if (!type)
    return Error{
        Code::file_unsupported,
        text(path.string(), ": arrays of type ", in_quotes(header->type),
             " are not read; convert the array with astype to float64 or a type of at most 32 bits")};

  StoredField stored;
  stored.type = *type;
  for (const std::int64_t count : header->shape) {
    Axis axis;
    axis.count = count;
    stored.axes.push_back(axis);
  }
  if (!header->fortran_order) std::ranges::reverse(stored.axes);
  stored.time_axis = usual_time_axis(stored.axes.size());

  const auto bytes = bytes_of(stored.axes, stored.type, path);
  if (!bytes) return bytes.error();
  if ((*file)->size() - parts->data != *bytes)
    return Error{Code::file_malformed,
                 text(path.string(), ": ", dims_text(stored.axes), " samples of type ", name_of(stored.type),
                      " need ", *bytes, " bytes, but the file has ", (*file)->size() - parts->data,
                      " after its header")};
  const bool swap = header->type[0] == '>'   ? std::endian::native == std::endian::little
                    : header->type[0] == '<' ? std::endian::native == std::endian::big
                                             : false;
  return read_stored(std::move(stored), plain_source(std::move(*file), parts->data), swap, path, options);
}

} // namespace hyperiso
