#include "field_files.hpp"
#include "temporary_folder.hpp"

#include <gtest/gtest.h>

using namespace hyperiso;

namespace {

// 2x3 samples first, first + 1, ... of u8.
void write_step(const std::filesystem::path& path, int first, const std::string& lines = "") {
  write_content(path, "NRRD0004\ntype: uchar\ndimension: 2\nsizes: 2 3\nencoding: raw\n" + lines + "\n" +
                          bytes_of(counting<std::uint8_t>(6, first)));
}

void write_vti_step(const std::filesystem::path& path, int first, const std::string& time) {
  std::string numbers;
  for (int i = 0; i < 6; ++i) numbers += std::to_string(first + i) + " ";
  write_content(path,
                "<VTKFile type=\"ImageData\"><ImageData WholeExtent=\"0 1 0 2 0 0\"><FieldData>"
                "<DataArray type=\"Float64\" Name=\"TimeValue\" NumberOfTuples=\"1\" format=\"ascii\">" +
                    time +
                    "</DataArray></FieldData><Piece Extent=\"0 1 0 2 0 0\"><PointData>"
                    "<DataArray type=\"UInt8\" Name=\"f\" format=\"ascii\">" +
                    numbers + "</DataArray></PointData></Piece></ImageData></VTKFile>");
}

std::string pvd(const std::vector<std::pair<std::string, std::string>>& steps) {
  std::string result = "<VTKFile type=\"Collection\"><Collection>";
  for (const auto& [file, attributes] : steps)
    result += "<DataSet file=\"" + file + "\" " + attributes + "/>";
  return result + "</Collection></VTKFile>";
}

Error error_of(const std::vector<std::filesystem::path>& paths, const ReadOptions& options = {}) {
  const auto reader = open_field(paths, options);
  EXPECT_FALSE(reader);
  if (reader) return {Code::internal, ""};
  EXPECT_EQ(reader.error().message.find('\n'), std::string::npos);
  return reader.error();
}

} // namespace

TEST(Series, list_of_files_is_stacked_in_its_order) {
  TemporaryFolder folder;
  write_step(folder / "b.nrrd", 1);
  write_step(folder / "a.nrrd", 7);
  write_step(folder / "c.nrrd", 13);
  const auto reader = open_field({folder / "b.nrrd", folder / "a.nrrd", folder / "c.nrrd"});
  ASSERT_TRUE(reader) << reader.error().message;
  const FieldInfo& info = (*reader)->info();
  EXPECT_TRUE(info.has_time);
  EXPECT_EQ(dims_of(info), (std::vector<std::int64_t>{2, 3, 3}));
  EXPECT_EQ(names_of(info), (std::vector<std::string>{"x", "y", "t"}));
  EXPECT_EQ(coordinates_of(info.axes[2]), (std::vector<double>{0, 1, 2}));
  for (std::int64_t begin = 0; begin < 3; ++begin)
    for (std::int64_t end = begin; end <= 3; ++end) {
      const auto field = (*reader)->read(begin, end);
      ASSERT_TRUE(field) << field.error().message;
      EXPECT_EQ(samples_of<std::uint8_t>(*field),
                counting<std::uint8_t>(static_cast<std::size_t>(6 * (end - begin)),
                                       1 + 6 * static_cast<int>(begin)));
      EXPECT_EQ(field->info.axes[2].count, end - begin);
      EXPECT_EQ(field->info.axes[2].coordinate(0), static_cast<double>(begin));
    }
}

