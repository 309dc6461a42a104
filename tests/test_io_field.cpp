#include "core/text.hpp"
#include "field_files.hpp"
#include "temporary_folder.hpp"

#include <gtest/gtest.h>
#include <limits>

using namespace hyperiso;

namespace {

namespace fs = std::filesystem;

Axis axis_of(std::int64_t count, double origin, double spacing, std::string name, std::string unit = "") {
  Axis axis;
  axis.count = count;
  axis.origin = origin;
  axis.spacing = spacing;
  axis.name = std::move(name);
  axis.unit = std::move(unit);
  return axis;
}

// Samples that use the whole range of the type, with NaN and infinities where it has them.
template <class T>
Field field_of(std::vector<Axis> axes, bool has_time) {
  FieldInfo info;
  info.name = "density <&\"\\>";
  info.type = sample_type_of<T>();
  info.axes = std::move(axes);
  info.has_time = has_time;
  auto memory = allocate_field(info);
  auto* samples = reinterpret_cast<T*>(memory->samples);
  const auto count = static_cast<std::size_t>(info.samples());
  for (std::size_t i = 0; i < count; ++i) samples[i] = static_cast<T>(i * 37 % 251);
  using Limits = std::numeric_limits<T>;
  samples[0] = Limits::lowest();
  samples[1] = Limits::max();
  if (Limits::has_infinity) {
    samples[2] = Limits::quiet_NaN();
    samples[3] = -Limits::infinity();
  }
  return std::move(memory->field);
}

template <class T>
Field space_time_field() {
  return field_of<T>({axis_of(4, 0.1, 0.3, "x", "mm"), axis_of(3, -1, 2, "y", "mm"),
                      axis_of(2, 5, 0.25, "z", "mm"), axis_of(5, 10, 0.1, "t", "s")},
                     true);
}

template <class T>
std::string bits_of(const Field& field) {
  return bytes_of(samples_of<T>(field));
}

Result<Field> read_all(const fs::path& path, const ReadOptions& options = {}) {
  auto reader = open_field({path}, options);
  if (!reader) return reader.error();
  return (*reader)->read();
}

void expect_same_axes(const FieldInfo& found, const FieldInfo& expected, bool with_units) {
  ASSERT_EQ(dims_of(found), dims_of(expected));
  EXPECT_EQ(names_of(found), names_of(expected));
  EXPECT_EQ(found.has_time, expected.has_time);
  for (std::size_t axis = 0; axis < expected.axes.size(); ++axis) {
    EXPECT_EQ(coordinates_of(found.axes[axis]), coordinates_of(expected.axes[axis])) << axis;
    EXPECT_EQ(found.axes[axis].unit, with_units ? expected.axes[axis].unit : "");
  }
}

template <class T>
class EveryType : public testing::Test {};
using Types = testing::Types<std::uint8_t, std::int8_t, std::uint16_t, std::int16_t, std::uint32_t,
                             std::int32_t, float, double>;
TYPED_TEST_SUITE(EveryType, Types);

} // namespace

TYPED_TEST(EveryType, what_is_written_is_read_back) {
  TemporaryFolder folder;
  const Field field = space_time_field<TypeParam>();
  const std::string bits = bits_of<TypeParam>(field);
  for (const char* name : {"f.nrrd", "z.nrrd", "f.pvd", "f.npy", "f.raw"}) {
    WriteFieldOptions options;
    options.compress = name[0] == 'z';
    const auto written = write_field(field, folder / name, options);
    ASSERT_TRUE(written) << written.error().message;
    ReadOptions how;
    if (name == std::string("f.raw")) {
      how.dims = dims_of(field.info);
      how.type = field.info.type;
    }
    const auto read = read_all(folder / name, how);
    ASSERT_TRUE(read) << read.error().message;
    ASSERT_EQ(read->info.type, field.info.type);
    EXPECT_EQ(bits_of<TypeParam>(*read), bits) << name;
    const std::string suffix = fs::path(name).extension().string();
    if (suffix == ".nrrd" || suffix == ".pvd") {
      expect_same_axes(read->info, field.info, suffix == ".nrrd");
      EXPECT_EQ(read->info.name, field.info.name);
    } else {
      EXPECT_EQ(dims_of(read->info), dims_of(field.info));
    }
  }
  EXPECT_EQ(folder.names(),
            (std::vector<std::string>{"f.npy", "f.nrrd", "f.pvd", "f.raw", "f_0000.vti", "f_0001.vti",
                                      "f_0002.vti", "f_0003.vti", "f_0004.vti", "z.nrrd"}));
}

