#include "hyperiso/track.hpp"
#include "cli/command.hpp"
#include "cli/console.hpp"
#include "cli/failure.hpp"
#include "cli/manual.hpp"
#include "cli/options.hpp"
#include "cli/parse.hpp"
#include "cli/point_data.hpp"
#include "cli/seed.hpp"
#include "cli/surface.hpp"
#include "cli/tracked_folder.hpp"
#include "core/memory.hpp"
#include "core/text.hpp"
#include "hyperiso/slice.hpp"
#include "hyperiso/track_files.hpp"

#include <algorithm>
#include <filesystem>
#include <fmt/format.h>
#include <fstream>
#include <memory>

namespace hyperiso::cli {
namespace {

constexpr int lowest_tracked = 3, highest_tracked = 4;

struct Track {
  FieldOptions input;
  std::vector<std::string> seeds, with;
  std::string select, directory;
  TrackingOptions tracking;
  SurfaceOptions surface;
  PrintOptions printing;
  MachineOptions machine;

  bool is_local() const { return !seeds.empty() || !select.empty(); }
};

// The seed of a track by the table of a former run: the last column of its row.
std::string seed_of_track(const std::string& select) {
  const auto colon = select.rfind(':');
  if (colon == std::string::npos) fail_usage(text("--select: '", select, "' is not FOLDER:ID"));
  const std::string path = select.substr(0, colon) + "/tracks.csv";
  const std::int64_t wanted = parse_integer("--select", select.substr(colon + 1));
  std::ifstream table(path);
  if (!table) throw Failure{{Code::file_not_found, text("--select: ", path, ": there is no such file")}};
  std::string line;
  std::getline(table, line);
  if (!line.ends_with(",seed"))
    fail_usage(
        text("--select: ", path, " is no table of tracks that track -o wrote: its last column is not seed"));
  for (std::int64_t row = 0; std::getline(table, line); ++row) {
    if (row != wanted) continue;
    std::string seed = line.substr(line.rfind(',') + 1);
    if (seed.empty())
      fail_usage(text("--select: ", path, ": track ", wanted, " has no seed, as it is a region"));
    std::ranges::replace(seed, ' ', ',');
    return seed;
  }
  fail_usage(text("--select: ", path, " has no track ", wanted));
}

// Without INPUT, the folder of --select says what the field is and how it was tracked.
TrackedFolder selected_folder(const std::string& select, const CLI::App& verb) {
  const auto colon = select.rfind(':');
  if (colon == std::string::npos)
    fail_usage("INPUT is required, or --select FOLDER:ID; see 'hyperiso track --help'");
  FieldOptions folder;
  folder.paths = {select.substr(0, colon)};
  return open_tracked_folder(folder, verb);
}

TrackedFolder folder_of(const Track& options) {
  TrackedFolder folder{options.directory, options.input, options.surface,
                       options.tracking,  options.seeds, {}};
  if (!options.select.empty()) folder.seeds.push_back(seed_of_track(options.select));
  return folder;
}

SeedCells cells_at(const std::vector<std::string>& seeds, const std::vector<Axis>& axes) {
  SeedCells cells;
  for (const std::string& seed : seeds) cells.push_back(cell_at(seed, axes));
  return cells;
}

// One surface per step, named by its tracks, and a series of them.
void write_surfaces(const Track& options, const TrackingGraph& graph, SelectedSteps& steps,
                    FileGroup& files) {
  const std::filesystem::path directory = options.directory;
  const TrackOptions tracking = options.tracking.track_options(options.surface, options.machine);
  std::vector<SeriesEntry> series;
  ProgressBar bar("write", options.printing.quiet);
  WriteMeshOptions format;
  format.group = &files;
  for (std::int64_t step = 0; step < graph.steps; ++step) {
    bar.show(static_cast<double>(step) / static_cast<double>(graph.steps));
    const Field field = take(steps.read(step, step + 1));
    const Mesh surface = take(tracked_surface(graph, field, step, tracking));
    const bool region = graph.tracked == Tracked::region;
    const std::string name =
        fmt::format("{}_{:04}.{}", region ? "region" : "surface", step, region ? "vtu" : "vtp");
    take(write_mesh(surface, directory / name, format));
    series.push_back({graph.axes.back().coordinate(step), name});
  }
  take(write_series(series, directory / "tracks.pvd", &files));
}

void write_outputs(const Track& options, const TrackedFolder& folder, const TrackingGraph& graph,
                   SelectedSteps& steps) {
  FileGroup files;
  take(write_tracking(graph, options.directory, &files));
  if (!options.is_local()) write_surfaces(options, graph, steps, files);
  finish_folder(folder, steps.info(), files);
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

std::string report_of(const Track& options, const FieldInfo& info, const TrackingGraph& graph,
                      double track_seconds) {
  Report report;
  report.add("field", size_and_type(info));
  if (graph.upper_isovalue)
    report.add("range", fmt::format("{} to {}", graph.isovalue, *graph.upper_isovalue));
  else
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

void check_steps(const FieldInfo& info) {
  if (info.dimension() < lowest_tracked || info.dimension() > highest_tracked)
    fail_usage(text("the field is ", size_and_type(info),
                    ": components are followed on 2 or 3 axes of space and through time, the last axis",
                    info.dimension() > highest_tracked ? "; --crop ,,,0:1 leaves one sample of axis 3" : ""));
  if (info.axes.back().count < 2)
    fail_usage(text("the field is ", size_and_type(info), ": axis ",
                    name_of_axis(info.axes, info.axes.size() - 1),
                    " has one sample, and components are followed from one step to the next; --time-axis "
                    "names the axis that is time, --steps chooses two or more"));
}

int run(Track options, const CLI::App& verb) {
  std::optional<TrackedFolder> earlier;
  if (options.input.paths.empty()) {
    earlier = selected_folder(options.select, verb);
    earlier->choose(options.input, options.tracking, options.surface);
  }
  TrackOptions tracking = options.tracking.track_options(options.surface, options.machine);
  if (options.is_local() && tracking.tracked == Tracked::region)
    fail_usage("--seed and --select follow surfaces; leave out --track region and --range");
  if (options.is_local() && !options.with.empty())
    fail_usage("--with: with --seed or --select no features are measured");
  const TrackedFolder folder = folder_of(options);
  SelectedSteps steps(options.input.open(options.machine), options.input);
  steps.leave_out_flat_axes(lowest_tracked);
  check_steps(steps.info());
  if (earlier) earlier->check_field(steps.info());
  PointDataOptions beside;
  beside.with = options.with;
  const std::vector<NamedSteps> others = beside.open(options.input, options.machine);
  for (const NamedSteps& other : others) other.steps->leave_out_flat_axes();
  for (const NamedSteps& other : others) tracking.with.push_back({other.name, other.steps.get()});
  const Stopwatch watch;
  const TrackingGraph graph = options.tracking.track(steps, tracking, options.printing.quiet,
                                                     cells_at(folder.seeds, steps.info().axes));
  const double track_seconds = watch.seconds();
  if (graph.tracks.empty() && !options.printing.quiet)
    print_warning(text("there is nothing at ", options.tracking.iso, options.tracking.range,
                       "; 'hyperiso info' tells the range of the field"));

  if (!options.directory.empty()) write_outputs(options, folder, graph, steps);
  if (options.printing.json) {
    Json object = Json::parse(tracking_summary_json(graph));
    object["seconds"] = {{"track", track_seconds}};
    object["peak_memory_bytes"] = peak_memory();
    print_json(object);
  } else {
    print(report_of(options, steps.info(), graph, track_seconds));
  }
  return 0;
}

} // namespace

Command track_command(CLI::App& program) {
  auto options = std::make_shared<Track>();
  CLI::App* app = program.add_subcommand("track", "what happens to each component through time, and when");
  options->input.add_to(*app);
  app->get_option("INPUT")->required(false); // --select may name it
  options->tracking.add_to(*app);
  options->surface.add_to(*app);
  app->remove_option(app->get_option("--cut")); // of a method that is not tracked with
  app->get_option("--method")
      ->description(
          "how a cell is filled: hull (default: fewest simplices), component (the same, but an ambiguous "
          "cell keeps the outside together; surfaces only) or simplicial (cuts of the Kuhn simplices)");
  app->add_option(
         "--seed", options->seeds,
         "follow only the component through the grid cell around this point, and its relatives; repeatable")
      ->type_name("X,Y,...,T")
      ->group("Tracks");
  app->add_option(
         "--select", options->select,
         "follow only track ID, and its relatives, of an earlier run that wrote FOLDER; without INPUT in the "
         "same field, with the same options")
      ->type_name("FOLDER:ID")
      ->group("Tracks");
  app->add_option(
         "--with", options->with,
         "further fields of the same grid, added up over each component: files, or variables of INPUT; "
         "they are called as the file or the variable is, or NAME")
      ->type_name("[NAME=]FIELD[,...]")
      ->delimiter(',')
      ->allow_extra_args(false)
      ->group("Tracks");
  app->add_option("-o,--output", options->directory,
                  "the folder for all files; made if it does not exist. Those of an earlier run in it are "
                  "replaced, other files beside them stay; a folder that holds only others is refused")
      ->type_name("FOLDER")
      ->group("Output");
  options->printing.add_to(*app);
  options->machine.add_to(*app);
  set_manual(
      *app,
      {{"track INPUT... --iso V [--track region] [-o FOLDER] [options]",
        "track INPUT... --range A:B [-o FOLDER] [options]", "track --select FOLDER:ID [-o FOLDER] [options]"},
       {"Follows every connected component of the isosurface of a field on 2 or 3 axes of space through "
        "time, "
        "the last axis. Events have the exact times of the surface in space and time, also between the "
        "steps: "
        "birth, death, merge, split, compound (any other change of number at one instant), genus (a handle "
        "or "
        "hole more or less), touch (a wall of the domain begins or ends to cut it), enter and exit (through "
        "a "
        "wall). What is there at the first or last step is open_start or open_end. Only two steps are held.",
        "With --track region or --range what is followed is the inside, or the volume between two surfaces: "
        "where two surfaces bound one shell there is one component, and it is that which merges and splits. "
        "genus is then any change of its Euler characteristic.",
        "With -o: tables (tracks.csv, features.csv, events.csv), events.json, the graph as GraphML, GEXF, "
        "DOT, JSON and VTU, pictures (graph.svg, volume.svg), tracks.pvd with the surface or region of each "
        "step named by its tracks, and files for napari. Coordinates are those of the field's axes. "
        "source.json says what was tracked and how: view and animate take the folder for an input."},
       {{"what happens to the water of a dam break",
         "hyperiso track examples/data/alpha_water_24x24x24x41.nrrd --iso 0.5 -o water"},
        {"the same, without drops", "hyperiso track examples/data/alpha_water_24x24x24x41.nrrd --iso 0.5 "
                                    "--min-volume 0.001 --min-duration 0.1 -o water"},
        {"tracks and events for a script",
         "hyperiso track examples/data/alpha_water_24x24x24x41.nrrd --iso 0.5 --json > water.json"}}});
  return {app, [options, app] { return run(*options, *app); }};
}

} // namespace hyperiso::cli
