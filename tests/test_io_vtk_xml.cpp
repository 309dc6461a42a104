// The arrays of VTK's XML files, in every encoding, whole and damaged.

#include "core/text.hpp"
#include "io/encoding.hpp"
#include "io/vtk_xml.hpp"
#include "temporary_folder.hpp"

#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>
#include <numeric>
#include <zlib.h>

using namespace hyperiso;

namespace {

template <class T>
std::string bytes_of(const std::vector<T>& values, bool big_endian) {
  std::string bytes(reinterpret_cast<const char*>(values.data()), values.size() * sizeof(T));
  for (std::size_t i = 0; big_endian && i < bytes.size(); i += sizeof(T))
    std::reverse(bytes.data() + i, bytes.data() + i + sizeof(T));
  return bytes;
}

std::string header_of(const std::vector<std::uint64_t>& words, bool wide, bool big_endian) {
  return wide ? bytes_of(words, big_endian)
              : bytes_of(std::vector<std::uint32_t>(words.begin(), words.end()), big_endian);
}

std::string base64(const std::string& bytes) {
  Base64Encoder encoder;
  std::string encoded;
  encoder.append({reinterpret_cast<const unsigned char*>(bytes.data()), bytes.size()}, encoded);
  encoder.finish(encoded);
  return encoded;
}

std::string deflated(const std::string& bytes) {
  uLongf size = compressBound(bytes.size());
  std::string compressed(size, '\0');
  compress(reinterpret_cast<Bytef*>(compressed.data()), &size, reinterpret_cast<const Bytef*>(bytes.data()),
           bytes.size());
  compressed.resize(size);
  return compressed;
}

struct Variant {
  bool appended, base64, compressed, wide, big_endian;
};

std::string encoded(const std::string& bytes, const Variant& variant) {
  const auto text = [&](const std::string& part) { return variant.base64 ? base64(part) : part; };
  if (!variant.compressed) return text(header_of({bytes.size()}, variant.wide, variant.big_endian) + bytes);
  constexpr std::size_t block = 64;
  std::vector<std::uint64_t> words{(bytes.size() + block - 1) / block, block, bytes.size() % block};
  std::string data;
  for (std::size_t start = 0; start < bytes.size(); start += block) {
    const std::string part = deflated(bytes.substr(start, block));
    words.push_back(part.size());
    data += part;
  }
  return text(header_of(words, variant.wide, variant.big_endian)) + text(data);
}

// A file of two arrays: f64 "a" in pairs, and i16 "b".
std::string file_of(const std::vector<double>& a, const std::vector<std::int16_t>& b,
                    const Variant& variant) {
  const std::string first = encoded(bytes_of(a, variant.big_endian), variant);
  const std::string second = encoded(bytes_of(b, variant.big_endian), variant);
  const auto attributes = [&](std::size_t offset) {
    return variant.appended ? text("format=\"appended\" offset=\"", offset, "\">")
                            : std::string("format=\"binary\">");
  };
  const auto content = [&](const std::string& data) { return variant.appended ? "" : "\n  " + data + "\n"; };
  return text("<?xml version=\"1.0\"?><!-- <a> --><VTKFile type=\"T\" byte_order=\"",
              variant.big_endian ? "BigEndian" : "LittleEndian", "\" ",
              variant.wide ? "header_type=\"UInt64\" " : "",
              variant.compressed ? "compressor=\"vtkZLibDataCompressor\"" : "",
              ">\n <DataArray Name=\"a>b\" ", "type=\"Float64\" NumberOfComponents=\"2\" ", attributes(0),
              content(first), "</DataArray><DataArray Name='b' type=\"Int16\" ", attributes(first.size()),
              content(second), "</DataArray>\n",
              variant.appended ? text("<AppendedData encoding=\"", variant.base64 ? "base64" : "raw",
                                      "\">\n _", first, second, "\n</AppendedData>\n")
                               : "",
              "</VTKFile>\n");
}

template <class T>
Result<std::vector<T>> values_of(const VtkXml& xml, pugi::xml_node node) {
  const auto array = xml.array(node);
  if (!array) return array.error();
  std::vector<T> values(array->values);
  if (array->bytes() != values.size() * sizeof(T)) return Error{Code::internal, "another type"};
  if (const auto status = xml.read(*array, values.data()); !status) return status.error();
  return values;
}

// Decodes every array of a file: what must not crash, whatever the bytes.
Status decode_all(const std::string& file) {
  const auto xml = VtkXml::parse(file, "file");
  if (!xml) return xml.error();
  for (const auto node : xml->root().children("DataArray")) {
    const auto array = xml->array(node);
    if (!array) return array.error();
    EXPECT_LE(array->bytes(), 1100 * file.size());
    std::vector<std::uint64_t> memory(array->bytes() / 8 + 1);
    if (const auto status = xml->read(*array, memory.data()); !status) return status.error();
  }
  return {};
}

std::vector<Variant> variants() {
  std::vector<Variant> all;
  for (int bits = 0; bits < 32; ++bits)
    if (const Variant variant{(bits & 1) != 0, (bits & 2) != 0, (bits & 4) != 0, (bits & 8) != 0,
                              (bits & 16) != 0};
        variant.appended || variant.base64)
      all.push_back(variant);
  return all;
}

std::vector<double> some_doubles(std::size_t count) {
  std::vector<double> values(count);
  for (std::size_t i = 0; i < count; ++i) values[i] = static_cast<double>(i * i) / 7 - 3;
  return values;
}

} // namespace