// Raw samples begin at a multiple of any sample's size, so that readers can use them in place.
TEST(WriteField, raw_samples_are_aligned) {
  TemporaryFolder folder;
  for (const std::string name : {"", "a", "ab", "abc"}) {
    Field field = space_time_field<double>();
    field.info.name = name;
    for (const char* file : {"f.nrrd", "f.npy"}) {
      ASSERT_TRUE(write_field(field, folder / file));
      EXPECT_EQ((fs::file_size(folder / file) - field.info.bytes()) % 64, 0u);
      ReadOptions options;
      options.memory_limit = 0; // mapped samples take none
      const auto read = read_all(folder / file, options);
      EXPECT_TRUE(read) << read.error().message;
    }
  }
}

TEST(WriteField, samples_in_any_order_in_memory) {
  TemporaryFolder folder;
  const Field field =
      field_of<std::uint16_t>({axis_of(2, 0, 1, "x"), axis_of(3, 0, 1, "y"), axis_of(4, 0, 1, "z")}, false);
  ASSERT_TRUE(write_field(field, folder / "f.raw"));
  ReadOptions options;
  options.dims = dims_of(field.info);
  options.type = SampleType::u16;
  for (const char* time : {"0", "1", "2"}) {
    options.time_axis = time;
    auto permuted = read_all(folder / "f.raw", options);
    ASSERT_TRUE(permuted) << permuted.error().message;
    for (const auto& piece :
         {*permuted, permuted->cropped(0, 1, 2), permuted->cropped(1, 1, 3), permuted->cropped(2, 1, 2)})
      for (const char* name : {"p.nrrd", "p.npy", "p.pvd"}) {
        ASSERT_TRUE(write_field(piece, folder / name));
        const auto again = read_all(folder / name);
        ASSERT_TRUE(again) << again.error().message;
        EXPECT_EQ(samples_of<std::uint16_t>(*again), samples_of<std::uint16_t>(piece)) << name << time;
      }
  }
}

// 0.1 + 3 * 0.1 is not 0.4: a crop must remember where the whole began to keep its coordinates to the bit.
TEST(WriteField, a_crop_keeps_its_coordinates_to_the_bit) {
  TemporaryFolder folder;
  const Field whole = field_of<float>({axis_of(40, 0.1, 0.1, "x"), axis_of(30, 0.7, -0.3, "y")}, false);
  const Field crop = whole.cropped(0, 3, 29).cropped(1, 2, 17);
  for (const char* name : {"c.nrrd", "c.vti"}) {
    ASSERT_TRUE(write_field(crop, folder / name));
    const auto read = read_all(folder / name);
    ASSERT_TRUE(read) << read.error().message;
    EXPECT_EQ(coordinates_of(read->info.axes[0]), coordinates_of(crop.info.axes[0]));
    auto fallen = coordinates_of(crop.info.axes[1]);
    if (name == std::string("c.vti"))
      std::ranges::reverse(fallen); // written backwards: VTK wants rising axes
    EXPECT_EQ(coordinates_of(read->info.axes[1]), fallen);
  }
  const auto flipped = read_all(folder / "c.vti");
  const auto samples = samples_of<float>(*flipped), expected = samples_of<float>(crop);
  for (std::size_t y = 0; y < 15; ++y)
    for (std::size_t x = 0; x < 26; ++x) ASSERT_EQ(samples[y * 26 + x], expected[(14 - y) * 26 + x]);
}

