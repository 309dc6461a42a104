// Meshes written and read back, and files that are damaged or cannot be written. Whether others can read what
// is written is for test_mesh_files.py.

#include "hand_made_meshes.hpp"
#include "hyperiso/io.hpp"
#include "io/mesh_formats.hpp"
#include "temporary_folder.hpp"

#include <cmath>
#include <cstring>
#include <gtest/gtest.h>

using namespace hyperiso;
namespace fs = std::filesystem;

namespace {

void expect_equal(const Mesh& read, const Mesh& written) {
  ASSERT_EQ(read.dimension, written.dimension);
  ASSERT_EQ(read.simplex_dimension, written.simplex_dimension);
  ASSERT_EQ(read.positions.wide(), written.positions.wide());
  ASSERT_EQ(read.positions.size(), written.positions.size());
  const auto bits = [](const Mesh& mesh) {
    return std::string(static_cast<const char*>(mesh.positions.data()), mesh.positions.bytes());
  };
  EXPECT_EQ(bits(read), bits(written)); // also of -0 and NaN
  ASSERT_EQ(read.simplices.size(), written.simplices.size());
  for (std::size_t i = 0; i < read.simplices.size(); ++i) EXPECT_EQ(read.simplices[i], written.simplices[i]);
}

void expect_equal_attributes(const Mesh& read, const Mesh& written) {
  ASSERT_EQ(read.attributes.size(), written.attributes.size());
  for (std::size_t i = 0; i < read.attributes.size(); ++i) {
    EXPECT_EQ(read.attributes[i].name, written.attributes[i].name);
    EXPECT_EQ(read.attributes[i].location, written.attributes[i].location);
    EXPECT_EQ(read.attributes[i].components, written.attributes[i].components);
    EXPECT_EQ(read.attributes[i].values, written.attributes[i].values);
  }
}

void expect_equal_provenance(const Mesh& read, const Mesh& written) {
  EXPECT_EQ(read.active_cells, written.active_cells);
  EXPECT_EQ(read.edges, written.edges);
  ASSERT_EQ(read.grid_axes.size(), written.grid_axes.size());
  for (std::size_t i = 0; i < read.grid_axes.size(); ++i) {
    const Axis &a = read.grid_axes[i], &b = written.grid_axes[i];
    EXPECT_EQ(std::tie(a.count, a.first, a.origin, a.spacing, a.coordinates, a.name, a.unit),
              std::tie(b.count, b.first, b.origin, b.spacing, b.coordinates, b.name, b.unit));
  }
}

Mesh read_back(const Mesh& mesh, const fs::path& path, const WriteMeshOptions& options = {}) {
  const auto written = write_mesh(mesh, path, options);
  EXPECT_TRUE(written) << written.error().message;
  auto read = read_mesh(path);
  EXPECT_TRUE(read) << read.error().message;
  return read ? *std::move(read) : Mesh(1, 1);
}

void expect_error(const Status& status, Code code, const std::string& what) {
  ASSERT_FALSE(status) << what;
  EXPECT_EQ(status.error().code, code) << status.error().message;
  EXPECT_NE(status.error().message.find(what), std::string::npos) << status.error().message;
}

Status read_status(const fs::path& path) {
  const auto mesh = read_mesh(path);
  return mesh ? Status() : mesh.error();
}

Status read_content(const fs::path& path, const std::string& content) {
  write_content(path, content);
  return read_status(path);
}

// Without a file: damaged content comes in thousands.
Status read_bytes(const std::string& content, const std::string& suffix) {
  const auto read = suffix == "ply"   ? read_ply
                    : suffix == "stl" ? read_stl
                    : suffix == "obj" ? read_obj
                    : suffix == "off" ? read_off
                                      : read_vtk_mesh;
  const auto mesh = read(content, "a." + suffix);
  return mesh ? Status() : mesh.error();
}

const MeshKind vtk_kinds[] = {{2, 1}, {2, 2}, {3, 1}, {3, 2}, {3, 3}, {4, 1}, {4, 2},
                              {4, 3}, {4, 4}, {5, 4}, {5, 5}, {6, 5}, {8, 7}};

} // namespace

