#include "field_files.hpp"
#include "temporary_folder.hpp"

#include <gtest/gtest.h>

using namespace hyperiso;

namespace {

ReadOptions raw_options(std::vector<std::int64_t> dims, SampleType type) {
  ReadOptions options;
  options.dims = std::move(dims);
  options.type = type;
  return options;
}

template <class T>
void expect_every_byte_order_and_offset() {
  TemporaryFolder folder;
  const auto samples = counting<T>(24);
  for (const bool big_endian : {false, true})
    for (const std::int64_t skip : {0, 1, 8}) { // 1: unaligned, so the samples must be copied
      write_content(folder / "f.raw",
                    std::string(static_cast<std::size_t>(skip), '#') + bytes_of(samples, big_endian));
      auto options = raw_options({2, 3, 4}, sample_type_of<T>());
      options.big_endian = big_endian;
      options.skip_bytes = skip;
      const auto reader = open_field({folder / "f.raw"}, options);
      ASSERT_TRUE(reader) << reader.error().message;
      EXPECT_EQ(dims_of((*reader)->info()), (std::vector<std::int64_t>{2, 3, 4}));
      const auto whole = (*reader)->read();
      ASSERT_TRUE(whole) << whole.error().message;
      EXPECT_EQ(samples_of<T>(*whole), samples);
      const auto part = (*reader)->read(1, 3);
      ASSERT_TRUE(part) << part.error().message;
      EXPECT_EQ(samples_of<T>(*part), std::vector<T>(samples.begin() + 6, samples.begin() + 18));
      EXPECT_EQ(part->info.axes[2].coordinate(0), 1);
    }
}

} // namespace

TEST(RawFile, every_type_byte_order_and_offset) {
  expect_every_byte_order_and_offset<std::uint8_t>();
  expect_every_byte_order_and_offset<std::int8_t>();
  expect_every_byte_order_and_offset<std::uint16_t>();
  expect_every_byte_order_and_offset<std::int16_t>();
  expect_every_byte_order_and_offset<std::uint32_t>();
  expect_every_byte_order_and_offset<std::int32_t>();
  expect_every_byte_order_and_offset<float>();
  expect_every_byte_order_and_offset<double>();
}

// Silence would look like a conversion to that type.
TEST(RawFile, its_options_are_refused_for_files_that_describe_themselves) {
  TemporaryFolder folder;
  write_content(folder / "f.bin", bytes_of(counting<float>(16)));
  const auto raw = open_field({folder / "f.bin"}, raw_options({4, 4}, SampleType::f32));
  for (const char* name : {"f.nrrd", "f.npy", "f.vti"}) {
    ASSERT_TRUE(write_field(*(*raw)->read(), folder / name));
    const auto reader = open_field({folder / name}, raw_options({4, 4}, SampleType::f32));
    ASSERT_FALSE(reader);
    EXPECT_EQ(reader.error().code, Code::invalid_argument);
    EXPECT_FALSE(open_field({folder / name, folder / name}, raw_options({4, 4}, SampleType::f32)));
  }
}

TEST(RawFile, the_last_of_four_axes_is_time) {
  TemporaryFolder folder;
  write_content(folder / "f.bin", bytes_of(counting<float>(16)));
  const auto reader = open_field({folder / "f.bin"}, raw_options({2, 2, 2, 2}, SampleType::f32));
  ASSERT_TRUE(reader) << reader.error().message;
  EXPECT_TRUE((*reader)->info().has_time);
  EXPECT_EQ(names_of((*reader)->info()), (std::vector<std::string>{"x", "y", "z", "t"}));
}