TEST(WriteField, uneven_axes) {
  TemporaryFolder folder;
  Field field = space_time_field<float>();
  field.info.axes[3].coordinates = {0, 0.1, 0.7, 1e10, 1e11};
  for (const char* name : {"f.nrrd", "f.pvd"}) {
    ASSERT_TRUE(write_field(field, folder / name));
    const auto read = read_all(folder / name);
    ASSERT_TRUE(read) << read.error().message;
    expect_same_axes(read->info, field.info, name == std::string("f.nrrd"));
  }
  field.info.axes[2].coordinates = {7, 3};
  ASSERT_TRUE(write_field(field, folder / "g.nrrd"));
  const auto read = read_all(folder / "g.nrrd");
  ASSERT_TRUE(read) << read.error().message;
  expect_same_axes(read->info, field.info, true);
  const auto refused = write_field(field, folder / "g.pvd");
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().code, Code::file_unsupported);
  expect_error_names(refused.error(), "axis z");
  field.info.axes[1].name = "z"; // two names, one key
  EXPECT_EQ(write_field(field, folder / "g.nrrd").error().code, Code::invalid_argument);
}

TEST(WriteField, four_spatial_axes_are_not_taken_for_time) {
  TemporaryFolder folder;
  Field field = space_time_field<float>();
  field.info.has_time = false;
  field.info.axes[3].name = "w";
  ASSERT_TRUE(write_field(field, folder / "f.nrrd"));
  const auto read = read_all(folder / "f.nrrd");
  ASSERT_TRUE(read) << read.error().message;
  EXPECT_FALSE(read->info.has_time);
  EXPECT_EQ(write_field(field, folder / "f.vti").error().code, Code::file_unsupported);
}

// What counts is where samples are in the world: axis coordinates may change with it.
TEST(WriteField, an_affine_map_keeps_positions_in_the_world) {
  const auto position = [](const FieldInfo& info, const std::vector<std::int64_t>& index) {
    std::vector<double> result = info.world->offset;
    for (std::size_t row = 0; row < result.size(); ++row)
      for (std::size_t k = 0; k < result.size(); ++k)
        result[row] += info.world->linear[row * result.size() + k] * info.axes[k].coordinate(index[k]);
    return result;
  };
  TemporaryFolder folder;
  Field field = space_time_field<float>();
  field.info.world = Affine{{0, 2, 0, 0, -1, 0, 0.5, 0, 0, 0, 3, 0, 0, 0, 0, 1}, {1, 2, 3, 0}};
  const Field uneven = [&] {
    Field result = field;
    result.info.axes[1].coordinates = {1, 2, 4};
    return result;
  }();
  const Field mixing = [&] { // space moves with time
    Field result = field;
    result.info.world->linear[3] = 0.5;
    return result;
  }();
  for (const auto& [written, name] :
       {std::pair(field, "f.nrrd"), {field, "f.pvd"}, {uneven, "f.nrrd"}, {mixing, "f.nrrd"}}) {
    const auto status = write_field(written, folder / name);
    ASSERT_TRUE(status) << status.error().message;
    const auto read = read_all(folder / name);
    ASSERT_TRUE(read) << read.error().message;
    ASSERT_TRUE(read->info.world);
    EXPECT_TRUE(read->info.has_time);
    for (const std::vector<std::int64_t>& index :
         {std::vector<std::int64_t>{0, 0, 0, 0}, {3, 1, 0, 2}, {1, 2, 1, 4}}) {
      const auto expected = position(written.info, index), found = position(read->info, index);
      for (std::size_t row = 0; row < 4; ++row) EXPECT_NEAR(found[row], expected[row], 1e-12) << name << row;
    }
  }
  EXPECT_EQ(check_field_format(uneven.info, folder / "f.pvd").error().code, Code::file_unsupported);
  EXPECT_EQ(write_field(uneven, folder / "f.pvd").error().code, Code::file_unsupported);
  EXPECT_EQ(write_field(mixing, folder / "f.pvd").error().code, Code::file_unsupported);
}

