#include "cli/command.hpp"
#include "cli/field_mesh.hpp"
#include "cli/manual.hpp"
#include "cli/parse.hpp"
#include "cli/seed.hpp"
#include "cli/steps.hpp"
#include "core/text.hpp"
#include "hyperiso/seeds.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <memory>

namespace hyperiso::cli {
namespace {

struct Extract : FieldMeshOptions {
  std::string iso, repeat = "1";
  std::vector<std::string> seeds;
};

// Of one field, for all isovalues and repetitions.
struct Reused {
  Workspace workspace;
  FieldRanges ranges;
};

// What was looked at to trace a surface from its seeds.
struct Visited {
  std::uint64_t samples, cells;
};

// What is told about the surface of one isovalue.
struct Surface {
  double isovalue;
  Outcome outcome;
  std::optional<Visited> visited; // if there are seeds
};

template <int D>
std::array<std::int64_t, D> index_of(const std::vector<std::int64_t>& indices) {
  std::array<std::int64_t, D> index;
  std::ranges::copy(indices, index.begin());
  return index;
}

template <int D>
Seeds<D> parse_seeds(const std::vector<std::string>& texts, const std::vector<Axis>& axes) {
  Seeds<D> seeds;
  for (const std::string& seed : texts) {
    const std::vector<std::string> points = split(seed, ':');
    if (points.size() > 2)
      fail_usage(text("--seed: '", seed, "' is neither a point nor two with a : between"));
    if (points.size() == 1)
      seeds.cells.push_back(index_of<D>(cell_at(points[0], axes)));
    else
      seeds.pairs.emplace_back(index_of<D>(sample_at(points[0], axes)),
                               index_of<D>(sample_at(points[1], axes)));
  }
  return seeds;
}

// The surface of a field that is known by its type and dimension: all of it, or what its seeds lead to.
template <class T, int D>
Status surface_into(const FieldView<const T, D>& view, double isovalue, const Extract& options,
                    const std::vector<Axis>& axes, const ExtractOptions& extraction,
                    std::optional<Visited>& visited, SimplexMesh<D>& surface) {
  if (options.seeds.empty()) return extract_into(view, isovalue, extraction, surface);
  if constexpr (D <= highest_dimension) {
    auto traced = extract_from_seeds(view, isovalue, parse_seeds<D>(options.seeds, axes), extraction);
    if (!traced)
      return Error{traced.error().code, text("--seed at isovalue ", isovalue, ": ", traced.error().message)};
    visited = {traced->samples, traced->cells};
    surface = std::move(traced->mesh);
    return {};
  } else {
    fail_usage(
        text("--seed: surfaces are traced in up to ", highest_dimension, " dimensions; the field has ", D));
  }
}

int repeat_count(const Extract& options) {
  const std::int64_t count = parse_integer("--repeat", options.repeat);
  if (count < 1 || count > 1'000'000) fail_usage(text("--repeat: ", count, " is not from 1 to 1000000"));
  return static_cast<int>(count);
}

// Calls work(progress) `times` times; `seconds` is the shortest.
template <class Work>
Status repeat(int times, const Progress& progress, double& seconds, Work&& work) {
  seconds = HUGE_VAL;
  for (int time = 0; time < times; ++time) {
    const Stopwatch working;
    if (Status status = work([&](double share) { return progress((time + share) / times); }); !status)
      return status;
    seconds = std::min(seconds, working.seconds());
  }
  return {};
}

Surface make_surface(const Extract& options, const LoadedField& loaded, const std::vector<NamedField>& others,
                     double isovalue, const std::string& path, ExtractOptions extraction, FileGroup& files) {
  const Field& field = loaded.field;
  extraction.keep_edges = !path.empty() || options.data.from_field();
  double extract_seconds = 0, add_seconds = 0;
  std::optional<Visited> visited;
  Mesh mesh = make_mesh<highest_extracted>(
      "extract", field, options.printing.quiet,
      [&]<class T, int D>(const FieldView<const T, D>& view, const Progress& progress) {
        Result<SimplexMesh<D>> surface = SimplexMesh<D>();
        const Status made =
            repeat(repeat_count(options), progress, extract_seconds, [&](const Progress& part) {
              extraction.progress = part;
              return surface_into(view, isovalue, options, field.info.axes, extraction, visited, *surface);
            });
        if (!made) surface = made.error();
        const Stopwatch adding;
        if (surface)
          take(add_point_data(*surface, field, isovalue, extraction.inside, others, options.data.normals));
        add_seconds = adding.seconds();
        return surface;
      });
  options.data.colour(mesh);
  if (mesh.simplex_count() == 0 && !options.printing.quiet) print_warning(why_empty(field, isovalue));
  Surface surface{isovalue, finish(mesh, options, field.info, path, files, extraction.memory_limit), visited};
  surface.outcome.extract_seconds = extract_seconds + add_seconds;
  surface.outcome.read_seconds = loaded.read_seconds;
  return surface;
}

// Data at the vertices come from the field as a whole, and seeds lead through it.
bool can_come_by_slabs(const Extract& options, const FieldInfo& info, const ExtractOptions& extraction) {
  return can_stream(info, extraction) && !options.data.from_field() && options.data.colour_by.empty() &&
         options.seeds.empty();
}

// Nothing if that takes too much memory.
std::optional<Surface> surface_in_memory(const Extract& options, const LoadedField& loaded, double isovalue,
                                         const std::string& path, const ExtractOptions& extraction,
                                         FileGroup& files) {
  try {
    return make_surface(options, loaded, {}, isovalue, path, extraction, files);
  } catch (const Failure& failure) {
    if (failure.error.code != Code::out_of_memory) throw;
    return std::nullopt;
  }
}

// Slab by slab, to the file: neither the field nor its surface is in memory as a whole.
Outcome write_slabs(const Extract& options, StepSource& steps, double isovalue, const std::string& path,
                    const ExtractOptions& extraction, FileGroup& files) {
  const FieldInfo& info = steps.info();
  Outcome outcome;
  outcome.simplex_dimension = info.dimension() - 1;
  outcome.path = path;
  std::optional<MeshFileWriter> writer;
  if (!path.empty())
    writer.emplace(take(MeshFileWriter::create(info.dimension(), info.dimension() - 1, path,
                                               options.output.write_options(info.axes, files))));
  take(stream(
      steps, isovalue,
      [&](SurfaceSlab& slab) -> Status {
        outcome.vertices += slab.mesh.vertex_count();
        outcome.simplices += slab.mesh.simplex_count();
        outcome.active_cells += slab.mesh.active_cells;
        if (!writer) return {};
        const Stopwatch writing;
        if (info.world) transform(slab.mesh, *info.world);
        const Status written = writer->append(slab.mesh);
        outcome.write_seconds += writing.seconds();
        return written;
      },
      extraction));
  if (!writer) return outcome;
  const Stopwatch writing;
  const ProgressBar bar("write", options.printing.quiet);
  take(writer->finish());
  outcome.write_seconds += writing.seconds();
  return outcome;
}

// What is measured is needed as a whole.
Outcome measure_slabs(const Extract& options, StepSource& steps, double isovalue, const std::string& path,
                      const ExtractOptions& extraction, FileGroup& files) {
  auto mesh = collect_surface(steps, isovalue, extraction);
  if (!mesh && mesh.error().code == Code::out_of_memory)
    throw Failure{{Code::out_of_memory, mesh.error().message + ", and is to be measured as a whole"}};
  Mesh surface = take(std::move(mesh));
  if (steps.info().world) transform(surface, *steps.info().world);
  return finish(surface, options, steps.info(), path, files, extraction.memory_limit);
}

Surface stream_surface(const Extract& options, const OpenedField& opened, double isovalue,
                       const std::string& path, FileGroup& files, ExtractOptions extraction) {
  SelectedSteps& selected = *opened.steps;
  std::optional<FieldSteps> within; // one step is gone through along its own last axis
  if (selected.info().axes.back().count == 1) within.emplace(load_field(options, opened).field);
  StepSource& steps = within ? static_cast<StepSource&>(*within) : selected;
  extraction.keep_edges = !path.empty();
  extraction.memory_limit = memory_beside_steps(steps.info(), extraction.memory_limit);
  ProgressBar bar("extract", options.printing.quiet);
  extraction.progress = bar.callback();
  const bool whole = options.measure || options.self_intersections;
  double fastest = HUGE_VAL; // without what is written
  for (int time = 1; time < repeat_count(options); ++time) {
    const double read_until = opened.steps->read_seconds();
    const Stopwatch watch;
    take(stream(
        steps, isovalue, [](SurfaceSlab&) { return Status{}; }, extraction));
    fastest = std::min(fastest, watch.seconds() - (opened.steps->read_seconds() - read_until));
  }
  const double read_before = opened.steps->read_seconds();
  const Stopwatch watch;
  Surface surface{isovalue,
                  (whole ? measure_slabs : write_slabs)(options, steps, isovalue, path, extraction, files),
                  std::nullopt};
  Outcome& outcome = surface.outcome;
  outcome.read_seconds = opened.steps->read_seconds() - read_before;
  outcome.extract_seconds = std::min(fastest, watch.seconds() - outcome.read_seconds - outcome.write_seconds);
  if (outcome.simplices == 0 && !options.printing.quiet) print_warning(why_empty(steps, isovalue));
  return surface;
}

Json json_of(const Surface& surface, const Extract& options, const FieldInfo& info) {
  Json object = json_of(surface.outcome, options, info, {{"isovalue", surface.isovalue}});
  if (surface.visited) {
    object["samples_visited"] = surface.visited->samples;
    object["cells_visited"] = surface.visited->cells;
  }
  return object;
}

std::string report_of(const Surface& surface, const Extract& options, const FieldInfo& info) {
  Report report;
  report.add("field", size_and_type(info));
  report.add("isovalue", fmt::format("{}, {}, inside {}", surface.isovalue, options.surface.method,
                                     options.surface.inside));
  if (surface.visited)
    report.add("visited", text(grouped(surface.visited->samples), " samples, ",
                               grouped(surface.visited->cells), " cells"));
  add_outcome(report, surface.outcome);
  return report.text();
}

void print_surfaces(const std::vector<Surface>& surfaces, const Extract& options, const FieldInfo& info) {
  if (!options.printing.json) {
    std::string reports;
    for (const Surface& surface : surfaces)
      reports += (reports.empty() ? "" : "\n") + report_of(surface, options, info);
    return print(reports);
  }
  if (surfaces.size() == 1) return print_json(json_of(surfaces[0], options, info));
  Json objects = Json::array();
  for (const Surface& surface : surfaces) objects.push_back(json_of(surface, options, info));
  print_json(Json{{"surfaces", objects}});
}

int run(const Extract& options) {
  const std::vector<double> isovalues = parse_isovalues(options.iso);
  const ExtractOptions given = options.surface.extract_options(options.machine); // told before reading
  const int times = repeat_count(options);
  const OpenedField opened = open_field(options, lowest_dimension, highest_extracted, 1);
  const bool can_come = can_come_by_slabs(options, opened.info, given);
  // Memory-mapped fields could be looked at as a whole: what is larger than the memory is not.
  std::optional<LoadedField> loaded;
  if (!can_come || opened.info.bytes() <= given.memory_limit) loaded = load_field(options, opened);
  const std::vector<NamedField> others = load_others(options);

  std::optional<Reused> reused(std::in_place);
  FileGroup files;
  std::vector<Surface> surfaces;
  for (const double isovalue : isovalues) {
    std::string path = options.output.path;
    if (options.output.wanted() && isovalues.size() > 1) path = with_suffix(path, "iso" + shortest(isovalue));
    std::optional<Surface> surface;
    const Stopwatch trying;
    if (loaded) {
      ExtractOptions extraction = options.surface.extract_options(options.machine);
      extraction.workspace = &reused->workspace;
      // Who repeats wants to know what a whole extraction costs.
      if (isovalues.size() > 1 && times == 1) extraction.ranges = &reused->ranges;
      surface = can_come ? surface_in_memory(options, *loaded, isovalue, path, extraction, files)
                         : make_surface(options, *loaded, others, isovalue, path, extraction, files);
    }
    if (!surface) { // field and surface together are too much
      const double tried_seconds = loaded ? trying.seconds() : 0,
                   read_seconds = loaded ? loaded->read_seconds : 0;
      loaded.reset();
      reused.reset();
      surface = stream_surface(options, opened, isovalue, path, files, given);
      surface->outcome.read_seconds += read_seconds;
      if (times == 1) surface->outcome.extract_seconds += tried_seconds; // else the shortest is told
    }
    surfaces.push_back(std::move(*surface));
  }
  take(files.commit());
  print_surfaces(surfaces, options, opened.info);
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
  app->add_option(
         "--seed", options->seeds,
         "only the components of the surface that pass the grid cell around this point; or two points "
         "with a colon between them, one inside and one outside: the component where the line from "
         "one to the other crosses the surface. In coordinates of the axes, as --time of slice takes "
         "them, not in numbers of samples; repeatable. Only samples beside the surface are looked at")
      ->type_name("X,Y,...[:X,Y,...]")
      ->allow_extra_args(false)
      ->group("Surface");
  options->data.add_to(*app);
  options->output.add_to(*app,
                         "With several isovalues one file for each: PATH with _iso and the value before "
                         "the suffix, as in wave_iso0.5.vtu.");
  app->add_flag("--measure", options->measure,
                "also check and measure the surface: components, Euler characteristic, boundary, area")
      ->group("Output");
  add_self_intersections_option(*app, options->self_intersections);
  options->printing.add_to(*app);
  options->machine.add_to(*app);
  app->add_option("--repeat", options->repeat,
                  "extract N times into the same memory; the time told is the shortest")
      ->type_name("N")
      ->group("Machine");
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
        "A field that does not fit into --memory, or not together with its surface, is read step by step "
        "(along "
        "the last axis), and the surface is written as it is found: two steps and the surface between them "
        "are in "
        "memory. The file is the same.",
        "Without -o nothing is written. 4D surfaces are written as .vtu, with the time of each vertex as "
        "point data "
        "t and all four coordinates as xyzt; cut them with 'hyperiso slice' or with ParaView's Contour of "
        "t. The isolines of 2D fields are whole lines, closed or open, in .svg, .geojson and .vtp: inside is "
        "on "
        "their left."},
       {{"the surface of the water through all of time, for ParaView",
         "hyperiso extract examples/data/alpha_water_24x24x24x41.nrrd --iso 0.5 -o water.vtu"},
        {"two isovalues, checked and measured, nothing written",
         "hyperiso extract examples/data/alpha_water_24x24x24x41.nrrd --iso 0.1,0.9 --measure"},
        {"one drop of spray at one step, by a point on it, whatever else there is",
         "hyperiso extract examples/data/alpha_water_24x24x24x41.nrrd --iso 0.02 --steps 14:15 --seed "
         "0.645,0.104,0.271 -o drop.ply"},
        {"the isolines of one step in a plane, as a picture",
         "hyperiso extract examples/data/alpha_water_24x24x24x41.nrrd --steps 20:21 --crop ,12:13 --iso 0.5 "
         "-o "
         "lines.svg"},
        {"ten steps of it, numbers for a script",
         "hyperiso extract examples/data/alpha_water_24x24x24x41.nrrd --iso 0.5 --steps 10:20 --json"},
        {"what extraction costs, without what the first run has to do once",
         "hyperiso extract examples/data/alpha_water_24x24x24x41.nrrd --iso 0.5 --repeat 20"}}});
  return {app, [options] { return run(*options); }};
}

} // namespace hyperiso::cli
