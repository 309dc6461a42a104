#include "jobs.hpp"

#include "clock.hpp"

#include "core/parallel.hpp"

#include <algorithm>
#include <benchmark/benchmark.h>
#include <cmath>

namespace hyperiso::bench {

int add_job(const std::string& title, std::function<JobTimes(int threads)> job, bool one_thread_only) {
  const int all = one_thread_only ? 1 : worker_count(0);
  for (int threads = 1; threads <= all; threads = threads < all ? all : all + 1)
    benchmark::RegisterBenchmark((title + ", " + std::to_string(threads)).c_str(),
                                 [job, threads](benchmark::State& state) {
                                   JobTimes times{};
                                   for (auto _ : state) {
                                     times = job(threads);
                                     state.SetIterationTime(times.seconds);
                                   }
                                   state.counters["threads"] = threads;
                                   state.counters["job"] = 1e3 * times.seconds;
                                   if (times.beside == 0) return;
                                   state.counters["beside"] = 1e3 * times.beside;
                                   state.counters["ratio"] = times.seconds / times.beside;
                                 })
        ->Iterations(1)
        ->UseManualTime();
  return 0;
}

double fastest_seconds(const std::function<void()>& work, int repetitions) {
  double fastest = HUGE_VAL;
  for (int repetition = 0; repetition < repetitions; ++repetition) {
    const Clock clock;
    work();
    fastest = std::min(fastest, clock.seconds());
  }
  return fastest;
}

} // namespace hyperiso::bench
