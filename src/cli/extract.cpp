#include "cli/command.hpp"
#include "cli/console.hpp"
#include "cli/dispatch.hpp"
#include "cli/manual.hpp"
#include "cli/options.hpp"
#include "cli/surface.hpp"
#include "core/memory.hpp"

#include <fmt/format.h>
#include <memory>

namespace hyperiso::cli {
namespace {

struct Extract {
  FieldOptions input;
  std::string iso;
  SurfaceOptions surface;
  MeshOutputOptions output;
  bool measure = false, self_intersections = false;
  PrintOptions printing;
  MachineOptions machine;
};

// What is told about one surface.
struct Outcome {
  double isovalue = 0;
  std::uint64_t vertices = 0, simplices = 0, active_cells = 0;
  std::optional<Measure> measure;
  std::optional<SelfIntersections> self_intersections;
  std::string path;
  double read_seconds = 0, extract_seconds = 0, write_seconds = 0;
};

Mesh surface_of(const Field& field, double isovalue, ExtractOptions options, bool quiet) {
  ProgressBar bar("extract", quiet);
  options.progress = bar.callback();
  Mesh mesh = with_view<lowest_dimension, highest_extracted>(
      field, [&](const auto& view) -> Mesh { return take(extract(view, isovalue, options)); });
  if (field.info.world) transform(mesh, *field.info.world);
  return mesh;
}

Outcome make_surface(const Extract& options, const Field& field, double isovalue, const std::string& path,
                     FileGroup& files) {
  ExtractOptions extraction = options.surface.extract_options(options.machine);
  extraction.keep_edges = !path.empty();
  Outcome outcome;
  outcome.isovalue = isovalue;
  outcome.path = path;

  const Stopwatch extracting;
  const Mesh mesh = surface_of(field, isovalue, extraction, options.printing.quiet);
  outcome.extract_seconds = extracting.seconds();
  outcome.vertices = mesh.vertex_count();
  outcome.simplices = mesh.simplex_count();
  outcome.active_cells = mesh.active_cells;
  if (mesh.simplex_count() == 0 && !options.printing.quiet) print_warning(why_empty(field, isovalue));
  if (options.measure) outcome.measure = measure_of(mesh, options.printing.quiet);
  if (options.self_intersections)
    outcome.self_intersections = self_intersections_of(mesh, options.printing.quiet);

  if (path.empty()) return outcome;
  const Stopwatch writing;
  const ProgressBar bar("write", options.printing.quiet);
  take(write_mesh(mesh, path, options.output.write_options(field.info.axes, files)));
  outcome.write_seconds = writing.seconds();
  return outcome;
}

Json json_of(const Outcome& outcome, const Extract& options, const FieldInfo& info) {
  Json object{{"dimension", info.dimension()},
              {"dims", dims_of(info)},
              {"isovalue", outcome.isovalue},
              {"method", options.surface.method},
              {"inside", options.surface.inside},
              {"vertices", outcome.vertices},
              {"simplices", outcome.simplices},
              {"active_cells", outcome.active_cells},
              {"seconds",
               {{"read", outcome.read_seconds},
                {"extract", outcome.extract_seconds},
                {"write", outcome.write_seconds}}},
              {"peak_memory_bytes", peak_memory()}};
  if (outcome.measure) object["measure"] = cli::json_of(*outcome.measure);
  if (outcome.self_intersections) object["self_intersections"] = cli::json_of(*outcome.self_intersections);
  return object;
}

std::string report_of(const Outcome& outcome, const Extract& options, const FieldInfo& info) {
  const int k = info.dimension() - 1;
  Report report;
  report.add("field", size_and_type(info));
  report.add("isovalue", fmt::format("{}, {}, inside {}", outcome.isovalue, options.surface.method,
                                     options.surface.inside));
  report.add("active cells", grouped(outcome.active_cells));
  report.add("vertices", grouped(outcome.vertices));
  report.add(simplex_noun(k), grouped(outcome.simplices));
  if (outcome.measure) add_measure(report, *outcome.measure, k);
  if (outcome.self_intersections) add_self_intersections(report, *outcome.self_intersections);
  std::string took =
      seconds(outcome.read_seconds) + " to read, " + seconds(outcome.extract_seconds) + " to extract";
  if (!outcome.path.empty()) took += ", " + seconds(outcome.write_seconds) + " to write";
  report.add("took", took);
  if (!outcome.path.empty()) report.add("wrote", outcome.path);
  return report.text();
}

void print_outcomes(const std::vector<Outcome>& outcomes, const Extract& options, const FieldInfo& info) {
  if (!options.printing.json) {
    std::string reports;
    for (const Outcome& outcome : outcomes)
      reports += (reports.empty() ? "" : "\n") + report_of(outcome, options, info);
    return print(reports);
  }
  if (outcomes.size() == 1) return print_json(json_of(outcomes[0], options, info));
  Json surfaces = Json::array();
  for (const Outcome& outcome : outcomes) surfaces.push_back(json_of(outcome, options, info));
  print_json(Json{{"surfaces", surfaces}});
}

int run(const Extract& options) {
  const std::vector<double> isovalues = parse_isovalues(options.iso);
  (void)options.surface.extract_options(options.machine); // wrong ones are told before anything is read
  const auto reader = options.input.open(options.machine);
  const Selection selection = options.input.selection(reader->info());
  const int dimension = without_flat_axes(selected(reader->info(), selection)).dimension();
  check_dimension<lowest_dimension, highest_extracted>(dimension, "the field");
  if (options.output.wanted()) options.output.check(dimension, dimension - 1, options.output.path);

  const Stopwatch reading;
  const Field field = without_flat_axes(read_selection(*reader, selection, options.printing.quiet));
  const double read_seconds = reading.seconds();

  FileGroup files;
  std::vector<Outcome> outcomes;
  for (const double isovalue : isovalues) {
    std::string path = options.output.path;
    if (options.output.wanted() && isovalues.size() > 1) path = with_suffix(path, "iso" + shortest(isovalue));
    outcomes.push_back(make_surface(options, field, isovalue, path, files));
    outcomes.back().read_seconds = read_seconds;
  }
  take(files.commit());
  print_outcomes(outcomes, options, field.info);
  return 0;
}

} // namespace

Command extract_command(CLI::App& program) {
  auto options = std::make_shared<Extract>();
  CLI::App* app = program.add_subcommand("extract", "the isosurface of a field");
  options->input.add_to(*app);
  app->add_option("--iso", options->iso, "the isovalue, or several with commas between them")
      ->type_name("V[,V...]")
      ->required()
      ->group("Surface");
  options->surface.add_to(*app);
  options->output.add_to(*app,
                         "With several isovalues one file for each: PATH with _iso and the value before "
                         "the suffix, as in wave_iso0.5.vtu.");
  app->add_flag("--measure", options->measure,
                "also check and measure the surface: components, Euler characteristic, boundary, area")
      ->group("Output");
  add_self_intersections_option(*app, options->self_intersections);
  options->printing.add_to(*app);
  options->machine.add_to(*app);
  set_manual(
      *app,
      {{"extract INPUT... --iso V[,V...] [options]"},
       {"Finds where the field has the value V: a mesh of segments in a 2D field, triangles in 3D, "
        "tetrahedra in "
        "4D (three axes of space and time), and so on. Vertices are shared, simplices oriented with their "
        "normals away "
        "from the "
        "inside; the mesh is closed except where it meets the end of the data. NaN samples are no data: no "
        "surface touches their cells.",
        "Without -o nothing is written. 4D surfaces are written as .vtu, with the time of each vertex as "
        "point data "
        "t and all four coordinates as xyzt; cut them with 'hyperiso slice' or with ParaView's Contour of "
        "t."},
       {{"the surface of the water through all of time, for ParaView",
         "hyperiso extract examples/data/alpha_water_24x24x24x41.nrrd --iso 0.5 -o water.vtu"},
        {"two isovalues, checked and measured, nothing written",
         "hyperiso extract examples/data/alpha_water_24x24x24x41.nrrd --iso 0.1,0.9 --measure"},
        {"ten steps of it, numbers for a script",
         "hyperiso extract examples/data/alpha_water_24x24x24x41.nrrd --iso 0.5 --steps 10:20 --json"}}});
  return {app, [options] { return run(*options); }};
}

} // namespace hyperiso::cli