TEST(Series, times_of_the_files) {
  TemporaryFolder folder;
  const std::vector<std::filesystem::path> paths{folder / "0.vti", folder / "1.vti", folder / "2.vti"};
  const auto write = [&](const char* a, const char* b, const char* c) {
    write_vti_step(paths[0], 1, a);
    write_vti_step(paths[1], 7, b);
    write_vti_step(paths[2], 13, c);
  };
  const auto times = [&] {
    const auto reader = open_field(paths);
    EXPECT_TRUE(reader) << reader.error().message;
    return reader ? coordinates_of((*reader)->info().axes.back()) : std::vector<double>{};
  };
  write("0.1", "0.2", "0.7");
  EXPECT_EQ(times(), (std::vector<double>{0.1, 0.2, 0.7}));
  write("5", "5", "5"); // a writer that knows no time
  EXPECT_EQ(times(), (std::vector<double>{0, 1, 2}));
  write("1", "10", "2"); // step_1 step_10 step_2, as a shell lists them
  const Error error = error_of(paths);
  EXPECT_EQ(error.code, Code::file_malformed);
  EXPECT_NE(error.message.find("2.vti"), std::string::npos);
}

TEST(Series, pvd_and_series_files) {
  TemporaryFolder folder;
  std::filesystem::create_directory(folder / "steps");
  write_step(folder / "steps/a&b.nrrd", 1);
  write_step(folder / "steps/c.nrrd", 7);
  write_step(folder / "steps/d.nrrd", 13);
  write_content(folder / "s.pvd", pvd({{"steps/d.nrrd", "timestep=\"4\" group=\"\" part=\"0\""},
                                       {"steps/a&amp;b.nrrd", "timestep=\"0.5\""},
                                       {"steps/c.nrrd", "timestep=\"1\""}}));
  write_content(folder / "s.vti.series",
                R"({"file-series-version": "1.0", "files": [{"name": "steps/a&b.nrrd", "time": 0.5},
                    {"name": "steps/c.nrrd", "time": 1}, {"name": "steps/d.nrrd", "time": 4.0}]})");
  for (const char* name : {"s.pvd", "s.vti.series"}) {
    const auto reader = open_field({folder / name});
    ASSERT_TRUE(reader) << reader.error().message;
    EXPECT_EQ(coordinates_of((*reader)->info().axes[2]), (std::vector<double>{0.5, 1, 4}));
    const auto field = (*reader)->read();
    ASSERT_TRUE(field) << field.error().message;
    EXPECT_EQ(samples_of<std::uint8_t>(*field), counting<std::uint8_t>(18));
    EXPECT_EQ(coordinates_of((*reader)->read(1, 3)->info.axes[2]), (std::vector<double>{1, 4}));
  }
}

// Only the files of the steps asked for are read: the others may be gone by then.
TEST(Series, steps_are_read_from_their_files_only) {
  TemporaryFolder folder;
  for (int step = 0; step < 3; ++step) write_step(folder / (std::to_string(step) + ".nrrd"), 6 * step);
  write_content(
      folder / "s.pvd",
      pvd({{"0.nrrd", "timestep=\"0\""}, {"1.nrrd", "timestep=\"1\""}, {"2.nrrd", "timestep=\"2\""}}));
  const auto reader = open_field({folder / "s.pvd"});
  ASSERT_TRUE(reader) << reader.error().message;
  std::filesystem::remove(folder / "2.nrrd");
  EXPECT_TRUE((*reader)->read(0, 2));
  const auto gone = (*reader)->read(1, 3);
  ASSERT_FALSE(gone);
  expect_error_names(gone.error(), "2.nrrd");
}

TEST(Series, the_file_that_differs_is_named) {
  TemporaryFolder folder;
  write_step(folder / "a.nrrd", 1);
  const auto expect_difference = [&](const std::string& content, const std::string& what) {
    write_content(folder / "b.nrrd", content);
    const Error error = error_of({folder / "a.nrrd", folder / "b.nrrd"});
    EXPECT_EQ(error.code, Code::file_malformed);
    EXPECT_NE(error.message.find("b.nrrd: not on the grid of"), std::string::npos) << error.message;
    EXPECT_NE(error.message.find(what), std::string::npos) << error.message;
    write_content(folder / "s.pvd", pvd({{"a.nrrd", "timestep=\"0\""}, {"b.nrrd", "timestep=\"1\""}}));
    const auto reader = open_field({folder / "s.pvd"});
    ASSERT_TRUE(reader) << reader.error().message;
    const auto field = (*reader)->read();
    ASSERT_FALSE(field);
    EXPECT_EQ(field.error().message, error.message);
  };
  const std::string start = "NRRD0004\nencoding: raw\ntype: ";
  expect_difference(start + "uchar\ndimension: 2\nsizes: 3 2\n\n123456", "axis x has 3 samples, not 2");
  expect_difference(start + "int8\ndimension: 2\nsizes: 2 3\n\n123456", "i8, not u8");
  expect_difference(start + "uchar\ndimension: 1\nsizes: 6\n\n123456", "1 axes, not 2");
  expect_difference(start + "uchar\ndimension: 2\nsizes: 2 3\naxis mins: 0 1\n\n123456", "from 1 to 3");
}

