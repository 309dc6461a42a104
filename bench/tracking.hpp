#pragma once
// What tracking costs beside extracting the same surface.

#include "hyperiso/track.hpp"

#include <optional>
#include <string>

namespace hyperiso::bench {

// A sample field, or one on disk: tracked in full, beside `stream` in the same run.
struct TrackingWorkload {
  std::string title;
  std::string sample = {}; // name of the built-in field; empty: that of `files`
  std::vector<std::int64_t> dims = {};
  int blobs = 2;
  std::string files = {}; // a folder with a file for each step; the row is left out where it is missing
  std::optional<double> isovalue = {};
  bool percent = false; // samples are rounded to hundredths, so that many equal the isovalue
  bool local = false;   // the component through the surface's first cell at the middle step instead of all
};

// Adds the workload to the second table, on one thread and on all. Returns 0.
int add_tracking_workload(TrackingWorkload workload);

} // namespace hyperiso::bench
