#include "hyperiso/convert.hpp"

#include "cli/command.hpp"
#include "cli/console.hpp"
#include "cli/failure.hpp"
#include "cli/manual.hpp"
#include "cli/options.hpp"
#include "cli/parse.hpp"
#include "cli/surface.hpp"
#include "core/text.hpp"

#include <memory>

namespace hyperiso::cli {
namespace {

struct ConvertVerb {
  FieldOptions input;
  std::string to, rescale;
  FieldOutputOptions output;
  PrintOptions printing;
  MachineOptions machine;
};

ConvertOptions convert_options(const ConvertVerb& options, SampleType type_of_input) {
  ConvertOptions result;
  result.type = options.to.empty() ? type_of_input : parse_sample_type("--to", options.to);
  if (!options.rescale.empty()) {
    const auto ends = split(options.rescale, ':');
    if (ends.size() != 2) fail_usage(text("--rescale: '", options.rescale, "' is not LOW:HIGH"));
    result.rescale = {parse_number("--rescale", ends[0]), parse_number("--rescale", ends[1])};
  }
  return result;
}

int run(const ConvertVerb& options) {
  const auto reader = options.input.open(options.machine);
  const Selection selection = options.input.selection(reader->info());
  ConvertOptions request = convert_options(options, reader->info().type);
  FieldInfo result = selected(reader->info(), selection);
  result.type = request.type;
  options.output.check(result);
  const Stopwatch reading;
  Field field = read_selection(*reader, selection, options.printing.quiet);
  const double read_seconds = reading.seconds();

  if (request.rescale || request.type != field.info.type) {
    request.memory_limit = options.machine.memory_left();
    ProgressBar bar("convert", options.printing.quiet);
    request.progress = bar.callback();
    Converted converted = take(convert(field, request));
    field = std::move(converted.field);
    if (converted.clamped > 0 && !options.printing.quiet)
      print_warning(text(converted.clamped, " samples lay outside the range of ", name_of(request.type),
                         " and were clamped"));
  }
  const double write_seconds = options.output.write(field, options.printing.quiet);
  if (options.printing.json) {
    print_json(Json{{"dims", dims_of(field.info)},
                    {"type", name_of(field.info.type)},
                    {"seconds", {{"read", read_seconds}, {"write", write_seconds}}}});
    return 0;
  }
  Report report;
  report.add("field", size_and_type(field.info));
  report.add("took", seconds(read_seconds) + " to read, " + seconds(write_seconds) + " to write");
  report.add("wrote", options.output.files_of(field.info));
  print(report.text());
  return 0;
}

} // namespace

Command convert_command(CLI::App& program) {
  auto options = std::make_shared<ConvertVerb>();
  CLI::App* app = program.add_subcommand("convert", "field to field: format, part, steps, type");
  options->input.add_to(*app);
  options->output.add_to(*app);
  app->add_option("--to", options->to,
                  "the type to write: u8, i8, u16, i16, u32, i32, f32 or f64. Integers: the nearest, "
                  "halves to even; what lies outside the range is clamped, with a warning; "
                  "NaN is an error")
      ->type_name("TYPE")
      ->group("Output");
  app->add_option("--rescale", options->rescale,
                  "map LOW to the lowest and HIGH to the highest number of an integer type, or to 0 and 1")
      ->type_name("LOW:HIGH")
      ->group("Output");
  options->printing.add_to(*app);
  options->machine.add_to(*app);
  set_manual(
      *app,
      {{"convert INPUT... -o PATH [options]"},
       {"Writes a field, or the part of it chosen by --crop and --steps, in another format or type. Axes "
        "keep their "
        "names, units and coordinates as far as the format can say them."},
       {{"ten steps of it for ParaView: a .vti each and a series",
         "hyperiso convert examples/data/alpha_water_24x24x24x41.nrrd --steps 10:20 -o water.vti"},
        {"as bytes, 0 to 255 for fractions from 0 to 1",
         "hyperiso convert examples/data/alpha_water_24x24x24x41.nrrd --to u8 --rescale 0:1 -o water.npy"}}});
  return {app, [options] { return run(*options); }};
}

} // namespace hyperiso::cli
