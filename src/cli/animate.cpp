#include "cli/command.hpp"
#include "cli/console.hpp"
#include "cli/failure.hpp"
#include "cli/frames.hpp"
#include "cli/manual.hpp"
#include "cli/movie.hpp"
#include "cli/parse.hpp"
#include "core/memory.hpp"
#include "core/text.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>

namespace hyperiso::cli {
namespace {

struct Animate {
  FieldOptions input;
  std::optional<TrackedFolder> folder; // where that is the input
  TrackingOptions tracking;            // --iso, and the others as `folder` says
  std::string frames, times;
  bool events = false, tracks = false;
  SurfaceOptions surface;
  PointDataOptions data;
  MovieOptions movie;
  PrintOptions printing;
  MachineOptions machine;
};

struct Outcome {
  std::optional<double> isovalue;
  std::size_t frames = 0, events = 0;
  std::uint64_t vertices = 0, simplices = 0; // of all frames
  std::pair<double, double> times;
  double read_seconds = 0, slice_seconds = 0, write_seconds = 0;
};

// N moments from the first to the last, both included; those that fall on samples of an even axis are these,
// to the bit.
std::vector<double> spread(std::int64_t count, const std::pair<double, double>& ends, const Axis& axis) {
  std::vector<double> times;
  for (std::int64_t i = 0; i < count; ++i) {
    const std::int64_t gaps = std::max<std::int64_t>(count - 1, 1);
    const bool even = axis.count > 1 && axis.coordinates.empty() && std::isfinite(axis.coordinate(0));
    if (even && i * (axis.count - 1) % gaps == 0) {
      const std::int64_t sample = i * (axis.count - 1) / gaps;
      times.push_back(axis.coordinate(axis.increasing() ? sample : axis.count - 1 - sample));
    } else {
      times.push_back(std::lerp(ends.first, ends.second, static_cast<double>(i) / static_cast<double>(gaps)));
    }
  }
  return times;
}

// The stored steps, forward in time.
std::vector<double> steps_of(const Axis& axis) {
  if (axis.count == 0 || !std::isfinite(axis.coordinate(0)))
    fail_usage(
        "the surface does not know the steps of its field: say which moments to show, by --frames N or "
        "--times T[,T...]");
  std::vector<double> times;
  for (std::int64_t step = 0; step < axis.count; ++step) times.push_back(axis.coordinate(step));
  if (!axis.increasing()) std::ranges::reverse(times);
  return times;
}

std::vector<double> moments(const Animate& options, const Frames& frames) {
  if (!options.times.empty()) {
    std::vector<double> times = parse_series("--times", options.times);
    for (std::size_t i = 0; i < times.size(); ++i) {
      frames.check(times[i]);
      if (i > 0 && !(times[i - 1] < times[i]))
        fail_usage(text("--times: ", times[i], " follows ", times[i - 1], "; frames go forward in time"));
    }
    return times;
  }
  if (options.frames.empty()) return steps_of(frames.axes().back());
  const std::int64_t count = parse_integer("--frames", options.frames);
  constexpr std::int64_t most = 1'000'000;
  if (count < 1 || count > most) fail_usage(text("--frames: ", count, " is not from 1 to ", most));
  const auto ends = frames.times();
  if (!(ends.first <= ends.second)) fail_usage("the surface is empty: there is no time to show it at");
  return spread(count, ends, frames.axes().back());
}

// The moments of events, each once, among the others. Gives how many there are.
std::size_t add_events(Frames& frames, std::vector<double>& times) {
  std::vector<double> events;
  for (const double time : frames.events())
    if (times.front() <= time && time <= times.back()) events.push_back(time);
  std::ranges::sort(events);
  events.erase(std::unique(events.begin(), events.end()), events.end());
  times.insert(times.end(), events.begin(), events.end());
  std::ranges::sort(times);
  times.erase(std::unique(times.begin(), times.end()), times.end());
  return events.size();
}

std::unique_ptr<Frames> frames_for(const Animate& options, Outcome& outcome) {
  const bool from_mesh = options.input.paths.size() == 1 && is_mesh_file(options.input.paths[0]);
  if (from_mesh) {
    if (!options.tracking.iso.empty())
      fail_usage("--iso: the input is a mesh; its isovalue is chosen already");
    if (options.data.from_field())
      fail_usage("--with, --normals: the input is a mesh; give them when it is extracted");
    if (options.tracks) fail_usage("--tracks: the input is a mesh; tracking needs the field");
    return frames_of_mesh(options.input.paths[0], options.surface, options.machine, options.printing);
  }
  if (options.tracking.iso.empty()) fail_usage("--iso is required to animate a field");
  const std::vector<double> isovalues = parse_isovalues(options.tracking.iso);
  if (isovalues.size() != 1) fail_usage("--iso: an animation shows one isovalue");
  outcome.isovalue = isovalues[0];
  // Surfaces of barycentric do not know where their vertices came from.
  const bool can = options.surface.method != "barycentric";
  const bool normals = options.data.normals || (can && options.movie.is_shaded());
  if (!options.tracks)
    return frames_of_field(options.input, isovalues[0], options.surface, options.data, normals,
                           options.machine, options.printing);
  return frames_with_tracks(options.input, options.tracking, options.folder ? &*options.folder : nullptr,
                            options.surface, options.data, normals, options.machine, options.printing);
}

Outcome animate(const Animate& options) {
  Outcome outcome;
  options.movie.check();
  if (options.tracks && !options.data.colour_by.empty())
    fail_usage(options.folder
                   ? "--colour-by: the input is a folder of tracks, which choose the colours; leave it out"
                   : "--tracks and --colour-by both choose the colours: give one of them");
  const auto frames = frames_for(options, outcome);
  const auto dimension = static_cast<int>(frames->axes().size()) - 1;
  options.movie.check_frames(dimension);
  std::vector<double> times = moments(options, *frames);
  if (options.events) outcome.events = add_events(*frames, times);
  outcome.frames = times.size();
  outcome.times = {times.front(), times.back()};

  Series series;
  series.axes = frames->axes();
  series.times = times;
  series.isovalue = outcome.isovalue;
  series.threads = options.machine.thread_count();
  const auto timed = [&](const auto& slice) {
    const Stopwatch slicing;
    auto result = slice();
    outcome.slice_seconds += slicing.seconds();
    return result;
  };
  if (options.movie.needs_survey()) {
    ProgressBar bar("look", options.printing.quiet);
    for (std::size_t i = 0; i < times.size(); ++i) {
      bar.show(static_cast<double>(i) / static_cast<double>(times.size()));
      series.look_at(timed([&] { return frames->at(times[i]); }), options.movie);
    }
  }
  const auto movie = options.movie.open(series);
  ProgressBar bar("animate", options.printing.quiet);
  for (std::size_t i = 0; i < times.size(); ++i) {
    bar.show(static_cast<double>(i) / static_cast<double>(times.size()));
    Mesh mesh(dimension, dimension - 1);
    std::optional<Mesh> end;
    if (options.movie.morphs && i + 1 < times.size()) {
      auto moving = timed([&] { return frames->moving(times[i], times[i + 1]); });
      mesh = std::move(moving.start);
      end = std::move(moving.end);
    } else {
      mesh = timed([&] { return frames->at(times[i]); });
    }
    outcome.vertices += mesh.vertex_count();
    outcome.simplices += mesh.simplex_count();
    const Stopwatch writing;
    movie->add(std::move(mesh), std::move(end), i);
    outcome.write_seconds += writing.seconds();
  }
  const Stopwatch writing;
  movie->finish();
  outcome.write_seconds += writing.seconds();
  outcome.read_seconds = frames->read_seconds();
  if (outcome.simplices == 0 && !options.printing.quiet)
    print_warning("no surface in any frame; 'hyperiso info' tells the range of the values");
  return outcome;
}

int run(Animate options, const CLI::App& verb) {
  if (!options.frames.empty() && !options.times.empty())
    fail_usage("--frames and --times both say which moments to show: give one of them");
  if (names_folder(options.input)) {
    options.folder = open_tracked_folder(options.input, verb);
    options.folder->choose(options.input, options.tracking, options.surface);
    options.tracks = true;
  }
  const Outcome outcome = animate(options);
  if (options.printing.json) {
    Json object{{"frames", outcome.frames}};
    if (options.events) object["events"] = outcome.events;
    if (outcome.isovalue) object["isovalue"] = *outcome.isovalue;
    object["times"] = {outcome.times.first, outcome.times.second};
    object["vertices"] = outcome.vertices;
    object["simplices"] = outcome.simplices;
    object["seconds"] = {
        {"read", outcome.read_seconds}, {"slice", outcome.slice_seconds}, {"write", outcome.write_seconds}};
    object["peak_memory_bytes"] = peak_memory();
    print_json(object);
    return 0;
  }
  Report report;
  std::string count = grouped(outcome.frames);
  if (options.events) count += fmt::format(", with the moments of {} events", grouped(outcome.events));
  report.add("frames", count);
  report.add("times", fmt::format("{:.12g} to {:.12g}", outcome.times.first, outcome.times.second));
  report.add("simplices", grouped(outcome.simplices) + " in all frames");
  report.add("took", seconds(outcome.slice_seconds) + " to slice, " + seconds(outcome.write_seconds) +
                         (options.movie.is_drawn() ? " to draw and write" : " to write"));
  report.add("wrote", options.movie.path);
  print(report.text());
  return 0;
}

} // namespace

Command animate_command(CLI::App& program) {
  auto options = std::make_shared<Animate>();
  CLI::App* app = program.add_subcommand("animate", "the surface at many times: films, glTF, numbered files");
  options->input.add_to(
      *app, "; or a mesh that 'hyperiso extract' wrote as .vtu; or a folder that 'hyperiso track' "
            "wrote, and after it the field, if that is no longer where it was");
  app->add_option("--frames", options->frames,
                  "how many moments, evenly from the first to the last; left out: the stored steps")
      ->type_name("N")
      ->group("Moments");
  app->add_option(
         "--times", options->times,
         "or these moments, in the coordinates of the last axis (times, not step numbers), in order: "
         "FROM:TO:STEP, a list, or both")
      ->type_name("T[,T...]")
      ->group("Moments");
  app->add_flag("--events", options->events,
                "also a frame at every moment at which a component is born, dies, merges, splits or changes "
                "otherwise, exactly")
      ->group("Moments");
  app->add_flag(
         "--tracks", options->tracks,
         "follow the components: a colour for each in films and pictures, a node for each in .glb, cell "
         "data track_id in .pvd; always so where INPUT is a folder of tracks. Between two steps a piece goes "
         "by its track at the first of them. The whole surface is held in memory")
      ->group("Surface");
  app->add_option("--iso", options->tracking.iso, "fields: the isovalue")->type_name("V")->group("Surface");
  options->surface.add_to(*app);
  options->data.add_to(*app, "films, pictures, .glb, .ply, by an axis of space too", "of all frames");
  options->movie.add_to(*app, options->data);
  options->printing.add_to(*app);
  options->machine.add_to(*app);
  set_manual(
      *app,
      {{"animate INPUT... --iso V -o PATH [options]", "animate MESH -o PATH [options]",
        "animate FOLDER -o PATH [options]"},
       {"Shows a 4D surface as it changes: cut at many times, between the stored steps as well as on them, "
        "so "
        "that it moves smoothly and what merges or parts does so in its place. Surfaces of 3D fields give "
        "curves in the plane.",
        "  .mp4 .gif     a film, drawn without a screen; encoded by ffmpeg\n"
        "  .glb          glTF 2.0: a node for each frame, one of them shown at a time.\n"
        "                glTF's y points up: (x, y, z) becomes (x, z, -y). Numbers stay\n"
        "                as they are, whatever their unit\n"
        "  .pvd          a .vtp for each frame, and their times: ParaView plays it\n"
        "  f_%04d.ply    a file for each frame, numbered from 0: .ply, .vtp, .vtu, .stl,\n"
        "                .obj, .off, or .png for pictures",
        "From a field two steps are in memory at a time and every one is read once, or twice for films and "
        "colours, whose range is looked up before."},
       {{"a film",
         "hyperiso animate examples/data/alpha_water_24x24x24x41.nrrd --iso 0.5 --frames 41 -o water.mp4"},
        {"for a web page or a presentation, with frames where drops part and merge",
         "hyperiso animate examples/data/alpha_water_24x24x24x41.nrrd --iso 0.5 --frames 41 --events -o "
         "water.glb"},
        {"the same, moving evenly between its frames",
         "hyperiso animate examples/data/alpha_water_24x24x24x41.nrrd --iso 0.5 --frames 121 --morph -o "
         "water.glb"},
        {"a node and a colour for each track of a folder that track wrote",
         "hyperiso track examples/data/alpha_water_24x24x24x41.nrrd --iso 0.5 --steps 16: -o water && "
         "hyperiso animate water -o tracks.glb"},
        {"for ParaView",
         "hyperiso animate examples/data/alpha_water_24x24x24x41.nrrd --iso 0.5 --times 0:0.5:0.05 -o "
         "water.pvd"}}});
  return {app, [options, app] { return run(*options, *app); }};
}

} // namespace hyperiso::cli
