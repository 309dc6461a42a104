#include "core/text.hpp"
#include "field_files.hpp"
#include "temporary_folder.hpp"

#include <bzlib.h>
#include <cmath>
#include <gtest/gtest.h>
#include <zlib.h>

using namespace hyperiso;

namespace {

std::string gzipped(const std::string& bytes) {
  z_stream stream{};
  deflateInit2(&stream, 6, Z_DEFLATED, 15 + 16, 8, Z_DEFAULT_STRATEGY);
  std::string result(deflateBound(&stream, bytes.size()) + 32, '\0');
  stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(bytes.data()));
  stream.avail_in = static_cast<uInt>(bytes.size());
  stream.next_out = reinterpret_cast<Bytef*>(result.data());
  stream.avail_out = static_cast<uInt>(result.size());
  deflate(&stream, Z_FINISH);
  result.resize(stream.total_out);
  deflateEnd(&stream);
  return result;
}

std::string bzipped(const std::string& bytes) {
  std::string result(bytes.size() + 1000, '\0');
  auto size = static_cast<unsigned>(result.size());
  BZ2_bzBuffToBuffCompress(result.data(), &size, const_cast<char*>(bytes.data()),
                           static_cast<unsigned>(bytes.size()), 9, 0, 0);
  result.resize(size);
  return result;
}

std::string in_hex(const std::string& bytes) {
  std::string result;
  for (const char c : bytes) {
    const auto byte = static_cast<unsigned char>(c);
    result += "0123456789aBcDeF"[byte >> 4];
    result += "0123456789abcdef"[byte & 15];
    if (result.size() % 7 == 0) result += '\n'; // line breaks may part the digits of a byte
  }
  return result;
}

template <class T>
std::string in_words(const std::vector<T>& numbers) {
  std::string result;
  for (const T number : numbers) result += text(+number, result.size() % 5 == 0 ? "\n" : ", ");
  return result;
}

std::string encoded(const std::string& encoding, const std::string& bytes) {
  if (encoding == "gzip") return gzipped(bytes);
  if (encoding == "bzip2") return bzipped(bytes);
  if (encoding == "hex") return in_hex(bytes);
  return bytes;
}

// A header of 2x3x4 u8 samples, with `lines` added.
std::string header(const std::string& lines, const std::string& encoding = "raw") {
  return "NRRD0004\ntype: uchar\ndimension: 3\nsizes: 2 3 4\nencoding: " + encoding + "\n" + lines;
}
std::string file(const std::string& lines) {
  return header(lines) + "\n" + bytes_of(counting<std::uint8_t>(24));
}

FieldInfo info_of(const std::string& content) {
  TemporaryFolder folder;
  write_content(folder / "f.nrrd", content);
  const auto reader = open_field({folder / "f.nrrd"});
  EXPECT_TRUE(reader) << reader.error().message;
  FieldInfo nothing;
  nothing.axes.resize(4);
  return reader ? (*reader)->info() : nothing;
}

Error error_of(const std::string& content) {
  TemporaryFolder folder;
  write_content(folder / "f.nrrd", content);
  const auto reader = open_field({folder / "f.nrrd"});
  if (!reader) {
    expect_error_names(reader.error(), "f.nrrd");
    return reader.error();
  }
  const auto field = (*reader)->read();
  EXPECT_FALSE(field);
  if (field) return {Code::internal, "no error"};
  expect_error_names(field.error(), "f.nrrd");
  return field.error();
}

// The whole, and every range of steps, in any order.
template <class T>
void expect_samples(const std::filesystem::path& path, const std::vector<T>& samples) {
  const auto reader = open_field({path});
  ASSERT_TRUE(reader) << reader.error().message;
  ASSERT_EQ((*reader)->info().type, sample_type_of<T>());
  const std::int64_t steps = (*reader)->info().axes.back().count;
  const auto step = static_cast<std::ptrdiff_t>(samples.size()) / steps;
  for (const bool forwards : {true, false})
    for (std::int64_t i = 0; i < steps; ++i)
      for (std::int64_t length = 1; length <= steps; ++length) {
        const std::int64_t begin = forwards ? i : steps - 1 - i, end = std::min(begin + length, steps);
        const auto part = (*reader)->read(begin, end);
        ASSERT_TRUE(part) << part.error().message;
        ASSERT_EQ(samples_of<T>(*part),
                  std::vector<T>(samples.begin() + begin * step, samples.begin() + end * step))
            << begin << ":" << end;
      }
}

