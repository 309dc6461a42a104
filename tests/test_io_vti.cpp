#include "field_files.hpp"
#include "temporary_folder.hpp"

#include <gtest/gtest.h>

using namespace hyperiso;

namespace {

std::string in_words(const std::vector<float>& numbers) {
  std::string result;
  for (const float number : numbers) result += std::to_string(number) + " ";
  return result;
}

std::string array(const std::string& name, const std::string& numbers, const std::string& attributes = "") {
  return "<DataArray type=\"Float32\" Name=\"" + name + "\" format=\"ascii\" " + attributes + ">" + numbers +
         "</DataArray>";
}

std::string vti(const std::string& image_attributes, const std::string& content) {
  return "<?xml version=\"1.0\"?>\n<VTKFile type=\"ImageData\" version=\"1.0\" byte_order=\"LittleEndian\">\n"
         "<ImageData " +
         image_attributes + ">" + content + "</ImageData></VTKFile>";
}

// 2x3x4 samples 1, 2, ... in one piece.
std::string simple(const std::string& image_attributes, const std::string& extent = "0 1 0 2 0 3") {
  return vti("WholeExtent=\"" + extent + "\" " + image_attributes,
             "<Piece Extent=\"" + extent + "\"><PointData>" + array("f", in_words(counting<float>(24))) +
                 "</PointData></Piece>");
}

Result<Field> read_vti(const std::string& content, const ReadOptions& options = {}) {
  TemporaryFolder folder;
  write_content(folder / "f.vti", content);
  auto reader = open_field({folder / "f.vti"}, options);
  if (!reader) {
    expect_error_names(reader.error(), "f.vti");
    return reader.error();
  }
  return (*reader)->read();
}

Code code_of(const std::string& content, const ReadOptions& options = {}) {
  const auto field = read_vti(content, options);
  EXPECT_FALSE(field) << content;
  return field ? Code::internal : field.error().code;
}

} // namespace

TEST(Vti, coordinates_follow_the_extent) {
  const auto field = read_vti(simple("Origin=\"1 2 3\" Spacing=\"0.5 1 -2\"", "4 5 -1 1 0 3"));
  ASSERT_TRUE(field) << field.error().message;
  EXPECT_EQ(field->info.name, "f");
  EXPECT_FALSE(field->info.has_time);
  EXPECT_EQ(names_of(field->info), (std::vector<std::string>{"x", "y", "z"}));
  EXPECT_EQ(coordinates_of(field->info.axes[0]), (std::vector<double>{3, 3.5}));
  EXPECT_EQ(coordinates_of(field->info.axes[1]), (std::vector<double>{1, 2, 3}));
  EXPECT_EQ(coordinates_of(field->info.axes[2]), (std::vector<double>{3, 1, -1, -3}));
  EXPECT_EQ(samples_of<float>(*field), counting<float>(24));
}

TEST(Vti, direction_along_the_axes_and_oblique) {
  const auto mirrored =
      read_vti(simple("Origin=\"1 2 3\" Spacing=\"2 1 1\" Direction=\"-1 0 0 0 1 0 0 0 1\""));
  ASSERT_TRUE(mirrored) << mirrored.error().message;
  EXPECT_FALSE(mirrored->info.world);
  EXPECT_EQ(coordinates_of(mirrored->info.axes[0]), (std::vector<double>{1, -1}));
  const auto turned = read_vti(simple("Origin=\"1 2 3\" Spacing=\"2 1 1\" Direction=\"0 -1 0 1 0 0 0 0 1\""));
  ASSERT_TRUE(turned) << turned.error().message;
  ASSERT_TRUE(turned->info.world);
  EXPECT_EQ(turned->info.world->linear, (std::vector<double>{0, -1, 0, 1, 0, 0, 0, 0, 1}));
  EXPECT_EQ(turned->info.world->offset, (std::vector<double>{1, 2, 3}));
  EXPECT_EQ(coordinates_of(turned->info.axes[0]), (std::vector<double>{0, 2}));
  EXPECT_EQ(code_of(simple("Direction=\"1 0 0 1 0 0 0 0 1\"")), Code::file_malformed);
}

