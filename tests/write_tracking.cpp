// Writes the tracking files of a field with many events, for test_tracking_files.py.
//
//   write_tracking FOLDER BLOBS

#include "hyperiso/track.hpp"
#include "hyperiso/track_files.hpp"

#include <cmath>
#include <cstdlib>
#include <iostream>
#include <random>

namespace {

using namespace hyperiso;

// Blobs on the plane that move, appear and vanish.
Field blobs(int count) {
  FieldInfo info;
  info.type = SampleType::f64;
  info.has_time = true;
  const std::int64_t side = 30 + count / 4, steps = 20;
  for (const char* name : {"x", "y", "t"}) {
    Axis& axis = info.axes.emplace_back();
    axis.name = name;
    axis.count = name[0] == 't' ? steps : side;
  }
  auto made = allocate_field(info);
  auto* sample = reinterpret_cast<double*>(made->samples);
  for (std::int64_t t = 0; t < steps; ++t)
    for (std::int64_t y = 0; y < side; ++y)
      for (std::int64_t x = 0; x < side; ++x) {
        std::mt19937 random(5);
        const auto uniform = [&](double low, double high) {
          return low + (high - low) * (random() / 4294967296.0);
        };
        double sum = 0;
        for (int blob = 0; blob < count; ++blob) {
          const double cx = uniform(0, static_cast<double>(side)) + uniform(-1, 1) * static_cast<double>(t);
          const double cy = uniform(0, static_cast<double>(side)) + uniform(-1, 1) * static_cast<double>(t);
          const double middle = uniform(0, static_cast<double>(steps)), half_life = uniform(3, 14);
          const double size = uniform(1.5, 3);
          const double strength = 1 - std::pow((static_cast<double>(t) - middle) / half_life, 2);
          if (strength > 0)
            sum += strength * std::exp(-(std::pow(static_cast<double>(x) - cx, 2) +
                                         std::pow(static_cast<double>(y) - cy, 2)) /
                                       (2 * size * size));
        }
        *sample++ = sum;
      }
  return made->field;
}

} // namespace

int main(int count, char** words) {
  if (count != 3) return 2;
  FieldSteps steps(blobs(std::atoi(words[2])));
  TrackOptions options;
  options.overlap_threshold = 0.8;
  auto graph = track(steps, 0.5, options);
  if (!graph) return std::cerr << graph.error().message << "\n", 1;
  simplify(*graph, 1, 0.5);
  if (const Status written = write_tracking(*graph, words[1]); !written)
    return std::cerr << written.error().message << "\n", 1;
}
