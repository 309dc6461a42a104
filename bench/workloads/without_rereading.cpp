// A field at one isovalue after another, and slab by slab, beside extracting it whole and alone.

#include "clock.hpp"
#include "jobs.hpp"

#include "hyperiso/sample.hpp"
#include "hyperiso/stream.hpp"

#include <cstdio>
#include <cstdlib>
#include <vector>

namespace hyperiso::bench {
namespace {

struct Given {
  Field field;
  double isovalue;
};
Given gaussians(std::vector<std::int64_t> dims, int blobs) {
  SampleOptions sample;
  sample.dims = std::move(dims);
  sample.blobs = blobs;
  auto field = make_sample("gaussians", sample);
  if (!field) std::fprintf(stderr, "%s\n", field.error().message.c_str()), std::exit(1);
  return {std::move(*field), sample_isovalue("gaussians", sample)};
}

// The next isovalue on the same field, with the ranges that the one before noted down, beside without.
JobTimes time_next_isovalue(const Given& given, int threads) {
  const auto view = given.field.view<float, 4>();
  Workspace workspace;
  FieldRanges ranges;
  SimplexMesh<4> mesh;
  ExtractOptions options;
  options.threads = threads;
  options.workspace = &workspace;
  const double next = 1.1 * given.isovalue;
  const double alone = fastest_seconds([&] { (void)extract_into(view, next, options, mesh); });
  options.ranges = &ranges;
  (void)extract_into(view, given.isovalue, options, mesh);
  return {fastest_seconds([&] { (void)extract_into(view, next, options, mesh); }), alone};
}

// Four isovalues in one call, beside one by one, into fresh memory.
JobTimes time_four_isovalues(const Given& given, int threads) {
  const auto view = given.field.view<float, 4>();
  const double level = given.isovalue;
  const std::vector<double> isovalues{0.8 * level, level, 1.2 * level, 1.4 * level};
  ExtractOptions options;
  options.threads = threads;
  const double together =
      fastest_seconds([&] { (void)extract(view, std::span<const double>(isovalues), options); }, 4);
  const double one_by_one = fastest_seconds(
      [&] {
        std::vector<SimplexMesh<4>> meshes;
        for (const double isovalue : isovalues) meshes.push_back(*extract(view, isovalue, options));
      },
      4);
  return {together, one_by_one};
}

// Slab by slab from memory, beside the whole into a mesh that has the memory.
JobTimes time_stream(const Given& given, int threads) {
  ExtractOptions options;
  options.threads = threads;
  FieldSteps steps(given.field);
  const double streamed = fastest_seconds([&] {
    (void)stream(
        steps, given.isovalue, [](SurfaceSlab&) { return Status{}; }, options);
  });
  SimplexMesh<4> mesh;
  const double whole = fastest_seconds(
      [&] { (void)extract_into(given.field.view<float, 4>(), given.isovalue, options, mesh); });
  return {streamed, whole};
}

[[maybe_unused]] const int added[] = {
    add_job("gaussians 256^3 x 10, the next isovalue",
            [](int threads) {
              return time_next_isovalue(gaussians({256, 256, 256, 10}, 2), threads);
            }),
    add_job("gaussians 256^3 x 10, four isovalues",
            [](int threads) {
              return time_four_isovalues(gaussians({256, 256, 256, 10}, 2), threads);
            }),
    add_job("gaussians 128^3 x 32, 2 % active, the next isovalue",
            [](int threads) {
              return time_next_isovalue(gaussians({128, 128, 128, 32}, 8), threads);
            }),
    add_job("gaussians 128^3 x 32, 2 % active, slab by slab",
            [](int threads) {
              return time_stream(gaussians({128, 128, 128, 32}, 8), threads);
            }),
};

} // namespace
} // namespace hyperiso::bench