TEST(Vti, a_flat_image_has_two_axes) {
  const auto field = read_vti(vti("WholeExtent=\"0 5 7 7 0 3\" Spacing=\"1 0 2\"",
                                  "<Piece Extent=\"0 5 7 7 0 3\"><PointData>" +
                                      array("f", in_words(counting<float>(24))) + "</PointData></Piece>"));
  ASSERT_TRUE(field) << field.error().message;
  EXPECT_EQ(names_of(field->info), (std::vector<std::string>{"x", "z"}));
  EXPECT_EQ(dims_of(field->info), (std::vector<std::int64_t>{6, 4}));
}

TEST(Vti, cell_data_are_sampled_at_the_centres) {
  const auto field = read_vti(vti("WholeExtent=\"1 3 0 3 0 4\" Origin=\"1 1 1\" Spacing=\"2 4 6\"",
                                  "<Piece Extent=\"1 3 0 3 0 4\"><PointData/><CellData>" +
                                      array("f", in_words(counting<float>(24))) + "</CellData></Piece>"));
  ASSERT_TRUE(field) << field.error().message;
  EXPECT_EQ(dims_of(field->info), (std::vector<std::int64_t>{2, 3, 4}));
  EXPECT_EQ(coordinates_of(field->info.axes[0]), (std::vector<double>{4, 6}));
  EXPECT_EQ(coordinates_of(field->info.axes[1]), (std::vector<double>{3, 7, 11}));
}

TEST(Vti, which_array_is_read) {
  const std::string numbers = in_words(counting<float>(24)), thrice = numbers + numbers + numbers;
  const auto content = [&](const std::string& active) {
    return vti("WholeExtent=\"0 1 0 2 0 3\"",
               "<Piece Extent=\"0 1 0 2 0 3\"><PointData " + active + ">" +
                   array("vector", thrice, "NumberOfComponents=\"3\"") +
                   "<DataArray type=\"Int64\" Name=\"long\" format=\"ascii\">" +
                   std::string(48, ' ').replace(0, 0,
                                                [] {
                                                  std::string ones;
                                                  for (int i = 0; i < 24; ++i) ones += "1 ";
                                                  return ones;
                                                }()) +
                   "</DataArray>" + array("first", numbers) + array("second", numbers) +
                   "</PointData><CellData>" + array("cells", "1 2 3 4 5 6") + "</CellData></Piece>");
  };
  const auto name_of_read = [&](const std::string& active, const std::string& variable) {
    ReadOptions options;
    options.variable = variable;
    const auto field = read_vti(content(active), options);
    return field ? field->info.name : field.error().message;
  };
  EXPECT_EQ(name_of_read("", ""), "first");
  EXPECT_EQ(name_of_read("Scalars=\"second\"", ""), "second");
  EXPECT_EQ(name_of_read("Scalars=\"vector\"", ""), "first");
  EXPECT_EQ(name_of_read("", "second"), "second");
  EXPECT_EQ(name_of_read("", "cells"), "cells");
  ReadOptions options;
  options.variable = "vector";
  EXPECT_EQ(code_of(content(""), options), Code::file_unsupported);
  options.variable = "long";
  EXPECT_EQ(code_of(content(""), options), Code::file_unsupported);
  options.variable = "third";
  EXPECT_EQ(code_of(content(""), options), Code::invalid_argument);
  EXPECT_NE(name_of_read("", "third").find("second"), std::string::npos);
}

// Writers in parallel leave one piece for each process; points on the seams are in both.
TEST(Vti, several_pieces) {
  const auto piece = [](const std::string& extent, const std::vector<float>& samples) {
    return "<Piece Extent=\"" + extent + "\"><PointData>" + array("f", in_words(samples)) +
           "</PointData></Piece>";
  };
  const std::string whole = "WholeExtent=\"0 1 0 2 0 3\"";
  std::vector<float> front, back, middle;
  for (float f = 1; f <= 12; ++f) front.push_back(f);
  for (float f = 7; f <= 24; ++f) back.push_back(f);
  for (const float f : {9.f, 10.f, 15.f, 16.f}) middle.push_back(f);
  const auto content =
      vti(whole, piece("0 1 0 2 0 1", front) + piece("0 1 0 2 1 3", back) + piece("0 1 1 1 1 2", middle));
  const auto field = read_vti(content);
  ASSERT_TRUE(field) << field.error().message;
  EXPECT_EQ(samples_of<float>(*field), counting<float>(24));

  TemporaryFolder folder;
  write_content(folder / "f.vti", content);
  const auto reader = open_field({folder / "f.vti"});
  ASSERT_TRUE(reader);
  const auto part = (*reader)->read(1, 3);
  ASSERT_TRUE(part);
  EXPECT_EQ(samples_of<float>(*part), counting<float>(12, 7));

  EXPECT_EQ(code_of(vti(whole, piece("0 1 0 2 0 1", front))), Code::file_malformed);
  EXPECT_EQ(code_of(vti(whole, piece("0 1 0 2 2 3", front) + piece("0 1 1 1 0 1", middle))),
            Code::file_malformed);
  EXPECT_EQ(code_of(vti(whole, piece("0 1 0 2 0 1", front) + piece("0 1 0 2 1 3", front))),
            Code::file_malformed);
  EXPECT_EQ(code_of(vti(whole, piece("0 1 0 2 0 1", front) + piece("0 1 0 2 2 4", back))),
            Code::file_malformed);
}

