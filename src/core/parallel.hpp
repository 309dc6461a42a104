#pragma once
// Work on several threads.

#include <algorithm>
#include <atomic>
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

// Calls work(worker, number) once for each number 0, ..., count - 1. They are begun in this order, each by
// the first of at most `workers` that is free. Rethrows the first exception.
template <class Work>
void share_out(int workers, std::size_t count, Work&& work) {
  std::atomic<std::size_t> next = 0;
  const std::size_t most = std::max<std::size_t>(count, 1);
  run_workers(static_cast<int>(std::min(static_cast<std::size_t>(workers), most)), [&](int worker) {
    for (std::size_t number; (number = next++) < count;) work(worker, number);
  });
}

// Calls tasks that do not depend on each other, begun in their order, on so many threads. Rethrows the first
// exception.
template <class... Tasks>
void run_tasks(int threads, Tasks&&... tasks) {
  share_out(threads, sizeof...(tasks), [&](int, std::size_t chosen) {
    std::size_t number = 0;
    ((number++ == chosen ? static_cast<void>(tasks()) : static_cast<void>(0)), ...);
  });
}

} // namespace hyperiso
