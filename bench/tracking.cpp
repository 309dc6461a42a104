#include "tracking.hpp"

#include "jobs.hpp"

#include "core/parallel.hpp"
#include "hyperiso/io.hpp"
#include "hyperiso/sample.hpp"
#include "hyperiso/stream.hpp"

#include <algorithm>
#include <benchmark/benchmark.h>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <filesystem>

namespace hyperiso::bench {
namespace {

constexpr int repetitions = 5;

template <class T>
T require(Result<T> result, const std::string& title) {
  if (!result) std::fprintf(stderr, "%s: %s\n", title.c_str(), result.error().message.c_str()), std::exit(1);
  return std::move(*result);
}

Field make_field(const TrackingWorkload& workload, double& isovalue) {
  SampleOptions options;
  options.dims = workload.dims;
  options.blobs = workload.blobs;
  if (!workload.files.empty()) {
    std::vector<std::filesystem::path> files;
    for (const auto& entry : std::filesystem::directory_iterator(workload.files))
      files.push_back(entry.path());
    std::ranges::sort(files);
    isovalue = *workload.isovalue;
    return require(require(open_field(files), workload.title)->read(), workload.title);
  }
  isovalue = workload.isovalue.value_or(sample_isovalue(workload.sample, options));
  Field field = require(make_sample(workload.sample, options), workload.title);
  if (!workload.percent) return field;
  const auto* samples = reinterpret_cast<const float*>(field.samples.get());
  auto rounded = std::make_shared<std::vector<float>>(samples, samples + field.info.samples());
  for (float& sample : *rounded) sample = std::round(100 * sample);
  isovalue = std::round(100 * isovalue);
  field.samples = {rounded, reinterpret_cast<const std::byte*>(rounded->data())};
  return field;
}

// A cell at the middle step that the surface passes.
std::vector<std::int64_t> seed_cell(const Field& field, double isovalue) {
  const auto view = field.view<float, 4>();
  const auto dims = view.dims();
  std::array<std::int64_t, 4> index{0, dims[1] / 2, dims[2] / 2, dims[3] / 2};
  const bool first = view.at(index) >= isovalue;
  while (index[0] + 2 < dims[0] && (view.at(index) >= isovalue) == first) ++index[0];
  return {index[0] - 1, index[1], index[2], index[3]};
}

void run(benchmark::State& state, const TrackingWorkload& workload, int threads) {
  double isovalue = 0;
  const Field field = make_field(workload, isovalue);
  FieldSteps steps(field);
  TrackOptions options;
  options.extraction.threads = threads;
  const double step_pairs = static_cast<double>(field.info.axes.back().count - 1);

  std::uint64_t simplices = 0;
  const auto count = [&](SurfaceSlab& slab) {
    simplices += slab.mesh.simplex_count();
    return Status{};
  };
  double extracting = 0, tracking = 0;
  for (auto _ : state) {
    extracting = fastest_seconds(
        [&] {
          simplices = 0;
          if (const Status streamed = stream(steps, isovalue, count, options.extraction); !streamed)
            std::fprintf(stderr, "%s: %s\n", workload.title.c_str(), streamed.error().message.c_str()),
                std::exit(1);
        },
        repetitions);
    if (workload.local) {
      const auto cell = seed_cell(field, isovalue);
      tracking = fastest_seconds(
          [&] {
            benchmark::DoNotOptimize(
                require(track_from_seeds(steps, isovalue, {cell}, options), workload.title));
          },
          repetitions);
    } else {
      tracking = fastest_seconds(
          [&] { benchmark::DoNotOptimize(require(track(steps, isovalue, options), workload.title)); },
          repetitions);
    }
    state.SetIterationTime(tracking);
  }
  auto& counters = state.counters;
  counters["threads"] = threads;
  counters["pair"] = static_cast<double>(simplices) / step_pairs;
  counters["extracting"] = 1e3 * extracting;
  counters["tracking"] = 1e3 * tracking;
  counters["ratio"] = tracking / extracting;
  counters["step"] = 1e3 * tracking / step_pairs;
}

} // namespace

int add_tracking_workload(TrackingWorkload workload) {
  if (!workload.files.empty() && !std::filesystem::is_directory(workload.files)) return 0;
  const int all = worker_count(0);
  for (int threads = 1; threads <= all; threads = threads < all ? all : all + 1)
    benchmark::RegisterBenchmark(
        ("track " + workload.title + ", " + std::to_string(threads)).c_str(),
        [workload, threads](benchmark::State& state) { run(state, workload, threads); })
        ->Iterations(1)
        ->UseManualTime();
  return 0;
}

} // namespace hyperiso::bench