template <class T>
void expect_every_encoding(const std::string& type) {
  TemporaryFolder folder;
  const auto samples = counting<T>(24);
  for (const std::string encoding : {"raw", "gzip", "bzip2", "hex"})
    for (const bool swapped : {false, true}) {
      const std::string data = encoded(encoding, bytes_of(samples, swapped));
      const std::string fields = "NRRD0003\ntype: " + type +
                                 "\ndimension: 3\nsizes: 2 3 4\nencoding: " + encoding +
                                 "\nendian: " + (swapped ? "big" : "little") + "\n";
      write_content(folder / "f.nrrd", fields + "\n" + data);
      expect_samples(folder / "f.nrrd", samples);
      write_content(folder / "d.nhdr", fields + "data file: some data.bin\n");
      write_content(folder / "some data.bin", data);
      expect_samples(folder / "d.nhdr", samples);
    }
  write_content(folder / "f.nrrd", "NRRD0001\ntype: " + type +
                                       "\ndimension: 3\nsizes: 2 3 4\nencoding: ascii\n\n" +
                                       in_words(samples));
  expect_samples(folder / "f.nrrd", samples);
}

} // namespace

TEST(Nrrd, every_type_encoding_and_byte_order) {
  expect_every_encoding<std::uint8_t>("unsigned char");
  expect_every_encoding<std::int8_t>("int8_t");
  expect_every_encoding<std::uint16_t>("UShort");
  expect_every_encoding<std::int16_t>("signed short int");
  expect_every_encoding<std::uint32_t>("uint32");
  expect_every_encoding<std::int32_t>("int");
  expect_every_encoding<float>("float");
  expect_every_encoding<double>("double");
}

TEST(Nrrd, text_with_nan_and_infinity) {
  TemporaryFolder folder;
  write_content(folder / "f.nrrd", "NRRD0001\ntype: float\ndimension: 2\nsizes: 3 2\nencoding: text\n\n"
                                   "nan -inf +1.5 1e-60 1e60 -0\n");
  const auto reader = open_field({folder / "f.nrrd"});
  ASSERT_TRUE(reader) << reader.error().message;
  const auto field = (*reader)->read();
  ASSERT_TRUE(field) << field.error().message;
  const auto samples = samples_of<float>(*field);
  EXPECT_TRUE(std::isnan(samples[0]));
  EXPECT_EQ(std::vector<float>(samples.begin() + 1, samples.end()),
            (std::vector<float>{-HUGE_VALF, 1.5f, 0, HUGE_VALF, -0.f}));
}

TEST(Nrrd, other_spellings_comments_and_line_ends) {
  const FieldInfo info = info_of("NRRD00.01\r\nContent: a name: with colons\r\n# sizes: 1\r\nType:uint8\r\n"
                                 "dimension: 3\r\nsizes: 2 3 4\r\naxismins: 1 nan 3\r\naxismaxs: 2 2 nan\r\n"
                                 "encoding: raw\r\nkey with: colon:=va\\nlue\r\n\r\n" +
                                 bytes_of(counting<std::uint8_t>(24)));
  EXPECT_EQ(info.name, "a name: with colons");
  EXPECT_EQ(coordinates_of(info.axes[0]), (std::vector<double>{1, 2}));
  EXPECT_EQ(coordinates_of(info.axes[1]), (std::vector<double>{0, 1, 2}));
  EXPECT_EQ(info.axes[2].origin, 3);
}

TEST(Nrrd, positions_by_mins_maxs_spacings_and_centring) {
  const auto axes = [](const std::string& lines) { return info_of(file(lines)).axes; };
  EXPECT_EQ(coordinates_of(axes("axis mins: 0 10 0\naxis maxs: 1 11 1\n")[1]),
            (std::vector<double>{10, 10.5, 11}));
  EXPECT_EQ(coordinates_of(axes("axis mins: 0 11 0\naxis maxs: 1 10 1\n")[1]),
            (std::vector<double>{11, 10.5, 10}));
  EXPECT_EQ(coordinates_of(axes("centerings: cell cell cell\naxis mins: 0 0 0\naxis maxs: 2 6 4\n")[1]),
            (std::vector<double>{1, 3, 5}));
  EXPECT_EQ(coordinates_of(axes("centers: node cell ???\nspacings: 1 -2 1\naxis mins: 5 5 5\n")[1]),
            (std::vector<double>{4, 2, 0}));
  EXPECT_EQ(coordinates_of(axes("spacings: 1 0.5 nan\naxis maxs: nan 3 nan\n")[1]),
            (std::vector<double>{2, 2.5, 3}));
  EXPECT_EQ(error_of(file("spacings: 1 0 1\n")).code, Code::file_malformed);
  EXPECT_EQ(error_of(file("spacings: 1 inf 1\n")).code, Code::file_malformed);
  EXPECT_EQ(error_of(file("axis mins: 1 1 1\naxis maxs: 1 1 1\n")).code, Code::file_malformed);
}

