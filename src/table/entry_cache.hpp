#pragma once
// Entries of a table that is too large to be made whole, kept as they are made.

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <mutex>
#include <span>
#include <utility>
#include <vector>

namespace hyperiso {

// Lists of bytes by a number, for many threads. A list that is there is found without a lock; a new one is
// made outside the lock and then entered. When the limit is reached the cache starts anew: what is still in
// use is made again, once, while data that has come and gone leaves nothing behind. The old entries live on
// until the last reader that uses them moves to the new ones, which it does at its next miss.
template <class Key>
class EntryCache {
  struct Generation;

 public:
  // Keeps `byte_limit` bytes of entries at most, of each generation.
  explicit EntryCache(std::size_t byte_limit)
      : byte_limit_(byte_limit), generation_(std::make_shared<Generation>(slots_for(byte_limit))) {}

  // One thread's way in.
  class Reader {
   public:
    explicit Reader(EntryCache& cache) : cache_(&cache), generation_(cache.current()) {}

    // The list of `key`, made by `make()`, a span of bytes, if it is not there. Valid until the next call.
    template <class Make>
    std::span<const std::uint8_t> entry(Key key, Make&& make) {
      if (const Entry* found = generation_->find(key)) return found->bytes();
      const std::span<const std::uint8_t> made = make();
      for (;;) {
        if (const Entry* kept = generation_->insert(key, made, cache_->byte_limit_)) return kept->bytes();
        if (generation_->is_empty()) return made; // larger than all that may be kept
        generation_ = cache_->successor_of(generation_);
      }
    }

   private:
    EntryCache* cache_;
    std::shared_ptr<Generation> generation_;
  };

 private:
  struct Entry { // followed by its bytes
    Key key;
    std::uint32_t size;
    std::span<const std::uint8_t> bytes() const {
      return {reinterpret_cast<const std::uint8_t*>(this + 1), size};
    }
  };

  struct Generation {
    explicit Generation(std::size_t slot_count)
        : slots(std::make_unique<std::atomic<const Entry*>[]>(slot_count)), mask(slot_count - 1) {}

    const Entry* find(Key key) const {
      for (std::size_t slot = first_slot(key);; slot = (slot + 1) & mask) {
        const Entry* entry = slots[slot].load(std::memory_order_acquire);
        if (entry == nullptr || entry->key == key) return entry;
      }
    }
    // The entry with a copy of the bytes, or the one that another thread has made; null if there is no room.
    const Entry* insert(Key key, std::span<const std::uint8_t> bytes, std::size_t byte_limit) {
      const std::lock_guard lock(mutex);
      if (const Entry* other = find(key)) return other;
      const std::size_t needed =
          (sizeof(Entry) + bytes.size() + alignof(Entry) - 1) / alignof(Entry) * alignof(Entry);
      if (used + needed > byte_limit || 2 * count > mask) return nullptr;
      auto* entry = new (room(needed)) Entry{key, static_cast<std::uint32_t>(bytes.size())};
      std::ranges::copy(bytes, reinterpret_cast<std::uint8_t*>(entry + 1));
      std::size_t slot = first_slot(key);
      while (slots[slot].load(std::memory_order_relaxed) != nullptr) slot = (slot + 1) & mask;
      slots[slot].store(entry, std::memory_order_release);
      used += needed;
      ++count;
      return entry;
    }
    bool is_empty() {
      const std::lock_guard lock(mutex);
      return count == 0;
    }
    void* room(std::size_t bytes) {
      if (bytes > room_left) {
        room_left = std::max(bytes, block_bytes);
        blocks.push_back(std::make_unique_for_overwrite<std::byte[]>(room_left));
        next_room = blocks.back().get();
      }
      room_left -= bytes;
      return std::exchange(next_room, next_room + bytes);
    }
    std::size_t first_slot(Key key) const {
      const std::uint64_t hash = std::uint64_t{key} * 0x9e3779b97f4a7c15; // 2^64 over the golden ratio
      return (hash >> 24) & mask;
    }

    static constexpr std::size_t block_bytes = 64 * 1024;

    std::unique_ptr<std::atomic<const Entry*>[]> slots;
    const std::size_t mask;
    std::mutex mutex; // of all below
    std::vector<std::unique_ptr<std::byte[]>> blocks;
    std::byte* next_room = nullptr;
    std::size_t room_left = 0, used = 0, count = 0;
  };

  // A slot for every 128 bytes, of which at most half are used: entries are larger than that on average.
  static std::size_t slots_for(std::size_t byte_limit) {
    std::size_t slots = 16;
    while (slots < byte_limit / 128) slots *= 2;
    return slots;
  }

  std::shared_ptr<Generation> current() {
    const std::lock_guard lock(mutex_);
    return generation_;
  }
  // The generation after a full one.
  std::shared_ptr<Generation> successor_of(const std::shared_ptr<Generation>& full) {
    const std::lock_guard lock(mutex_);
    if (generation_ == full) generation_ = std::make_shared<Generation>(slots_for(byte_limit_));
    return generation_;
  }

  const std::size_t byte_limit_;
  std::mutex mutex_; // of generation_
  std::shared_ptr<Generation> generation_;
};

} // namespace hyperiso