TEST(Vtu, every_dimension_and_precision_comes_back_to_the_bit) {
  const TemporaryFolder folder;
  for (MeshKind kind : vtk_kinds)
    for (const bool f64 : {false, true})
      for (const std::size_t simplices : {0, 1, 7}) {
        kind.f64 = f64;
        kind.simplices = simplices;
        const Mesh mesh = random_mesh(kind);
        const Mesh read = read_back(mesh, folder / "a.vtu");
        expect_equal(read, mesh);
        expect_equal_attributes(read, mesh);
      }
}

TEST(Vtp, every_dimension_comes_back_to_the_bit) {
  const TemporaryFolder folder;
  for (const MeshKind kind : {MeshKind{2, 1}, {2, 2}, {3, 1}, {3, 2}, {3, 2, true}, {3, 1, false, 5, 0}}) {
    const Mesh mesh = random_mesh(kind);
    const Mesh read = read_back(mesh, folder / "a.vtp");
    expect_equal(read, mesh);
    expect_equal_attributes(read, mesh);
  }
}

// Segments come back as the lines they were joined to, one after the other.
TEST(Vtp, segments_are_joined_to_lines) {
  const TemporaryFolder folder;
  Mesh mesh = random_mesh({2, 1, true, 7, 6}); // 4-3-0 open, 1-2-5-1 closed, 6 by itself
  mesh.attributes.resize(2);
  const std::array<std::uint64_t, 10> corners{3, 0, 5, 1, 4, 3, 1, 2, 2, 5};
  mesh.simplices.reset(corners.size(), false);
  for (std::size_t i = 0; i < corners.size(); ++i) mesh.simplices.set(i, corners[i]);
  const Mesh read = read_back(mesh, folder / "a.vtp");
  EXPECT_NE(content_of(folder / "a.vtp").find("NumberOfLines=\"2\""), std::string::npos);
  const std::array<std::uint64_t, 10> joined{1, 2, 2, 5, 5, 1, 4, 3, 3, 0};
  for (std::size_t i = 0; i < joined.size(); ++i) mesh.simplices.set(i, joined[i]);
  expect_equal(read, mesh);
  expect_equal_attributes(read, mesh);
}

TEST(WriteMesh, lines_that_are_none_and_places_that_are_nowhere) {
  const TemporaryFolder folder;
  Mesh branching = random_mesh({2, 1, false, 4, 3});
  for (std::size_t i = 0; i < 6; ++i) branching.simplices.set(i, i % 2 == 0 ? 0 : 1 + i / 2);
  Mesh far = random_mesh({2, 1, false, 3, 1});
  far.positions.set(4, HUGE_VAL);
  for (const char* name : {"a.svg", "a.geojson"}) {
    expect_error(write_mesh(branching, folder / name), Code::invalid_argument, "two segments");
    expect_error(write_mesh(far, folder / name), Code::invalid_argument, "vertex 2 is at inf");
    expect_error(write_mesh(random_mesh({3, 1}), folder / name), Code::file_unsupported, "vtu, vtp, obj");
    EXPECT_TRUE(write_mesh(random_mesh({2, 1, false, 0, 0}), folder / name));
  }
}

TEST(Vtk, mesh_without_vertices) {
  const TemporaryFolder folder;
  for (MeshKind kind : vtk_kinds)
    for (const char* name : {"a.vtu", "a.vtp"}) {
      if (name == std::string("a.vtp") && (kind.dimension > 3 || kind.simplex_dimension == 3)) continue;
      kind.vertices = kind.simplices = 0;
      Mesh mesh = random_mesh(kind);
      const Mesh read = read_back(mesh, folder / name);
      EXPECT_EQ(read.dimension, mesh.dimension);
      EXPECT_EQ(read.simplex_dimension, mesh.simplex_dimension);
      expect_equal_attributes(read, mesh);
    }
}

