#pragma once
// What is tracked and how: the options that decide which tracks a field has.

#include "cli/options.hpp"
#include "hyperiso/track.hpp"

#include <string>

namespace hyperiso::cli {

using SeedCells = std::vector<std::vector<std::int64_t>>; // as `track_from_seeds` takes them

// --iso, --range, --track, --overlap, --overlap-volumes, --min-volume, --min-duration
struct TrackingOptions {
  std::string iso, range, tracked, overlap, overlap_volumes, minimum_volume, minimum_duration;

  void add_to(CLI::App& app);
  double isovalue() const; // of a range, its first
  bool of_regions() const { return tracked == "region" || !range.empty(); }
  // With the memory that is left now. Fails if any of the options has no meaning.
  TrackOptions track_options(const SurfaceOptions& surface, const MachineOptions& machine) const;
  // Marks the tracks that are too small or too short.
  void simplify(TrackingGraph& graph) const;
  // Tracks, through these cells alone if there are any, under a progress bar, and simplifies. Fails if the
  // program comes to hold more than the memory limit of the options.
  TrackingGraph track(StepSource& steps, TrackOptions options, bool quiet, const SeedCells& seeds = {}) const;
};

} // namespace hyperiso::cli
