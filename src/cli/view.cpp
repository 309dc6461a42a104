#include "hyperiso/view.hpp"
#include "cli/command.hpp"
#include "cli/console.hpp"
#include "cli/dispatch.hpp"
#include "cli/manual.hpp"
#include "cli/options.hpp"
#include "cli/parse.hpp"
#include "cli/point_data.hpp"
#include "cli/steps.hpp"
#include "cli/surface.hpp"
#include "cli/tracked_folder.hpp"
#include "core/memory.hpp"
#include "hyperiso/track.hpp"
#include "view/world_axis.hpp"

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fmt/format.h>
#include <memory>
#include <sys/wait.h>
#include <unistd.h>

namespace hyperiso::cli {
namespace {

constexpr int lowest_shown = 3;
constexpr const char* default_size = "256M";
// For the choice of samples only: what a page turns out to have is checked when it is written.
constexpr double bytes_per_simplex = 5.5, bytes_of_viewer = 7e5;
constexpr int most_halvings = 4;

struct View {
  FieldOptions input;
  TrackingOptions tracking; // --iso, and the others as `folder` says
  SurfaceOptions surface;
  std::optional<TrackedFolder> folder; // where that is the input
  std::string path, title, colour_by, payload, size = default_size;
  bool track = false, open = false;
  PrintOptions printing;
  MachineOptions machine;
};

// What the page shows.
struct Content {
  std::unique_ptr<Mesh> mesh;         // of a page that holds the surface
  Field field;                        // as far as it is needed still
  std::optional<PageSamples> samples; // what of them
  PageSurface surface{};
  PageOptions page;
  TrackingGraph tracking;
  double read_seconds = 0, extract_seconds = 0;
};

std::string title_of(const View& options) {
  if (!options.title.empty()) return options.title;
  if (options.folder) return options.folder->name();
  return std::filesystem::path(options.input.paths[0]).stem().string();
}

// Where axes of one sample lie, which are left out of the surface: "t = 0.5 s".
std::string part_of(const FieldInfo& info) {
  std::string part;
  for (std::size_t k = 0; k < info.axes.size(); ++k) {
    if (info.axes[k].count != 1 || (info.world && !stands_alone(*info.world, k))) continue;
    const Axis axis = info.world ? world_axis(info.axes[k], *info.world, k) : info.axes[k];
    part += fmt::format("{}{} = {:.7g}{}{}", part.empty() ? "" : ", ", name_of_axis(info.axes, k),
                        axis.coordinate(0), axis.unit.empty() ? "" : " ", axis.unit);
  }
  return part;
}

// Every second sample along the axes of space. Shares the samples.
Field halved(Field field) {
  const std::size_t space = field.info.axes.size() - (field.info.has_time ? 1 : 0);
  for (std::size_t k = 0; k < space; ++k) {
    Axis& axis = field.info.axes[k];
    if (axis.count < 4) continue;
    std::vector<double> kept;
    for (std::int64_t i = 0; i < axis.count; i += 2) kept.push_back(axis.coordinate(i));
    if (axis.coordinates.empty()) {
      axis.origin = kept[0];
      axis.spacing *= 2;
      axis.first = 0;
    } else {
      axis.coordinates = kept;
    }
    axis.count = static_cast<std::int64_t>(kept.size());
    field.strides[k] *= 2;
  }
  return field;
}

// Of a field that does not fit into memory: every `every`-th sample along the axes of space, a power of two.
class ThinnedSteps final : public StepSource {
 public:
  ThinnedSteps(StepSource& steps, std::int64_t every) : steps_(steps), every_(every) {
    Field whole{steps.info(), nullptr, std::vector<std::int64_t>(steps.info().axes.size(), 1)};
    info_ = thinned(std::move(whole)).info;
  }
  const FieldInfo& info() const override { return info_; }
  // One step at a time.
  Result<Field> read(std::int64_t begin, std::int64_t end) override {
    const std::int64_t step = info_.has_time ? begin : begin * every_;
    auto field = steps_.read(step, step + 1);
    if (!field) return field;
    Field thin = thinned(*std::move(field));
    thin.info.axes.back() = info_.axes.back().cropped(begin, end);
    return thin;
  }

 private:
  Field thinned(Field field) const {
    for (std::int64_t times = 1; times < every_; times *= 2) field = halved(std::move(field));
    return field;
  }

