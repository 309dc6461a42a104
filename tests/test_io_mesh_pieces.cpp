// A mesh written piece by piece gives the file that it gives as a whole, in every format; and like every
// other output it appears whole or not at all.

#include "check.hpp"
#include "hyperiso/extract.hpp"
#include "hyperiso/io.hpp"
#include "hyperiso/stream.hpp"
#include "temporary_folder.hpp"

#include <gtest/gtest.h>

using namespace hyperiso;

namespace {

template <int D>
Field field_of(const check::OwnedField<float, D>& owned) {
  Field field;
  field.info.type = SampleType::f32;
  field.info.axes.assign(owned.view.grid.axes.begin(), owned.view.grid.axes.end());
  field.samples = {std::shared_ptr<const void>(), reinterpret_cast<const std::byte*>(owned.samples.data())};
  field.strides.assign(owned.view.strides.begin(), owned.view.strides.end());
  return field;
}

template <int D>
void expect_same_file(const std::string& suffix, const ExtractOptions& extraction = {},
                      const WriteMeshOptions& options = {}) {
  SCOPED_TRACE(suffix);
  const TemporaryFolder folder;
  std::array<std::int64_t, D> dims;
  dims.fill(9);
  const auto owned = check::random_field<float, D>(dims, 10, 5);
  const auto whole = extract(owned.view, 0.5, extraction);
  ASSERT_TRUE(whole);
  ASSERT_TRUE(write_mesh(*whole, folder / ("whole" + suffix), options));

  auto writer = MeshFileWriter::create(D, D - 1, folder / ("pieces" + suffix), options);
  ASSERT_TRUE(writer) << writer.error().message;
  FieldSteps steps(field_of(owned));
  const Status streamed = stream(
      steps, 0.5, [&](SurfaceSlab& slab) { return writer->append(slab.mesh); }, extraction);
  ASSERT_TRUE(streamed) << streamed.error().message;
  const Status finished = writer->finish();
  ASSERT_TRUE(finished) << finished.error().message;
  EXPECT_EQ(content_of(folder / ("pieces" + suffix)), content_of(folder / ("whole" + suffix)));
}

} // namespace

TEST(MeshPieces, every_format) {
  for (const char* suffix : {".vtu", ".vtp", ".obj"}) expect_same_file<2>(suffix);
  for (const char* suffix : {".vtu", ".vtp", ".obj", ".off", ".ply", ".stl"}) expect_same_file<3>(suffix);
  expect_same_file<4>(".vtu");
}

TEST(MeshPieces, precision_edges_and_names) {
  ExtractOptions extraction;
  extraction.precision = Precision::f64;
  for (const char* suffix : {".vtu", ".ply", ".obj"}) expect_same_file<3>(suffix, extraction);
  WriteMeshOptions options;
  options.keep_edges = false;
  options.axis_names = {"x", "y", "z", "hour"};
  expect_same_file<4>(".vtu", extraction, options);
  extraction.keep_edges = false;
  expect_same_file<4>(".vtu", extraction);
}

TEST(MeshPieces, no_piece_and_no_simplex) {
  const TemporaryFolder folder;
  auto writer = MeshFileWriter::create(3, 2, folder / "none.ply");
  ASSERT_TRUE(writer);
  ASSERT_TRUE(writer->finish());
  const auto read = read_mesh(folder / "none.ply");
  ASSERT_TRUE(read) << read.error().message;
  EXPECT_EQ(read->simplex_count(), 0u);
}

// From the piece on in which numbers pass 32 bits, they come in 64.
TEST(MeshPieces, numbers_become_wide) {
  const TemporaryFolder folder;
  const auto owned = check::random_field<float, 3>({9, 9, 9}, 10, 5);
  const auto whole = extract(owned.view, 0.5);
  ASSERT_TRUE(write_mesh(*whole, folder / "whole.vtu"));
  auto writer = MeshFileWriter::create(3, 2, folder / "pieces.vtu");
  FieldSteps steps(field_of(owned));
  ASSERT_TRUE(stream(steps, 0.5, [&](SurfaceSlab& slab) {
    if (slab.step >= 3 && slab.step != 6) {
      IndexArray wide;
      wide.reset(slab.mesh.simplices.size(), true);
      for (std::size_t i = 0; i < wide.size(); ++i) wide.set(i, slab.mesh.simplices[i]);
      std::swap(slab.mesh.simplices, wide);
    }
    return writer->append(slab.mesh);
  }));
  ASSERT_TRUE(writer->finish());
  EXPECT_EQ(content_of(folder / "pieces.vtu"), content_of(folder / "whole.vtu"));
}

TEST(MeshPieces, nothing_is_left_of_what_is_given_up) {
  const TemporaryFolder folder;
  write_content(folder / "old.vtu", "old");
  {
    auto writer = MeshFileWriter::create(3, 2, folder / "old.vtu");
    ASSERT_TRUE(writer);
    const auto owned = check::random_field<float, 3>({5, 5, 5}, 10, 5);
    ASSERT_TRUE(writer->append(*extract(owned.view, 0.5)));
    EXPECT_GT(folder.names().size(), 1u);
  }
  EXPECT_EQ(folder.names().size(), 1u);
  EXPECT_EQ(content_of(folder / "old.vtu"), "old");
}

TEST(MeshPieces, takes_its_place_with_its_group) {
  const TemporaryFolder folder;
  {
    FileGroup group;
    WriteMeshOptions options;
    options.group = &group;
    auto writer = MeshFileWriter::create(3, 2, folder / "a.vtu", options);
    ASSERT_TRUE(writer->finish());
    EXPECT_FALSE(std::filesystem::exists(folder / "a.vtu"));
  }
  EXPECT_EQ(folder.names().size(), 0u);
}

TEST(MeshPieces, what_contradicts_itself_is_refused) {
  const TemporaryFolder folder;
  EXPECT_EQ(MeshFileWriter::create(4, 3, folder / "a.ply").error().code, Code::file_unsupported);
  EXPECT_EQ(MeshFileWriter::create(3, 2, folder / "missing" / "a.ply").error().code, Code::file_unwritable);
  auto writer = MeshFileWriter::create(3, 2, folder / "a.ply");
  ASSERT_TRUE(writer);
  Mesh piece(3, 2);
  piece.positions.reset(9, false);
  for (std::size_t i = 0; i < 9; ++i) piece.positions.set(i, static_cast<float>(i));
  piece.simplices.reset(3, false);
  for (std::size_t i = 0; i < 3; ++i) piece.simplices.set(i, static_cast<std::uint32_t>(i));
  EXPECT_TRUE(writer->append(piece));
  Mesh wrong = piece;
  wrong.simplices.set(2, 6);
  EXPECT_EQ(writer->append(wrong).error().code, Code::invalid_argument);
  wrong = piece;
  wrong.positions.reset(9, true);
  EXPECT_EQ(writer->append(wrong).error().code, Code::invalid_argument);
  wrong = Mesh(3, 1);
  EXPECT_EQ(writer->append(wrong).error().code, Code::invalid_argument);
  wrong = piece;
  wrong.attributes.push_back({"a", Attribute::Location::vertex, 1, std::vector<float>(3)});
  EXPECT_EQ(writer->append(wrong).error().code, Code::invalid_argument);
}
