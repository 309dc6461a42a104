// Work shared among threads: nothing is left out, nothing is done twice, and what is thrown comes out.

#include "core/parallel.hpp"

#include <array>
#include <gtest/gtest.h>
#include <new>
#include <numeric>

using namespace hyperiso;

// With fewer numbers than workers, as many, and many more; and with none.
TEST(ShareOut, every_number_once_by_workers_that_there_are) {
  for (const int workers : {1, 2, 7})
    for (const std::size_t count : {0u, 1u, 2u, 7u, 1000u}) {
      std::vector<std::atomic<int>> times(count);
      std::atomic<bool> known_workers = true;
      share_out(workers, count, [&](int worker, std::size_t number) {
        ++times.at(number);
        if (worker < 0 || worker >= workers) known_workers = false;
      });
      EXPECT_TRUE(known_workers);
      for (std::size_t number = 0; number < count; ++number)
        EXPECT_EQ(times[number], 1) << number << " of " << count << " on " << workers;
    }
}

// Units of work may wait for those before them: these have been begun then.
TEST(ShareOut, numbers_are_begun_in_their_order) {
  std::vector<std::size_t> begun;
  share_out(1, 50, [&](int, std::size_t number) { begun.push_back(number); });
  std::vector<std::size_t> ascending(50);
  std::iota(ascending.begin(), ascending.end(), std::size_t{0});
  EXPECT_EQ(begun, ascending);
}

// On whichever thread memory runs out, the caller gets to know, once no thread is at work any more.
TEST(ShareOut, what_a_worker_throws_reaches_the_caller) {
  for (const int workers : {1, 3})
    for (const std::size_t bad : {0u, 99u}) {
      const auto work = [&](int, std::size_t number) {
        if (number == bad) throw std::bad_alloc();
      };
      EXPECT_THROW(share_out(workers, 100, work), std::bad_alloc) << bad << " on " << workers;
    }
}

// Whatever the threads, all are done when the call returns.
TEST(RunTasks, all_are_done_on_fewer_and_on_more_threads) {
  for (const int threads : {1, 2, 9}) {
    std::array<int, 3> done{};
    run_tasks(
        threads, [&] { done[0] = 1; }, [&] { done[1] = 2; }, [&] { done[2] = 3; });
    EXPECT_EQ(done, (std::array<int, 3>{1, 2, 3})) << threads;
  }
}
