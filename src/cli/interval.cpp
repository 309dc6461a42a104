#include "hyperiso/interval.hpp"

#include "cli/command.hpp"
#include "cli/field_mesh.hpp"
#include "cli/manual.hpp"
#include "cli/parse.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <memory>

namespace hyperiso::cli {
namespace {

struct Interval : FieldMeshOptions {
  std::string range, level_axis = "last";
};

IntervalOptions interval_options(const Interval& options) {
  IntervalOptions result;
  static_cast<ExtractOptions&>(result) = options.surface.extract_options(options.machine);
  result.keep_edges = options.output.wanted();
  if (options.level_axis != "last" && options.level_axis != "first")
    fail_usage(text("--level-axis: '", options.level_axis, "' is neither last nor first"));
  result.level_axis = options.level_axis == "first" ? LevelAxis::first : LevelAxis::last;
  return result;
}

// What is told of every volume, and so part of the work; --measure has it already.
Contents contents_of(const Mesh& mesh, const Interval& options, Outcome& outcome) {
  if (outcome.measure) return *outcome.measure;
  const ProgressBar bar("measure", options.printing.quiet);
  const Stopwatch adding;
  const Contents contents = take(measure_contents(mesh, options.machine.thread_count()));
  outcome.extract_seconds += adding.seconds();
  return contents;
}

std::string report_of(const Outcome& outcome, const Interval& options, const std::vector<double>& levels,
                      const FieldInfo& info) {
  Report report;
  report.add("field", size_and_type(info));
  report.add(levels.size() == 2 ? "range" : "levels",
             fmt::format("{:.12g}, {}", fmt::join(levels, levels.size() == 2 ? " to " : ", "),
                         options.surface.method));
  add_outcome(report, outcome);
  return report.text();
}

int run(const Interval& options) {
  const std::vector<double> levels = parse_levels("--range", options.range);
  IntervalOptions filling = interval_options(options); // wrong ones are told before anything is read
  const auto [field, read_seconds] = load_field(options, lowest_dimension, highest_dimension, 0);

  const Stopwatch extracting;
  const Mesh mesh = make_mesh<highest_dimension>(
      "interval", field, options.printing.quiet, [&](const auto& view, const Progress& progress) {
        filling.progress = progress;
        return interval(view, std::span<const double>(levels), filling);
      });
  const double extract_seconds = extracting.seconds();
  if (mesh.simplex_count() == 0 && !options.printing.quiet) print_warning(why_empty(field, levels.front()));

  FileGroup files;
  Outcome outcome = finish(mesh, options, field.info, options.output.path, files, filling.memory_limit);
  outcome.read_seconds = read_seconds;
  outcome.extract_seconds = extract_seconds;
  outcome.contents = contents_of(mesh, options, outcome);
  take(files.commit());
  if (options.printing.json)
    print_json(json_of(outcome, options, field.info,
                       {{"range", {levels.front(), levels.back()}}, {"levels", levels}}));
  else
    print(report_of(outcome, options, levels, field.info));
  return 0;
}

} // namespace

Command interval_command(CLI::App& program) {
  auto options = std::make_shared<Interval>();
  CLI::App* app = program.add_subcommand("interval", "the volume between two values of a field, or several");
  options->input.add_to(*app);
  app->add_option("--range", options->range,
                  "the values: A:B; A:B:N for N levels, evenly from A to B; or a list A,B,...")
      ->type_name("A:B[:N]")
      ->required()
      ->group("Volume");
  app->add_option("--level-axis", options->level_axis,
                  "where the axis of levels stands in the order that cuts cells: last, or first, as in the "
                  "example of the paper; last folds less")
      ->type_name("last|first")
      ->capture_default_str()
      ->group("Volume");
  options->surface.add_to(*app);
  options->output.add_to(*app, {});
  app->add_flag("--measure", options->measure,
                "also check and measure the volume: its content, folded simplices")
      ->group("Output");
  options->printing.add_to(*app);
  options->machine.add_to(*app);
  set_manual(
      *app,
      {{"interval INPUT... --range A:B [options]"},
       {"Fills the volume where the field lies between A and B (samples that equal A belong to it, those "
        "that equal B do not; with --inside below the other way round): with tetrahedra in a 3D field, with "
        "triangles in 2D; in a 4D field, through time, with 4-simplices, which 'hyperiso slice' cuts at any "
        "time into the tetrahedra of that moment. With more levels the volumes between them are one mesh, "
        "joined at the isosurface of each level. "
        "Every vertex has point data: level, the number of its level, and isovalue; ParaView's Contour of "
        "isovalue slides through the range.",
        "No program draws 4-simplices: as .vtu they are cells of five unconnected points, x, y, z with the "
        "fourth coordinate as point data t, as 4D surfaces are; ParaView shows them as points.",
        "With --method hull a few simplices may fold over: project with the wrong sign. They are counted as "
        "inverted; on smooth fields there are hardly any. Where simplices are integrated over "
        "and "
        "the sum must be exact, use --method simplicial, which never folds and takes about five times as "
        "many."},
       {{"where there is a tenth to nine tenths of water, at one step of a dam break",
         "hyperiso interval examples/data/alpha_water_24x24x24x41.nrrd --steps 20:21 --range 0.1:0.9 "
         "--measure -o "
         "spray.vtu"},
        {"the same at three steps and all times between them, and one of those",
         "hyperiso interval examples/data/alpha_water_24x24x24x41.nrrd --steps 20:23 --range 0.1:0.9 -o "
         "sprays.vtu"},
        {"", "hyperiso slice sprays.vtu --time 0.51 --measure -o spray_0.51.vtu"}}});
  return {app, [options] { return run(*options); }};
}

} // namespace hyperiso::cli