// A slice at a stored step is exact only with the grid edges that the mesh was written with.
TEST(Vtk, grid_edges_and_axes_are_restored) {
  const TemporaryFolder folder;
  Mesh meshes[] = {random_mesh({2, 1}), random_mesh({3, 2}), random_mesh({4, 3}),
                   random_mesh({2, 2}), random_mesh({3, 3}), random_mesh({4, 4})};
  add_edges<2>(meshes[0]);
  add_edges<3>(meshes[1]);
  add_edges<4>(meshes[2]);
  add_edges<3>(meshes[3]); // of volumes: with an axis of levels
  add_edges<4>(meshes[4]);
  add_edges<5>(meshes[5]);
  for (const Mesh& mesh : meshes) {
    expect_equal_provenance(read_back(mesh, folder / "a.vtu"), mesh);
    if (mesh.dimension < 4 && mesh.simplex_dimension < 3)
      expect_equal_provenance(read_back(mesh, folder / "a.vtp"), mesh);
    const Mesh without = read_back(mesh, folder / "a.vtu", {.keep_edges = false});
    EXPECT_TRUE(without.edges.empty());
    EXPECT_TRUE(without.grid_axes.empty());
    expect_equal(without, mesh);
  }
}

// Filters of other programs carry arrays along that no longer mean what they say.
TEST(Vtk, grid_edges_that_fit_no_grid_are_left_out) {
  const TemporaryFolder folder;
  const auto expect_none = [&](Mesh mesh, auto damage) {
    add_edges<3>(mesh);
    damage(mesh);
    const Mesh read = read_back(mesh, folder / "a.vtu");
    EXPECT_TRUE(read.edges.empty());
    EXPECT_TRUE(read.grid_axes.empty());
    expect_equal(read, mesh);
  };
  const Mesh mesh = random_mesh({3, 2});
  expect_none(mesh, [](Mesh& m) { m.edges[3] = m.edges[2]; });
  expect_none(mesh, [](Mesh& m) { m.edges[11] = UINT64_MAX; });
  expect_none(mesh, [](Mesh& m) { m.edges[0] = 0; });
  expect_none(mesh, [](Mesh& m) { m.grid_axes[0].count = 0; });
  expect_none(mesh, [](Mesh& m) { m.grid_axes[1].count = -5; });
  expect_none(mesh, [](Mesh& m) { m.grid_axes[1].spacing = 0; });
  expect_none(mesh, [](Mesh& m) { m.grid_axes[2].coordinates[3] = NAN; });
  expect_none(mesh, [](Mesh& m) { m.grid_axes[2].coordinates[3] = m.grid_axes[2].coordinates[2]; });
  expect_none(mesh, [](Mesh& m) { m.grid_axes[2].coordinates.pop_back(); });
  expect_none(mesh, [](Mesh& m) { m.grid_axes.pop_back(); });
}

TEST(Vtk, time_is_named_after_its_axis) {
  const TemporaryFolder folder;
  const Mesh mesh = random_mesh({4, 3});
  const Mesh read = read_back(mesh, folder / "a.vtu", {.axis_names = {"x", "y", "z", "age"}});
  const std::string content = content_of(folder / "a.vtu");
  EXPECT_NE(content.find("Name=\"age\""), std::string::npos);
  EXPECT_EQ(content.find("Name=\"t\""), std::string::npos);
  expect_equal(read, mesh);
  expect_equal_attributes(read, mesh);
}

TEST(Vtk, not_a_number_and_infinity_survive) {
  const TemporaryFolder folder;
  Mesh mesh = random_mesh({3, 2});
  mesh.positions.set(0, NAN);
  mesh.positions.set(4, HUGE_VAL);
  mesh.positions.set(5, -0.0);
  expect_equal(read_back(mesh, folder / "a.vtu"), mesh);
  expect_equal(read_back(mesh, folder / "a.ply"), mesh);
}

