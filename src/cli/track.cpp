#include "hyperiso/track.hpp"
#include "cli/command.hpp"
#include "cli/console.hpp"
#include "cli/failure.hpp"
#include "cli/manual.hpp"
#include "cli/options.hpp"
#include "cli/parse.hpp"
#include "cli/seed.hpp"
#include "cli/surface.hpp"
#include "core/memory.hpp"
#include "core/text.hpp"
#include "hyperiso/slice.hpp"
#include "hyperiso/track_files.hpp"

#include <algorithm>
#include <filesystem>
#include <fmt/format.h>
#include <memory>

namespace hyperiso::cli {
namespace {

struct Track {
  FieldOptions input;
  std::vector<std::string> seeds;
  std::string iso, overlap, minimum_volume, minimum_duration, directory;
  SurfaceOptions surface;
  PrintOptions printing;
  MachineOptions machine;
};

// The steps of a file that were selected.
class SelectedSteps final : public StepSource {
 public:
  SelectedSteps(FieldReader& reader, Selection selection)
      : reader_(reader), selection_(std::move(selection)), info_(selected(reader.info(), selection_)) {}
  const FieldInfo& info() const override { return info_; }
  Result<Field> read(std::int64_t begin, std::int64_t end) override {
    Selection wanted = selection_;
    const std::int64_t first = selection_.ranges.back().first;
    wanted.ranges.back() = {first + begin, first + end};
    try {
      return read_selection(reader_, wanted);
    } catch (const Failure& failure) {
      return failure.error;
    }
  }

