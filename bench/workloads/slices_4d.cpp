// Cuts of one surface, prepared by an index: millions of triangles a second on one core.

#include "clock.hpp"

#include "hyperiso/sample.hpp"
#include "hyperiso/slice.hpp"

#include <algorithm>
#include <benchmark/benchmark.h>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <map>

namespace hyperiso::bench {
namespace {

constexpr int planes = 40, repetitions = 3;

struct Surface {
  SimplexMesh<4> mesh;
  SliceIndex<4> index;
};

Surface make_surface(const std::string& name, const std::vector<std::int64_t>& dims) {
  SampleOptions sample;
  sample.dims = dims;
  const auto field = make_sample(name, sample);
  if (!field) std::fprintf(stderr, "%s\n", field.error().message.c_str()), std::exit(1);
  auto mesh = extract(field->view<float, 4>(), sample_isovalue(name, sample));
  if (!mesh) std::fprintf(stderr, "%s\n", mesh.error().message.c_str()), std::exit(1);
  SliceIndex<4> index(*mesh);
  return {*std::move(mesh), std::move(index)};
}

// Planes from one end of the surface to the other.
std::vector<Hyperplane<4>> planes_along(const SimplexMesh<4>& mesh, const std::array<double, 4>& normal) {
  double low = HUGE_VAL, high = -HUGE_VAL;
  for (std::size_t vertex = 0; vertex < mesh.vertex_count(); ++vertex) {
    double along = 0;
    for (std::size_t k = 0; k < 4; ++k) along += normal[k] * mesh.positions[vertex * 4 + k];
    low = std::min(low, along);
    high = std::max(high, along);
  }
  std::vector<Hyperplane<4>> result;
  for (int i = 0; i < planes; ++i) result.push_back({normal, low + (high - low) * (i + 0.4999) / planes});
  return result;
}

void run(benchmark::State& state, const std::string& name, const std::vector<std::int64_t>& dims,
         const std::array<double, 4>& normal, bool welded) {
  static std::map<std::string, Surface> surfaces; // as long as they are asked for, one after the other
  if (!surfaces.contains(name)) {
    surfaces.clear();
    surfaces.emplace(name, make_surface(name, dims));
  }
  const auto& [mesh, index] = surfaces.at(name);
  const auto cuts = planes_along(mesh, normal);
  SliceOptions options;
  options.welded = welded;
  SimplexMesh<3> cut;
  double fastest = HUGE_VAL, triangles = 0;
  for (auto _ : state) {
    for (int repetition = 0; repetition < repetitions; ++repetition) {
      triangles = 0;
      const Clock clock;
      for (const Hyperplane<4>& plane : cuts) {
        if (!index.slice_into(mesh, plane, options, cut)) std::exit(1);
        triangles += static_cast<double>(cut.simplex_count());
      }
      fastest = std::min(fastest, clock.seconds());
    }
    state.SetIterationTime(fastest);
  }
  state.counters["threads"] = 1;
  state.counters["cut"] = static_cast<double>(mesh.simplex_count()) / 1e6;
  state.counters["triangles"] = triangles / planes;
  state.counters["rate"] = triangles / fastest / 1e6;
  state.counters["slices"] = planes / fastest;
}

int add(const std::string& name, const std::vector<std::int64_t>& dims) {
  const std::pair<const char*, std::array<double, 4>> directions[] = {
      {"at a time", {0, 0, 0, 1}}, {"across x", {1, 0, 0, 0}}, {"oblique", {0.5, 0.3, -0.4, 0.7}}};
  for (const auto& [direction, normal] : directions)
    for (const bool welded : {true, false}) {
      const std::string title = name + " cut " + direction + (welded ? "" : ", unshared") + ", 1";
      benchmark::RegisterBenchmark(
          title.c_str(),
          [=, along = normal](benchmark::State& state) { run(state, name, dims, along, welded); })
          ->Iterations(1)
          ->UseManualTime();
    }
  return 0;
}

[[maybe_unused]] const int added[] = {add("gyroid", {48, 48, 48, 24}), add("gaussians", {96, 96, 96, 32})};

} // namespace
} // namespace hyperiso::bench