// 64-bit vertex numbers in memory are written in 32 bits where they fit.
TEST(WriteMesh, wide_vertex_numbers) {
  const TemporaryFolder folder;
  const Mesh narrow = random_mesh({3, 2});
  Mesh wide = random_mesh({3, 2});
  wide.simplices.reset(narrow.simplices.size(), true);
  for (std::size_t i = 0; i < narrow.simplices.size(); ++i) wide.simplices.set(i, narrow.simplices[i]);
  for (const char* name : {"a.vtu", "a.vtp", "a.ply", "a.stl", "a.obj", "a.off"}) {
    ASSERT_TRUE(write_mesh(narrow, folder / name));
    const std::string expected = content_of(folder / name);
    ASSERT_TRUE(write_mesh(wide, folder / name));
    EXPECT_EQ(content_of(folder / name), expected) << name;
  }
}

TEST(Ply, triangles_and_scalar_attributes) {
  const TemporaryFolder folder;
  for (const bool f64 : {false, true}) {
    const Mesh mesh = random_mesh({3, 2, f64});
    const Mesh read = read_back(mesh, folder / "a.ply");
    expect_equal(read, mesh);
    ASSERT_EQ(read.attributes.size(), 6u);
    EXPECT_EQ(read.attributes[0].values, mesh.attributes[0].values);
    EXPECT_EQ(read.attributes[2].name, "velocity_<m/s>_&_\"more\"_1");
    EXPECT_EQ(std::get<1>(read.attributes[2].values)[5], std::get<1>(mesh.attributes[1].values)[16]);
    EXPECT_EQ(read.attributes[4].values, mesh.attributes[2].values);
    EXPECT_EQ(std::get<2>(read.attributes[5].values)[0], -2); // 64-bit integers that fit 32
  }
}

TEST(Ply, names_and_numbers_that_need_care) {
  const TemporaryFolder folder;
  Mesh mesh = random_mesh({3, 2});
  mesh.attributes = {{"x", Attribute::Location::vertex, 1, std::vector<float>(12, 1)},
                     {"a b", Attribute::Location::simplex, 1, std::vector<std::int64_t>(7, 1ll << 40)},
                     {"a_b", Attribute::Location::simplex, 1, std::vector<float>(7, 2)}};
  const Mesh read = read_back(mesh, folder / "a.ply");
  expect_equal(read, mesh);
  ASSERT_EQ(read.attributes.size(), 3u);
  EXPECT_EQ(read.attributes[0].name, "x_");
  EXPECT_EQ(std::get<1>(read.attributes[1].values)[0], std::ldexp(1, 40));
  EXPECT_EQ(read.attributes[2].name, "a_b_");
}

