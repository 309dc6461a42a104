#include "field_files.hpp"
#include "temporary_folder.hpp"

#include <gtest/gtest.h>

using namespace hyperiso;

namespace {

std::string npy(const std::string& dictionary, const std::string& data, int version = 1) {
  std::string file = "\x93NUMPY";
  file += static_cast<char>(version);
  file += '\0';
  for (int byte = 0; byte < (version == 1 ? 2 : 4); ++byte)
    file += static_cast<char>(dictionary.size() >> (8 * byte) & 255);
  return file + dictionary + data;
}

std::string dictionary(const std::string& type, const std::string& order, const std::string& shape) {
  return "{'descr': '" + type + "', 'fortran_order': " + order + ", 'shape': " + shape + ", }     \n";
}

template <class T>
void expect_both_byte_orders(const std::string& type) {
  TemporaryFolder folder;
  const auto samples = counting<T>(24);
  for (const bool big_endian : {false, true})
    for (const int version : {1, 2, 3}) {
      write_content(folder / "a.npy", npy(dictionary((big_endian ? ">" : "<") + type, "False", "(4, 3, 2)"),
                                          bytes_of(samples, big_endian), version));
      const auto reader = open_field({folder / "a.npy"});
      ASSERT_TRUE(reader) << reader.error().message;
      EXPECT_EQ((*reader)->info().type, sample_type_of<T>());
      EXPECT_EQ(dims_of((*reader)->info()), (std::vector<std::int64_t>{2, 3, 4}));
      const auto part = (*reader)->read(1, 3);
      ASSERT_TRUE(part) << part.error().message;
      EXPECT_EQ(samples_of<T>(*part), std::vector<T>(samples.begin() + 6, samples.begin() + 18));
    }
}

Code code_of(const std::string& content) {
  TemporaryFolder folder;
  write_content(folder / "a.npy", content);
  const auto reader = open_field({folder / "a.npy"});
  EXPECT_FALSE(reader) << content;
  if (reader) return Code::internal;
  expect_error_names(reader.error(), "a.npy");
  return reader.error().code;
}

} // namespace

TEST(Npy, every_type_byte_order_and_version) {
  expect_both_byte_orders<std::uint8_t>("u1");
  expect_both_byte_orders<std::int8_t>("i1");
  expect_both_byte_orders<std::uint16_t>("u2");
  expect_both_byte_orders<std::int16_t>("i2");
  expect_both_byte_orders<std::uint32_t>("u4");
  expect_both_byte_orders<std::int32_t>("i4");
  expect_both_byte_orders<float>("f4");
  expect_both_byte_orders<double>("f8");
  expect_both_byte_orders<std::uint8_t>("b1");
}

// In C order the last index varies fastest, in Fortran order the first: the fastest is axis 0 either way.
TEST(Npy, fortran_order) {
  TemporaryFolder folder;
  write_content(folder / "a.npy", npy("{ \"shape\": (2L,3,4) , \"fortran_order\":True,'descr':'|u1'}",
                                      bytes_of(counting<std::uint8_t>(24))));
  const auto reader = open_field({folder / "a.npy"});
  ASSERT_TRUE(reader) << reader.error().message;
  EXPECT_EQ(dims_of((*reader)->info()), (std::vector<std::int64_t>{2, 3, 4}));
  const auto field = (*reader)->read();
  ASSERT_TRUE(field);
  EXPECT_EQ(samples_of<std::uint8_t>(*field), counting<std::uint8_t>(24));
}

TEST(Npy, headers_that_are_wrong) {
  const std::string data(24, '#');
  EXPECT_EQ(code_of(npy(dictionary("|u1", "False", "(5, 5)"), data)), Code::file_malformed);
  EXPECT_EQ(code_of(npy(dictionary("|u1", "False", "(5, 4)"), data)), Code::file_malformed);
  EXPECT_EQ(code_of(npy(dictionary("|u1", "False", "(4294967296, 4294967296)"), data)), Code::file_malformed);
  EXPECT_EQ(code_of(npy(dictionary("|u1", "False", "(99999999999999999999,)"), data)), Code::file_malformed);
  EXPECT_EQ(code_of(npy(dictionary("|u1", "False", "(-24,)"), data)), Code::file_malformed);
  EXPECT_EQ(code_of(npy(dictionary("|u1", "False", "()"), "#")), Code::file_malformed);
  EXPECT_EQ(code_of(npy(dictionary("|u1", "False", "(0, 4)"), "")), Code::file_malformed);
  EXPECT_EQ(code_of(npy(dictionary("|u1", "Maybe", "(24,)"), data)), Code::file_malformed);
  EXPECT_EQ(code_of(npy("{'descr': '|u1', 'shape': (24,)}", data)), Code::file_malformed);
  EXPECT_EQ(code_of(npy("{'descr': '|u1', 'descr': '|u1', 'fortran_order': False, 'shape': (24,)}", data)),
            Code::file_malformed);
  EXPECT_EQ(code_of(npy(dictionary("|u1", "False", "(24,)"), data, 4)), Code::file_unsupported);
  for (const std::string type : {"<i8", "<u8", "<f2", "<c8", "|O", "|S24", "f4", ""})
    EXPECT_EQ(code_of(npy(dictionary(type, "False", "(24,)"), data)), Code::file_unsupported) << type;
  EXPECT_EQ(code_of(npy("{'descr': [('a', '<f4')], 'fortran_order': False, 'shape': (6,)}", data)),
            Code::file_unsupported);
}