TEST(Nrrd, names_and_units) {
  const FieldInfo info =
      info_of(file("labels: \"left \\\"x\\\"\" \"\" \"depth\"\nunits: \"mm\" \"\" \"km\"\n"));
  EXPECT_EQ(names_of(info), (std::vector<std::string>{"left \"x\"", "y", "depth"}));
  EXPECT_EQ(info.axes[0].unit, "mm");
  EXPECT_EQ(info.axes[2].unit, "km");
  EXPECT_EQ(error_of(file("labels: \"x\" \"y\"\n")).code, Code::file_malformed);
  EXPECT_EQ(error_of(file("labels: \"x\" \"y\" \"z\n")).code, Code::file_malformed);
}

// 3D Slicer puts time first, most others last; either way it is the field's last axis, and each sample stays
// with its position and time.
TEST(Nrrd, time_first_as_slicer_writes_it) {
  TemporaryFolder folder;
  for (const std::string kind : {"list", "time"}) {
    const std::string fields =
        header("kinds: " + kind +
                   " domain domain\nspace dimension: 2\nspace directions: none (2,0) (0,-3)\n"
                   "space origin: (5,6)\nlabels: \"frame\" \"\" \"\"\nspace units: \"mm\" \"cm\"\n"
                   "units: \"s\" \"\" \"\"\naxis 0 index values:=0.5 1.5\n",
               "gzip");
    write_content(folder / "f.nrrd", fields + "\n" + gzipped(bytes_of(counting<std::uint8_t>(24, 0))));
    const auto reader = open_field({folder / "f.nrrd"});
    ASSERT_TRUE(reader) << reader.error().message;
    const FieldInfo& info = (*reader)->info();
    EXPECT_TRUE(info.has_time);
    EXPECT_EQ(names_of(info), (std::vector<std::string>{"x", "y", "frame"}));
    EXPECT_EQ(dims_of(info), (std::vector<std::int64_t>{3, 4, 2}));
    EXPECT_EQ(coordinates_of(info.axes[0]), (std::vector<double>{5, 7, 9}));
    EXPECT_EQ(coordinates_of(info.axes[1]), (std::vector<double>{6, 3, 0, -3}));
    EXPECT_EQ(coordinates_of(info.axes[2]), (std::vector<double>{0.5, 1.5}));
    EXPECT_EQ(info.axes[1].unit, "cm");
    EXPECT_EQ(info.axes[2].unit, "s");
    EXPECT_FALSE(info.world);
    for (std::int64_t step = 0; step < 2; ++step) {
      const auto field = (*reader)->read(step, step + 1);
      ASSERT_TRUE(field) << field.error().message;
      const auto samples = samples_of<std::uint8_t>(*field);
      for (std::size_t i = 0; i < 12; ++i) EXPECT_EQ(samples[i], 2 * i + static_cast<std::size_t>(step));
    }
  }
}

