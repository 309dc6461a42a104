#include "cli/tracking_options.hpp"

#include "cli/console.hpp"
#include "cli/failure.hpp"
#include "cli/parse.hpp"
#include "core/memory.hpp"
#include "core/text.hpp"

#include <fmt/format.h>
#include <optional>

namespace hyperiso::cli {
namespace {

// "0.35" or "35%"
double parse_share(std::string_view option, std::string value) {
  const bool percent = !value.empty() && value.back() == '%';
  if (percent) value.pop_back();
  const double share = parse_number(option, value) / (percent ? 100 : 1);
  if (share < 0 || share >= 1)
    fail_usage(text(option, ": ", share, " is not a share; give one from 0 to 1, or from 0% to 100%"));
  return share;
}

double not_negative(const char* option, const std::string& value) {
  if (value.empty()) return 0;
  const double number = parse_number(option, value);
  if (number < 0) fail_usage(text(option, ": ", number, " is negative"));
  return number;
}

// What is tracked: at one isovalue, or from one to another.
struct Isovalues {
  double first;
  std::optional<double> upper;
};

Isovalues isovalues_of(const TrackingOptions& options) {
  if (options.iso.empty() == options.range.empty()) fail_usage("give either --iso or --range");
  if (!options.iso.empty()) {
    const std::vector<double> isovalues = parse_isovalues(options.iso);
    if (isovalues.size() > 1) fail_usage("--iso: one isovalue is tracked at a time");
    return {isovalues[0], {}};
  }
  if (options.tracked == "surface") fail_usage("--range tracks a region; it cannot go with --track surface");
  const auto colon = options.range.find(':');
  if (colon == std::string::npos) fail_usage(text("--range: '", options.range, "' is not A:B"));
  return {parse_number("--range", options.range.substr(0, colon)),
          parse_number("--range", options.range.substr(colon + 1))};
}

// What a slab holds is known only once it is passed: it is looked at now and then.
class MemoryWatch {
 public:
  // For so many bytes more than the program holds now.
  explicit MemoryWatch(std::uint64_t bytes) {
    const std::uint64_t held = held_memory();
    most_ = bytes < UINT64_MAX - held ? held + bytes : UINT64_MAX;
  }

  bool is_over() {
    constexpr double interval = 0.02; // asking the system takes some 20 microseconds
    if (since_look_.seconds() < interval) return false;
    since_look_ = {};
    return held_memory() > most_;
  }

 private:
  std::uint64_t most_;
  Stopwatch since_look_;
};

// Of the methods: what MachineOptions says comes on top of --memory.
std::uint64_t most_for_tables(const TrackOptions& options, int dimension) {
  return std::uint64_t{options.tracked == Tracked::region && dimension == 4 ? 140u : 20u} << 20;
}

Result<TrackingGraph> graph_of(StepSource& steps, double isovalue, const SeedCells& seeds,
                               const TrackOptions& options) {
  if (seeds.empty()) return hyperiso::track(steps, isovalue, options);
  auto local = track_from_seeds(steps, isovalue, seeds, options);
  if (!local) return local.error();
  return std::move(local->graph);
}

} // namespace

void TrackingOptions::add_to(CLI::App& app) {
  app.add_option("--iso", iso, "the isovalue")->type_name("V")->group("Surface");
  app.add_option("--range", range,
                 "two isovalues: track what lies between them, from one surface to the other")
      ->type_name("A:B")
      ->group("Surface");
  app.add_option("--track", tracked,
                 "surface: components of the isosurface; region: of what is inside it, so that a hollow "
                 "thing is one, not two")
      ->type_name("WHAT")
      ->default_str("surface")
      ->group("Tracks");
  app.add_option(
         "--overlap", overlap,
         "cut tracks where a component and what it is one step later overlap by no more than this share "
         "of the smaller one; 35% is usual")
      ->type_name("SHARE")
      ->group("Tracks");
  app.add_option(
         "--overlap-volumes", overlap_volumes,
         "cells: overlaps count cells by the share of their corners inside; exact: they are volumes of "
         "the piecewise linear field")
      ->type_name("HOW")
      ->default_str("cells")
      ->group("Tracks");
  app.add_option("--min-volume", minimum_volume, "mark tracks that never reach this volume as simplified")
      ->type_name("V")
      ->group("Tracks");
  app.add_option("--min-duration", minimum_duration,
                 "mark tracks that last less as simplified, if they are born, die, or come back to where "
                 "they split off")
      ->type_name("T")
      ->group("Tracks");
}

double TrackingOptions::isovalue() const { return isovalues_of(*this).first; }

TrackOptions TrackingOptions::track_options(const SurfaceOptions& surface,
                                            const MachineOptions& machine) const {
  TrackOptions result;
  result.upper_isovalue = isovalues_of(*this).upper;
  result.extraction = surface.extract_options(machine);
  if (!tracked.empty() && tracked != "surface" && tracked != "region")
    fail_usage(text("--track: '", tracked, "' is neither surface nor region"));
  if (of_regions()) result.tracked = Tracked::region;
  if (overlap_volumes == "exact")
    result.overlap_volumes = OverlapVolumes::exact;
  else if (!overlap_volumes.empty() && overlap_volumes != "cells")
    fail_usage(text("--overlap-volumes: '", overlap_volumes, "' is neither cells nor exact"));
  if (!overlap.empty()) result.overlap_threshold = parse_share("--overlap", overlap);
  for (const auto& [option, value] :
       {std::pair{"--min-volume", &minimum_volume}, {"--min-duration", &minimum_duration}})
    (void)not_negative(option, *value);
  return result;
}

void TrackingOptions::simplify(TrackingGraph& graph) const {
  hyperiso::simplify(graph, not_negative("--min-volume", minimum_volume),
                     not_negative("--min-duration", minimum_duration));
}

TrackingGraph TrackingOptions::track(StepSource& steps, TrackOptions options, bool quiet,
                                     const SeedCells& seeds) const {
  ProgressBar bar("track", quiet);
  const std::uint64_t limit = options.extraction.memory_limit;
  const std::uint64_t tables = most_for_tables(options, steps.info().dimension());
  MemoryWatch watch(limit < UINT64_MAX - tables ? limit + tables : limit);
  double share = 0;
  options.extraction.progress = [&](double done) {
    bar.show(share = done);
    return !watch.is_over();
  };
  auto graph = graph_of(steps, isovalue(), seeds, options);
  if (!graph && graph.error().code == Code::cancelled)
    throw Failure{{Code::out_of_memory,
                   fmt::format("tracking holds more than {}, {:.0f} % of the way through time; a field with "
                               "less noise takes less",
                               byte_size(limit), 100 * share)}};
  if (!graph) throw Failure{graph.error()};
  simplify(*graph);
  return *std::move(graph);
}

} // namespace hyperiso::cli
