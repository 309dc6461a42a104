#pragma once
// Jobs that are more, or less, than one extraction: what they cost, beside what they are compared with.

#include <functional>
#include <string>

namespace hyperiso::bench {

struct JobTimes {
  double seconds;
  double beside = 0; // of what it is compared with; 0: nothing
};

// Adds the job to a table of its own, on one thread and on all, or on one only. Returns 0.
int add_job(const std::string& title, std::function<JobTimes(int threads)> job, bool one_thread_only = false);

// The fastest of some repetitions.
double fastest_seconds(const std::function<void()>& work, int repetitions = 7);

} // namespace hyperiso::bench
