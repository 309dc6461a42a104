#include "hyperiso/slice.hpp"
#include "cli/command.hpp"
#include "cli/console.hpp"
#include "cli/dispatch.hpp"
#include "cli/manual.hpp"
#include "cli/options.hpp"
#include "cli/parse.hpp"
#include "cli/surface.hpp"
#include "core/memory.hpp"

#include <cmath>
#include <filesystem>
#include <fmt/format.h>
#include <functional>
#include <memory>

namespace hyperiso::cli {
namespace {

constexpr int lowest_sliced = 3;

struct Slice {
  FieldOptions input;
  std::string iso, time, axis;
  SurfaceOptions surface;
  MeshOutputOptions output;
  bool measure = false;
  PrintOptions printing;
  MachineOptions machine;
};

// Where to cut: across which axis, and at which of its coordinates.
struct Cuts {
  int axis = 0;
  std::string name;
  std::vector<double> values;
};

std::string axis_list(const std::vector<Axis>& axes) {
  std::string list;
  for (std::size_t axis = 0; axis < axes.size(); ++axis)
    list += (axis == 0 ? "" : ", ") + name_of_axis(axes, axis);
  return list;
}

Cuts parse_cuts(const Slice& options, const std::vector<Axis>& axes) {
  Cuts cuts;
  if (options.axis.empty()) {
    cuts.axis = static_cast<int>(axes.size()) - 1;
    cuts.values = parse_numbers("--time", options.time);
  } else {
    const auto equals = options.axis.find('=');
    if (equals == std::string::npos) fail_usage(text("--axis: '", options.axis, "' is not NAME=VALUE"));
    const std::string name = options.axis.substr(0, equals);
    FieldInfo info;
    info.axes = axes;
    const auto axis = info.axis_named(name);
    if (!axis) fail_usage(text("--axis: there is no axis '", name, "'; there are ", axis_list(axes)));
    cuts.axis = *axis;
    cuts.values = parse_numbers("--axis", options.axis.substr(equals + 1));
  }
  cuts.name = name_of_axis(axes, static_cast<std::size_t>(cuts.axis));
  return cuts;
}

std::vector<Axis> without(std::vector<Axis> axes, int axis) {
  axes.erase(axes.begin() + axis);
  return axes;
}

// Slices of a field. Of the last axis it reads only the samples around each plane, and those once where the
// next plane needs the same.
class FieldSource {
 public:
  FieldSource(const Slice& options, FieldReader& reader, Cuts cuts)
      : options_(options), reader_(reader), cuts_(std::move(cuts)),
        selection_(options.input.selection(reader.info())), axes_(selected(reader.info(), selection_).axes) {
    FieldInfo rest = reader.info();
    rest.axes = without(axes_, cuts_.axis);
    check_axes(rest);
    for (const double value : cuts_.values) (void)take(samples_around(cut_axis(), value));
  }

  Mesh slice(double isovalue, double value, double& read_seconds) {
    read_seconds = read_around(value);
    const ExtractOptions extraction = options_.surface.extract_options(options_.machine);
    Mesh mesh = with_view<lowest_sliced>(*field_, [&]<class T, int D>(const FieldView<T, D>& view) -> Mesh {
      return take(hyperiso::slice(view, isovalue, Hyperplane<D>::at(cuts_.axis, value), extraction));
    });
    if (field_->info.world) transform(mesh, at_coordinate(*field_->info.world, cuts_.axis, value));
    return mesh;
  }

 private:
  const Axis& cut_axis() const { return axes_[static_cast<std::size_t>(cuts_.axis)]; }

  // Gives the seconds it took.
  double read_around(double value) {
    Selection wanted = selection_;
    if (cuts_.axis + 1 == static_cast<int>(axes_.size())) {
      const SampleRange around = take(samples_around(cut_axis(), value));
      const std::int64_t first = selection_.ranges.back().first;
      wanted.ranges.back() = {first + around.begin, first + around.end};
    }
    if (field_ && wanted.ranges == held_.ranges) return 0;
    field_.reset();
    const Stopwatch reading;
    field_ = read_selection(reader_, wanted);
    held_ = wanted;
    return reading.seconds();
  }

