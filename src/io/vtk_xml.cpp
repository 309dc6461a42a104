#include "io/vtk_xml.hpp"

#include "core/text.hpp"
#include "io/encoding.hpp"
#include "io/parse.hpp"

#include <algorithm>
#include <bit>
#include <cstring>
#include <optional>
#include <zlib.h>

namespace hyperiso {
namespace {

bool remove_suffix(std::string_view& text, std::string_view suffix) {
  text = trimmed(text);
  if (!text.ends_with(suffix)) return false;
  text.remove_suffix(suffix.size());
  return true;
}

// The markup of a file with a number in place of each run of text.
struct Skeleton {
  std::string markup;
  std::vector<std::string_view> texts;
  std::string_view appended; // what follows the tag <AppendedData ...>, its own end tags left out
};

// One past the `>` that ends the tag, comment or instruction at the start of `file`; npos if it is cut short.
std::size_t markup_end(std::string_view file) {
  constexpr std::string_view delimiters[][2] = {{"<!--", "-->"}, {"<![CDATA[", "]]>"}, {"<?", "?>"}};
  for (const auto& [start, end] : delimiters)
    if (file.starts_with(start)) {
      const std::size_t found = file.find(end, start.size());
      return found == file.npos ? found : found + end.size();
    }
  char quote = 0;
  for (std::size_t i = 0; i < file.size(); ++i) {
    if (quote) {
      if (file[i] == quote) quote = 0;
    } else if (file[i] == '"' || file[i] == '\'') {
      quote = file[i];
    } else if (file[i] == '>') {
      return i + 1;
    }
  }
  return file.npos;
}

// Nothing if the file ends inside a tag or its appended section.
std::optional<Skeleton> skeleton_of(std::string_view file) {
  Skeleton skeleton;
  while (!file.empty()) {
    if (file.front() != '<') {
      const std::size_t length = std::min(file.find('<'), file.size());
      if (const auto content = trimmed(file.substr(0, length)); !content.empty()) {
        skeleton.markup += std::to_string(skeleton.texts.size());
        skeleton.texts.push_back(content);
      }
      file.remove_prefix(length);
      continue;
    }
    const std::size_t length = markup_end(file);
    if (length == file.npos) return std::nullopt;
    const std::string_view tag = file.substr(0, length);
    skeleton.markup += tag;
    file.remove_prefix(length);
    constexpr std::string_view appended = "<AppendedData";
    if (!tag.starts_with(appended) || tag.ends_with("/>") ||
        (!is_space(tag[appended.size()]) && tag[appended.size()] != '>'))
      continue;
    if (!remove_suffix(file, "</VTKFile>") || !remove_suffix(file, "</AppendedData>")) return std::nullopt;
    skeleton.appended = file;
    skeleton.markup += "</AppendedData></VTKFile>";
    break;
  }
  return skeleton;
}

constexpr const char* type_names[] = {"Int8",   "UInt8", "Int16",  "UInt16",  "Int32",
                                      "UInt32", "Int64", "UInt64", "Float32", "Float64"};

std::optional<VtkType> type_named(std::string_view name) {
  if (name == "String") return VtkType::u8;
  const auto* found = std::find(std::begin(type_names), std::end(type_names), name);
  if (found == std::end(type_names)) return std::nullopt;
  return static_cast<VtkType>(found - std::begin(type_names));
}

// The bytes that a binary text holds, in order. Texts encoded one after the other, each padded, read as one.
class EncodedBytes {
 public:
  EncodedBytes(VtkArray::Encoding encoding, std::string_view content)
      : encoded_(encoding == VtkArray::Encoding::base64), content_(content) {}

  // False if fewer bytes are left, or what is left is not base64.
  bool read(void* destination, std::size_t bytes) {
    if (!encoded_) {
      if (bytes > content_.size()) return false;
      if (bytes > 0) std::memcpy(destination, content_.data(), bytes);
      content_.remove_prefix(bytes);
      return true;
    }
    const std::size_t done = decoder_.decode(content_, static_cast<unsigned char*>(destination), bytes);
    return done == bytes;
  }
  // What no byte read so far belongs to.
  std::string_view rest() const { return content_; }
  // At least as many bytes as are left.
  std::uint64_t most_bytes() const { return encoded_ ? content_.size() / 4 * 3 + 3 : content_.size(); }

