// Entries that are kept as they are made: right and valid whatever other threads do and however little fits.
#include "table/entry_cache.hpp"

#include <algorithm>
#include <gtest/gtest.h>
#include <thread>
#include <vector>

using namespace hyperiso;

namespace {

// Bytes that tell the key and have a length of their own.
std::vector<std::uint8_t> bytes_of(std::uint32_t key) {
  std::vector<std::uint8_t> bytes(key % 37);
  for (std::size_t i = 0; i < bytes.size(); ++i) bytes[i] = static_cast<std::uint8_t>(key >> (i % 4 * 8));
  return bytes;
}

// Asks for `keys` keys in an order that a seed gives; returns how many had to be made.
int ask(EntryCache<std::uint32_t>& cache, std::uint32_t keys, std::uint32_t seed) {
  EntryCache<std::uint32_t>::Reader reader(cache);
  int made = 0;
  std::vector<std::uint8_t> bytes;
  for (std::uint32_t i = 0; i < keys; ++i) {
    const std::uint32_t key = (i * 2654435761u ^ seed) % keys;
    const auto entry = reader.entry(key, [&]() -> std::span<const std::uint8_t> {
      ++made;
      return bytes = bytes_of(key);
    });
    EXPECT_TRUE(std::ranges::equal(entry, bytes_of(key))) << key;
  }
  return made;
}

} // namespace

TEST(EntryCache, makes_each_entry_once_while_there_is_room) {
  EntryCache<std::uint32_t> cache(1 << 20);
  EXPECT_GT(ask(cache, 4096, 0), 1000);
  EXPECT_EQ(ask(cache, 4096, 0), 0);
}

// Little room: entries go and are made again; none is wrong, none grows the cache.
TEST(EntryCache, starts_anew_when_full) {
  for (const std::size_t limit : {0, 40, 100, 1000, 10000}) {
    EntryCache<std::uint32_t> cache(limit);
    EXPECT_GT(ask(cache, 4096, 0), 0);
    EXPECT_GT(ask(cache, 4096, 0), 0) << "not all fit into " << limit << " bytes";
  }
}

TEST(EntryCache, many_threads_at_once) {
  for (const std::size_t limit : {2000, 1 << 20}) {
    EntryCache<std::uint32_t> cache(limit);
    std::vector<std::thread> threads;
    for (std::uint32_t seed = 0; seed < 4; ++seed)
      threads.emplace_back([&, seed] { ask(cache, 4096, seed * 7919); });
    for (std::thread& thread : threads) thread.join();
  }
}

// Another reader that starts the cache anew does not take an entry away.
TEST(EntryCache, an_entry_stays_until_its_reader_asks_again) {
  EntryCache<std::uint32_t> cache(1000);
  EntryCache<std::uint32_t>::Reader reader(cache);
  const auto made = bytes_of(36);
  const auto entry = reader.entry(36, [&]() -> std::span<const std::uint8_t> { return made; });
  ask(cache, 4096, 0);
  EXPECT_TRUE(std::ranges::equal(entry, bytes_of(36)));
}
