#pragma once
// Work on several threads.

#include <algorithm>
#include <exception>
#include <mutex>
#include <system_error>
#include <thread>
#include <vector>

namespace hyperiso {

// How many workers `threads` asks for: itself, or one per processor if it is 0.
inline int worker_count(int threads) {
  return threads > 0 ? threads : std::max(1, static_cast<int>(std::thread::hardware_concurrency()));
}

// Calls work(worker) for worker = 0, ..., workers - 1, each on a thread of its own, 0 on the calling one, and
// returns when all are done. Where the system refuses a thread the others do without it, so the work must
// be shared out as workers ask for it. Rethrows the first exception.
template <class Work>
void run_workers(int workers, Work&& work) {
  std::mutex mutex;
  std::exception_ptr failure;
  const auto guarded = [&](int worker) {
    try {
      work(worker);
    } catch (...) {
      const std::lock_guard lock(mutex);
      if (!failure) failure = std::current_exception();
    }
  };
  std::vector<std::thread> threads;
  threads.reserve(static_cast<std::size_t>(workers - 1));
  try {
    for (int worker = 1; worker < workers; ++worker) threads.emplace_back(guarded, worker);
  } catch (const std::system_error&) { // no more threads: the ones there are will do
  }
  guarded(0);
  for (std::thread& thread : threads) thread.join();
  if (failure) std::rethrow_exception(failure);
}

} // namespace hyperiso
