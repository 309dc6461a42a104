#pragma once
// What the verbs that make meshes of a field share: their options, the way from the file to the field and
// from the mesh to its file, and what is told about each mesh.

#include "cli/dispatch.hpp"
#include "cli/failure.hpp"
#include "cli/point_data.hpp"
#include "cli/surface.hpp"

namespace hyperiso::cli {

struct FieldMeshOptions {
  FieldOptions input;
  SurfaceOptions surface;
  PointDataOptions data; // of surfaces
  MeshOutputOptions output;
  bool measure = false, self_intersections = false;
  PrintOptions printing;
  MachineOptions machine;
};

// A field that is open but not yet read.
struct OpenedField {
  std::unique_ptr<SelectedSteps> steps;
  FieldInfo info; // without its axes of one sample
};

// Opens the field that the options select. Fails if it does not have `lowest` to `highest` dimensions, or if
// the file to write cannot hold simplices of `codimension` less than that.
OpenedField open_field(const FieldMeshOptions& options, int lowest, int highest, int codimension);

// A field as it was read, without its axes of one sample.
struct LoadedField {
  Field field;
  double read_seconds = 0;
};

// Reads the field that the options select. Fails, before its samples are read, if it does not have `lowest`
// to `highest` dimensions, or if the file to write cannot hold simplices of `codimension` less than that.
LoadedField load_field(const FieldMeshOptions& options, int lowest, int highest, int codimension);
LoadedField load_field(const FieldMeshOptions& options, const OpenedField& opened);

// Reads the fields of --with, as the options select of the field itself.
std::vector<NamedField> load_others(const FieldMeshOptions& options);

// What is told about one mesh.
struct Outcome {
  int simplex_dimension = 0;
  std::uint64_t vertices = 0, simplices = 0, active_cells = 0;
  std::optional<Measure> measure;
  std::optional<Contents> contents; // told of volumes, measured or not
  std::optional<SelfIntersections> self_intersections;
  std::string path; // of its file; empty: it was not written
  double read_seconds = 0, extract_seconds = 0, write_seconds = 0;
};

// Calls make(view, progress) with the field as a view of its type and dimension, under a progress bar, and
// takes the mesh that it gives to world coordinates.
template <int Highest, class Make>
Mesh make_mesh(const char* label, const Field& field, bool quiet, const Make& make) {
  ProgressBar bar(label, quiet);
  Mesh mesh = with_view<lowest_dimension, Highest>(
      field, [&](const auto& view) -> Mesh { return take(make(view, bar.callback())); });
  if (field.info.world) transform(mesh, *field.info.world);
  return mesh;
}

// Measures a mesh and writes it to `path`, if there is one, as the options ask. `memory_limit` is that of the
// mesh and of what is measured together.
Outcome finish(const Mesh& mesh, const FieldMeshOptions& options, const FieldInfo& info,
               const std::string& path, FileGroup& files, std::uint64_t memory_limit);

// The members of the JSON object, after `about` (dimension, dims and what the verb has to say), and the lines
// of the report.
Json json_of(const Outcome& outcome, const FieldMeshOptions& options, const FieldInfo& info, Json about);
void add_outcome(Report& report, const Outcome& outcome);

} // namespace hyperiso::cli
