#include "hyperiso/sample.hpp"

#include "cli/command.hpp"
#include "cli/console.hpp"
#include "cli/failure.hpp"
#include "cli/manual.hpp"
#include "cli/options.hpp"
#include "cli/parse.hpp"
#include "cli/surface.hpp"
#include "core/text.hpp"
#include "hyperiso/io.hpp"

#include <fmt/format.h>
#include <memory>

namespace hyperiso::cli {
namespace {

struct Sample {
  std::string name, dims = "64,64,64,32", type = "f32", blobs, seed;
  bool list = false, time = false, no_time = false;
  FieldOutputOptions output;
  PrintOptions printing;
  MachineOptions machine;
};

void print_list(bool json) {
  Json list = Json::array();
  std::string lines;
  for (const SampleField& field : sample_fields()) {
    list.push_back({{"name", field.name}, {"description", field.description}, {"isovalue", field.isovalue}});
    lines += fmt::format("{:<16} {:<72} isovalue {}\n", field.name, field.description, field.isovalue);
  }
  json ? print_json(Json{{"fields", list}}) : print(lines);
}

SampleOptions sample_options(const Sample& options) {
  SampleOptions result;
  result.dims = parse_counts("--dims", options.dims);
  result.type = parse_sample_type("--type", options.type);
  if (options.time && options.no_time) fail_usage("give one of --time and --no-time");
  if (options.time || options.no_time) result.time = options.time;
  if (!options.blobs.empty()) {
    const std::int64_t blobs = parse_integer("--blobs", options.blobs);
    if (blobs > 1'000'000) fail_usage("--blobs: at most a million");
    result.blobs = static_cast<int>(blobs);
  }
  if (!options.seed.empty()) result.seed = static_cast<std::uint64_t>(parse_integer("--seed", options.seed));
  result.memory_limit = options.machine.memory_left();
  return result;
}

int run(const Sample& options) {
  if (options.list) return print_list(options.printing.json), 0;
  if (options.name.empty()) fail_usage("which field? 'hyperiso sample --list' names them");
  SampleOptions request = sample_options(options);
  options.output.check(take(describe_sample(options.name, request)));

  const Stopwatch computing;
  std::optional<Field> field;
  {
    ProgressBar bar("sample", options.printing.quiet);
    request.progress = bar.callback();
    field = take(make_sample(options.name, request));
  }
  const double compute_seconds = computing.seconds();
  const double write_seconds = options.output.write(*field, options.printing.quiet);
  const double isovalue = sample_isovalue(options.name, request);
  if (options.printing.json) {
    print_json(Json{{"name", options.name},
                    {"dims", dims_of(field->info)},
                    {"type", name_of(field->info.type)},
                    {"isovalue", isovalue},
                    {"seconds", {{"compute", compute_seconds}, {"write", write_seconds}}}});
    return 0;
  }
  Report report;
  report.add("field", options.name + ", " + size_and_type(field->info));
  report.add("isovalue", shortest(isovalue) + " shows the shape");
  report.add("took", seconds(compute_seconds) + " to compute, " + seconds(write_seconds) + " to write");
  report.add("wrote", options.output.files_of(field->info));
  print(report.text());
  return 0;
}

} // namespace

Command sample_command(CLI::App& program) {
  auto options = std::make_shared<Sample>();
  CLI::App* app = program.add_subcommand("sample", "built-in sample fields, written as a field file");
  std::string names;
  for (const SampleField& field : sample_fields())
    names += (names.empty() ? "" : ", ") + std::string(field.name);
  app->add_option("NAME", options->name, "the field: " + names)->group("Input");
  app->add_flag("--list", options->list, "say what the fields are, with an isovalue for each")
      ->group("Input");
  app->add_option("--dims", options->dims, "samples along each of 2 to 8 axes, x first; default 64,64,64,32")
      ->type_name("N,N,...")
      ->group("Input");
  app->add_option("--type", options->type,
                  "u8, i8, u16, i16, u32, i32, f32 (default) or f64; integers hold the field scaled to all "
                  "of their range")
      ->type_name("TYPE")
      ->group("Input");
  app->add_flag("--time", options->time, "the last axis is time")->group("Input");
  app->add_flag("--no-time", options->no_time,
                "all axes are space; left out, the last of 4 or more axes is time")
      ->group("Input");
  app->add_option("--blobs", options->blobs, "gaussians: how many; default 2")
      ->type_name("N")
      ->group("Input");
  app->add_option("--seed", options->seed, "noise, and where more than two blobs start; default 1")
      ->type_name("N")
      ->group("Input");
  options->output.add_to(*app);
  options->printing.add_to(*app);
  options->machine.add_to(*app);
  set_manual(*app, {{"sample NAME --dims N,N,... -o PATH [options]", "sample --list"},
                    {"Known shapes in any dimension, to try things on. Axes of space go from -1 to 1, time "
                     "from 0 to 1 (torus-morph: to "
                     "2). The same options give the same file every time."},
                    {{"what is there?", "hyperiso sample --list"},
                     {"a sphere that becomes a torus and then two spheres",
                      "hyperiso sample torus-morph --dims 32,32,32,21 -o morph.nrrd"},
                     {"", "hyperiso slice morph.nrrd --iso 0.5 --time 0.3,1,1.7 --measure"},
                     {"a ball in a 3D volume of bytes",
                      "hyperiso sample ball --dims 64,64,64 --type u8 -o ball.npy"}}});
  return {app, [options] { return run(*options); }};
}

} // namespace hyperiso::cli