TEST(Nrrd, which_axis_is_time) {
  const auto time_of = [](const std::string& lines) {
    const FieldInfo info = info_of(file(lines));
    return info.has_time ? dims_of(info).back() : 0;
  };
  EXPECT_EQ(time_of(""), 0);
  EXPECT_EQ(time_of("kinds: domain time domain\n"), 3);
  EXPECT_EQ(time_of("kinds: domain domain list\n"), 4);
  EXPECT_EQ(time_of("labels: \"Time\" \"a\" \"b\"\n"), 2);
  EXPECT_EQ(time_of("labels: \"t\" \"a\" \"t\"\n"), 0);
  const std::string four = "NRRD0004\ntype: uchar\ndimension: 4\nsizes: 1 2 3 4\nencoding: raw\n";
  const std::string data = std::string("\n") + bytes_of(counting<std::uint8_t>(24));
  EXPECT_TRUE(info_of(four + data).has_time);
  const FieldInfo spatial = info_of(four + "kinds: space space space space\n" + data);
  EXPECT_FALSE(spatial.has_time);
  EXPECT_EQ(names_of(spatial), (std::vector<std::string>{"x0", "x1", "x2", "x3"}));
  const FieldInfo in_space_time = info_of(four +
                                          "space: right-anterior-superior-time\nspace directions: (0,0,0,2) "
                                          "(3,0,0,0) (0,4,0,0) (0,0,5,0)\nspace origin: (1,2,3,4)\n" +
                                          data);
  EXPECT_TRUE(in_space_time.has_time);
  EXPECT_EQ(dims_of(in_space_time), (std::vector<std::int64_t>{2, 3, 4, 1}));
  EXPECT_EQ(in_space_time.axes[3].spacing, 2);
  EXPECT_EQ(in_space_time.axes[3].origin, 4);
  EXPECT_EQ(in_space_time.axes[0].spacing, 3);
  EXPECT_FALSE(in_space_time.world);
}

TEST(Nrrd, oblique_directions_become_an_affine_map) {
  const FieldInfo info = info_of(file("kinds: time domain domain\nspace dimension: 2\n"
                                      "space directions: none (3,4) (-8,6)\nspace origin: (1,2)\n"));
  ASSERT_TRUE(info.world);
  EXPECT_EQ(info.axes[0].spacing, 5);
  EXPECT_EQ(info.axes[1].spacing, 10);
  EXPECT_EQ(info.world->linear, (std::vector<double>{0.6, -0.8, 0, 0.8, 0.6, 0, 0, 0, 1}));
  EXPECT_EQ(info.world->offset, (std::vector<double>{1, 2, 0}));
  EXPECT_EQ(error_of(file("space dimension: 3\nspace directions: (1,0,0) (0,1,0) (1,1,0)\n")).code,
            Code::file_malformed);
}

// A plane of a volume in space has no map of its own to the world: its spacings are right all the same.
TEST(Nrrd, fewer_axes_than_the_space_has_dimensions) {
  const FieldInfo info =
      info_of("NRRD0004\ntype: uchar\ndimension: 2\nsizes: 4 6\nencoding: raw\nspace: LPS\n"
              "space directions: (0,3,4) (2,0,0)\nspace origin: (1,1,1)\n\n" +
              bytes_of(counting<std::uint8_t>(24)));
  EXPECT_FALSE(info.world);
  EXPECT_EQ(info.axes[0].spacing, 5);
  EXPECT_EQ(info.axes[1].spacing, 2);
}

TEST(Nrrd, components_of_one_value_are_refused_unless_there_is_one) {
  const Error error = error_of(file("kinds: complex domain domain\n"));
  EXPECT_EQ(error.code, Code::file_unsupported);
  EXPECT_NE(error.message.find("unu slice"), std::string::npos);
  EXPECT_EQ(error_of(file("kinds: RGB-color domain domain\n")).code, Code::file_unsupported);
  EXPECT_EQ(error_of(file("kinds: list time domain\n")).code, Code::file_unsupported);
  EXPECT_EQ(error_of(file("kinds: time time domain\n")).code, Code::file_malformed);
  const FieldInfo info = info_of("NRRD0004\ntype: uchar\ndimension: 3\nsizes: 1 6 4\nencoding: raw\n"
                                 "kinds: stub domain domain\nspacings: nan 2 3\n\n" +
                                 bytes_of(counting<std::uint8_t>(24)));
  EXPECT_EQ(dims_of(info), (std::vector<std::int64_t>{6, 4}));
  EXPECT_EQ(names_of(info), (std::vector<std::string>{"x", "y"}));
  EXPECT_EQ(info.axes[0].spacing, 2);
}