 private:
  bool encoded_;
  std::string_view content_;
  Base64Decoder decoder_;
};

// Words of 4 or 8 bytes. Callers have checked `count` against what the source can hold.
std::optional<std::vector<std::uint64_t>> read_words(EncodedBytes& source, std::uint64_t count, bool wide,
                                                     bool swapped) {
  std::vector<std::uint64_t> words(count);
  for (std::uint64_t& word : words) {
    unsigned char bytes[8]{};
    const std::size_t width = wide ? 8 : 4;
    if (!source.read(bytes, width)) return std::nullopt;
    if (swapped) std::reverse(bytes, bytes + width);
    std::memcpy(&word, bytes, 8);
  }
  return words;
}

bool inflate_block(const std::vector<unsigned char>& compressed, unsigned char* destination,
                   std::uint64_t bytes) {
  uLongf size = bytes;
  return uncompress(destination, &size, compressed.data(), compressed.size()) == Z_OK && size == bytes;
}

void swap_bytes(unsigned char* data, std::uint64_t values, std::size_t width) {
  for (std::uint64_t i = 0; i < values; ++i) std::reverse(data + i * width, data + (i + 1) * width);
}

} // namespace

std::size_t size_of(VtkType type) {
  return visit_vtk_type(type, [](auto value) { return sizeof value; });
}

const char* name_of(VtkType type) { return type_names[static_cast<int>(type)]; }

Error VtkXml::malformed(const std::string& what) const {
  return Error{Code::file_malformed, text(name_, ": ", what)};
}

Error VtkXml::unsupported(const std::string& what) const {
  return Error{Code::file_unsupported, text(name_, ": ", what)};
}

Result<VtkXml> VtkXml::parse(std::string_view file, std::string name) {
  VtkXml xml;
  xml.name_ = std::move(name);
  auto skeleton = skeleton_of(file);
  if (!skeleton) return xml.malformed("not XML, or cut short");
  const auto parsed = xml.document_.load_buffer(skeleton->markup.data(), skeleton->markup.size(),
                                                pugi::parse_default, pugi::encoding_utf8);
  if (!parsed) return xml.malformed(text("not XML, or cut short: ", parsed.description()));
  if (!xml.root()) return xml.malformed("no <VTKFile> in it: not a file of VTK's XML formats");
  xml.texts_ = std::move(skeleton->texts);
  xml.appended_ = skeleton->appended;
  if (auto checked = xml.check_header(); !checked) return checked.error();
  return xml;
}

Status VtkXml::check_header() {
  const std::string_view order = root().attribute("byte_order").as_string("LittleEndian");
  if (order != "LittleEndian" && order != "BigEndian")
    return malformed(text("byte_order is \"", order, "\", neither LittleEndian nor BigEndian"));
  big_endian_ = order == "BigEndian";
  const std::string_view header = root().attribute("header_type").as_string("UInt32");
  if (header != "UInt32" && header != "UInt64")
    return malformed(text("header_type is \"", header, "\", neither UInt32 nor UInt64"));
  wide_header_ = header == "UInt64";
  compressor_ = root().attribute("compressor").as_string();
  if (const auto section = root().child("AppendedData")) {
    const std::string_view encoding = section.attribute("encoding").as_string();
    if (encoding != "raw" && encoding != "base64")
      return malformed(text("the encoding of AppendedData is \"", encoding, "\", neither raw nor base64"));
    appended_raw_ = encoding == "raw";
    if (!appended_.starts_with('_')) return malformed("no _ at the start of AppendedData");
    appended_.remove_prefix(1);
  }
  return {};
}

Result<VtkArray> VtkXml::array(pugi::xml_node node) const {
  VtkArray array;
  array.name = node.attribute("Name").as_string();
  const std::string_view type_name = node.attribute("type").as_string();
  const auto type = type_named(type_name);
  if (!type) return unsupported(text("array \"", array.name, "\" has the unknown type \"", type_name, "\""));
  array.type = *type;
  array.components = node.attribute("NumberOfComponents").as_ullong(1);
  if (array.components == 0) return malformed(text("array \"", array.name, "\" has no components"));
  if (auto located = locate(node, array); !located) return located.error();
  if (array.values % array.components != 0)
    return malformed(text("array \"", array.name, "\" holds ", array.values,
                          " values, not a multiple of its ", array.components, " components"));
  return array;
}

Status VtkXml::locate(pugi::xml_node node, VtkArray& array) const {
  const std::string_view format = node.attribute("format").as_string("ascii");
  if (node.attribute("offset")) {
    const std::uint64_t offset = node.attribute("offset").as_ullong(UINT64_MAX);
    if (!root().child("AppendedData"))
      return malformed(text("array \"", array.name, "\" is appended, but there is no AppendedData"));
    if (offset > appended_.size())
      return malformed(text("array \"", array.name, "\" starts at offset ", offset, " of ", appended_.size(),
                            " appended bytes: the file is damaged or cut short"));
    array.encoding = appended_raw_ ? VtkArray::Encoding::raw : VtkArray::Encoding::base64;
    array.content = appended_.substr(offset);
    return measure_binary(array);
  }
  if (format != "ascii" && format != "binary")
    return malformed(text("array \"", array.name, "\" has the format \"", format, "\" and no offset"));
  if (const std::string_view number_of_text = node.child_value(); !number_of_text.empty()) {
    const auto number = number_from<std::size_t>(number_of_text);
    if (!number || *number >= texts_.size())
      return malformed(text("array \"", array.name, "\" holds more than text"));
    array.content = texts_[*number];
  }
  array.encoding = format == "ascii" ? VtkArray::Encoding::ascii : VtkArray::Encoding::base64;
  if (format == "binary") return measure_binary(array);
  array.values = 0;
  for (std::string_view rest = array.content; !next_word(rest, is_space).empty();) ++array.values;
  return {};
}

// Reads the header in front of binary data, and holds what it says against what is there.
Status VtkXml::measure_binary(VtkArray& array) const {
  const Error damaged =
      malformed(text("array \"", array.name, "\" claims more than the file holds: damaged or cut short"));
  const bool swapped = big_endian_ != (std::endian::native == std::endian::big);
  const std::size_t word = wide_header_ ? 8 : 4;
  array.values = 0;
  array.header_bytes = 0;
  array.block_bytes = 0;
  if (array.content.empty() && array.encoding == VtkArray::Encoding::base64) return {}; // an empty array
  EncodedBytes source(array.encoding, array.content);
  std::uint64_t bytes = 0;
  if (compressor_.empty()) {
    const auto header = read_words(source, 1, wide_header_, swapped);
    if (!header) return damaged;
    bytes = header->front();
    array.header_bytes = word;
    if (bytes > source.most_bytes() + 3) return damaged; // base64: up to 3 bytes decoded with the header
  } else {
    if (compressor_ != "vtkZLibDataCompressor")
      return unsupported(text("array \"", array.name, "\" is compressed by ", compressor_,
                              "; hyperiso reads vtkZLibDataCompressor and uncompressed files"));
    const auto header = read_words(source, 3, wide_header_, swapped);
    if (!header) return damaged;
    const std::uint64_t blocks = (*header)[0], last = (*header)[2];
    array.block_bytes = (*header)[1];
    if (blocks > source.most_bytes() / word || last > array.block_bytes) return damaged;
    auto sizes = read_words(source, blocks, wide_header_, swapped);
    if (!sizes) return damaged;
    array.compressed_sizes = std::move(*sizes);
    array.content = source.rest();
    std::uint64_t available = EncodedBytes(array.encoding, array.content).most_bytes();
    for (std::uint64_t i = 0; i < blocks; ++i) {
      const std::uint64_t size = array.compressed_sizes[i];
      const std::uint64_t expanded = i + 1 == blocks && last > 0 ? last : array.block_bytes;
      if (size > available || expanded / 1032 > size) return damaged; // zlib compresses at most 1032 to 1
      available -= size;
      bytes += expanded;
    }
  }
  const std::size_t width = size_of(array.type);
  if (bytes % width != 0)
    return malformed(text("array \"", array.name, "\" holds ", bytes, " bytes, not a multiple of ", width));
  array.values = bytes / width;
  return {};
}

Status VtkXml::read(const VtkArray& array, void* destination) const {
  const Error damaged = malformed(text("array \"", array.name, "\" is damaged"));
  if (array.encoding == VtkArray::Encoding::ascii)
    return visit_vtk_type(array.type, [&](auto zero) -> Status {
      auto* values = static_cast<decltype(zero)*>(destination);
      std::string_view rest = array.content;
      for (std::uint64_t i = 0; i < array.values; ++i) {
        const auto word = next_word(rest, is_space);
        const auto number = number_from<decltype(zero)>(word);
        if (!number)
          return malformed(text("array \"", array.name, "\": ", in_quotes(word), " is no value of its type"));
        values[i] = *number;
      }
      return {};
    });

  auto* bytes = static_cast<unsigned char*>(destination);
  EncodedBytes source(array.encoding, array.content);
  if (array.block_bytes == 0) {
    unsigned char header[8];
    if (!source.read(header, array.header_bytes) || !source.read(bytes, array.bytes())) return damaged;
  } else {
    std::vector<unsigned char> compressed;
    std::uint64_t remaining = array.bytes();
    for (const std::uint64_t size : array.compressed_sizes) {
      compressed.resize(size);
      const std::uint64_t expanded = std::min(remaining, array.block_bytes);
      if (!source.read(compressed.data(), size) || !inflate_block(compressed, bytes, expanded))
        return damaged;
      bytes += expanded;
      remaining -= expanded;
    }
  }
  if (big_endian_ != (std::endian::native == std::endian::big))
    swap_bytes(static_cast<unsigned char*>(destination), array.values, size_of(array.type));
  return {};
}

} // namespace hyperiso
