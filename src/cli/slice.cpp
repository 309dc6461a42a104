#include "hyperiso/slice.hpp"
#include "cli/command.hpp"
#include "cli/console.hpp"
#include "cli/dispatch.hpp"
#include "cli/manual.hpp"
#include "cli/options.hpp"
#include "cli/parse.hpp"
#include "cli/planes.hpp"
#include "cli/point_data.hpp"
#include "cli/surface.hpp"
#include "core/memory.hpp"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <memory>
#include <set>

namespace hyperiso::cli {
namespace {

constexpr int lowest_sliced = 3;
constexpr std::size_t worth_an_index = 4; // cuts: about what an index costs

struct Slice {
  FieldOptions input;
  std::string iso, range;
  PlaneOptions where;
  SurfaceOptions surface;
  PointDataOptions data;
  MeshOutputOptions output;
  bool measure = false;
  PrintOptions printing;
  MachineOptions machine;
};

// What is told about one cut.
struct Outcome {
  const Plane* plane = nullptr;
  std::optional<double> isovalue; // of a field
  std::string path;
  PlaneCoordinates coordinates;
  std::uint64_t vertices = 0, simplices = 0;
  std::optional<Measure> measure;
  double read_seconds = 0, slice_seconds = 0, write_seconds = 0;
};

// What all cuts share.
struct Plan {
  std::vector<Plane> planes;
  std::vector<double> isovalues; // empty for a mesh and for a volume
  std::vector<double> levels;    // of a volume
  std::vector<Axis> axes;        // of the space of the output: of the field, of the mesh, or of the world
  int simplex_dimension = 0;     // of the cut
  bool has_time = true;          // the last axis, as far as the input tells