TEST(Nrrd, one_file_for_each_step) {
  TemporaryFolder folder;
  const auto samples = counting<std::uint16_t>(24);
  const std::string fields = "NRRD0004\ntype: ushort\ndimension: 3\nsizes: 2 3 4\nendian: little\nencoding: ";
  for (const std::string encoding : {"raw", "gzip"}) {
    std::string list = "data file: LIST\n";
    for (std::size_t step = 0; step < 4; ++step) {
      const std::vector<std::uint16_t> part(samples.begin() + static_cast<std::ptrdiff_t>(6 * step),
                                            samples.begin() + static_cast<std::ptrdiff_t>(6 * step + 6));
      const std::string data = encoded(encoding, bytes_of(part));
      write_content(folder / (text("step", step, ".raw")), data);
      write_content(folder / (text("down-00", 9 - 2 * step, ".raw")), data);
      list += text("step", step, ".raw\n");
    }
    write_content(folder / "list.nhdr", fields + encoding + "\n" + list);
    expect_samples(folder / "list.nhdr", samples);
    write_content(folder / "pattern.nhdr", fields + encoding + "\ndata file: step%d.raw 0 3 1\n");
    expect_samples(folder / "pattern.nhdr", samples);
    write_content(folder / "padded.nhdr", fields + encoding + "\ndata file: down-%03d.raw 9 3 -2 2\n");
    expect_samples(folder / "padded.nhdr", samples);
  }
  const auto error = [&](const std::string& data_file) {
    write_content(folder / "bad.nhdr", fields + "raw\ndata file: " + data_file + "\n");
    const auto reader = open_field({folder / "bad.nhdr"});
    EXPECT_FALSE(reader) << data_file;
    return reader ? Error{Code::internal, "no error"} : reader.error();
  };
  EXPECT_EQ(error("step%d.raw 0 4 1").code, Code::file_malformed); // five names for four steps
  EXPECT_EQ(error("step%d.raw 4 7 1").code, Code::file_not_found);
  EXPECT_EQ(error("step%d.raw 0 3 0").code, Code::file_malformed);
  EXPECT_EQ(error("step%d.raw 3 0 1").code, Code::file_malformed);
  EXPECT_EQ(error("step%d.raw 0 3 1 7").code, Code::file_malformed);
  EXPECT_EQ(error("step%d.raw 0 99999999999 1").code, Code::file_malformed);
  EXPECT_EQ(error("step%099999999d.raw 0 3 1").code, Code::file_not_found);
  EXPECT_EQ(error("LIST\nstep0.raw\nstep1.raw").code, Code::file_malformed);
  EXPECT_EQ(error("LIST\nstep0.raw\nstep1.raw\nstep2.raw\nlist.nhdr").code, Code::file_malformed);
  EXPECT_EQ(error("none.raw").code, Code::file_not_found);
  EXPECT_EQ(error("").code, Code::file_malformed);
}

// Slabs of the last axis: as many steps in each file as there are.
TEST(Nrrd, several_steps_in_each_file) {
  TemporaryFolder folder;
  const auto samples = counting<std::uint8_t>(24);
  write_content(folder / "a", bytes_of(samples).substr(0, 12));
  write_content(folder / "b", bytes_of(samples).substr(12));
  write_content(folder / "f.nhdr", header("data file: LIST 3\na\nb\n"));
  expect_samples(folder / "f.nhdr", samples);
  write_content(
      folder / "one.nhdr", header("data file: LIST 1\n") + [] {
        std::string names;
        for (int i = 0; i < 12; ++i) names += text("row", i, "\n");
        return names;
      }());
  for (std::size_t i = 0; i < 12; ++i)
    write_content(folder / (text("row", i)), bytes_of(samples).substr(2 * i, 2));
  expect_samples(folder / "one.nhdr", samples);
}

TEST(Nrrd, skipped_lines_and_bytes) {
  TemporaryFolder folder;
  const auto samples = counting<std::uint8_t>(24);
  const std::string data = bytes_of(samples);
  const auto expect = [&](const std::string& lines, const std::string& content,
                          const std::string& encoding = "raw") {
    write_content(folder / "data", content);
    write_content(folder / "f.nhdr", header(lines + "data file: data\n", encoding));
    expect_samples(folder / "f.nhdr", samples);
  };
  expect("line skip: 2\n", "one\n two\n" + data);
  expect("byte skip: 3\n", "abc" + data);
  expect("byte skip: 3\n", "abc" + data + "more");
  expect("line skip: 1\nbyte skip: 3\n", "one\nabc" + data);
  expect("byte skip: -1\n", "anything" + data);
  expect("byte skip: -4\n", "anything" + data + "abc");
  expect("line skip: 1\nbyteskip: 3\n", "one\n" + gzipped("abc" + data), "gzip");
  expect("byte skip: 3\n", gzipped("abc" + data + "more"), "gzip");
  expect("line skip: 1\n", "numbers\n" + in_words(samples), "text");

  const auto error = [&](const std::string& lines) { return error_of(file(lines)).code; };
  EXPECT_EQ(error("line skip: 99\n"), Code::file_malformed);
  EXPECT_EQ(error("line skip: -1\n"), Code::file_malformed);
  EXPECT_EQ(error("byte skip: 1\n"), Code::file_malformed);
  EXPECT_EQ(error("byte skip: 9223372036854775807\n"), Code::file_malformed);
  EXPECT_EQ(error("byte skip: -9223372036854775808\n"), Code::file_malformed);
  EXPECT_EQ(error("byte skip: -1000000\n"), Code::file_malformed);
}

