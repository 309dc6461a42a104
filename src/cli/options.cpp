#include "cli/options.hpp"

#include "cli/console.hpp"
#include "cli/failure.hpp"
#include "cli/parse.hpp"
#include "cli/surface.hpp"
#include "core/memory.hpp"
#include "core/text.hpp"

#include <algorithm>
#include <filesystem>

namespace hyperiso::cli {
namespace {

constexpr const char* input_group = "Input";
constexpr const char* surface_group = "Surface";
constexpr const char* output_group = "Output";
constexpr const char* machine_group = "Machine";

// Declares an option with one value, taken as text.
void add_text(CLI::App& app, const char* name, std::string& value, const char* type, const char* group,
              const std::string& meaning) {
  app.add_option(name, value, meaning)->type_name(type)->group(group);
}

std::pair<std::int64_t, std::int64_t> resolve(const char* option, const IndexRange& range,
                                              const FieldInfo& info, std::size_t axis) {
  const std::int64_t count = info.axes[axis].count;
  const std::int64_t begin = range.begin.value_or(0), end = range.end.value_or(count);
  if (begin >= end || end > count)
    fail_usage(text(option, ": ", begin, ":", end, " does not fit axis ", name_of_axis(info.axes, axis),
                    ", whose samples are 0:", count));
  return {begin, end};
}

} // namespace

void PrintOptions::add_to(CLI::App& app) {
  app.add_flag("--json", json, "print one JSON object instead of the report")->group(output_group);
  app.add_flag("--quiet", quiet, "no progress bar and no warnings; errors still appear")->group(output_group);
}

void MachineOptions::add_to(CLI::App& app) {
  add_text(app, "--memory", memory, "SIZE", machine_group,
           "the most memory to use, for example 800M or 4G (K, M, G, T: powers of 1024); what takes more and "
           "cannot be done step by step is an error. The tables of the methods come on top: up to 20 MB, "
           "and 140 MB for 5D fields and volumes of 4D ones. Left out: 80 % of what is free");
  add_text(app, "--threads", threads, "N", machine_group,
           "the most threads to use; left out: one for each processor. The result does not depend on it");
}

int MachineOptions::thread_count() const {
  if (threads.empty()) return 0;
  const std::int64_t count = parse_integer("--threads", threads);
  if (count < 1 || count > 4096) fail_usage(text("--threads: ", count, " is not from 1 to 4096"));
  return static_cast<int>(count);
}

std::uint64_t MachineOptions::memory_limit() const {
  if (!memory.empty()) return parse_bytes("--memory", memory);
  const std::uint64_t available = available_memory();
  return available == UINT64_MAX ? available : available / 5 * 4;
}

std::uint64_t MachineOptions::memory_left() const {
  if (memory.empty()) return memory_limit(); // what is free now leaves out what is held
  const std::uint64_t limit = memory_limit(), held = held_memory();
  if (limit <= held)
    throw Failure{{Code::out_of_memory, text("the program itself holds ", byte_size(held),
                                             ", the memory limit is ", byte_size(limit))}};
  return limit - held;
}

void FieldOptions::add_to(CLI::App& app, const std::string& instead) {
  app.add_option("INPUT", paths,
                 "the field: one .nrrd, .nhdr, .vti, .npy, .pvd, .series, or .raw (with --dims and --type); "
                 "or a file "
                 "for each step" +
                     instead)
      ->expected(1, CLI::detail::expected_max_vector_size)
      ->required()
      ->group(input_group);
  add_text(app, "--variable", variable, "NAME", input_group,
           "the array to read where a file holds several; left out: the first");
  add_text(
      app, "--time-axis", time_axis, "AXIS", input_group,
      "name or number of the axis that is time; it becomes the last. Left out: as the file says, else the "
      "last axis");
  add_text(app, "--crop", crop, "RANGES", input_group,
           "samples to use, a range of indices for each axis, axis 0 first: 0:32,,8:24 is samples 0 to 31 of "
           "axis 0, all of axis 1, 8 to 23 of axis 2 and all of the others");
  add_text(app, "--steps", steps, "T0:T1", input_group,
           "steps to use: a range of indices along the last axis, from T0 up to but not including T1. Only "
           "these are read");
  add_text(app, "--dims", dims, "N,N,...", input_group,
           "raw files: samples along each axis, the fastest first");
  add_text(app, "--type", type, "TYPE", input_group, "raw files: u8, i8, u16, i16, u32, i32, f32 or f64");
  add_text(app, "--skip", skip, "BYTES", input_group, "raw files: header to leave out; default 0");
  app.add_flag("--big-endian", big_endian, "raw files: the most significant byte comes first")
      ->group(input_group);
}

std::unique_ptr<FieldReader> FieldOptions::open(const MachineOptions& machine) const {
  ReadOptions options;
  if (!dims.empty()) options.dims = parse_counts("--dims", dims);
  if (!type.empty()) options.type = parse_sample_type("--type", type);
  if (!skip.empty()) options.skip_bytes = parse_integer("--skip", skip);
  options.big_endian = big_endian;
  options.variable = variable;
  options.time_axis = time_axis;
  options.memory_limit = machine.memory_left();
  return take(open_field({paths.begin(), paths.end()}, options));
}

Selection FieldOptions::selection(const FieldInfo& info) const {
  const std::size_t axes = info.axes.size();
  const auto entries = crop.empty() ? std::vector<std::string>{} : split(crop, ',');
  if (entries.size() > axes)
    fail_usage(text("--crop: ", entries.size(), " ranges for a field of ", axes, " axes"));
  Selection selection;
  for (std::size_t axis = 0; axis < axes; ++axis)
    selection.ranges.push_back(resolve(
        "--crop", axis < entries.size() ? parse_range("--crop", entries[axis]) : IndexRange{}, info, axis));
  if (!steps.empty()) {
    if (entries.size() == axes && !entries.back().empty())
      fail_usage("--steps and the last range of --crop both choose steps: give one of them");
    selection.ranges.back() = resolve("--steps", parse_range("--steps", steps), info, axes - 1);
  }
  return selection;
}

FieldInfo selected(const FieldInfo& info, const Selection& selection) {
  FieldInfo result = info;
  for (std::size_t axis = 0; axis < result.axes.size(); ++axis)
    result.axes[axis] =
        result.axes[axis].cropped(selection.ranges[axis].first, selection.ranges[axis].second);
  return result;
}

Field read_selection(FieldReader& reader, const Selection& selection, bool quiet) {
  const ProgressBar bar("read", quiet);
  Field field = take(reader.read(selection.ranges.back().first, selection.ranges.back().second));
  for (std::size_t axis = 0; axis + 1 < selection.ranges.size(); ++axis)
    field =
        field.cropped(static_cast<int>(axis), selection.ranges[axis].first, selection.ranges[axis].second);
  return field;
}

std::vector<double> parse_isovalues(const std::string& iso) {
  std::vector<double> isovalues = parse_numbers("--iso", iso);
  for (std::size_t i = 0; i < isovalues.size(); ++i)
    if (std::find(isovalues.begin(), isovalues.begin() + static_cast<std::ptrdiff_t>(i), isovalues[i]) !=
        isovalues.begin() + static_cast<std::ptrdiff_t>(i))
      fail_usage(text("--iso: ", isovalues[i], " is given twice"));
  return isovalues;
}

void SurfaceOptions::add_to(CLI::App& app) {
  add_text(
      app, "--method", method, "METHOD", surface_group,
      "how a cell is filled: hull (default: fewest simplices, vertices on the edges of the grid), "
      "component (the same, but an ambiguous cell keeps the outside together), simplicial (cuts of the "
      "Kuhn simplices, about five times as many; never passes through itself, whatever the dimension) or "
      "barycentric (cuts of the barycentric subdivision: for comparison, slow)");
  add_text(app, "--cut", cut, "CUT", surface_group,
           "of --method barycentric: midpoints (default: recursive contour meshing) or staircase (as "
           "simplicial: fewer simplices)");
  add_text(app, "--inside", inside, "SIDE", surface_group,
           "which samples are inside: above (default: values >= the isovalue) or below (values <= it). "
           "Normals point away from them; where a cell is ambiguous they stay together");
  add_text(app, "--precision", precision, "TYPE", surface_group,
           "of the coordinates: f32 (default) or f64; they are computed in f64 in any case");
}

ExtractOptions SurfaceOptions::extract_options(const MachineOptions& machine) const {
  ExtractOptions options;
  options.threads = machine.thread_count();
  options.memory_limit = machine.memory_left();
  if (method == "hull")
    options.method = Method::hull;
  else if (method == "simplicial")
    options.method = Method::simplicial;
  else if (method == "component")
    options.method = Method::component;
  else if (method == "barycentric")
    options.method = Method::barycentric;
  else
    fail_usage(text("--method: '", method,
                    "' is not a method; there are hull, component, simplicial and barycentric"));
  if (!cut.empty() && cut != "midpoints" && cut != "staircase")
    fail_usage(text("--cut: '", cut, "' is neither midpoints nor staircase"));
  if (!cut.empty() && options.method != Method::barycentric)
    fail_usage(text("--cut: only for --method barycentric, not for ", method));
  options.cut = cut == "staircase" ? Cut::staircase : Cut::midpoints;
  if (inside != "above" && inside != "below")
    fail_usage(text("--inside: '", inside, "' is neither above nor below"));
  options.inside = inside == "above" ? Inside::above : Inside::below;
  if (precision != "f32" && precision != "f64")
    fail_usage(text("--precision: '", precision, "' is neither f32 nor f64"));
  options.precision = precision == "f32" ? Precision::f32 : Precision::f64;
  return options;
}

void MeshOutputOptions::add_to(CLI::App& app, const std::string& several) {
  add_text(app, "-o,--output", path, "PATH", output_group,
           "file to write, in the format of its suffix. " + several +
               " Left out: nothing is written, only the report");
  add_text(app, "--format", format, "FORMAT", output_group,
           "the format, whatever the suffix: vtu, vtp, ply, stl, obj, off or, for lines, svg or geojson");
}

void MeshOutputOptions::check(int dimension, int simplex_dimension, const std::string& written) const {
  WriteMeshOptions options;
  options.format = format;
  take(check_mesh_format(dimension, simplex_dimension, written, options));
}

std::string MeshOutputOptions::format_of(const std::string& written) const {
  const std::string suffix = std::filesystem::path(written).extension().string();
  return !format.empty() || suffix.empty() ? format : suffix.substr(1);
}

WriteMeshOptions MeshOutputOptions::write_options(const std::vector<Axis>& axes, FileGroup& group) const {
  WriteMeshOptions options;
  options.format = format;
  options.group = &group;
  for (const Axis& axis : axes) {
    options.axis_names.push_back(axis.name);
    options.axis_units.push_back(axis.unit);
  }
  return options;
}

void FieldOutputOptions::add_to(CLI::App& app) {
  add_text(
      app, "-o,--output", path, "PATH", output_group,
      "file to write: .nrrd, .npy, .raw or .vti (with time: PATH.pvd and a numbered .vti for each step)");
  app.add_flag("--compress", compress, ".nrrd: compress the samples (gzip)")->group(output_group);
}

WriteFieldOptions FieldOutputOptions::write_options() const { return {.format = {}, .compress = compress}; }

void FieldOutputOptions::check(const FieldInfo& info) const {
  if (path.empty()) fail_usage("-o is required: the file to write");
  take(check_field_format(info, path, write_options()));
}

std::string FieldOutputOptions::files_of(const FieldInfo& info) const {
  std::filesystem::path series = path;
  const std::string suffix = series.extension().string();
  if (!info.has_time || (suffix != ".vti" && suffix != ".pvd")) return path;
  const std::int64_t steps = info.axes.back().count;
  const std::string files =
      steps == 1 ? "the .vti of its step" : text("a .vti for each of its ", steps, " steps");
  return text(series.replace_extension("pvd").string(), ", and ", files);
}

double FieldOutputOptions::write(const Field& field, bool quiet) const {
  const ProgressBar bar("write", quiet);
  const Stopwatch stopwatch;
  take(write_field(field, path, write_options()));
  return stopwatch.seconds();
}

} // namespace hyperiso::cli
