// The writing half of test_mesh_files.py: writes meshes in every format and, beside them, what they hold as
// plain JSON.
//
//   mesh_files write FOLDER       the files and FOLDER/meshes.json
//   mesh_files dump FILE...       one line of JSON for each mesh, as read_mesh reads it

#include "hand_made_meshes.hpp"
#include "hyperiso/io.hpp"
#include "hyperiso/measure.hpp"
#include "hyperiso/polylines.hpp"
#include "hyperiso/sample.hpp"
#include "hyperiso/slice.hpp"

#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <iostream>
#include <nlohmann/json.hpp>

using namespace hyperiso;
using Json = nlohmann::json;

namespace {

// The value, or the end of the program.
template <class T>
T need(Result<T> result) {
  if (result) return *std::move(result);
  std::fprintf(stderr, "mesh_files: %s\n", result.error().message.c_str());
  std::exit(1);
}

void need(const Status& status) {
  if (status) return;
  std::fprintf(stderr, "mesh_files: %s\n", status.error().message.c_str());
  std::exit(1);
}

template <class Values>
Json numbers(const Values& values) {
  Json list = Json::array();
  for (std::size_t i = 0; i < values.size(); ++i) list.push_back(values[i]);
  return list;
}

Json plain(const Mesh& mesh) {
  Json attributes = Json::array();
  for (const Attribute& attribute : mesh.attributes)
    attributes.push_back(
        {{"name", attribute.name},
         {"at", attribute.location == Attribute::Location::vertex ? "points" : "cells"},
         {"components", attribute.components},
         {"values", std::visit([](const auto& v) { return numbers(v); }, attribute.values)}});
  return {{"dimension", mesh.dimension},          {"corners", mesh.simplex_dimension + 1},
          {"f64", mesh.positions.wide()},         {"positions", numbers(mesh.positions)},
          {"simplices", numbers(mesh.simplices)}, {"attributes", attributes},
          {"edges", numbers(mesh.edges)}};
}

class Writer {
 public:
  explicit Writer(std::filesystem::path folder) : folder_(std::move(folder)) {}

  void write(const std::string& name, const Mesh& mesh, std::initializer_list<const char*> suffixes,
             Json more = Json::object()) {
    more.update(plain(mesh));
    for (const char* suffix : suffixes) {
      const std::string file = name + "." + suffix;
      need(write_mesh(mesh, folder_ / file));
      more["file"] = file;
      meshes_.push_back(more);
    }
  }
  void finish() const { std::ofstream(folder_ / "meshes.json") << meshes_; }

 private:
  std::filesystem::path folder_;
  Json meshes_ = Json::array();
};

// A ball that moves through the grid, as one surface in R^4, and the area of its slice in time.
void write_moving_ball(Writer& writer) {
  const Field field = need(make_sample("ball", {.dims = {17, 17, 17, 9}}));
  const auto surface = need(extract(field.view<float, 4>(), 0.5, {.precision = Precision::f64}));
  const double time = 0.4;
  const auto cut = need(slice(surface, Hyperplane<4>::at(3, time), {.precision = Precision::f64}));
  const Measure measured = need(measure(cut));
  writer.write("moving_ball", surface, {"vtu"}, {{"time", time}, {"area", measured.content}});
  writer.write("slice", cut, {"vtu", "vtp", "ply", "stl", "obj", "off"});
}

// Isolines of a field with ties: closed and open ones.
void write_isolines(Writer& writer) {
  const Field field = need(make_sample("noise", {.dims = {24, 18}}));
  const auto surface = need(extract(field.view<float, 2>(), 0.5));
  Json lines = Json::array();
  for (const Polyline& line : need(polylines(surface)))
    lines.push_back({{"vertices", line.vertices}, {"closed", line.closed}});
  writer.write("isolines", surface, {"vtp", "svg", "geojson"}, {{"lines", lines}});
}

void write_all(const std::filesystem::path& folder) {
  Writer writer(folder);
  for (const bool f64 : {false, true}) {
    const std::string precision = f64 ? "_f64" : "_f32";
    writer.write("segments_r2" + precision, random_mesh({2, 1, f64}), {"vtu", "vtp", "obj"});
    writer.write("triangles_r2" + precision, random_mesh({2, 2, f64}),
                 {"vtu", "vtp", "ply", "stl", "obj", "off"});
    writer.write("segments_r3" + precision, random_mesh({3, 1, f64}), {"vtu", "vtp", "obj"});
    writer.write("triangles_r3" + precision, random_mesh({3, 2, f64}),
                 {"vtu", "vtp", "ply", "stl", "obj", "off"});
    writer.write("tetrahedra_r3" + precision, random_mesh({3, 3, f64}), {"vtu"});
    writer.write("triangles_r4" + precision, random_mesh({4, 2, f64}), {"vtu"});
    writer.write("tetrahedra_r4" + precision, random_mesh({4, 3, f64}), {"vtu"});
    writer.write("4_simplices_r4" + precision, random_mesh({4, 4, f64}), {"vtu"});
  }
  Mesh heat = random_mesh({3, 2});
  heat.attributes.resize(2); // those of vertices
  writer.write("vertex_attributes", heat, {"ply"});
  // More than one block of every array.
  writer.write("large", random_mesh({3, 2, true, 50'000, 100'000}), {"vtu", "vtp", "ply"});
  writer.write("no_triangles", random_mesh({3, 2, false, 5, 0}), {"vtu", "vtp"});
  writer.write("nothing", random_mesh({3, 2, false, 0, 0}), {"vtu", "vtp"});
  writer.write("nothing_r4", random_mesh({4, 3, false, 0, 0}), {"vtu"});
  Mesh with_edges = random_mesh({4, 3});
  add_edges<4>(with_edges);
  writer.write("with_edges", with_edges, {"vtu"});
  write_moving_ball(writer);
  write_isolines(writer);
  writer.finish();
  need(write_series({{0.1, "slice.vtp"}, {1.0 / 3, "triangles_r3_f32.vtp"}}, folder / "series & <more>.pvd"));
}

} // namespace

int main(int argc, char** argv) {
  const std::string verb = argc > 2 ? argv[1] : "";
  if (verb == "write") {
    write_all(argv[2]);
  } else if (verb == "dump") {
    for (int i = 2; i < argc; ++i) std::cout << plain(need(read_mesh(argv[i]))) << '\n';
  } else {
    std::fprintf(stderr, "usage: mesh_files write FOLDER | dump FILE...\n");
    return 2;
  }
}