  StepSource& steps_;
  std::int64_t every_;
  FieldInfo info_;
};

std::unique_ptr<Mesh> surface_of(const View& options, const Field& field, double isovalue) {
  ExtractOptions extraction = options.surface.extract_options(options.machine);
  extraction.keep_edges = options.track;
  ProgressBar bar("extract", options.printing.quiet);
  extraction.progress = bar.callback();
  return with_view<lowest_shown>(field, [&](const auto& view) -> std::unique_ptr<Mesh> {
    return std::make_unique<Mesh>(take(extract(view, isovalue, extraction)));
  });
}

std::string fewer_samples(std::uint64_t size, int times) {
  return fmt::format("page would have been larger than {}: it shows every {} sample along each axis of space",
                     byte_size(size), times == 2 ? "second" : fmt::format("{}th", times));
}

// Says in the page and to the caller that samples were left out.
void tell_fewer_samples(const View& options, std::uint64_t size, int times, Content& content) {
  const std::string what = fewer_samples(size, times);
  content.page.notes.push_back("The " + what + ".");
  if (!options.printing.quiet) print_warning("the " + what);
}

// Fails where samples must not be left out, as the tracks of a folder would not be those of what is left.
void check_fewer_samples(const View& options, std::uint64_t size) {
  if (options.folder)
    fail_usage(text("the page would be larger than ", byte_size(size),
                    ", and fewer samples have other tracks than ", options.folder->path,
                    "; give a higher limit by --max-size"));
}

double expected_bytes(const Content& content) {
  return bytes_of_viewer + bytes_per_simplex * static_cast<double>(content.mesh->simplex_count());
}

// Takes fewer samples until the page of the surface should fit.
void fit(const View& options, std::uint64_t size, double isovalue, Field& field, Content& content) {
  int times = 1;
  for (int halving = 0; halving < most_halvings; ++halving) {
    if (expected_bytes(content) <= static_cast<double>(size)) break;
    check_fewer_samples(options, size);
    field = halved(std::move(field));
    times *= 2;
    content.mesh = surface_of(options, field, isovalue);
  }
  if (times > 1) tell_fewer_samples(options, size, times, content);
}

void track_components(const View& options, StepSource& steps, Content& content) {
  if (!options.track) return;
  if (!steps.info().has_time) fail_usage("--track: no axis of the field is time; --time-axis names one");
  const TrackOptions tracking = options.tracking.track_options(options.surface, options.machine);
  content.tracking = options.tracking.track(steps, tracking, options.printing.quiet);
  if (options.folder) options.folder->check_tracks(content.tracking);
  take(use_boundary_pieces(content.tracking, steps, tracking));
  content.page.tracking = &content.tracking;
}
void track_components(const View& options, Content& content) {
  FieldSteps steps(content.field);
  track_components(options, steps, content);
}

// What the page says of the field that its surface is of.
void describe(const FieldInfo& info, Content& content) {
  content.page.axes = info.axes;
  content.page.has_time = info.has_time;
  content.page.field_name = info.name;
  content.page.world = info.world;
  if (info.world) transform(*content.mesh, *info.world);
}

// Of a field that does not fit into memory, step by step; the surface has to.
void stream_field(const View& options, std::uint64_t size, SelectedSteps& steps, Content& content) {
  const double isovalue = *content.page.isovalue;
  ExtractOptions extraction = options.surface.extract_options(options.machine);
  extraction.keep_edges = options.track;
  extraction.memory_limit = memory_beside_steps(steps.info(), extraction.memory_limit);
  const Stopwatch watch;
  std::optional<ThinnedSteps> thinned;
  int times = 1;
  for (;; times *= 2) {
    thinned.emplace(steps, times);
    ProgressBar bar("extract", options.printing.quiet);
    extraction.progress = bar.callback();
    content.mesh.reset();
    content.mesh = std::make_unique<Mesh>(take(collect_surface(*thinned, isovalue, extraction)));
    if (expected_bytes(content) <= static_cast<double>(size) || times == 1 << most_halvings) break;
    check_fewer_samples(options, size);
  }
  if (times > 1) tell_fewer_samples(options, size, times, content);
  if (content.mesh->simplex_count() == 0 && !options.printing.quiet)
    print_warning(why_empty(steps, isovalue));
  track_components(options, *thinned, content);
  content.read_seconds = steps.read_seconds();
  content.extract_seconds = watch.seconds() - content.read_seconds;
  describe(thinned->info(), content);
}

Field whole_field(SelectedSteps& steps, const View& options) {
  const ProgressBar bar("read", options.printing.quiet);
  return without_flat_axes(take(steps.read(0, steps.info().axes.back().count)));
}

// One step of a volume is a volume, and so on.
void check_extent(const View& options, const FieldInfo& info) {
  const int dimension = without_flat_axes(info).dimension();
  check_dimension(dimension, lowest_shown, highest_dimension,
                  dimension == info.dimension() ? "the field" : "the field, without its axes of one sample,");
  if (options.track && info.has_time && info.axes.back().count == 1)
    fail_usage("--track: the field has one step, and components are followed from one to the next; give two "
               "or more by --steps");
}

void read_field(const View& options, std::uint64_t size, Content& content) {
  const std::vector<double> isovalues = parse_isovalues(options.tracking.iso);
  if (isovalues.size() != 1) fail_usage("--iso: a page shows one isovalue");
  const ExtractOptions extraction = options.surface.extract_options(options.machine); // told before reading
  SelectedSteps steps(options.input.open(options.machine), options.input);
  const FieldInfo& info = steps.info();
  check_extent(options, info);
  content.page.part = part_of(info);
  steps.leave_out_flat_axes();
  if (options.folder) options.folder->check_field(info);
  content.page.isovalue = isovalues[0];
  const bool of_surface = options.payload.empty() || options.payload == "mesh";
  if (of_surface && info.bytes() > extraction.memory_limit && can_stream(info, extraction))
    return stream_field(options, size, steps, content);
  Field field = whole_field(steps, options);
  content.read_seconds = steps.read_seconds();

  const Stopwatch extracting;
  if (options.payload == "band" || options.payload == "field") {
    content.samples = options.payload == "band" ? PageSamples::band : PageSamples::all;
  } else {
    content.mesh = surface_of(options, field, isovalues[0]);
    const bool too_large = expected_bytes(content) > static_cast<double>(size);
    if (too_large && options.payload.empty() && has_field_pages() &&
        options.surface.method != "barycentric") {
      content.samples = PageSamples::band;
      content.mesh.reset();
    }
  }
  if (content.mesh) fit(options, size, isovalues[0], field, content);
  if (content.mesh && content.mesh->simplex_count() == 0 && !options.printing.quiet)
    print_warning(why_empty(field, isovalues[0]));
  content.field = std::move(field);
  track_components(options, content);
  content.extract_seconds = extracting.seconds();
  if (content.samples) return;
  describe(content.field.info, content);
  content.field = {};
}

void read_surface(const View& options, Content& content) {
  if (!options.tracking.iso.empty()) fail_usage("--iso: the input is a mesh; its isovalue is chosen already");
  if (options.track) fail_usage("--track: the input is a mesh; tracking needs the field");
  const Stopwatch reading;
  content.mesh = std::make_unique<Mesh>(take(read_mesh(options.input.paths[0])));
  content.read_seconds = reading.seconds();
  content.page.axes = axes_of(*content.mesh);
  content.page.has_time = content.mesh->dimension == 4 || content.page.axes.back().name == "t";
}

// Writes the page of a field, of fewer samples until it fits.
void write_samples(const View& options, std::uint64_t size, Content& content) {
  const ExtractOptions extraction = options.surface.extract_options(options.machine);
  FieldPageOptions page;
  page.samples = *content.samples;
  page.method = extraction.method;
  page.inside = extraction.inside;
  page.threads = extraction.threads;
  page.memory_limit = extraction.memory_limit;
  for (int times = 1;; times *= 2) {
    if (times > 1) {
      check_fewer_samples(options, size);
      content.field = halved(std::move(content.field));
      content.page.notes = {"The " + fewer_samples(size, times) + "."};
      track_components(options, content);
    }
    static_cast<PageOptions&>(page) = content.page;
    ProgressBar bar("write", options.printing.quiet);
    page.progress = bar.callback();
    Result<PageSurface> written = write_field_page(content.field, *content.page.isovalue, page, options.path);
    if (!written && written.error().code == Code::invalid_argument && times < 1 << most_halvings) continue;
    content.surface = take(std::move(written));
    if (times > 1 && !options.printing.quiet) print_warning("the " + fewer_samples(size, times));
    if (content.surface.simplices == 0 && !options.printing.quiet)
      print_warning(why_empty(content.field, *content.page.isovalue));
    return;
  }
}

void write_surface(const View& options, Content& content) {
  ProgressBar bar("write", options.printing.quiet);
  content.page.progress = bar.callback();
  take(write_page(*content.mesh, content.page, options.path));
  content.surface = {content.mesh->vertex_count(), content.mesh->simplex_count()};
}

const char* payload_of(const Content& content) {
  if (!content.samples) return "mesh";
  return *content.samples == PageSamples::band ? "band" : "field";
}

constexpr const char* openers[] = {"xdg-open", "open"};

// The system's program that opens files of any kind; empty if there is none.
std::string opener() {
  const char* path = std::getenv("PATH");
  for (const char* name : openers)
    for (const std::string& folder : split(path ? path : "", ':')) {
      const std::string program = (std::filesystem::path(folder) / name).string();
      if (!folder.empty() && access(program.c_str(), X_OK) == 0) return program;
    }
  return {};
}

// Starts the system's program for files of this kind and does not wait for it.
void open_page(const View& options) {
  const std::string program = opener();
  if (program.empty()) {
    if (!options.printing.quiet)
      print_warning(
          text("--open: there is no ", openers[0], " on PATH; open ", options.path, " in a browser"));
    return;
  }
  const std::string page = std::filesystem::absolute(options.path).string();
  const pid_t child = fork();
  if (child == 0) {
    if (fork() == 0) execl(program.c_str(), program.c_str(), page.c_str(), nullptr);
    _exit(exit_failure);
  }
  if (child > 0) waitpid(child, nullptr, 0);
}

void print_outcome(const View& options, const Content& content, double write_seconds) {
  const std::uint64_t bytes = std::filesystem::file_size(options.path);
  const int dimension = content.mesh ? content.mesh->dimension : content.field.info.dimension();
  if (options.printing.json) {
    Json object{
        {"dimension", dimension},
        {"vertices", content.surface.vertices},
        {"simplices", content.surface.simplices},
        {"payload", payload_of(content)},
        {"bytes", bytes},
        {"notes", content.page.notes},
        {"seconds",
         {{"read", content.read_seconds}, {"extract", content.extract_seconds}, {"write", write_seconds}}},
        {"peak_memory_bytes", peak_memory()}};
    if (content.page.isovalue) object["isovalue"] = *content.page.isovalue;
    if (content.page.tracking) object["tracks"] = content.tracking.tracks.size();
    return print_json(object);
  }
  Report report;
  report.add("vertices", grouped(content.surface.vertices));
  report.add(simplex_noun(content.mesh ? content.mesh->simplex_dimension : dimension - 1),
             grouped(content.surface.simplices));
  if (content.page.tracking)
    report.add("tracks",
               fmt::format("{}, {} events", content.tracking.tracks.size(), content.tracking.events.size()));
  report.add("took", fmt::format("{} to read, {} to extract, {} to write", seconds(content.read_seconds),
                                 seconds(content.extract_seconds), seconds(write_seconds)));
  report.add("wrote", fmt::format("{}, {} with the {}; open it in a browser", options.path, byte_size(bytes),
                                  !content.samples                        ? "surface"
                                  : *content.samples == PageSamples::band ? "samples near the surface"
                                                                          : "field"));
  print(report.text());
}

void check_payload(const View& options, bool from_mesh) {
  if (options.payload != "mesh" && options.payload != "band" && options.payload != "field")
    fail_usage(text("--payload: '", options.payload, "' is none of mesh, band and field"));
  if (options.payload == "mesh") return;
  if (from_mesh) fail_usage(text("--payload ", options.payload, ": the input is a mesh, it has no samples"));
  if (options.surface.method == "barycentric")
    fail_usage(text("--payload ", options.payload, ": a page does not extract by --method barycentric"));
  if (!has_field_pages())
    fail_usage(text("--payload ", options.payload,
                    ": this build of hyperiso has no extraction for pages; build it where there is a Clang "
                    "for WebAssembly (docs/dependencies.md), or take --payload mesh"));
}

void check_output(const std::string& path) {
  const std::string suffix = std::filesystem::path(path).extension().string();
  std::error_code failure;
  const bool is_device = path.starts_with("/dev/") || std::filesystem::is_other(path, failure);
  if (suffix != ".html" && suffix != ".htm" && !is_device)
    fail_usage(text("-o: ", path, " does not end in .html, and a page is what view writes"));
}

int run(View options, const CLI::App& verb) {
  check_output(options.path);
  const std::uint64_t size = parse_bytes("--max-size", options.size);
  if (names_folder(options.input)) {
    options.folder = open_tracked_folder(options.input, verb);
    options.folder->choose(options.input, options.tracking, options.surface);
    options.track = true;
  }
  const bool from_mesh = options.input.paths.size() == 1 && is_mesh_file(options.input.paths[0]);
  if (!from_mesh && options.tracking.iso.empty()) fail_usage("--iso is required to view a field");
  if (!options.payload.empty()) check_payload(options, from_mesh);
  Content content;
  if (from_mesh)
    read_surface(options, content);
  else
    read_field(options, size, content);
  content.page.title = title_of(options);
  content.page.colour_by = options.colour_by;
  content.page.size_limit = size;
  const Stopwatch writing;
  if (content.samples)
    write_samples(options, size, content);
  else
    write_surface(options, content);
  print_outcome(options, content, writing.seconds());
  if (options.open) open_page(options);
  return 0;
}

} // namespace

Command view_command(CLI::App& program) {
  auto options = std::make_shared<View>();
  CLI::App* app = program.add_subcommand("view", "one HTML page that plays the surface and cuts it");
  options->input.add_to(
      *app, "; or a mesh that 'hyperiso extract' wrote as .vtu; or a folder that 'hyperiso track' "
            "wrote, and after it the field, if that is no longer where it was");
  app->add_option("--iso", options->tracking.iso, "fields: the isovalue")->type_name("V")->group("Surface");
  options->surface.add_to(*app);
  app->add_option("-o,--output", options->path, "the page, a file that ends in .html")
      ->type_name("PATH")
      ->required()
      ->group("Output");
  app->add_option("--title", options->title, "what it is called; left out: the name of the input")
      ->type_name("TEXT")
      ->group("Output");
  app->add_option("--colour-by", options->colour_by,
                  "colour at first: solid, component, speed, time, track, the name of an axis or of an "
                  "attribute of the mesh; the page offers all of them")
      ->type_name("NAME")
      ->group("Output");
  app->add_flag("--track", options->track,
                "also track the components through time, and show tracks and events under the picture")
      ->group("Output");
  app->add_option(
         "--payload", options->payload,
         "what the page holds: mesh (default: the surface), band (the samples near it, from which the "
         "page extracts the same surface: the smallest) or field (all samples: the page has a slider "
         "for the isovalue). Samples that are not integers of 8 or 16 bits are rounded to 16")
      ->type_name("WHAT")
      ->group("Output");
  app->add_option(
         "--max-size", options->size,
         text("how large the page may be; default ", default_size,
              ". Of a field whose surface would take more, the band is taken; where that is too large as "
              "well, "
              "every second sample (or fourth, ...) along the axes of space, with a warning here and in the "
              "page"))
      ->type_name("SIZE")
      ->group("Output");
  app->add_flag("--open", options->open, "open it in the browser")->group("Output");
  options->printing.add_to(*app);
  options->machine.add_to(*app);
  set_manual(
      *app,
      {{"view INPUT... --iso V -o PAGE.html [options]", "view MESH -o PAGE.html [options]",
        "view FOLDER -o PAGE.html [options]"},
       {"Writes one file that opens in any current browser, without a network: it plays the surface through "
        "time, continuously and exactly, cuts it by any hyperplane of space and time, colours it, reads "
        "points, "
        "saves pictures and slices. One step (--steps 3:4) is shown as the surface that it has in space. "
        "Surfaces of 3D and 4D fields; interval volumes of 2D and 3D fields, "
        "between whose "
        "isovalues the page slides.",
        "A page takes about 5 bytes per tetrahedron, with --payload band 0.3, with --payload field 1 to 2 "
        "per "
        "sample."},
       {{"the water through time, coloured by how fast its surface moves",
         "hyperiso view examples/data/alpha_water_24x24x24x41.nrrd --iso 0.5 --colour-by speed -o "
         "water.html"},
        {"with what merges and parts on the time line",
         "hyperiso view examples/data/alpha_water_24x24x24x41.nrrd --iso 0.5 --track -o tracked.html"},
        {"the same of a folder that track wrote", "hyperiso track examples/data/alpha_water_24x24x24x41.nrrd "
                                                  "--iso 0.5 -o water && hyperiso view water "
                                                  "-o tracked.html"},
        {"how the surface depends on the isovalue, from 0.3 to 0.7",
         "hyperiso interval examples/data/alpha_water_24x24x24x41.nrrd --steps 20:21 --range 0.3:0.7 -o "
         "shell.vtu && hyperiso view shell.vtu -o "
         "shell.html"},
        {"with a slider for the isovalue", "hyperiso view examples/data/alpha_water_24x24x24x41.nrrd --iso "
                                           "0.5 --payload field -o levels.html"}}});
  return {app, [options, app] { return run(*options, *app); }};
}

} // namespace hyperiso::cli