TEST(WriteField, formats_by_suffix_or_by_name) {
  TemporaryFolder folder;
  const Field field = space_time_field<float>();
  const auto code = [&](const char* name, const char* format, bool compress = false) {
    WriteFieldOptions options;
    options.format = format;
    options.compress = compress;
    const auto status = write_field(field, folder / name, options);
    EXPECT_FALSE(status) << name;
    return status ? Code::internal : status.error().code;
  };
  EXPECT_EQ(code("f.dat", ""), Code::file_unsupported);
  EXPECT_EQ(code("f", ""), Code::file_unsupported);
  EXPECT_EQ(code("f.nrrd", "jpeg"), Code::file_unsupported);
  EXPECT_EQ(code("f.npy", "", true), Code::invalid_argument);
  EXPECT_EQ(code("none/f.npy", ""), Code::file_unwritable);
  EXPECT_EQ(write_field({}, folder / "f.npy").error().code, Code::invalid_argument);
  EXPECT_TRUE(folder.names().empty());
  WriteFieldOptions options;
  options.format = "npy";
  ASSERT_TRUE(write_field(field, folder / "f.dat", options));
  EXPECT_EQ(content_of(folder / "f.dat").substr(1, 5), "NUMPY");
}

// The steps of a series appear together, or none does.
TEST(WriteField, a_series_that_fails_leaves_what_was_there) {
  TemporaryFolder folder;
  const Field field = space_time_field<float>();
  write_content(folder / "f_0001.vti", "before");
  fs::create_directory(folder / "f_0003.vti"); // cannot be replaced
  const auto status = write_field(field, folder / "f.vti");
  ASSERT_FALSE(status);
  EXPECT_EQ(status.error().code, Code::file_unwritable);
  EXPECT_EQ(folder.names(), (std::vector<std::string>{"f_0001.vti", "f_0003.vti"}));
  EXPECT_EQ(content_of(folder / "f_0001.vti"), "before");
}

TEST(WriteField, the_same_field_gives_the_same_bytes) {
  TemporaryFolder folder;
  WriteFieldOptions options;
  options.compress = true;
  for (const char* name : {"a.nrrd", "b.nrrd"})
    ASSERT_TRUE(write_field(space_time_field<float>(), folder / name, options));
  EXPECT_EQ(content_of(folder / "a.nrrd"), content_of(folder / "b.nrrd"));
}

TEST(ReadField, options_that_do_not_fit_the_format) {
  TemporaryFolder folder;
  const Field field = space_time_field<float>();
  for (const char* name : {"f.nrrd", "f.npy", "f.pvd", "f.raw"})
    ASSERT_TRUE(write_field(field, folder / name));
  ReadOptions raw, named;
  raw.dims = dims_of(field.info);
  raw.type = SampleType::f32;
  named.variable = "density";
  for (const char* name : {"f.nrrd", "f.npy", "f.pvd", "f_0000.vti"})
    EXPECT_EQ(read_all(folder / name, raw).error().code, Code::invalid_argument) << name;
  for (const char* name : {"f.nrrd", "f.npy", "f.pvd"})
    EXPECT_EQ(read_all(folder / name, named).error().code, Code::invalid_argument) << name;
  EXPECT_TRUE(read_all(folder / "f.raw", raw));
  named.variable = field.info.name;
  EXPECT_TRUE(read_all(folder / "f.pvd", named));
}