 private:
  FieldReader& reader_;
  Selection selection_;
  FieldInfo info_;
};

// "0.35" or "35%"
double parse_share(std::string_view option, std::string value) {
  const bool percent = !value.empty() && value.back() == '%';
  if (percent) value.pop_back();
  const double share = parse_number(option, value) / (percent ? 100 : 1);
  if (share < 0 || share >= 1)
    fail_usage(text(option, ": ", share, " is not a share; give one from 0 to 1, or from 0% to 100%"));
  return share;
}

TrackOptions track_options(const Track& options) {
  TrackOptions result;
  result.extraction = options.surface.extract_options(options.machine);
  if (!options.overlap.empty()) result.overlap_threshold = parse_share("--overlap", options.overlap);
  return result;
}

double not_negative(const char* option, const std::string& value) {
  if (value.empty()) return 0;
  const double number = parse_number(option, value);
  if (number < 0) fail_usage(text(option, ": ", number, " is negative"));
  return number;
}

TrackingGraph make_graph(const Track& options, StepSource& steps, double isovalue, TrackOptions tracking) {
  ProgressBar bar("track", options.printing.quiet);
  tracking.extraction.progress = bar.callback();
  if (options.seeds.empty()) return take(track(steps, isovalue, tracking));
  std::vector<std::vector<std::int64_t>> cells;
  for (const std::string& seed : options.seeds) cells.push_back(cell_at(seed, steps.info().axes));
  return take(track_from_seeds(steps, isovalue, cells, tracking)).graph;
}

// One surface per step, named by its tracks, and a series of them.
void write_surfaces(const Track& options, const TrackingGraph& graph, SelectedSteps& steps,
                    FileGroup& files) {
  const std::filesystem::path directory = options.directory;
  std::vector<SeriesEntry> series;
  ProgressBar bar("write", options.printing.quiet);
  WriteMeshOptions format;
  format.group = &files;
  for (std::int64_t step = 0; step < graph.steps; ++step) {
    bar.show(static_cast<double>(step) / static_cast<double>(graph.steps));
    const Field field = take(steps.read(step, step + 1));
    const Mesh surface = take(tracked_surface(graph, field, step, track_options(options)));
    const std::string name = fmt::format("surface_{:04}.vtp", step);
    take(write_mesh(surface, directory / name, format));
    series.push_back({graph.axes.back().coordinate(step), name});
  }
  take(write_series(series, directory / "tracks.pvd", &files));
}

void write_outputs(const Track& options, const TrackingGraph& graph, SelectedSteps& steps) {
  FileGroup files;
  take(write_tracking(graph, options.directory, &files));
  if (options.seeds.empty()) write_surfaces(options, graph, steps, files);
  take(files.commit());
}

std::string counts_of(const TrackingGraph& graph) {
  std::string list;
  for (int type = 0; type <= static_cast<int>(EventType::open_end); ++type) {
    const auto count = std::ranges::count(graph.events, static_cast<EventType>(type), &TrackingEvent::type);
    if (count > 0)
      list += fmt::format("{}{} {}", list.empty() ? "" : ", ", count, name_of(static_cast<EventType>(type)));
  }
  return list.empty() ? "none" : list;
}

std::string report_of(const Track& options, const TrackingGraph& graph, double track_seconds) {
  Report report;
  report.add("isovalue", fmt::format("{}", graph.isovalue));
  report.add("steps", grouped(static_cast<std::uint64_t>(graph.steps)));
  report.add("tracks", grouped(graph.tracks.size()));
  const auto simplified = std::ranges::count(graph.tracks, true, &hyperiso::Track::simplified);
  if (simplified > 0) report.add("simplified", grouped(static_cast<std::uint64_t>(simplified)));
  report.add("events", counts_of(graph));
  const auto weak = std::ranges::count(graph.links, true, &FeatureLink::weak);
  if (weak > 0) report.add("weak links", grouped(static_cast<std::uint64_t>(weak)));
  report.add("took", seconds(track_seconds));
  if (!options.directory.empty()) report.add("wrote", options.directory);
  return report.text();
}

int run(const Track& options) {
  if (options.iso.empty()) fail_usage("--iso is required");
  const std::vector<double> isovalues = parse_isovalues(options.iso);
  if (isovalues.size() > 1) fail_usage("--iso: one isovalue is tracked at a time");
  const TrackOptions tracking = track_options(options);
  const double minimum_volume = not_negative("--min-volume", options.minimum_volume);
  const double minimum_duration = not_negative("--min-duration", options.minimum_duration);

  const auto reader = options.input.open(options.machine);
  SelectedSteps steps(*reader, options.input.selection(reader->info()));
  const Stopwatch watch;
  TrackingGraph graph = make_graph(options, steps, isovalues[0], tracking);
  const double track_seconds = watch.seconds();
  simplify(graph, minimum_volume, minimum_duration);
  if (graph.tracks.empty() && !options.printing.quiet)
    print_warning(
        text("there is no surface at ", isovalues[0], "; 'hyperiso info' tells the range of the field"));

  if (!options.directory.empty()) write_outputs(options, graph, steps);
  if (options.printing.json) {
    Json object = Json::parse(tracking_summary_json(graph));
    object["seconds"] = {{"track", track_seconds}};
    object["peak_memory_bytes"] = peak_memory();
    print_json(object);
  } else {
    print(report_of(options, graph, track_seconds));
  }
  return 0;
}

} // namespace

Command track_command(CLI::App& program) {
  auto options = std::make_shared<Track>();
  CLI::App* app = program.add_subcommand("track", "what happens to each component through time, and when");
  options->input.add_to(*app);
  app->add_option("--iso", options->iso, "the isovalue")->type_name("V")->group("Surface");
  options->surface.add_to(*app);
  app->add_option(
         "--seed", options->seeds,
         "follow only the component through the grid cell around this point, and its relatives; repeatable")
      ->type_name("X,Y,...,T")
      ->group("Tracks");
  app->add_option(
         "--overlap", options->overlap,
         "cut tracks where a component and what it is one step later overlap by no more than this share "
         "of the smaller one; 35% is usual")
      ->type_name("SHARE")
      ->group("Tracks");
  app->add_option("--min-volume", options->minimum_volume,
                  "mark tracks that never reach this volume as simplified")
      ->type_name("V")
      ->group("Tracks");
  app->add_option("--min-duration", options->minimum_duration,
                  "mark tracks that last less as simplified, if they are born, die, or come back to where "
                  "they split off")
      ->type_name("T")
      ->group("Tracks");
  app->add_option("-o,--output", options->directory, "the folder for all files; made if it does not exist")
      ->type_name("FOLDER")
      ->group("Output");
  options->printing.add_to(*app);
  options->machine.add_to(*app);
  set_manual(
      *app,
      {{"track INPUT... --iso V [-o FOLDER] [options]"},
       {"Follows every connected component of the isosurface of a field on 2 or 3 axes of space through "
        "time, "
        "the last axis. Events have the exact times of the surface in space and time, also between the "
        "steps: "
        "birth, death, merge, split, compound (any other change of number at one instant), genus (a handle "
        "or "
        "hole more or less), touch (a wall of the domain begins or ends to cut it), enter and exit (through "
        "a "
        "wall). What is there at the first or last step is open_start or open_end. Only two steps are held.",
        "With -o: tables (tracks.csv, features.csv, events.csv), events.json, the graph as GraphML, GEXF, "
        "DOT, "
        "JSON and VTU, pictures (graph.svg, volume.svg), tracks.pvd with the surface of each step named by "
        "its "
        "tracks, and files for napari. Coordinates are those of the field's axes."},
       {{"what happens to the water of a dam break",
         "hyperiso track examples/data/alpha_water_24x24x24x41.nrrd --iso 0.5 -o water"},
        {"the same, without drops", "hyperiso track examples/data/alpha_water_24x24x24x41.nrrd --iso 0.5 "
                                    "--min-volume 0.001 --min-duration 0.1 -o water"},
        {"tracks and events for a script",
         "hyperiso track examples/data/alpha_water_24x24x24x41.nrrd --iso 0.5 --json > water.json"}}});
  return {app, [options] { return run(*options); }};
}

} // namespace hyperiso::cli
