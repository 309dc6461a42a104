// Prints a table: what each workload costs, beside the roof measured in the same run, and what others need.
//
// All times are the fastest of the repetitions. "warm" extracts into a mesh that has the memory, with a
// workspace, "fresh" into new ones; peers are compared with fresh, in three dimensions without the numbers of
// grid edges, which they do not give either. Select rows as in any Google Benchmark program:
// --benchmark_filter=REGEX.

#include "clock.hpp"
#include "jobs.hpp"
#include "peers.hpp"
#include "roof.hpp"
#include "workload.hpp"

#include "core/parallel.hpp"
#include "extract/reference.hpp"
#include "hyperiso/sample.hpp"

#include <benchmark/benchmark.h>
#include <cstdio>
#include <map>
#include <span>

namespace hyperiso::bench {
namespace {

constexpr double least_seconds = 2; // of repetitions for each row
constexpr int most_repetitions = 200;

// A column of the table; a row has a number for it or not.
struct Column {
  const char* name;
  const char* title;
  int digits;
};
constexpr Column columns[] = {
    {"active", "active %", 1}, {"simplices", "simplices M", 2}, {"warm", "warm ms", 1},
    {"fresh", "fresh ms", 1},  {"cell", "ns/cell", 2},          {"simplex", "ns/simplex", 2},
    {"gigabytes", "GB/s", 1},  {"roof", "x roof", 2},           {"loop", "loop x", 1},
    {"vtk", "VTK x", 1},       {"skimage", "skimage x", 1},     {"gudhi", "GUDHI x", 0},
};
constexpr Column tracking_columns[] = {
    // "all" tetrahedra: of the whole surface
    {"pair", "all tetrahedra per step pair", 0},
    {"extracting", "stream ms", 1},
    {"tracking", "track ms", 1},
    {"ratio", "track / stream", 2},
    {"step", "track ms per step pair", 2},
};
constexpr Column job_columns[] = {{"job", "ms", 2}, {"beside", "beside ms", 2}, {"ratio", "ratio", 2}};
constexpr Column slice_columns[] = {
    {"cut", "M tetrahedra", 2},
    {"triangles", "triangles a slice", 0},
    {"rate", "M triangles/s", 1},
    {"slices", "slices/s", 0},
};

// The field of a workload; the last one is kept, for the rows of one workload follow each other.
const Field& field_of(const Workload& workload, const SampleOptions& options) {
  static std::string title;
  static Field field;
  if (title != workload.title) {
    field = {};
    auto made = make_sample(workload.sample, options);
    if (!made)
      std::fprintf(stderr, "%s: %s\n", workload.title.c_str(), made.error().message.c_str()), std::exit(1);
    field = *made;
    title = workload.title;
  }
  return field;
}

template <class T, int D>
void time_peers(benchmark::State& state, const Workload& workload, const FieldView<const T, D>& field,
                double isovalue, const ExtractOptions& options, double fresh) {
  if (options.threads == 1) {
    const Clock clock;
    benchmark::DoNotOptimize(extract_reference(field, isovalue, options));
    state.counters["loop"] = clock.seconds() / fresh;
  }
  if constexpr (std::is_same_v<T, float> && D == 3) {
    ExtractOptions alike = options;
    alike.keep_edges = false;
    fresh = fastest_seconds([&] { benchmark::DoNotOptimize(extract(field, isovalue, alike)); }, 40);
    const auto dims = field.dims();
    const Volume volume{field.samples,
                        {static_cast<int>(dims[0]), static_cast<int>(dims[1]), static_cast<int>(dims[2])}};
    if (const auto seconds = vtk_flying_edges_seconds(volume, isovalue, options.threads))
      state.counters["vtk"] = *seconds / fresh;
    if (options.threads == 1)
      if (const auto seconds = skimage_marching_cubes_seconds(volume, isovalue))
        state.counters["skimage"] = *seconds / fresh;
  }
  if (D == 4 && workload.sample == "ball" && options.threads == 1)
    if (const auto seconds = gudhi_manifold_tracing_seconds(static_cast<int>(workload.dims[0])))
      state.counters["gudhi"] = *seconds / fresh;
}

template <class T, int D>
void run(benchmark::State& state, const Workload& workload, int threads) {
  SampleOptions sample;
  sample.dims = workload.dims;
  sample.type = workload.type;
  sample.blobs = workload.blobs;
  if (workload.sample == "ball") sample.time = false;
  const FieldView<const T, D> field = field_of(workload, sample).view<T, D>();
  const double isovalue =
      workload.isovalue != -1 ? workload.isovalue : sample_isovalue(workload.sample, sample);
  ExtractOptions options;
  options.method = workload.method;
  options.threads = threads;

  ExtractOptions again = options;
  Workspace workspace;
  again.workspace = &workspace;
  SimplexMesh<D> mesh;
  (void)extract_into(field, isovalue, again, mesh); // makes the tables and the memory
  const std::size_t input_bytes = static_cast<std::size_t>(field.grid.samples()) * sizeof(T);
  const std::size_t output_bytes =
      mesh.positions.bytes() + mesh.edges.size() * sizeof(GridEdge) + mesh.simplices.bytes();
  Buffer output;
  output.reset(output_bytes + 64);

  double warm = HUGE_VAL, fresh = HUGE_VAL, roof = HUGE_VAL;
  const Clock all;
  for (auto _ : state) {
    for (int repetition = 0;
         repetition < most_repetitions && (repetition < 3 || all.seconds() < least_seconds); ++repetition) {
      const Clock warm_clock;
      (void)extract_into(field, isovalue, again, mesh);
      warm = std::min(warm, warm_clock.seconds());
      roof = std::min(roof, roof_seconds(field.samples, input_bytes, output.data(), output_bytes, threads));
      const Clock fresh_clock;
      auto new_mesh = extract(field, isovalue, options);
      fresh = std::min(fresh, fresh_clock.seconds());
    }
    state.SetIterationTime(warm);
  }

  double cells = 1;
  for (const std::int64_t count : field.dims()) cells *= static_cast<double>(count - 1);
  const auto simplices = static_cast<double>(mesh.simplex_count());
  auto& counters = state.counters;
  counters["threads"] = threads;
  counters["active"] = 100 * static_cast<double>(mesh.active_cells) / cells;
  counters["simplices"] = simplices / 1e6;
  counters["warm"] = 1e3 * warm;
  counters["fresh"] = 1e3 * fresh;
  counters["cell"] = 1e9 * warm / cells;
  counters["simplex"] = 1e9 * warm / simplices;
  counters["gigabytes"] = 1e-9 * static_cast<double>(input_bytes + output_bytes) / warm;
  counters["roof"] = warm / roof;
  if (workload.peers) time_peers(state, workload, field, isovalue, options, fresh);
}

void run_workload(benchmark::State& state, const Workload& workload, int threads) {
  visit_sample_type(workload.type, [&](auto type) {
    using T = decltype(type);
    switch (workload.dims.size()) {
    case 2:
      return run<T, 2>(state, workload, threads);
    case 3:
      return run<T, 3>(state, workload, threads);
    default:
      return run<T, 4>(state, workload, threads);
    }
  });
}

// Prints Markdown tables, a row when it is done: of extraction, of tracking, and of other jobs.
class TableReporter : public benchmark::BenchmarkReporter {
 public:
  bool ReportContext(const Context&) override { return true; }
  void ReportRuns(const std::vector<Run>& runs) override {
    for (const Run& row : runs) {
      const std::span<const Column> wanted =
          row.counters.contains("tracking") ? std::span<const Column>(tracking_columns)
          : row.counters.contains("slices") ? std::span<const Column>(slice_columns)
          : row.counters.contains("job")    ? std::span<const Column>(job_columns)
                                            : std::span<const Column>(columns);
      if (wanted.data() != table_.data()) start(wanted);
      const std::string title = row.run_name.function_name;
      std::printf("| %s | %.0f |", title.substr(0, title.rfind(',')).c_str(),
                  row.counters.at("threads").value);
      for (const Column& column : table_) {
        const auto found = row.counters.find(column.name);
        if (found == row.counters.end())
          std::printf(" |");
        else
          std::printf(" %.*f |", column.digits, found->second.value);
      }
      std::printf("\n");
      std::fflush(stdout);
    }
  }

 private:
  void start(std::span<const Column> wanted) {
    std::printf("%s| workload | threads |", table_.empty() ? "" : "\n");
    table_ = wanted;
    for (const Column& column : table_) std::printf(" %s |", column.title);
    std::printf("\n| --- | --: |");
    for (std::size_t i = 0; i < table_.size(); ++i) std::printf(" --: |");
    std::printf("\n");
  }

  std::span<const Column> table_; // that was begun
};

} // namespace

int add_workload(Workload workload) {
  const int all = worker_count(0);
  for (int threads = 1; threads <= all; threads = threads < all ? all : all + 1)
    benchmark::RegisterBenchmark(
        (workload.title + ", " + std::to_string(threads)).c_str(),
        [workload, threads](benchmark::State& state) { run_workload(state, workload, threads); })
        ->Iterations(1)
        ->UseManualTime();
  return 0;
}

} // namespace hyperiso::bench

int main(int argc, char** argv) {
  benchmark::Initialize(&argc, argv);
  hyperiso::bench::TableReporter reporter;
  benchmark::RunSpecifiedBenchmarks(&reporter);
  benchmark::Shutdown();
}
