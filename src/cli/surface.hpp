#pragma once
// What the verbs that make surfaces have in common: names of files, the measure, the way to world
// coordinates.

#include "cli/console.hpp"
#include "cli/options.hpp"
#include "hyperiso/measure.hpp"
#include "hyperiso/mesh.hpp"
#include "hyperiso/self_intersections.hpp"

namespace hyperiso::cli {

// "24 x 24 x 24 x 41 f32"
std::string size_and_type(const FieldInfo& info);
Json dims_of(const FieldInfo& info); // [24, 24, 24, 41]

// "x", or the number of an axis without a name
std::string name_of_axis(const std::vector<Axis>& axes, std::size_t axis);

// The axes of the space of a mesh: those of its grid, else x, y, z, t without samples.
std::vector<Axis> axes_of(const Mesh& mesh);

Mesh mesh_in(const std::string& path, bool quiet);
Measure measure_of(const Mesh& mesh, bool quiet, int threads = 0);
// Fails if the mesh and --measure of it take more memory than the limit.
void check_memory_to_measure(const Mesh& mesh, std::uint64_t limit);
std::uint64_t bytes_of(const Mesh& mesh);

// Whether a file holds a mesh, by its suffix.
bool is_mesh_file(const std::string& path);

// "tetrahedra", "triangles", ... for simplices of dimension k
const char* simplex_noun(int k);
// "area", "volume", ...
const char* content_noun(int k);

Json json_of(const Measure& measure);
// --self-intersections
void add_self_intersections_option(CLI::App& app, bool& option);
SelfIntersections self_intersections_of(const Mesh& mesh, bool quiet);
Json json_of(const SelfIntersections& found);
void add_self_intersections(Report& report, const SelfIntersections& found);

void add_measure(Report& report, const Measure& measure, int simplex_dimension);
void add_contents(Report& report, const Contents& contents, int simplex_dimension);

// The field without its axes of one sample, as far as two are left: one step of a volume is a volume. Fails
// if an axis of one sample remains: no surface can exist.
FieldInfo without_flat_axes(FieldInfo info);
Field without_flat_axes(Field field);

// Fails if an axis has one sample.
void check_axes(const FieldInfo& info);

// The same map without `axis`, which stays at `value`.
Affine at_coordinate(const Affine& map, int axis, double value);

// The file of one of several results: name.vtu, "iso0.5" -> name_iso0.5.vtu
std::string with_suffix(const std::string& path, const std::string& suffix);

// Whether a path has a place for a number: %d, %4d or %04d, as in frames/f_%04d.ply.
bool has_number_pattern(const std::string& path);
// The path with the number there. Fails unless there is exactly one such place ("%%" is a percent sign).
std::string with_number(const std::string& option, const std::string& path, std::size_t number);

// A warning for an empty surface: that the isovalue is outside the range of the field, if it is.
std::string why_empty(const Field& field, double isovalue);
std::string why_empty(StepSource& steps, double isovalue);

} // namespace hyperiso::cli