// No steps are a range too, after any other, whatever is kept from it.
TEST(ReadField, empty_ranges) {
  TemporaryFolder folder;
  const Field field = space_time_field<float>();
  WriteFieldOptions compressed;
  compressed.compress = true;
  ASSERT_TRUE(write_field(field, folder / "z.nrrd", compressed));
  for (const char* name : {"f.nrrd", "f.pvd"}) ASSERT_TRUE(write_field(field, folder / name));
  for (const char* name : {"z.nrrd", "f.nrrd", "f.pvd"}) {
    const auto reader = open_field({folder / name});
    ASSERT_TRUE(reader);
    for (std::int64_t step = 0; step <= 5; ++step) {
      const auto none = (*reader)->read(step, step);
      ASSERT_TRUE(none) << none.error().message;
      EXPECT_EQ(none->info.samples(), 0);
      ASSERT_TRUE((*reader)->read(0, step));
      EXPECT_TRUE((*reader)->read(std::max<std::int64_t>(step - 1, 0), std::max<std::int64_t>(step - 1, 0)));
    }
  }
}

TEST(ReadField, coordinates_beyond_all_numbers) {
  TemporaryFolder folder;
  write_content(folder / "f.nrrd", "NRRD0004\ntype: uchar\ndimension: 2\nsizes: 3 2\nencoding: raw\n"
                                   "spacings: 1e308 1\n\n123456");
  const auto read = read_all(folder / "f.nrrd");
  ASSERT_FALSE(read);
  EXPECT_EQ(read.error().code, Code::file_malformed);
}

// A file that ends early is an error wherever it ends, never a crash and never a shorter field.
TEST(MalformedField, every_prefix_of_every_format) {
  TemporaryFolder folder;
  const Field field = field_of<std::uint16_t>({axis_of(3, 0, 1, "x"), axis_of(2, 0, 1, "y")}, false);
  WriteFieldOptions compressed;
  compressed.compress = true;
  ASSERT_TRUE(write_field(field, folder / "z.nrrd", compressed));
  for (const char* name : {"f.nrrd", "f.npy", "f.vti"}) ASSERT_TRUE(write_field(field, folder / name));
  write_content(folder / "t.nrrd",
                "NRRD0001\ntype: ushort\ndimension: 2\nsizes: 3 2\nencoding: text\n\n1 2 3 4 5 6");
  write_content(folder / "h.nrrd",
                "NRRD0001\ntype: uchar\ndimension: 2\nsizes: 3 2\nencoding: hex\n\n010203040506");
  write_content(folder / "a.vti",
                "<VTKFile type=\"ImageData\" byte_order=\"LittleEndian\" header_type=\"UInt64\">"
                "<ImageData WholeExtent=\"0 2 0 1 0 0\"><Piece Extent=\"0 2 0 1 0 0\"><PointData>"
                "<DataArray type=\"UInt8\" Name=\"f\" format=\"appended\" offset=\"0\"/></PointData>"
                "</Piece></ImageData><AppendedData encoding=\"raw\">_" +
                    bytes_of(std::vector<std::uint64_t>{6}) + "123456</AppendedData></VTKFile>");
  write_content(folder / "s.pvd",
                "<VTKFile type=\"Collection\"><Collection><DataSet timestep=\"0\" file=\"f.npy\"/>"
                "</Collection></VTKFile>");
  write_content(folder / "s.series", R"({"files": [{"name": "f.npy", "time": 0}]})");
  write_content(folder / "d.nhdr",
                "NRRD0001\ntype: uchar\ndimension: 2\nencoding: raw\ndata file: data\nsizes: 3 2");
  write_content(folder / "data", "123456");

  for (const std::string name :
       {"z.nrrd", "f.nrrd", "f.npy", "f.vti", "t.nrrd", "h.nrrd", "a.vti", "s.pvd", "s.series", "d.nhdr"}) {
    const std::string content = content_of(folder / name);
    const auto whole = read_all(folder / name);
    ASSERT_TRUE(whole) << name << whole.error().message;
    const fs::path prefix = folder / ("prefix-" + name);
    write_content(prefix, content);
    // The last digit of a text, the last line end and the end tags after the data add nothing.
    for (std::size_t size = content.size(); size-- > 0;) {
      fs::resize_file(prefix, size);
      const auto read = read_all(prefix);
      if (!read)
        expect_error_names(read.error(), "prefix-" + name);
      else
        EXPECT_EQ(size + 1, content.size()) << name;
    }
  }
}