// A time axis that is not the last in the file is moved by its stride; the samples stay where they are.
TEST(RawFile, time_axis_by_name_or_number) {
  TemporaryFolder folder;
  write_content(folder / "f.raw", bytes_of(counting<std::uint8_t>(24, 0)));
  for (const char* name : {"y", "1"}) {
    auto options = raw_options({2, 3, 4}, SampleType::u8);
    options.time_axis = name;
    const auto reader = open_field({folder / "f.raw"}, options);
    ASSERT_TRUE(reader) << reader.error().message;
    EXPECT_EQ(names_of((*reader)->info()), (std::vector<std::string>{"x", "y", "t"}));
    EXPECT_EQ(dims_of((*reader)->info()), (std::vector<std::int64_t>{2, 4, 3}));
    const auto step = (*reader)->read(2, 3);
    ASSERT_TRUE(step) << step.error().message;
    EXPECT_EQ(samples_of<std::uint8_t>(*step), (std::vector<std::uint8_t>{4, 5, 10, 11, 16, 17, 22, 23}));
  }
  auto options = raw_options({2, 3, 4}, SampleType::u8);
  options.time_axis = "depth";
  const auto reader = open_field({folder / "f.raw"}, options);
  ASSERT_FALSE(reader);
  EXPECT_EQ(reader.error().code, Code::invalid_argument);
  expect_error_names(reader.error(), "depth");
}

TEST(RawFile, sizes_that_do_not_match_the_file) {
  TemporaryFolder folder;
  write_content(folder / "f.raw", std::string(24, '#'));
  write_content(folder / "empty.raw", "");
  const auto code_of = [&](const char* file, const ReadOptions& options) {
    const auto reader = open_field({folder / file}, options);
    EXPECT_FALSE(reader);
    if (reader) return Code::internal;
    expect_error_names(reader.error(), file);
    return reader.error().code;
  };
  EXPECT_EQ(code_of("f.raw", raw_options({2, 3, 5}, SampleType::u8)), Code::file_malformed);
  EXPECT_EQ(code_of("f.raw", raw_options({2, 3, 3}, SampleType::u8)), Code::file_malformed);
  EXPECT_EQ(code_of("empty.raw", raw_options({2, 3, 3}, SampleType::u8)), Code::file_malformed);
  EXPECT_EQ(code_of("none.raw", raw_options({2, 3, 4}, SampleType::u8)), Code::file_not_found);
  EXPECT_EQ(code_of("", raw_options({2, 3, 4}, SampleType::u8)), Code::file_unreadable);
  EXPECT_EQ(code_of("f.raw", raw_options({0, 3, 4}, SampleType::u8)), Code::invalid_argument);
  EXPECT_EQ(code_of("f.raw", raw_options({-2, 3, -4}, SampleType::u8)), Code::invalid_argument);
  EXPECT_EQ(code_of("f.raw", raw_options({std::int64_t{1} << 33, std::int64_t{1} << 33}, SampleType::u8)),
            Code::invalid_argument);
  EXPECT_EQ(code_of("f.raw", raw_options({std::int64_t{1} << 61}, SampleType::f64)), Code::invalid_argument);
  EXPECT_EQ(code_of("f.raw", {}), Code::invalid_argument);
  auto options = raw_options({2, 3, 4}, SampleType::u8);
  options.skip_bytes = 25;
  EXPECT_EQ(code_of("f.raw", options), Code::file_malformed);
  options.skip_bytes = -1;
  EXPECT_EQ(code_of("f.raw", options), Code::invalid_argument);
}

TEST(RawFile, memory_limit_counts_what_is_held_not_what_is_mapped) {
  TemporaryFolder folder;
  write_content(folder / "f.raw", bytes_of(counting<float>(24)));
  auto options = raw_options({2, 3, 4}, SampleType::f32);
  options.memory_limit = 48;
  auto reader = open_field({folder / "f.raw"}, options);
  ASSERT_TRUE(reader && (*reader)->read());
  options.big_endian = true;
  reader = open_field({folder / "f.raw"}, options);
  ASSERT_TRUE(reader && (*reader)->read(1, 3));
  const auto field = (*reader)->read();
  ASSERT_FALSE(field);
  EXPECT_EQ(field.error().code, Code::out_of_memory);
  for (const auto& [begin, end] : {std::pair(-1, 2), {3, 2}, {3, 5}})
    EXPECT_EQ((*reader)->read(begin, end).error().code, Code::invalid_argument);
}