  int dimension() const { return static_cast<int>(axes.size()) - 1; } // of the cut's space
};

// A .pvd names numbered files that are written beside it.
bool is_series(const std::string& path) { return std::filesystem::path(path).extension() == ".pvd"; }

// The path that the numbers of the frames of a series go into.
std::string path_of_frames(const Slice& options) {
  const std::string suffix = options.output.format.empty() ? "vtp" : options.output.format;
  return std::filesystem::path(options.output.path).replace_extension(suffix).string();
}

// The file of a cut: PATH with its number, if PATH has a place for it or names a series; else PATH itself if
// there is one cut, else PATH with the isovalue, if there are several, and the place.
std::string path_of(const Slice& options, const Plan& plan, const Outcome& outcome, std::size_t number) {
  const std::string& path = options.output.path;
  if (path.empty()) return path;
  if (is_series(path)) return with_suffix(path_of_frames(options), fmt::format("{:04}", number));
  if (has_number_pattern(path)) return with_number("-o", path, number);
  std::string result = path;
  if (plan.isovalues.size() > 1) result = with_suffix(result, "iso" + shortest(*outcome.isovalue));
  if (plan.planes.size() == 1) return result;
  const Plane& plane = *outcome.plane;
  return with_suffix(result,
                     plane.axis < 0 ? fmt::format("plane{:04}", number) : plane.name + shortest(plane.value));
}

// The cuts to make, with their paths. Fails if they cannot be written.
std::vector<Outcome> outcomes_of(const Slice& options, const Plan& plan) {
  std::vector<Outcome> outcomes;
  std::set<std::string> paths;
  for (const Plane& plane : plan.planes) {
    for (std::size_t surface = 0; surface < std::max<std::size_t>(plan.isovalues.size(), 1); ++surface) {
      Outcome& outcome = outcomes.emplace_back();
      outcome.plane = &plane;
      if (!plan.isovalues.empty()) outcome.isovalue = plan.isovalues[surface];
      outcome.path = path_of(options, plan, outcome, outcomes.size() - 1);
      if (!outcome.path.empty() && !paths.insert(outcome.path).second)
        fail_usage(text("-o: two cuts would be written to ", outcome.path));
    }
    if (is_series(options.output.path) && plane.name != plan.planes[0].name)
      fail_usage(
          text("-o: a .pvd series goes along one axis, not ", plan.planes[0].name, " and ", plane.name));
  }
  if (is_series(options.output.path) && plan.isovalues.size() > 1)
    fail_usage("-o: a .pvd series holds one isovalue; give one, or another suffix");
  const std::string& written = outcomes[0].path;
  if (!written.empty()) options.output.check(plan.dimension(), plan.simplex_dimension, written);
  options.data.check(options.output, written);
  return outcomes;
}

std::vector<Plane> planes_in(const Slice& options, const std::vector<Axis>& axes) {
  std::vector<Plane> planes = options.where.parse(axes);
  if (planes.empty()) fail_usage("say where to cut: --time T, --axis NAME=VALUE or --plane N,...,C");
  return planes;
}

// Makes the cuts one after the other: make(outcome, progress) gives the mesh, in the coordinates of the
// plane.
template <int D, class Make>
void make_cuts(const Slice& options, const Plan& plan, std::vector<Outcome>& outcomes, const Make& make) {
  const SliceFrame frame = options.where.slice_frame();
  std::vector<SeriesEntry> series;
  FileGroup files;
  ProgressBar bar("slice", options.printing.quiet);
  for (std::size_t number = 0; number < outcomes.size(); ++number) {
    Outcome& outcome = outcomes[number];
    const Hyperplane<D> plane = outcome.plane->template hyperplane<D>();
    const auto progress = [&](double share) {
      bar.show((static_cast<double>(number) + share) / static_cast<double>(outcomes.size()));
      return true;
    };
    const Stopwatch slicing;
    Mesh mesh = make(outcome, progress);
    if (outcome.plane->axis < 0)
      mesh.attributes.push_back(axis_on_slice(mesh, plane, frame, D - 1, name_of_axis(plan.axes, D - 1)));
    options.data.colour(mesh);
    outcome.slice_seconds = slicing.seconds() - outcome.read_seconds;
    outcome.coordinates = plane_coordinates(plane, frame);
    outcome.vertices = mesh.vertex_count();
    outcome.simplices = mesh.simplex_count();
    if (outcome.simplices == 0 && !options.printing.quiet)
      print_warning(
          "the plane meets no part of the surface; 'hyperiso info' tells the ranges of axes and values");
    if (options.measure) outcome.measure = take(measure(mesh, options.machine.thread_count()));
    if (outcome.path.empty()) continue;
    const Stopwatch writing;
    take(write_mesh(mesh, outcome.path, options.output.write_options({}, files)));
    outcome.write_seconds = writing.seconds();
    series.push_back({outcome.plane->value, std::filesystem::path(outcome.path).filename()});
  }
  if (is_series(options.output.path)) take(write_series(series, options.output.path, &files));
  take(files.commit());
}

Json json_of(const Outcome& outcome, const Plan& plan) {
  Json object{{"dimension", plan.dimension()}};
  if (outcome.isovalue) object["isovalue"] = *outcome.isovalue;
  if (!plan.levels.empty()) {
    object["range"] = {plan.levels.front(), plan.levels.back()};
    object["levels"] = plan.levels;
  }
  object["hyperplane"] = {{"normal", outcome.plane->normal}, {"offset", outcome.plane->offset}};
  object["frame"] = {{"directions", outcome.coordinates.directions}, {"origin", outcome.coordinates.foot}};
  object["vertices"] = outcome.vertices;
  object["simplices"] = outcome.simplices;
  object["seconds"] = {
      {"read", outcome.read_seconds}, {"slice", outcome.slice_seconds}, {"write", outcome.write_seconds}};
  object["peak_memory_bytes"] = peak_memory();
  if (outcome.measure) object["measure"] = cli::json_of(*outcome.measure);
  if (!outcome.path.empty()) object["file"] = outcome.path;
  return object;
}

// "t = 0.5" or "1 x + 2 t = 0.5"
std::string equation(const Plane& plane, const std::vector<Axis>& axes) {
  if (plane.axis >= 0) return fmt::format("{} = {}", plane.name, plane.value);
  std::string sum;
  for (std::size_t axis = 0; axis < axes.size(); ++axis) {
    const double factor = plane.normal[axis];
    if (factor == 0) continue;
    sum += sum.empty() ? (factor < 0 ? "-" : "") : factor < 0 ? " - " : " + ";
    if (std::abs(factor) != 1) sum += shortest(std::abs(factor)) + " ";
    sum += name_of_axis(axes, axis);
  }
  return sum + " = " + shortest(plane.offset);
}

std::string report_of(const Outcome& outcome, const Plan& plan) {
  Report report;
  report.add("plane", equation(*outcome.plane, plan.axes));
  if (outcome.isovalue) report.add("isovalue", fmt::format("{}", *outcome.isovalue));
  if (!plan.levels.empty()) report.add("levels", fmt::format("{:.12g}", fmt::join(plan.levels, ", ")));
  report.add("vertices", grouped(outcome.vertices));
  report.add(simplex_noun(plan.simplex_dimension), grouped(outcome.simplices));
  if (outcome.measure) add_measure(report, *outcome.measure, plan.simplex_dimension);
  std::string took =
      seconds(outcome.read_seconds) + " to read, " + seconds(outcome.slice_seconds) + " to slice";
  if (!outcome.path.empty()) took += ", " + seconds(outcome.write_seconds) + " to write";
  report.add("took", took);
  if (!outcome.path.empty()) report.add("wrote", outcome.path);
  return report.text();
}

// Many cuts: a line each.
std::string table_of(const std::vector<Outcome>& outcomes, const Plan& plan) {
  const bool isovalues = plan.isovalues.size() > 1;
  const bool along_one_axis = std::ranges::all_of(
      plan.planes, [&](const Plane& plane) { return plane.axis >= 0 && plane.axis == plan.planes[0].axis; });
  const auto place_of = [&](const Outcome& outcome) {
    return along_one_axis ? fmt::format("{}", outcome.plane->value) : equation(*outcome.plane, plan.axes);
  };
  std::size_t width = 12;
  for (const Outcome& outcome : outcomes) width = std::max(width, place_of(outcome).size());
  std::string lines = fmt::format("{:>{}}", along_one_axis ? plan.planes[0].name : "plane", width);
  if (isovalues) lines += fmt::format("  {:>12}", "isovalue");
  lines += fmt::format("  {:>10}  {:>10}", "vertices", simplex_noun(plan.simplex_dimension));
  if (outcomes[0].measure)
    lines +=
        fmt::format("  {:>10}  {:>6}  {:>12}", "components", "Euler", content_noun(plan.simplex_dimension));
  lines += '\n';
  for (const Outcome& outcome : outcomes) {
    lines += fmt::format("{:>{}}", place_of(outcome), width);
    if (isovalues) lines += fmt::format("  {:>12}", *outcome.isovalue);
    lines += fmt::format("  {:>10}  {:>10}", grouped(outcome.vertices), grouped(outcome.simplices));
    if (const auto& measure = outcome.measure)
      lines += fmt::format("  {:>10}  {:>6}  {:>12.6g}", measure->components, measure->euler_characteristic,
                           measure->content);
    lines += '\n';
  }
  return lines;
}

void print_outcomes(const std::vector<Outcome>& outcomes, const Slice& options, const Plan& plan) {
  if (options.printing.json && outcomes.size() == 1) return print_json(json_of(outcomes[0], plan));
  if (options.printing.json) {
    Json slices = Json::array();
    for (const Outcome& outcome : outcomes) slices.push_back(json_of(outcome, plan));
    return print_json(Json{{"slices", slices}});
  }
  if (outcomes.size() == 1 && !is_series(options.output.path)) return print(report_of(outcomes[0], plan));
  std::string table = table_of(outcomes, plan);
  if (is_series(options.output.path))
    table += text("wrote ", options.output.path, " and a file for each line\n");
  else if (options.output.wanted())
    table += text("wrote ", outcomes.front().path, " to ", outcomes.back().path, "\n");
  print(table);
}

// Each plane as one of the axes. Fails where one across an axis misses it, or where the field has no surface.
std::vector<MappedPlane> mapped_planes(const Slice& options, const Plan& plan, const FieldInfo& info) {
  std::vector<MappedPlane> mapped;
  for (const Plane& plane : plan.planes) {
    mapped.push_back(in_axis_coordinates(plane, info.world, options.where.slice_frame()));
    const Plane& cut = mapped.back().plane;
    FieldInfo rest = info;
    if (cut.axis >= 0) {
      const auto axis = static_cast<std::size_t>(cut.axis);
      (void)take(samples_around(info.axes[axis], cut.offset / cut.normal[axis]));
      rest.axes.erase(rest.axes.begin() + cut.axis);
    }
    check_axes(rest);
  }
  return mapped;
}

// Makes the cuts of surfaces (K = D-1), one slicer for each isovalue, or of a volume (K = D).
template <int D, int K>
void slice_steps(const Slice& options, const Plan& plan, SelectedSteps& steps,
                 const std::vector<std::vector<double>>& levels, std::vector<Outcome>& outcomes) {
  const std::vector<MappedPlane> mapped = mapped_planes(options, plan, steps.info());
  const std::vector<NamedSteps> others = options.data.open(options.input, options.machine);
  for (const NamedSteps& other : others)
    if (other.steps->info().dimension() > D) other.steps->leave_out_flat_axes();
  const Progress* progress_of_cut = nullptr;
  FieldSliceOptions how;
  static_cast<ExtractOptions&>(how) = options.surface.extract_options(options.machine);
  how.frame = steps.info().world ? SliceFrame::axes : options.where.slice_frame();
  how.with_normals = options.data.normals;
  for (const NamedSteps& other : others) how.others.push_back({other.name, other.steps.get()});
  how.progress = [&](double share) { return (*progress_of_cut)(share); };
  std::vector<FieldSlicer<D, K>> slicers;
  for (const std::vector<double>& of_one : levels) slicers.emplace_back(steps, of_one, how);

  make_cuts<D>(options, plan, outcomes, [&](Outcome& outcome, const Progress& progress) -> Mesh {
    progress_of_cut = &progress;
    const double read_before = steps.read_seconds();
    const MappedPlane& plane = mapped[static_cast<std::size_t>(outcome.plane - plan.planes.data())];
    const auto number = static_cast<std::size_t>(&outcome - outcomes.data());
    Mesh mesh = take(slicers[number % slicers.size()].slice(plane.plane.hyperplane<D>()));
    if (plane.map) transform(mesh, *plane.map);
    outcome.read_seconds = steps.read_seconds() - read_before;
    return mesh;
  });
}

// Of the field and the planes, unless one of these cuts them.
void leave_out_flat_axes(Plan& plan, SelectedSteps& steps) {
  std::vector<std::size_t> flat; // the last first
  for (std::size_t axis = plan.axes.size() - 1; axis-- > 0;)
    if (plan.axes[axis].count == 1) flat.push_back(axis);
  for (const std::size_t axis : flat)
    for (const Plane& plane : plan.planes)
      if (plane.normal[axis] != 0) return;
  for (const std::size_t axis : flat)
    for (Plane& plane : plan.planes) {
      plane.normal.erase(plane.normal.begin() + static_cast<std::ptrdiff_t>(axis));
      if (plane.axis > static_cast<int>(axis)) --plane.axis;
    }
  steps.leave_out_flat_axes(lowest_sliced);
  plan.axes = steps.info().axes;
}

// The names of the axes of the world are those of the field.
std::vector<Outcome> slice_field(const Slice& options, Plan& plan) {
  if (options.iso.empty() == options.range.empty())
    fail_usage("to slice a field give either --iso, for its surface, or --range, for a volume");
  const bool volume = options.iso.empty();
  if (volume && options.data.from_field()) fail_usage("--with, --normals: volumes have none; give --iso");
  std::vector<std::vector<double>> levels;
  if (volume) {
    plan.levels = parse_levels("--range", options.range);
    levels.push_back(plan.levels);
  } else {
    plan.isovalues = parse_isovalues(options.iso);
    for (const double isovalue : plan.isovalues) levels.push_back({isovalue});
  }
  (void)options.surface.extract_options(options.machine); // wrong ones are told before anything is read
  SelectedSteps steps(options.input.open(options.machine), options.input);
  plan.axes = steps.info().axes;
  plan.planes = planes_in(options, plan.axes);
  leave_out_flat_axes(plan, steps);
  const FieldInfo& info = steps.info();
  check_dimension(info.dimension(), lowest_sliced, highest_dimension, "the field");
  plan.simplex_dimension = volume ? plan.dimension() : plan.dimension() - 1;
  plan.has_time = info.has_time;
  std::vector<Outcome> outcomes = outcomes_of(options, plan);
  with_dimension<lowest_sliced>(info.dimension(), "the field", [&](auto dimension) {
    constexpr int D = decltype(dimension)::value;
    volume ? slice_steps<D, D>(options, plan, steps, levels, outcomes)
           : slice_steps<D, D - 1>(options, plan, steps, levels, outcomes);
  });
  return outcomes;
}

// Refuses a plane across an axis that misses the grid of the mesh.
void check_planes(const Plan& plan) {
  for (const Plane& plane : plan.planes) {
    if (plane.axis < 0) continue;
    const Axis& across = plan.axes[static_cast<std::size_t>(plane.axis)];
    if (across.count > 0 && std::isfinite(across.coordinate(0)))
      (void)take(samples_around(across, plane.value));
  }
}

std::vector<Outcome> slice_mesh(const Slice& options, Plan& plan) {
  if (!options.iso.empty()) fail_usage("--iso: the input is a mesh; its isovalue is chosen already");
  if (!options.range.empty()) fail_usage("--range: the input is a mesh; its levels are chosen already");
  if (options.data.from_field())
    fail_usage(
        "--with, --normals: the input is a mesh; what its vertices carry comes along, so give these to "
        "extract");
  const SliceOptions how{options.surface.extract_options(options.machine).precision, true,
                         options.where.slice_frame()};
  const Stopwatch reading;
  Mesh mesh = mesh_in(options.input.paths[0], options.printing.quiet);
  const double read_seconds = reading.seconds();
  return with_simplex_mesh<lowest_sliced>(std::move(mesh), [&]<int D, int K>(const SimplexMesh<D, K>& whole) {
    plan.axes = axes_of(whole);
    plan.axes.resize(D); // a volume has an axis of levels besides
    plan.simplex_dimension = K - 1;
    plan.planes = planes_in(options, plan.axes);
    plan.has_time = plan.axes.back().name != "z";
    std::vector<Outcome> outcomes = outcomes_of(options, plan);
    check_planes(plan);
    std::optional<SliceIndex<D, K>> index;
    if (outcomes.size() >= worth_an_index) index.emplace(whole);
    make_cuts<D>(options, plan, outcomes, [&](Outcome& outcome, const Progress&) -> Mesh {
      const Hyperplane<D> plane = outcome.plane->template hyperplane<D>();
      return take(index ? index->slice(whole, plane, how) : hyperiso::slice(whole, plane, how));
    });
    outcomes.front().read_seconds = read_seconds;
    return outcomes;
  });
}

void warn_of_time(const Slice& options, const Plan& plan) {
  const std::string last = name_of_axis(plan.axes, plan.axes.size() - 1);
  print_warning(text("--time cuts the last axis, ", last, ", which the input does not call time; --axis ",
                     last, "=", options.where.times.front(), " means the same"));
}

int run(const Slice& options) {
  Plan plan;
  (void)options.where.slice_frame();
  const bool from_mesh = options.input.paths.size() == 1 && is_mesh_file(options.input.paths[0]);
  const std::vector<Outcome> outcomes = from_mesh ? slice_mesh(options, plan) : slice_field(options, plan);
  if (!plan.has_time && !options.where.times.empty() && !options.printing.quiet) warn_of_time(options, plan);
  print_outcomes(outcomes, options, plan);
  return 0;
}

} // namespace

Command slice_command(CLI::App& program) {
  auto options = std::make_shared<Slice>();
  CLI::App* app = program.add_subcommand("slice", "the surface at any time, or cut across any axis");
  options->input.add_to(*app, "; or a mesh that 'hyperiso extract' wrote as .vtu");
  options->where.add_to(*app);
  app->add_option("--iso", options->iso, "fields: the isovalue, or several with commas between them")
      ->type_name("V[,V...]")
      ->group("Surface");
  app->add_option("--range", options->range,
                  "fields: cut the volume between these values instead, as 'hyperiso interval' makes it")
      ->type_name("A:B[:N]")
      ->group("Surface");
  options->surface.add_to(*app);
  options->data.add_to(*app);
  options->output.add_to(
      *app, "With several cuts one file for each: PATH with the place before the suffix, as in "
            "wave_t0.25.vtp; or with a number in the place of %04d, as in frames/f_%04d.ply; or, "
            "if PATH ends in .pvd, numbered files and a series that names them with their times, "
            "which ParaView plays.");
  app->add_flag("--measure", options->measure,
                "also check and measure each cut: components, Euler characteristic, boundary, area")
      ->group("Output");
  options->printing.add_to(*app);
  options->machine.add_to(*app);
  set_manual(
      *app,
      {{"slice INPUT... --iso V --time T[,T...] [options]", "slice MESH --time T[,T...] [options]",
        "slice INPUT... --axis NAME=V[,V...] [options]", "slice INPUT... --plane N,...,C [options]"},
       {"Cuts a 4D isosurface into triangles in space: the surface at time T, between the stored steps as "
        "well as on them, or on any other plane, and a mesh of tetrahedra as 'hyperiso interval' makes it. A "
        "cut at a stored step is exactly the isosurface of that step, as far as the surface through time has "
        "it: where samples before or after are missing it may end earlier in the cut of a mesh. 3D surfaces "
        "are cut into segments. "
        "What "
        "the vertices of a mesh carry comes along; cuts by oblique planes have the time of their vertices as "
        "data.",
        "From a field only the samples around T are read, and for other planes slab after slab of two steps: "
        "the 4D surface never exists as a whole. Places are in the coordinates of the output: where a file "
        "has "
        "a map to the world, they are the world's.",
        "With --json several cuts are the list \"slices\" of one object. \"frame\" says where a cut lies in "
        "space: origin + u[0] directions[0] + u[1] directions[1] + ..."},
       {{"the surface at one moment, from the field",
         "hyperiso slice examples/data/alpha_water_24x24x24x41.nrrd --iso 0.5 --time 0.33 -o water.ply"},
        {"a movie of five frames for ParaView", "hyperiso slice examples/data/alpha_water_24x24x24x41.nrrd "
                                                "--iso 0.5 --times 0:0.04:0.01 -o movie.pvd"},
        {"a surface made before, cut twice and measured",
         "hyperiso extract examples/data/alpha_water_24x24x24x41.nrrd --iso 0.5 -o water.vtu"},
        {"", "hyperiso slice water.vtu --time 0.31,0.62 --measure"},
        {"how the profile at y = 0.5 moves through time",
         "hyperiso slice water.vtu --axis y=0.5 -o profile.vtp"},
        {"where there is a tenth to nine tenths of water, at one moment, as tetrahedra",
         "hyperiso slice examples/data/alpha_water_24x24x24x41.nrrd --range 0.1:0.9 --time 0.33 -o "
         "spray.vtu"},
        {"what a plane sees that sweeps through the tank, numbered files",
         "hyperiso slice water.vtu --plane 1,0,0,-0.5,0:0.5:0.125 -o sweep_%04d.ply"}}});
  return {app, [options] { return run(*options); }};
}

} // namespace hyperiso::cli