TEST(Ply, files_of_others) {
  const TemporaryFolder folder;
  write_content(folder / "a.ply",
                "ply\r\nformat ascii 1.0\r\ncomment made by hand\r\nelement material 2\r\n"
                "property list uchar float colours\r\nelement vertex 3\r\n"
                "property uchar red\r\nproperty double z\r\nproperty float x\r\n"
                "property float y\r\nelement face 1\r\nproperty list int uint vertex_index\r\n"
                "end_header\r\n2 .5 .5\r\n0\r\n255 3 1 2\r\n0 6 4 5\r\n7 9 7 8\r\n3 2 0 1\r\n");
  const auto mesh = read_mesh(folder / "a.ply");
  ASSERT_TRUE(mesh) << mesh.error().message;
  ASSERT_EQ(mesh->positions.size(), 9u);
  for (std::size_t i = 0; i < 9; ++i) EXPECT_EQ(mesh->positions[i], static_cast<double>(i + 1));
  EXPECT_EQ(mesh->simplices[0], 2u);
  EXPECT_EQ(std::get<2>(mesh->attributes.at(0).values), (std::vector<std::int32_t>{255, 0, 7}));

  const std::string header = "ply\nformat binary_big_endian 1.0\nelement vertex 1\nproperty short x\n"
                             "property short y\nproperty short z\nend_header\n";
  write_content(folder / "b.ply", header + std::string("\1\0\0\2\xff\xff", 6));
  const auto big_endian = read_mesh(folder / "b.ply");
  ASSERT_TRUE(big_endian) << big_endian.error().message;
  EXPECT_EQ(big_endian->positions[0], 256);
  EXPECT_EQ(big_endian->positions[1], 2);
  EXPECT_EQ(big_endian->positions[2], -1);

  const std::string start = "ply\nformat ascii 1.0\nelement vertex ",
                    xyz = "\nproperty float x\nproperty float y\n"
                          "property float z\nelement face ",
                    faces = "\nproperty list uchar int vertex_indices\nend_header\n";
  expect_error(
      read_content(folder / "c.ply", start + "4" + xyz + "1" + faces + "0 0 0 0 0 0 0 0 0 0 0 0 4 0 1 2 3"),
      Code::file_unsupported, "triangle");
  expect_error(read_content(folder / "c.ply", start + "1" + xyz + "1" + faces + "0 0 0 3 0 0 1"),
               Code::file_malformed, "vertex");
  expect_error(read_content(folder / "c.ply", start + "1" + xyz + "1" + faces + "0 0 0 3 0 0 -1"),
               Code::file_malformed, "vertex");
  expect_error(read_content(folder / "c.ply", start + "18446744073709551615" + xyz + "0" + faces),
               Code::file_malformed, "vertex");
  expect_error(
      read_content(folder / "c.ply", "ply\nformat ascii 1.0\nelement ghost 999999999999999\nend_header\n"),
      Code::file_malformed, "ghost");
  expect_error(read_content(folder / "c.ply", "ply\nformat ascii 1.0\nelement face 0\nend_header\n"),
               Code::file_malformed, "x, y, z");
  expect_error(read_content(folder / "c.ply", "ply\nformat ascii 2.0\nend_header\n"), Code::file_malformed,
               "2.0");
}

TEST(Stl, unshared_corners_and_unit_normals) {
  const TemporaryFolder folder;
  Mesh mesh = random_mesh({3, 2, true, 12, 7});
  for (std::size_t i = 0; i < 3; ++i) mesh.simplices.set(i, 4); // no area
  const Mesh read = read_back(mesh, folder / "a.stl");
  ASSERT_EQ(read.simplex_count(), 7u);
  ASSERT_EQ(read.vertex_count(), 21u);
  for (std::size_t corner = 0; corner < 21; ++corner) {
    EXPECT_EQ(read.simplices[corner], corner);
    for (std::size_t axis = 0; axis < 3; ++axis)
      EXPECT_EQ(read.positions[3 * corner + axis],
                static_cast<float>(mesh.positions[3 * mesh.simplices[corner] + axis]));
  }
  const std::string content = content_of(folder / "a.stl");
  ASSERT_EQ(content.size(), 84u + 7 * 50);
  for (std::size_t facet = 0; facet < 7; ++facet) {
    float normal[3];
    std::memcpy(normal, content.data() + 84 + 50 * facet, sizeof normal);
    EXPECT_NEAR(std::hypot(normal[0], normal[1], normal[2]), facet > 0, 1e-6);
  }
}

TEST(Stl, text_of_others) {
  const TemporaryFolder folder;
  const std::string facet = "facet normal 0 0 1\n outer loop\n vertex 0 0 0\n VERTEX 1e0 0 0\n vertex 0 1 0\n"
                            " endloop\nendfacet\n";
  write_content(folder / "a.stl", "solid with a facet in its name\n" + facet + facet + "endsolid\n");
  const auto mesh = read_mesh(folder / "a.stl");
  ASSERT_TRUE(mesh) << mesh.error().message;
  EXPECT_EQ(mesh->simplex_count(), 2u);
  EXPECT_EQ(mesh->positions[3], 1);
  expect_error(read_content(folder / "a.stl", "solid\n" + facet), Code::file_malformed, "facet 1");
  expect_error(read_content(folder / "a.stl", "solid"), Code::file_malformed, "facet 0");
  expect_error(read_content(folder / "a.stl", "plain text"), Code::file_malformed, "solid");
}