TEST(Nrrd, headers_that_contradict_themselves_or_the_file) {
  const std::string data = std::string("\n") + bytes_of(counting<std::uint8_t>(24));
  for (const std::string lines : {
           "NRRD0009\ntype: uchar\ndimension: 1\nsizes: 24\nencoding: raw\n",
           "NRRD0004\ntype: uchar\ndimension: 1\nsizes: 25\nencoding: raw\n",
           "NRRD0004\ntype: uchar\ndimension: 1\nsizes: 23\nencoding: raw\n",
           "NRRD0004\ntype: uchar\ndimension: 2\nsizes: 24\nencoding: raw\n",
           "NRRD0004\ntype: uchar\ndimension: 0\nsizes:\nencoding: raw\n",
           "NRRD0004\ntype: uchar\ndimension: 17\nsizes: 24 1 1 1 1 1 1 1 1 1 1 1 1 1 1 1 1\nencoding: raw\n",
           "NRRD0004\ntype: uchar\ndimension: 1\nsizes: -24\nencoding: raw\n",
           "NRRD0004\ntype: uchar\ndimension: 1\nsizes: 0\nencoding: raw\n",
           "NRRD0004\ntype: uchar\ndimension: 1\nsizes: 24 \ndimension: 1\nencoding: raw\n",
           "NRRD0004\ntype: uchar\ndimension: 2\nsizes: 4294967296 4294967296\nencoding: raw\n",
           "NRRD0004\ntype: uchar\ndimension: 1\nsizes: 99999999999999999999\nencoding: raw\n",
           "NRRD0004\ntype: uchar\ndimension: 2\nsizes: 1000000000 1000000000\nencoding: gzip\n",
           "NRRD0004\ntype: uchar\ndimension: 2\nsizes: 1000000000 1000000000\nencoding: bzip2\n",
           "NRRD0004\ntype: uchar\ndimension: 2\nsizes: 1000000000 1000000000\nencoding: text\n",
           "NRRD0004\ntype: uchar\ndimension: 2\nsizes: 1000000000 1000000000\nencoding: hex\n",
           "NRRD0004\ntype: short\ndimension: 1\nsizes: 12\nencoding: raw\n", // no endian
           "NRRD0004\ntype: short\ndimension: 1\nsizes: 12\nencoding: raw\nendian: middle\n",
           "NRRD0004\ntype: number\ndimension: 1\nsizes: 24\nencoding: raw\n",
           "NRRD0004\ndimension: 1\nsizes: 24\nencoding: raw\n",
           "NRRD0004\ntype: uchar\nsizes: 24\nencoding: raw\n",
           "NRRD0004\ntype: uchar\ndimension: 1\nencoding: raw\n",
           "NRRD0004\ntype: uchar\ndimension: 1\nsizes: 24\n",
           "NRRD0004\ntype: uchar\ndimension: 1\nsizes: 24\nencoding: raw\nnonsense\n",
           "NRRD0004\ntype: uchar\ndimension: 1\nsizes: 24\nencoding: raw\nspacing: 1\n",
           "NRRD0004\ntype: uchar\ndimension: 1\nsizes: 24\nencoding: raw\nspace: LPS\nspace directions: "
           "(1,0)\n",
           "NRRD0004\ntype: uchar\ndimension: 1\nsizes: 24\nencoding: raw\nspace dimension: 1000000000\n",
           "NRRD0004\ntype: uchar\ndimension: 1\nsizes: 24\nencoding: raw\nspace dimension: 1\nspace "
           "directions: (1) (1)\n",
           "NRRD0004\ntype: uchar\ndimension: 1\nsizes: 24\nencoding: raw\nspace dimension: 1\nspace origin: "
           "5\n",
           "NRRD0004\ntype: uchar\ndimension: 1\nsizes: 24\nencoding: raw\nlabels: \"t\"\nhyperiso axis "
           "coordinates t:=1 2\n",
           "PNG\n",
       }) {
    const Error error = error_of(lines + data);
    EXPECT_TRUE(error.code == Code::file_malformed || error.code == Code::file_unsupported)
        << lines << error.message;
  }
}