TEST(VtkXml, every_encoding_byte_order_and_header) {
  for (const Variant& variant : variants())
    for (const std::size_t count : {0, 2, 8, 34}) { // no, part of, exactly and several blocks of 64 bytes
      const auto a = some_doubles(count);
      std::vector<std::int16_t> b(count + 1);
      std::iota(b.begin(), b.end(), static_cast<std::int16_t>(-300));
      const std::string file = file_of(a, b, variant);
      const auto xml = VtkXml::parse(file, "file");
      ASSERT_TRUE(xml) << xml.error().message;
      const auto first = xml->root().child("DataArray");
      const auto read_a = values_of<double>(*xml, first);
      const auto read_b = values_of<std::int16_t>(*xml, first.next_sibling());
      ASSERT_TRUE(read_a) << read_a.error().message;
      ASSERT_TRUE(read_b) << read_b.error().message;
      EXPECT_EQ(*read_a, a);
      EXPECT_EQ(*read_b, b);
      EXPECT_EQ(xml->array(first)->name, "a>b");
      EXPECT_EQ(xml->array(first)->components, 2u);
    }
}

TEST(VtkXml, ascii_numbers) {
  const std::string file =
      "<VTKFile><DataArray type=\"Float32\" format=\"ascii\"> 1 +2.5e0\n-inf nan\t1e-3</DataArray>"
      "<DataArray type=\"Int8\">-128 127</DataArray><DataArray "
      "type=\"UInt64\">18446744073709551615</DataArray>"
      "<DataArray type=\"Int32\" format=\"ascii\"/></VTKFile>";
  const auto xml = VtkXml::parse(file, "file");
  ASSERT_TRUE(xml) << xml.error().message;
  auto node = xml->root().first_child();
  const auto floats = values_of<float>(*xml, node);
  ASSERT_TRUE(floats) << floats.error().message;
  ASSERT_EQ(floats->size(), 5u);
  EXPECT_EQ((*floats)[1], 2.5f);
  EXPECT_EQ((*floats)[2], -HUGE_VALF);
  EXPECT_NE((*floats)[3], (*floats)[3]);
  EXPECT_EQ((*floats)[4], 1e-3f);
  EXPECT_EQ(*values_of<std::int8_t>(*xml, node = node.next_sibling()), (std::vector<std::int8_t>{-128, 127}));
  EXPECT_EQ(*values_of<std::uint64_t>(*xml, node = node.next_sibling()),
            (std::vector<std::uint64_t>{UINT64_MAX}));
  EXPECT_TRUE(values_of<std::int32_t>(*xml, node.next_sibling())->empty());
}