TEST(Vti, files_that_contradict_themselves) {
  const std::string numbers = array("f", in_words(counting<float>(24)));
  const std::string piece = "<Piece Extent=\"0 1 0 2 0 3\"><PointData>" + numbers + "</PointData></Piece>";
  EXPECT_EQ(code_of(vti("WholeExtent=\"0 1 0 2 0 4\"", piece)), Code::file_malformed);
  EXPECT_EQ(code_of(vti("WholeExtent=\"0 1 0 2\"", piece)), Code::file_malformed);
  EXPECT_EQ(code_of(vti("WholeExtent=\"0 1 0 2 0 99999999999\"", piece)), Code::file_malformed);
  EXPECT_EQ(code_of(vti("WholeExtent=\"0 1 2 0 0 3\"", piece)), Code::file_malformed);
  EXPECT_EQ(code_of(vti("", piece)), Code::file_malformed);
  EXPECT_EQ(code_of(vti("WholeExtent=\"0 1 0 2 0 3\"", "")), Code::file_malformed);
  EXPECT_EQ(code_of(vti("WholeExtent=\"0 1 0 2 0 3\" Spacing=\"1 1 0\"", piece)), Code::file_malformed);
  EXPECT_EQ(code_of(vti("WholeExtent=\"0 1 0 2 0 3\" Spacing=\"1 1 nan\"", piece)), Code::file_malformed);
  EXPECT_EQ(code_of(vti("WholeExtent=\"0 1 0 2 0 3\" Origin=\"0\"", piece)), Code::file_malformed);
  // A grid of 2^93 points in a few bytes, whose product wraps around to that of its array.
  const std::string huge = "0 2147483646 0 2147483646 0 2147483646";
  EXPECT_EQ(code_of(vti("WholeExtent=\"" + huge + "\"",
                        "<Piece Extent=\"" + huge + "\"><PointData>" + numbers + "</PointData></Piece>")),
            Code::file_malformed);
  EXPECT_EQ(code_of("<VTKFile type=\"PolyData\"><PolyData/></VTKFile>"), Code::file_unsupported);
  EXPECT_EQ(code_of("<html></html>"), Code::file_malformed);
  EXPECT_EQ(code_of(vti("WholeExtent=\"0 1 0 2 0 3\"", "<Piece Extent=\"0 1 0 2 0 3\"><PointData/></Piece>")),
            Code::file_unsupported);
}

// Uncompressed appended data are used where they lie, if they happen to be aligned.
TEST(Vti, appended_raw_aligned_or_not) {
  for (int shift = 0; shift < 4; ++shift) {
    std::string content = "<VTKFile type=\"ImageData\" byte_order=\"LittleEndian\" header_type=\"UInt64\">" +
                          std::string(static_cast<std::size_t>(shift), ' ') +
                          "<ImageData WholeExtent=\"0 1 0 2 0 3\"><Piece Extent=\"0 1 0 2 0 3\"><PointData>"
                          "<DataArray type=\"Float32\" Name=\"f\" format=\"appended\" "
                          "offset=\"0\"/></PointData></Piece></ImageData>"
                          "<AppendedData encoding=\"raw\">_";
    content += bytes_of(std::vector<std::uint64_t>{96}) + bytes_of(counting<float>(24)) +
               "</AppendedData></VTKFile>";
    const auto field = read_vti(content);
    ASSERT_TRUE(field) << field.error().message;
    EXPECT_EQ(samples_of<float>(*field), counting<float>(24));
  }
}