TEST(Series, files_that_are_no_series) {
  TemporaryFolder folder;
  write_step(folder / "a.nrrd", 1);
  write_step(folder / "t.nrrd", 1, "kinds: domain time\n");
  const auto code = [&](const char* name, const std::string& content) {
    write_content(folder / name, content);
    const Error error = error_of({folder / name});
    EXPECT_NE(error.message.find(name), std::string::npos) << error.message;
    return error.code;
  };
  EXPECT_EQ(code("s.pvd", pvd({})), Code::file_malformed);
  EXPECT_EQ(code("s.pvd", "<VTKFile/>"), Code::file_malformed);
  EXPECT_EQ(code("s.pvd", pvd({{"", ""}})), Code::file_malformed);
  EXPECT_EQ(code("s.pvd", pvd({{"a.nrrd", "timestep=\"soon\""}})), Code::file_malformed);
  EXPECT_EQ(code("s.pvd", pvd({{"a.nrrd", "timestep=\"0\""}, {"a.nrrd", ""}, {"a.nrrd", "timestep=\"1\""}})),
            Code::file_malformed);
  EXPECT_EQ(code("s.pvd", pvd({{"a.nrrd", "timestep=\"0\""}, {"none.nrrd", "timestep=\"1\""}})),
            Code::file_not_found);
  EXPECT_EQ(code("s.pvd", pvd({{"a.nrrd", "part=\"0\""}, {"a.nrrd", "part=\"1\""}})), Code::file_unsupported);
  EXPECT_EQ(code("s.pvd", pvd({{"s.pvd", ""}})), Code::file_unsupported); // not for ever
  EXPECT_EQ(code("s.series", "{\"files\": 1}"), Code::file_malformed);
  EXPECT_EQ(code("s.series", "{\"files\": [{\"name\": 1}]}"), Code::file_malformed);
  EXPECT_EQ(code("s.series", "{\"files\": [{\"name\": \"a.nrrd\", \"time\": \"0\"}]}"), Code::file_malformed);
  EXPECT_EQ(code("s.series", "nothing"), Code::file_malformed);
  EXPECT_EQ(code("s.series", std::string(100000, '[')), Code::file_malformed);
  EXPECT_EQ(error_of({folder / "a.nrrd", folder / "t.nrrd"}).code, Code::file_malformed);
  EXPECT_EQ(error_of({folder / "t.nrrd", folder / "t.nrrd"}).code, Code::file_unsupported);
  EXPECT_EQ(error_of({folder / "a.nrrd", folder / "none.nrrd"}).code, Code::file_not_found);
  ReadOptions options;
  options.time_axis = "x";
  EXPECT_EQ(error_of({folder / "a.nrrd", folder / "a.nrrd"}, options).code, Code::invalid_argument);
  for (const char* name : {"t", "2"}) {
    options.time_axis = name;
    EXPECT_TRUE(open_field({folder / "a.nrrd", folder / "a.nrrd"}, options));
  }
  options = {};
  options.memory_limit = 11;
  const auto reader = open_field({folder / "a.nrrd", folder / "a.nrrd"}, options);
  ASSERT_TRUE(reader);
  EXPECT_EQ((*reader)->read().error().code, Code::out_of_memory);
}