// Each byte of each header, changed: an error or a field, but no crash and no huge allocation.
TEST(MalformedField, every_changed_byte) {
  TemporaryFolder folder;
  const Field field = field_of<std::uint8_t>({axis_of(3, 0, 1, "x"), axis_of(2, 0, 1, "y")}, false);
  WriteFieldOptions compressed;
  compressed.compress = true;
  ASSERT_TRUE(write_field(field, folder / "z.nrrd", compressed));
  for (const char* name : {"f.nrrd", "f.npy", "f.vti"}) ASSERT_TRUE(write_field(field, folder / name));
  for (const std::string name : {"z.nrrd", "f.nrrd", "f.npy", "f.vti"}) {
    std::string content = content_of(folder / name);
    std::fstream file(folder / name, std::ios::binary | std::ios::in | std::ios::out);
    for (std::size_t i = 0; i < content.size(); ++i)
      for (const char change : {'\x01', '\x08', '\x80'}) {
        const auto put = [&](char c) {
          file.seekp(static_cast<std::streamoff>(i));
          file.put(c);
          file.flush();
        };
        put(static_cast<char>(content[i] ^ change));
        ReadOptions options;
        options.memory_limit = 1 << 20;
        if (const auto read = read_all(folder / name, options); !read) expect_error_names(read.error(), name);
        put(content[i]);
      }
  }
}

// Real data where they are at hand: HYPERISO_SHARED_DATA, or beside the repository.
namespace {
fs::path shared_data() {
  if (const char* folder = std::getenv("HYPERISO_SHARED_DATA")) return folder;
  return fs::path(HYPERISO_SOURCE_FOLDER) / "../shared/data";
}
} // namespace

TEST(RealData, viscous_fingers_as_a_list_of_files) {
  std::vector<fs::path> paths;
  std::error_code error;
  for (const auto& entry : fs::directory_iterator(shared_data() / "viscous_fingers", error))
    paths.push_back(entry.path());
  if (paths.empty()) GTEST_SKIP() << "the data are not there";
  std::ranges::sort(paths);
  const auto reader = open_field(paths);
  ASSERT_TRUE(reader) << reader.error().message;
  const FieldInfo& info = (*reader)->info();
  EXPECT_EQ(dims_of(info), (std::vector<std::int64_t>{64, 64, 64, 60}));
  EXPECT_EQ(info.type, SampleType::f32);
  EXPECT_EQ(info.name, "ImageFile");
  const auto two = (*reader)->read(30, 32), one = (*reader)->read(31, 32);
  ASSERT_TRUE(two && one);
  EXPECT_EQ(samples_of<float>(two->cropped(3, 1, 2)), samples_of<float>(*one));
}

TEST(RealData, dam_break_as_gzip_nrrd) {
  const fs::path path = fs::path(HYPERISO_SOURCE_FOLDER) / "examples/data/alpha_water_24x24x24x41.nrrd";
  if (!fs::exists(path)) GTEST_SKIP() << "the data are not there";
  const auto reader = open_field({path});
  ASSERT_TRUE(reader) << reader.error().message;
  const FieldInfo& info = (*reader)->info();
  EXPECT_EQ(dims_of(info), (std::vector<std::int64_t>{24, 24, 24, 41}));
  EXPECT_TRUE(info.has_time);
  EXPECT_EQ(info.axes[3].spacing, 0.025);
  EXPECT_EQ(info.axes[0].origin, 0.020833333);
  const auto whole = (*reader)->read();
  ASSERT_TRUE(whole) << whole.error().message;
  for (std::int64_t step = 0; step + 2 <= 41; ++step) {
    const auto pair = (*reader)->read(step, step + 2);
    ASSERT_TRUE(pair) << pair.error().message;
    ASSERT_EQ(samples_of<float>(*pair), samples_of<float>(whole->cropped(3, step, step + 2)));
  }
}
