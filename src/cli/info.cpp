#include "cli/command.hpp"
#include "cli/console.hpp"
#include "cli/failure.hpp"
#include "cli/manual.hpp"
#include "cli/options.hpp"
#include "cli/surface.hpp"
#include "core/text.hpp"
#include "hyperiso/statistics.hpp"

#include <fmt/format.h>
#include <memory>

namespace hyperiso::cli {
namespace {

constexpr double quantile_shares[] = {0.01, 0.05, 0.25, 0.5, 0.75, 0.95, 0.99};

struct Info {
  FieldOptions input;
  bool header = false;
  PrintOptions printing;
  MachineOptions machine;
};

// One pass over the selected samples, in pieces of some steps, so that no more than a piece is held.
Statistics statistics_of(FieldReader& reader, const Selection& selection, bool quiet) {
  constexpr std::int64_t piece_bytes = 64 << 20;
  const auto [begin, end] = selection.ranges.back();
  const auto step_bytes = static_cast<std::int64_t>(reader.info().bytes()) / reader.info().axes.back().count;
  const std::int64_t steps = std::max<std::int64_t>(1, piece_bytes / std::max<std::int64_t>(1, step_bytes));
  StatisticsCollector collector;
  ProgressBar bar("read", quiet);
  Selection piece = selection;
  for (std::int64_t first = begin; first < end; first += steps) {
    piece.ranges.back() = {first, std::min(first + steps, end)};
    collector.add(read_selection(reader, piece));
    bar.show(static_cast<double>(first - begin) / static_cast<double>(end - begin));
  }
  return std::move(collector).finish();
}

Json json_of(const Axis& axis) {
  Json object{{"name", axis.name}, {"unit", axis.unit}, {"count", axis.count}};
  object["first"] = axis.coordinate(0);
  object["last"] = axis.coordinate(axis.count - 1);
  if (axis.coordinates.empty())
    object["spacing"] = axis.spacing;
  else
    object["coordinates"] = axis.coordinates;
  return object;
}

Json json_of(const FieldInfo& info) {
  Json axes = Json::array();
  for (const Axis& axis : info.axes) axes.push_back(json_of(axis));
  Json object{{"dimension", info.dimension()},
              {"dims", dims_of(info)},
              {"type", name_of(info.type)},
              {"name", info.name},
              {"axes", axes},
              {"has_time", info.has_time},
              {"samples", info.samples()},
              {"bytes", info.bytes()}};
  if (info.world) object["world"] = {{"linear", info.world->linear}, {"offset", info.world->offset}};
  return object;
}

void add_statistics(Json& object, const Statistics& statistics) {
  object["missing"] = statistics.missing;
  object["infinite"] = statistics.infinite;
  object["range"] = statistics.finite() == 0 ? Json() : Json{statistics.minimum, statistics.maximum};
  object["quantiles"] = Json::object();
  object["suggested_isovalues"] = Json::array();
  if (statistics.finite() == 0) return;
  for (const double share : quantile_shares)
    object["quantiles"][shortest(share)] = statistics.quantile(share);
  for (const auto& suggestion : suggest_isovalues(statistics))
    object["suggested_isovalues"].push_back(suggestion.isovalue);
}

std::string coordinates_text(const Axis& axis) {
  std::string text = fmt::format("{:.9g} to {:.9g}", axis.coordinate(0), axis.coordinate(axis.count - 1));
  if (!axis.unit.empty()) text += ' ' + axis.unit;
  return text + (axis.coordinates.empty() ? fmt::format(", every {:.9g}", axis.spacing) : ", uneven");
}

void add_description(Report& report, const FieldInfo& info) {
  report.add("field", (info.name.empty() ? "" : info.name + ", ") + size_and_type(info));
  for (std::size_t axis = 0; axis < info.axes.size(); ++axis) {
    const bool time = info.has_time && axis + 1 == info.axes.size();
    report.add(fmt::format("axis {}", axis),
               fmt::format("{:<2} {:>6} samples, {}{}", name_of_axis(info.axes, axis), info.axes[axis].count,
                           coordinates_text(info.axes[axis]), time ? " (time)" : ""));
  }
  if (info.world)
    report.add("world",
               "the file maps these coordinates to world coordinates; surfaces are written in those");
  report.add("memory", byte_size(info.bytes()));
}

void add_statistics(Report& report, const Statistics& statistics) {
  report.add("no data",
             grouped(statistics.missing) + " NaN" +
                 (statistics.infinite > 0 ? ", " + grouped(statistics.infinite) + " infinite" : ""));
  if (statistics.finite() == 0) return report.add("range", "no finite sample");
  report.add("range", fmt::format("{:.9g} to {:.9g}", statistics.minimum, statistics.maximum));
  std::string quantiles;
  for (const double share : quantile_shares)
    quantiles += fmt::format("{}{:g} %: {:.4g}", quantiles.empty() ? "" : ", ", share * 100,
                             statistics.quantile(share));
  report.add("quantiles", quantiles);
  for (const auto& suggestion : suggest_isovalues(statistics))
    report.add("isovalue?", fmt::format("{:<8} {}", suggestion.isovalue, suggestion.reason));
}

int run(const Info& options) {
  const auto reader = options.input.open(options.machine);
  const Selection selection = options.input.selection(reader->info());
  const FieldInfo info = selected(reader->info(), selection);
  std::optional<Statistics> statistics;
  if (!options.header) statistics = statistics_of(*reader, selection, options.printing.quiet);
  if (options.printing.json) {
    Json object = json_of(info);
    if (statistics) add_statistics(object, *statistics);
    print_json(object);
    return 0;
  }
  Report report;
  add_description(report, info);
  if (statistics) add_statistics(report, *statistics);
  print(report.text());
  return 0;
}

} // namespace

Command info_command(CLI::App& program) {
  auto options = std::make_shared<Info>();
  CLI::App* app =
      program.add_subcommand("info", "what a field holds: axes, type, range, suggested isovalues");
  options->input.add_to(*app);
  app->add_flag("--header", options->header, "only what the header says; no sample is read")->group("Output");
  options->printing.add_to(*app);
  options->machine.add_to(*app);
  set_manual(*app, {{"info INPUT... [options]"},
                    {"Describes a field: its axes and their coordinates, its type, the range and the "
                     "quantiles of its samples, how many "
                     "are NaN (no data) or infinite, and isovalues worth a try. Quantiles are exact up to a "
                     "million samples, and of a "
                     "million drawn at random above that."},
                    {{"a file", "hyperiso info examples/data/alpha_water_24x24x24x41.nrrd"},
                     {"one corner of it at the first ten steps, for a script",
                      "hyperiso info examples/data/alpha_water_24x24x24x41.nrrd --crop 0:8,0:8,0:8 --steps "
                      "0:10 --json"}}});
  return {app, [options] { return run(*options); }};
}

} // namespace hyperiso::cli
