#include "hyperiso/morph.hpp"
#include "cli/command.hpp"
#include "cli/console.hpp"
#include "cli/dispatch.hpp"
#include "cli/manual.hpp"
#include "cli/options.hpp"
#include "cli/point_data.hpp"
#include "cli/surface.hpp"
#include "core/memory.hpp"
#include "hyperiso/morph_files.hpp"

#include <fmt/format.h>
#include <memory>

namespace hyperiso::cli {
namespace {

constexpr int lowest_morphed = 3;

struct Morph {
  FieldOptions input;
  std::string iso, path;
  SurfaceOptions surface;
  PrintOptions printing;
  MachineOptions machine;
};

struct Outcome {
  int dimension = 0;
  std::optional<double> isovalue;
  std::size_t simplices = 0, pieces = 0;
  std::optional<std::pair<double, double>> times; // of the first and the last piece
  double read_seconds = 0, extract_seconds = 0, morph_seconds = 0, write_seconds = 0;
};

void check_input(int dimension, const Morph& options) {
  check_dimension(dimension, lowest_morphed, highest_dimension, "the surface");
  if (!options.path.empty()) take(check_morph_format(dimension, options.path));
}

Mesh surface_of_field(const Morph& options, Outcome& outcome) {
  if (options.iso.empty()) fail_usage("--iso is required for the pieces of a field's surface");
  const std::vector<double> isovalues = parse_isovalues(options.iso);
  if (isovalues.size() > 1) fail_usage("--iso: pieces are made at one isovalue");
  outcome.isovalue = isovalues[0];
  (void)options.surface.extract_options(options.machine); // wrong ones are told before anything is read
  SelectedSteps steps(options.input.open(options.machine), options.input);
  steps.leave_out_flat_axes(lowest_morphed);
  check_input(steps.info().dimension(), options);
  check_axes(steps.info());

  const Field field = take(steps.read(0, steps.info().axes.back().count));
  outcome.read_seconds = steps.read_seconds();
  const Stopwatch extracting;
  ProgressBar bar("extract", options.printing.quiet);
  ExtractOptions extraction = options.surface.extract_options(options.machine);
  extraction.progress = bar.callback();
  extraction.keep_edges = false;
  Mesh mesh = with_view<lowest_morphed>(
      field, [&](const auto& view) -> Mesh { return take(extract(view, isovalues[0], extraction)); });
  if (field.info.world) transform(mesh, *field.info.world);
  outcome.extract_seconds = extracting.seconds();
  if (mesh.simplex_count() == 0 && !options.printing.quiet) print_warning(why_empty(field, isovalues[0]));
  return mesh;
}

Mesh surface_of_file(const Morph& options, Outcome& outcome) {
  if (!options.iso.empty()) fail_usage("--iso: the input is a mesh; its isovalue is chosen already");
  const Stopwatch reading;
  Mesh mesh = mesh_in(options.input.paths[0], options.printing.quiet);
  outcome.read_seconds = reading.seconds();
  if (mesh.simplex_dimension != mesh.dimension - 1)
    fail_usage(text(options.input.paths[0], ": it holds ", simplex_noun(mesh.simplex_dimension), " in ",
                    mesh.dimension, " dimensions; pieces are made of a surface through time, ",
                    "of tetrahedra in 4 dimensions or triangles in 3"));
  check_input(mesh.dimension, options);
  return mesh;
}

Outcome morph(const Morph& options) {
  Outcome outcome;
  const bool from_mesh = options.input.paths.size() == 1 && is_mesh_file(options.input.paths[0]);
  Mesh surface = from_mesh ? surface_of_file(options, outcome) : surface_of_field(options, outcome);
  outcome.dimension = surface.dimension;
  outcome.simplices = surface.simplex_count();
  with_dimension<lowest_morphed>(surface.dimension, "the surface", [&](auto dimension) {
    constexpr int D = decltype(dimension)::value;
    const Stopwatch morphing;
    const auto pieces =
        take(morph_pieces(SimplexMesh<D>(std::move(surface)), D - 1, options.machine.memory_left()));
    outcome.morph_seconds = morphing.seconds();
    outcome.pieces = pieces.count();
    if (pieces.count() > 0)
      outcome.times = {pieces.start_times.front(), *std::ranges::max_element(pieces.end_times)};
    if (options.path.empty()) return;
    const Stopwatch writing;
    take(write_morph(pieces, options.path));
    outcome.write_seconds = writing.seconds();
  });
  return outcome;
}

Json json_of(const Outcome& outcome) {
  Json object{{"dimension", outcome.dimension}};
  if (outcome.isovalue) object["isovalue"] = *outcome.isovalue;
  object["simplices"] = outcome.simplices;
  object["pieces"] = outcome.pieces;
  object["times"] = outcome.times ? Json{outcome.times->first, outcome.times->second} : Json::array();
  object["seconds"] = {{"read", outcome.read_seconds},
                       {"extract", outcome.extract_seconds},
                       {"morph", outcome.morph_seconds},
                       {"write", outcome.write_seconds}};
  object["peak_memory_bytes"] = peak_memory();
  return object;
}

std::string report_of(const Outcome& outcome, const Morph& options) {
  Report report;
  if (outcome.isovalue) report.add("isovalue", fmt::format("{}", *outcome.isovalue));
  report.add(simplex_noun(outcome.dimension - 1), grouped(outcome.simplices));
  report.add("pieces", fmt::format("{} {}", grouped(outcome.pieces), simplex_noun(outcome.dimension - 2)));
  if (outcome.times)
    report.add("times", fmt::format("{:.12g} to {:.12g}", outcome.times->first, outcome.times->second));
  std::string took = seconds(outcome.read_seconds) + " to read, " +
                     seconds(outcome.extract_seconds + outcome.morph_seconds) + " to make";
  if (!options.path.empty()) took += ", " + seconds(outcome.write_seconds) + " to write";
  report.add("took", took);
  if (!options.path.empty()) report.add("wrote", options.path);
  return report.text();
}

int run(const Morph& options) {
  const Outcome outcome = morph(options);
  if (options.printing.json)
    print_json(json_of(outcome));
  else
    print(report_of(outcome, options));
  return 0;
}

} // namespace

Command morph_command(CLI::App& program) {
  auto options = std::make_shared<Morph>();
  CLI::App* app = program.add_subcommand("morph", "the surface as triangles that move, for other renderers");
  options->input.add_to(*app, "; or a mesh that 'hyperiso extract' wrote as .vtu");
  app->add_option("--iso", options->iso, "fields: the isovalue")->type_name("V")->group("Surface");
  options->surface.add_to(*app);
  app->add_option("-o,--output", options->path,
                  "the file: .npz for NumPy, or a format of meshes such as .vtu. Left out: only count")
      ->type_name("PATH")
      ->group("Output");
  options->printing.add_to(*app);
  options->machine.add_to(*app);
  set_manual(
      *app,
      {{"morph INPUT... --iso V -o PATH [options]", "morph MESH -o PATH [options]"},
       {"Takes the surface of a 4D field apart into triangles that move: each has a start time and an end "
        "time, a "
        "position for each corner at both, and its corners go straight from the one to the other. At any "
        "moment "
        "those whose time it is are the surface then, exactly. Surfaces of 3D fields become segments.",
        "  .npz  start, end            piece x corner x coordinate\n"
        "        start_time, end_time  of each piece, ascending by start_time; it is\n"
        "                              there for start < t <= end\n"
        "        simplex               the simplex of the surface that it lies in\n"
        "  .vtu  the starts as triangles; point data `end`, cell data the others"},
       {{"for a renderer of your own",
         "hyperiso morph examples/data/alpha_water_24x24x24x41.nrrd --iso 0.5 -o pieces.npz"}}});
  return {app, [options] { return run(*options); }};
}

} // namespace hyperiso::cli