TEST(Obj, triangles_and_segments) {
  const TemporaryFolder folder;
  for (const MeshKind kind : {MeshKind{3, 2, true}, {3, 1, true}, {3, 2, true, 0, 0}}) {
    const Mesh mesh = random_mesh(kind);
    expect_equal(read_back(mesh, folder / "a.obj"), mesh);
  }
  const Mesh flat = read_back(random_mesh({2, 1}), folder / "a.obj");
  EXPECT_EQ(flat.dimension, 3);
  EXPECT_EQ(flat.positions[2], 0);
}

TEST(Obj, files_of_others) {
  const TemporaryFolder folder;
  write_content(folder / "a.obj",
                "# made by hand\nmtllib a.mtl\no thing\nv 0 0 0 1.0\nv 1 0 0\r\nvn 0 0 1\nv 0 1 0\n"
                "f 1//1 2//1 3//1\nv 2 2 2\nf -1 -2/5 -3/5/6");
  const auto mesh = read_mesh(folder / "a.obj");
  ASSERT_TRUE(mesh) << mesh.error().message;
  ASSERT_EQ(mesh->simplex_count(), 2u);
  const std::uint64_t corners[] = {0, 1, 2, 3, 2, 1};
  for (std::size_t i = 0; i < 6; ++i) EXPECT_EQ(mesh->simplices[i], corners[i]);
  const std::string points = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";
  for (const char* line : {"f 1 2 3 1", "f 1 2", "l 1 2 3", "f 1 2 3\nl 1 2"})
    expect_error(read_content(folder / "a.obj", points + line), Code::file_unsupported, "line ");
  for (const char* line : {"f 1 2 4", "f 1 2 -4", "f 0 1 2", "f a b c", "f / / /", "v 1 2"})
    expect_error(read_content(folder / "a.obj", points + line), Code::file_malformed, "vertex");
  expect_error(read_content(folder / "a.obj", "something else\n"), Code::file_malformed, "OBJ");
}

TEST(Off, triangles) {
  const TemporaryFolder folder;
  for (const MeshKind kind : {MeshKind{3, 2, true}, {3, 2, true, 0, 0}}) {
    const Mesh mesh = random_mesh(kind);
    expect_equal(read_back(mesh, folder / "a.off"), mesh);
  }
  expect_error(
      read_content(folder / "a.off", "OFF 4 1 0 # comment\n\n0 0 0\n1 0 0\n\n0 1 0\n0 0 1\n4 0 1 2 3\n"),
      Code::file_unsupported, "4 corners");
  expect_error(read_content(folder / "a.off", "OFF\n1 1 0\n0 0 0\n3 0 0 1\n"), Code::file_malformed,
               "vertex");
  expect_error(read_content(folder / "a.off", "OFF\n18446744073709551615 1 0\n0 0 0\n"), Code::file_malformed,
               "vertex 1");
  expect_error(read_content(folder / "a.off", "4OFF\n1 1 0\n"), Code::file_unsupported, "OFF");
}

