// What the first call of a process pays for: tables. These rows come first, before anything has made them.

#include "clock.hpp"
#include "jobs.hpp"

#include "extract/march_table.hpp"
#include "hyperiso/interval.hpp"
#include "hyperiso/sample.hpp"

#include <benchmark/benchmark.h>
#include <cstdio>
#include <cstdlib>

namespace hyperiso::bench {
namespace {

JobTimes time_4d_table(int) {
  const Clock clock;
  benchmark::DoNotOptimize(march_table<4>(Method::hull, {}).corners.size());
  return {clock.seconds()};
}

JobTimes time_interval(int threads) {
  SampleOptions sample;
  sample.dims = {96, 96, 96, 2};
  const auto field = make_sample("gaussians", sample);
  if (!field) std::fprintf(stderr, "%s\n", field.error().message.c_str()), std::exit(1);
  const double isovalue = sample_isovalue("gaussians", sample);
  IntervalOptions options;
  options.threads = threads;
  const Clock clock;
  benchmark::DoNotOptimize(interval(field->view<float, 4>(), isovalue, 1.2 * isovalue, options));
  return {clock.seconds()};
}

[[maybe_unused]] const int added[] = {
    add_job("4D table", time_4d_table, true),
    add_job("interval of gaussians 96^3 x 2, first 5D cells", time_interval, true),
};

} // namespace
} // namespace hyperiso::bench