TEST(Nrrd, types_and_encodings_of_the_format_that_are_not_read) {
  for (const std::string type : {"int64", "unsigned long long int", "block"})
    EXPECT_EQ(error_of("NRRD0004\ntype: " + type +
                       "\ndimension: 1\nsizes: 3\nencoding: raw\nendian: little\n\n" + std::string(24, '\0'))
                  .code,
              Code::file_unsupported);
  EXPECT_EQ(error_of(header("", "zrl") + "\n").code, Code::file_unsupported);
}

TEST(Nrrd, compressed_data_that_are_damaged_truncated_or_followed_by_others) {
  const std::string bytes = bytes_of(counting<std::uint8_t>(24));
  for (const std::string encoding : {"gzip", "bzip2"}) {
    const std::string start = header("", encoding) + "\n", data = encoded(encoding, bytes);
    for (std::size_t size = 0; size < data.size(); ++size)
      EXPECT_EQ(error_of(start + data.substr(0, size)).code, Code::file_malformed) << encoding << size;
    EXPECT_EQ(error_of(start + data + "garbage").code, Code::file_malformed);
    EXPECT_EQ(error_of(start + data + data).code, Code::file_malformed);
    EXPECT_EQ(error_of(start + encoded(encoding, bytes + "1")).code, Code::file_malformed);
    EXPECT_EQ(error_of(start + encoded(encoding, bytes.substr(1))).code, Code::file_malformed);
    for (std::size_t i = data.size() - 8; i < data.size() && encoding == "gzip"; ++i) { // its checksums
      std::string damaged = data;
      damaged[i] = static_cast<char>(damaged[i] ^ 0x40);
      EXPECT_EQ(error_of(start + damaged).code, Code::file_malformed) << i;
    }
    TemporaryFolder folder; // members one after the other are one stream
    write_content(folder / "f.nrrd",
                  start + encoded(encoding, bytes.substr(0, 7)) + encoded(encoding, bytes.substr(7)));
    expect_samples(folder / "f.nrrd", counting<std::uint8_t>(24));
  }
}

// A reader of some steps must not pay for, nor be stopped by, what follows them.
TEST(Nrrd, steps_before_a_damage_are_read) {
  TemporaryFolder folder;
  std::vector<std::uint8_t> samples;
  for (std::uint32_t i = 0, state = 1; i < 40000; ++i)
    samples.push_back(static_cast<std::uint8_t>((state = state * 1664525 + 1013904223) >> 24));
  const std::string data = gzipped(bytes_of(samples));
  write_content(folder / "f.nrrd", "NRRD0001\ntype: uchar\ndimension: 2\nsizes: 10000 4\nencoding: gzip\n\n" +
                                       data.substr(0, data.size() * 3 / 4));
  const auto reader = open_field({folder / "f.nrrd"});
  ASSERT_TRUE(reader) << reader.error().message;
  EXPECT_TRUE((*reader)->read(0, 2));
  EXPECT_FALSE((*reader)->read(1, 4));
  const auto again = (*reader)->read(1, 2);
  ASSERT_TRUE(again) << again.error().message;
  EXPECT_EQ(samples_of<std::uint8_t>(*again),
            std::vector<std::uint8_t>(samples.begin() + 10000, samples.begin() + 20000));
}

TEST(Nrrd, text_that_is_no_number_of_its_type) {
  const std::string start = header("", "ascii") + "\n";
  const std::string numbers = in_words(counting<std::uint8_t>(23));
  EXPECT_EQ(error_of(start + numbers).code, Code::file_malformed);
  EXPECT_EQ(error_of(start + numbers + " 1 2").code, Code::file_malformed);
  for (const std::string word : {"256", "-1", "1.5", "x", "1x", "0x1"})
    EXPECT_EQ(error_of(start + numbers + word).code, Code::file_malformed) << word;
}