  const Slice& options_;
  FieldReader& reader_;
  Cuts cuts_;
  Selection selection_;
  std::vector<Axis> axes_; // as selected
  std::optional<Field> field_;
  Selection held_; // of field_
};

// What is told about one cut.
struct Outcome {
  std::optional<double> isovalue; // of a field
  double value = 0;
  std::uint64_t vertices = 0, simplices = 0;
  std::optional<Measure> measure;
  std::string path;
  double read_seconds = 0, slice_seconds = 0, write_seconds = 0;
};

// The cuts are made one after the other, each by a call.
using MakeCut = std::function<Mesh(double isovalue, double value, Outcome& outcome)>;

// What all cuts share.
struct Plan {
  Cuts cuts;
  std::vector<double> isovalues; // empty for a mesh
  std::vector<Axis> axes;        // of the field or of the space of the mesh

  int simplex_dimension = 0; // of the cut

  int dimension() const { return static_cast<int>(axes.size()) - 1; } // of the cut's space
  std::size_t count() const { return cuts.values.size() * std::max<std::size_t>(isovalues.size(), 1); }
};

// A .pvd names numbered files that are written beside it.
bool is_series(const std::string& path) { return std::filesystem::path(path).extension() == ".pvd"; }

// The path that the numbers of the frames of a series go into.
std::string path_of_frames(const Slice& options) {
  const std::string suffix = options.output.format.empty() ? "vtp" : options.output.format;
  return std::filesystem::path(options.output.path).replace_extension(suffix).string();
}

void check_output(const Slice& options, const Plan& plan) {
  const std::string& path = options.output.path;
  if (path.empty()) return;
  options.output.check(plan.dimension(), plan.simplex_dimension,
                       is_series(path) ? path_of_frames(options) : path);
}

// The file of a cut: PATH itself if there is one cut, else PATH with the isovalue, if there are several, and
// the place; in a series, numbered.
std::string path_of(const Slice& options, const Plan& plan, const Outcome& outcome, std::size_t number) {
  const std::string& path = options.output.path;
  if (path.empty()) return path;
  if (is_series(path)) return with_suffix(path_of_frames(options), fmt::format("{:04}", number));
  std::string result = path;
  if (plan.isovalues.size() > 1) result = with_suffix(result, "iso" + shortest(*outcome.isovalue));
  if (plan.cuts.values.size() > 1) result = with_suffix(result, plan.cuts.name + shortest(outcome.value));
  return result;
}

std::vector<Outcome> make_cuts(const Slice& options, const Plan& plan, const MakeCut& make_cut) {
  std::vector<Outcome> outcomes;
  std::vector<SeriesEntry> series;
  FileGroup files;
  ProgressBar bar("slice", options.printing.quiet);
  const std::vector<double> isovalues = plan.isovalues.empty() ? std::vector<double>{0} : plan.isovalues;
  for (const double value : plan.cuts.values)
    for (const double isovalue : isovalues) {
      bar.show(static_cast<double>(outcomes.size()) / static_cast<double>(plan.count()));
      Outcome& outcome = outcomes.emplace_back();
      if (!plan.isovalues.empty()) outcome.isovalue = isovalue;
      outcome.value = value;
      const Stopwatch slicing;
      const Mesh mesh = make_cut(isovalue, value, outcome);
      outcome.slice_seconds = slicing.seconds() - outcome.read_seconds;
      outcome.vertices = mesh.vertex_count();
      outcome.simplices = mesh.simplex_count();
      if (options.measure) outcome.measure = take(measure(mesh));
      outcome.path = path_of(options, plan, outcome, outcomes.size() - 1);
      if (outcome.path.empty()) continue;
      const Stopwatch writing;
      take(write_mesh(mesh, outcome.path,
                      options.output.write_options(without(plan.axes, plan.cuts.axis), files)));
      outcome.write_seconds = writing.seconds();
      series.push_back({value, std::filesystem::path(outcome.path).filename()});
    }
  if (is_series(options.output.path)) take(write_series(series, options.output.path, &files));
  take(files.commit());
  return outcomes;
}

Json json_of(const Outcome& outcome, const Plan& plan) {
  std::vector<double> normal(plan.axes.size(), 0.0);
  normal[static_cast<std::size_t>(plan.cuts.axis)] = 1;
  Json object{{"dimension", plan.dimension()}};
  if (outcome.isovalue) object["isovalue"] = *outcome.isovalue;
  object["hyperplane"] = {{"normal", normal}, {"offset", outcome.value}};
  object["vertices"] = outcome.vertices;
  object["simplices"] = outcome.simplices;
  object["seconds"] = {
      {"read", outcome.read_seconds}, {"slice", outcome.slice_seconds}, {"write", outcome.write_seconds}};
  object["peak_memory_bytes"] = peak_memory();
  if (outcome.measure) object["measure"] = cli::json_of(*outcome.measure);
  return object;
}

std::string report_of(const Outcome& outcome, const Plan& plan) {
  Report report;
  report.add("plane", fmt::format("{} = {}", plan.cuts.name, outcome.value));
  if (outcome.isovalue) report.add("isovalue", fmt::format("{}", *outcome.isovalue));
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
  std::string lines = fmt::format("{:>12}", plan.cuts.name);
  if (isovalues) lines += fmt::format("  {:>12}", "isovalue");
  lines += fmt::format("  {:>10}  {:>10}", "vertices", simplex_noun(plan.simplex_dimension));
  if (outcomes[0].measure)
    lines +=
        fmt::format("  {:>10}  {:>6}  {:>12}", "components", "Euler", content_noun(plan.simplex_dimension));
  lines += '\n';
  for (const Outcome& outcome : outcomes) {
    lines += fmt::format("{:>12}", outcome.value);
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

std::vector<Outcome> slice_field(const Slice& options, Plan& plan) {
  if (options.iso.empty()) fail_usage("--iso is required to slice a field");
  plan.isovalues = parse_isovalues(options.iso);
  if (plan.isovalues.size() > 1 && is_series(options.output.path))
    fail_usage("-o: a .pvd series holds one isovalue; give one, or another suffix");
  (void)options.surface.extract_options(options.machine); // wrong ones are told before anything is read
  const auto reader = options.input.open(options.machine);
  check_dimension(reader->info().dimension(), lowest_sliced, highest_dimension, "the field");
  plan.axes = reader->info().axes;
  plan.simplex_dimension = plan.dimension() - 1;
  check_output(options, plan);
  plan.cuts = parse_cuts(options, plan.axes);
  FieldSource source(options, *reader, plan.cuts);
  return make_cuts(options, plan, [&](double isovalue, double value, Outcome& outcome) {
    return source.slice(isovalue, value, outcome.read_seconds);
  });
}

std::vector<Outcome> slice_mesh(const Slice& options, Plan& plan) {
  if (!options.iso.empty()) fail_usage("--iso: the input is a mesh; its isovalue is chosen already");
  const Precision precision = options.surface.extract_options(options.machine).precision;
  const Stopwatch reading;
  Mesh mesh = mesh_in(options.input.paths[0], options.printing.quiet);
  const double read_seconds = reading.seconds();
  plan.axes = axes_of(mesh);
  plan.cuts = parse_cuts(options, plan.axes);
  const Axis& across = plan.axes[static_cast<std::size_t>(plan.cuts.axis)];
  for (const double value : plan.cuts.values)
    if (across.count > 0 && std::isfinite(across.coordinate(0)))
      (void)take(samples_around(across, value)); // the mesh knows its grid: refuse what misses it
  std::vector<Outcome> outcomes =
      with_simplex_mesh<lowest_sliced>(std::move(mesh), [&]<int D, int K>(const SimplexMesh<D, K>& whole) {
        plan.simplex_dimension = K - 1;
        check_output(options, plan);
        return make_cuts(options, plan, [&](double, double value, Outcome&) -> Mesh {
          return take(
              hyperiso::slice(whole, Hyperplane<D>::at(plan.cuts.axis, value), SliceOptions{precision}));
        });
      });
  outcomes.front().read_seconds = read_seconds;
  return outcomes;
}

int run(const Slice& options) {
  if (options.time.empty() == options.axis.empty())
    fail_usage("say where to cut: either --time T or --axis NAME=VALUE");
  Plan plan;
  const bool from_mesh = options.input.paths.size() == 1 && is_mesh_file(options.input.paths[0]);
  const std::vector<Outcome> outcomes = from_mesh ? slice_mesh(options, plan) : slice_field(options, plan);
  print_outcomes(outcomes, options, plan);
  return 0;
}

} // namespace

Command slice_command(CLI::App& program) {
  auto options = std::make_shared<Slice>();
  CLI::App* app = program.add_subcommand("slice", "the surface at any time, or cut across any axis");
  options->input.add_to(*app, "; or a mesh that 'hyperiso extract' wrote as .vtu");
  app->add_option("--time", options->time,
                  "where to cut the last axis, in its coordinates (times, not step numbers); several with "
                  "commas between them")
      ->type_name("T[,T...]")
      ->group("Cut");
  app->add_option("--axis", options->axis, "where to cut another axis, by its name or number: y=0.5 or 1=0.5")
      ->type_name("NAME=V[,V...]")
      ->group("Cut");
  app->add_option("--iso", options->iso, "fields: the isovalue, or several with commas between them")
      ->type_name("V[,V...]")
      ->group("Surface");
  options->surface.add_to(*app);
  options->output.add_to(*app,
                         "With several cuts one file for each: PATH with the place before the suffix, as in "
                         "wave_t0.25.vtp; or, if PATH ends in .pvd, numbered files and a series that names "
                         "them with their times, which ParaView plays.");
  app->add_flag("--measure", options->measure,
                "also check and measure each cut: components, Euler characteristic, boundary, area")
      ->group("Output");
  options->printing.add_to(*app);
  options->machine.add_to(*app);
  set_manual(
      *app,
      {{"slice INPUT... --iso V --time T[,T...] [options]", "slice MESH --time T[,T...] [options]",
        "slice INPUT... --axis NAME=V[,V...] [options]"},
       {"Cuts a 4D isosurface into triangles in space: the surface at time T, between the stored steps as "
        "well as on "
        "them. A cut at a stored step is exactly the isosurface of that step. 3D surfaces are cut into "
        "segments.",
        "From a field only the samples around T are read, and the 4D surface never exists as a whole; for "
        "many cuts "
        "through a surface that fits in memory, extract it once and slice the mesh."},
       {{"the surface at one moment, from the field",
         "hyperiso slice examples/data/alpha_water_24x24x24x41.nrrd --iso 0.5 --time 0.33 -o water.ply"},
        {"a movie of five frames for ParaView", "hyperiso slice examples/data/alpha_water_24x24x24x41.nrrd "
                                                "--iso 0.5 --time 0,0.01,0.02,0.03,0.04 -o movie.pvd"},
        {"a surface made before, cut twice and measured",
         "hyperiso extract examples/data/alpha_water_24x24x24x41.nrrd --iso 0.5 -o water.vtu"},
        {"", "hyperiso slice water.vtu --time 0.31,0.62 --measure"},
        {"how the profile at y = 0.5 moves through time",
         "hyperiso slice water.vtu --axis y=0.5 -o profile.vtp"}}});
  return {app, [options] { return run(*options); }};
}

} // namespace hyperiso::cli