TEST(VtkXml, contradictions_are_errors_that_name_the_file) {
  const std::string binary = "<VTKFile header_type=\"UInt64\" compressor=\"vtkZLibDataCompressor\">"
                             "<DataArray type=\"UInt8\" format=\"binary\">";
  const std::string end = "</DataArray></VTKFile>";
  const auto words = [](const std::vector<std::uint64_t>& header) {
    return base64(header_of(header, true, false));
  };
  for (const std::string& file : {
           std::string(),
           std::string("no markup"),
           std::string("<a/>"),
           std::string("<VTKFile>"),
           std::string("<VTKFile byte_order=\"Middle\"/>"),
           std::string("<VTKFile header_type=\"Int8\"/>"),
           "<VTKFile><DataArray type=\"Float16\">1" + end,
           "<VTKFile><DataArray type=\"Int8\">128" + end,
           "<VTKFile><DataArray type=\"Int8\">1x" + end,
           "<VTKFile><DataArray type=\"Float32\">1e99" + end,
           "<VTKFile><DataArray type=\"Int8\" NumberOfComponents=\"0\">1" + end,
           "<VTKFile><DataArray type=\"Int8\" NumberOfComponents=\"2\">1 2 3" + end,
           "<VTKFile><DataArray type=\"Int8\" format=\"appended\">" + end,
           "<VTKFile><DataArray type=\"Int8\" offset=\"0\">" + end,
           "<VTKFile><DataArray type=\"Int8\" format=\"binary\">?AAA" + end,
           "<VTKFile compressor=\"vtkLZ4DataCompressor\"><DataArray type=\"Int8\" format=\"binary\">AAAA" +
               end,
           binary + "AAAA" + end,
           binary + words({UINT64_MAX, 1, 0}) + end, // sizes of more blocks than the file has bytes
           binary + words({1, UINT64_MAX, 0, 10}) + base64("0123456789") + end, // more than zlib can expand
           binary + words({1, 100, 200, 10}) + base64("0123456789") + end,
           binary + words({1, 100, 0, UINT64_MAX}) + base64("0123456789") + end,
           binary + words({1, 100, 0, 10}) + base64("0123456789") + end, // not zlib
           binary + words({1, 9, 0, deflated("0123456789").size()}) + base64(deflated("0123456789")) + end,
       }) {
    const auto status = decode_all(file);
    ASSERT_FALSE(status) << file;
    EXPECT_EQ(status.error().message.rfind("file: ", 0), 0u) << status.error().message;
  }
}

TEST(VtkXml, every_prefix_is_an_error_and_no_changed_byte_crashes) {
  const std::vector<std::int16_t> b{1, 2, 3};
  for (const Variant& variant : variants()) {
    std::string file = file_of(some_doubles(20), b, variant);
    for (std::size_t length = 0; length + 1 < file.size(); ++length) // the last byte is a line's end
      EXPECT_FALSE(decode_all(file.substr(0, length))) << length;
    for (char& byte : file) {
      const char before = byte;
      for (const int change : {1, 0x10, 0x80, before ^ '<', before ^ '"'}) {
        byte = static_cast<char>(before ^ change);
        (void)decode_all(file);
      }
      byte = before;
    }
  }
}

TEST(CompressedArrayWriter, array_of_many_blocks_in_uneven_pieces) {
  const TemporaryFolder folder;
  for (const std::size_t count : {0, 1, 32767, 32768, 32769, 200'000}) { // blocks are of 32768 doubles
    const auto values = some_doubles(count);
    auto file = AtomicFile::create(folder / "a");
    ASSERT_TRUE(file);
    file->write("<VTKFile header_type=\"UInt64\" compressor=\"vtkZLibDataCompressor\">"
                "<DataArray type=\"Float64\" format=\"binary\">");
    CompressedArrayWriter writer(*file, count * 8);
    for (std::size_t start = 0, size = 1; start < count; start += size, size = size * 7 + 1)
      writer.append(values.data() + start, std::min(size, count - start) * 8);
    writer.finish();
    file->write("</DataArray></VTKFile>");
    ASSERT_TRUE(file->commit());
    const std::string content = content_of(folder / "a");
    const auto xml = VtkXml::parse(content, "a");
    ASSERT_TRUE(xml) << xml.error().message;
    const auto read = values_of<double>(*xml, xml->root().first_child());
    ASSERT_TRUE(read) << read.error().message;
    EXPECT_EQ(*read, values);
  }
}