TEST(ReadMesh, vtk_files_of_others) {
  const TemporaryFolder folder;
  const auto vtu = [](const char* counts, const char* connectivity, const char* offsets, const char* types) {
    return std::string("<VTKFile type=\"UnstructuredGrid\"><UnstructuredGrid><Piece ") + counts +
           "><Points><DataArray type=\"Int32\" NumberOfComponents=\"3\">0 0 0 1 0 0 0 1 0 0 0 "
           "1</DataArray></Points>"
           "<Cells><DataArray type=\"UInt8\" Name=\"connectivity\">" +
           connectivity + "</DataArray><DataArray type=\"Int16\" Name=\"offsets\">" + offsets +
           "</DataArray><DataArray type=\"UInt8\" Name=\"types\">" + types +
           "</DataArray></Cells></Piece></UnstructuredGrid></VTKFile>";
  };
  const char* counts = "NumberOfPoints=\"4\" NumberOfCells=\"2\"";
  write_content(folder / "a.vtu", vtu(counts, "0 1 2 1 2 3", "3 6", "5 5"));
  const auto mesh = read_mesh(folder / "a.vtu");
  ASSERT_TRUE(mesh) << mesh.error().message;
  EXPECT_EQ(mesh->dimension, 3);
  EXPECT_EQ(mesh->simplex_dimension, 2);
  EXPECT_EQ(mesh->simplices[5], 3u);
  const auto expect = [&](Code code, const std::string& content, const char* what) {
    expect_error(read_content(folder / "a.vtu", content), code, what);
  };
  expect(Code::file_unsupported, vtu(counts, "0 1 2 0 1 2 3", "3 7", "5 10"), "cells");
  expect(Code::file_unsupported, vtu(counts, "0 1 2 3 0 1", "4 6", "5 5"), "corners");
  expect(Code::file_malformed, vtu(counts, "0 1 2 1 2 4", "3 6", "5 5"), "point 4");
  expect(Code::file_malformed, vtu(counts, "0 1 2 1 2", "3 6", "5 5"), "corners");
  expect(Code::file_malformed, vtu(counts, "0 1 2 1 2 3", "3 6", "5"), "types");
  expect(Code::file_malformed, vtu(counts, "0 1 2 1 2 3", "3", "5 5"), "offsets");
  expect(Code::file_malformed, vtu("NumberOfPoints=\"5\" NumberOfCells=\"2\"", "0 1 2 1 2 3", "3 6", "5 5"),
         "coordinates");
  expect(Code::file_malformed, vtu("NumberOfPoints=\"many\"", "0 1 2 1 2 3", "3 6", "5 5"), "many");
  expect(Code::file_unsupported, "<VTKFile type=\"ImageData\"><ImageData/></VTKFile>", "ImageData");
  expect(Code::file_malformed, "<VTKFile type=\"PolyData\"><PolyData/></VTKFile>", "Piece");
  expect(Code::file_unsupported, "<VTKFile type=\"PolyData\"><PolyData><Piece/><Piece/></PolyData></VTKFile>",
         "pieces");
  expect(Code::file_unsupported,
         "<VTKFile type=\"PolyData\"><PolyData><Piece NumberOfStrips=\"1\"/></PolyData></VTKFile>", "strips");
}

TEST(ReadMesh, missing_and_unknown_files) {
  const TemporaryFolder folder;
  expect_error(read_status(folder / "a.vtu"), Code::file_not_found, "a.vtu");
  expect_error(read_content(folder / "a.xyz", "x"), Code::file_unsupported, ".vtu");
  expect_error(read_content(folder / "a.vtu", ""), Code::file_malformed, "empty");
}

// A file cut short anywhere must be refused, not half read. Blanks at the end may go; OBJ has no end to miss.
TEST(ReadMesh, every_prefix_is_an_error) {
  const TemporaryFolder folder;
  Mesh mesh = random_mesh({3, 2, false, 4, 3});
  add_edges<3>(mesh);
  for (const std::string suffix : {"vtu", "vtp", "ply", "stl", "obj", "off"}) {
    ASSERT_TRUE(write_mesh(mesh, folder / ("a." + suffix)));
    const std::string content = content_of(folder / ("a." + suffix));
    ASSERT_TRUE(read_bytes(content, suffix));
    const std::size_t end = content.size() - (content.ends_with("\n") ? 2 : 1);
    for (std::size_t length = 0; length <= end; ++length) {
      const auto status = read_bytes(content.substr(0, length), suffix);
      EXPECT_TRUE(!status || suffix == "obj") << suffix << " cut to " << length;
    }
  }
}

TEST(ReadMesh, no_changed_byte_crashes) {
  const TemporaryFolder folder;
  Mesh mesh = random_mesh({3, 2, false, 4, 2});
  add_edges<3>(mesh);
  for (const std::string suffix : {"vtu", "ply", "stl", "obj", "off"}) {
    ASSERT_TRUE(write_mesh(mesh, folder / ("a." + suffix)));
    std::string content = content_of(folder / ("a." + suffix));
    for (char& byte : content) {
      const char before = byte;
      for (const int change : {1, 0x12, 0x80}) {
        byte = static_cast<char>(before ^ change);
        (void)read_bytes(content, suffix);
      }
      byte = before;
    }
  }
}

