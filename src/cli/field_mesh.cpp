#include "cli/field_mesh.hpp"

#include "core/memory.hpp"

namespace hyperiso::cli {

OpenedField open_field(const FieldMeshOptions& options, int lowest, int highest, int codimension) {
  OpenedField opened{std::make_unique<SelectedSteps>(options.input.open(options.machine), options.input), {}};
  opened.info = without_flat_axes(opened.steps->info());
  opened.steps->leave_out_flat_axes();
  const int dimension = opened.info.dimension();
  check_dimension(dimension, lowest, highest, "the field");
  if (options.output.wanted()) options.output.check(dimension, dimension - codimension, options.output.path);
  options.data.check(options.output, options.output.path);
  return opened;
}

LoadedField load_field(const FieldMeshOptions& options, const OpenedField& opened) {
  const ProgressBar bar("read", options.printing.quiet);
  const Stopwatch reading;
  LoadedField loaded{without_flat_axes(take(opened.steps->read(0, opened.steps->info().axes.back().count)))};
  loaded.read_seconds = reading.seconds();
  return loaded;
}

LoadedField load_field(const FieldMeshOptions& options, int lowest, int highest, int codimension) {
  return load_field(options, open_field(options, lowest, highest, codimension));
}

std::vector<NamedField> load_others(const FieldMeshOptions& options) {
  std::vector<NamedField> others;
  for (const NamedSteps& other : options.data.open(options.input, options.machine))
    others.push_back(
        {other.name, without_flat_axes(take(other.steps->read(0, other.steps->info().axes.back().count)))});
  return others;
}

Outcome finish(const Mesh& mesh, const FieldMeshOptions& options, const FieldInfo& info,
               const std::string& path, FileGroup& files, std::uint64_t memory_limit) {
  const bool quiet = options.printing.quiet;
  Outcome outcome;
  outcome.simplex_dimension = mesh.simplex_dimension;
  outcome.vertices = mesh.vertex_count();
  outcome.simplices = mesh.simplex_count();
  outcome.active_cells = mesh.active_cells;
  outcome.path = path;
  if (options.measure) {
    check_memory_to_measure(mesh, memory_limit);
    outcome.measure = measure_of(mesh, quiet, options.machine.thread_count());
  }
  if (options.self_intersections) outcome.self_intersections = self_intersections_of(mesh, quiet);
  if (path.empty()) return outcome;

  const Stopwatch writing;
  const ProgressBar bar("write", quiet);
  take(write_mesh(mesh, path, options.output.write_options(info.axes, files)));
  outcome.write_seconds = writing.seconds();
  return outcome;
}

Json json_of(const Outcome& outcome, const FieldMeshOptions& options, const FieldInfo& info, Json about) {
  Json object{{"dimension", info.dimension()}, {"dims", dims_of(info)}};
  object.update(about);
  object["method"] = options.surface.method;
  object["inside"] = options.surface.inside;
  object["vertices"] = outcome.vertices;
  object["simplices"] = outcome.simplices;
  object["active_cells"] = outcome.active_cells;
  object["seconds"] = {
      {"read", outcome.read_seconds}, {"extract", outcome.extract_seconds}, {"write", outcome.write_seconds}};
  object["peak_memory_bytes"] = peak_memory();
  if (outcome.contents) {
    object["content"] = outcome.contents->content;
    object["inverted_simplices"] = outcome.contents->inverted_simplices;
  }
  if (outcome.measure) object["measure"] = json_of(*outcome.measure);
  if (outcome.self_intersections) object["self_intersections"] = json_of(*outcome.self_intersections);
  return object;
}

void add_outcome(Report& report, const Outcome& outcome) {
  report.add("active cells", grouped(outcome.active_cells));
  report.add("vertices", grouped(outcome.vertices));
  report.add(simplex_noun(outcome.simplex_dimension), grouped(outcome.simplices));
  if (outcome.measure)
    add_measure(report, *outcome.measure, outcome.simplex_dimension);
  else if (outcome.contents)
    add_contents(report, *outcome.contents, outcome.simplex_dimension);
  if (outcome.self_intersections) add_self_intersections(report, *outcome.self_intersections);
  std::string took =
      seconds(outcome.read_seconds) + " to read, " + seconds(outcome.extract_seconds) + " to extract";
  if (!outcome.path.empty()) took += ", " + seconds(outcome.write_seconds) + " to write";
  report.add("took", took);
  if (!outcome.path.empty()) report.add("wrote", outcome.path);
}

} // namespace hyperiso::cli