TEST(WriteMesh, meshes_that_a_format_cannot_hold) {
  const TemporaryFolder folder;
  const auto expect = [&](const MeshKind& kind, const char* name, const char* what) {
    expect_error(write_mesh(random_mesh(kind), folder / name), Code::file_unsupported, what);
    expect_error(check_mesh_format(kind.dimension, kind.simplex_dimension, folder / name),
                 Code::file_unsupported, what);
  };
  expect({4, 4}, "a.vtp", "4-simplices in 4 dimensions; formats that do: vtu");
  expect({4, 3}, "a.vtp", "vtu");
  expect({4, 3}, "a.ply", "vtu");
  expect({3, 3}, "a.stl", "vtu");
  expect({3, 1}, "a.stl", "vtu, vtp, obj");
  expect({3, 1}, "a.off", "vtu, vtp, obj");
  expect({9, 2}, "a.vtu", "no format");
  expect({5, 4}, "a.ply", "4-simplices in 5 dimensions; formats that do: vtu");
  expect({3, 2}, "a.xyz", "\"xyz\"");
  expect({3, 2}, "a", "vtu, vtp, ply");
  EXPECT_TRUE(folder.names().empty());
}

TEST(WriteMesh, meshes_that_contradict_themselves) {
  const TemporaryFolder folder;
  const auto expect = [&](auto damage, const char* what) {
    Mesh mesh = random_mesh({4, 3});
    damage(mesh);
    expect_error(write_mesh(mesh, folder / "a.vtu"), Code::invalid_argument, what);
  };
  expect([](Mesh& mesh) { mesh.simplices.set(5, 12); }, "12 vertices");
  expect([](Mesh& mesh) { mesh.simplices.resize(27); }, "within");
  expect([](Mesh& mesh) { mesh.edges.resize(3); }, "3 grid edges");
  expect([](Mesh& mesh) { mesh.attributes[1].components = 2; }, "velocity");
  expect([](Mesh& mesh) { mesh.attributes[3].name = mesh.attributes[2].name; }, "component");
  for (const char* name : {"t", "xyzt", "grid_edge"})
    expect([&](Mesh& mesh) { mesh.attributes[0].name = name; }, name);
  EXPECT_TRUE(folder.names().empty());
}

TEST(WriteMesh, existing_file_stays_when_writing_fails) {
  const TemporaryFolder folder;
  write_content(folder / "a.vtu", "old");
  EXPECT_FALSE(write_mesh(random_mesh({9, 4}), folder / "a.vtu"));
  EXPECT_EQ(content_of(folder / "a.vtu"), "old");
  expect_error(write_mesh(random_mesh({3, 2}), folder / "missing" / "a.vtu"), Code::file_unwritable, "a.vtu");
}

TEST(WriteMesh, full_disk) {
  for (const char* format : {"vtu", "vtp", "ply", "stl", "obj", "off"})
    expect_error(write_mesh(random_mesh({3, 2}), "/dev/full", {.format = format}), Code::file_unwritable,
                 "/dev/full");
}

TEST(WriteSeries, names_and_times_as_given) {
  const TemporaryFolder folder;
  ASSERT_TRUE(write_series({{0.1, "a b/1.vtp"}, {1e-300, "<&\">'.vtp"}, {-2, "c"}}, folder / "s.pvd"));
  const std::string content = content_of(folder / "s.pvd");
  EXPECT_NE(content.find("timestep=\"0.1\" part=\"0\" file=\"a b/1.vtp\""), std::string::npos) << content;
  EXPECT_NE(content.find("timestep=\"1e-300\" part=\"0\" file=\"&lt;&amp;&quot;&gt;'.vtp\""),
            std::string::npos);
  EXPECT_NE(content.find("timestep=\"-2\""), std::string::npos);
  expect_error(write_series({}, folder / "missing" / "s.pvd"), Code::file_unwritable, "s.pvd");
}
