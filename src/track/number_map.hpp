#pragma once
// Numbers for keys, given as they come.

#include <cstdint>
#include <utility>
#include <vector>

namespace hyperiso::track_detail {

// Open addressing, at most half full. Keys are less than 2^64 - 1.
class NumberMap {
 public:
  // Makes room for so many keys.
  void reserve(std::size_t count) {
    while (2 * count > entries_.size()) grow();
  }
  // The number of a key, `number` if it is new; and whether it is.
  std::pair<std::uint32_t, bool> insert(std::uint64_t key, std::uint32_t number) {
    if (2 * (count_ + 1) > entries_.size()) grow();
    Entry& entry = entries_[place_of(key)];
    if (entry.key == key) return {entry.number, false};
    entry = {key, number};
    ++count_;
    return {number, true};
  }

 private:
  static constexpr std::uint64_t none = UINT64_MAX;
  struct Entry {
    std::uint64_t key = none;
    std::uint32_t number = 0;
  };

  std::size_t place_of(std::uint64_t key) const {
    const std::size_t mask = entries_.size() - 1;
    std::size_t place = (key * 0x9e3779b97f4a7c15u) >> 32 & mask;
    while (entries_[place].key != none && entries_[place].key != key) place = (place + 1) & mask;
    return place;
  }
  void grow() {
    std::vector<Entry> before(entries_.empty() ? 64 : 2 * entries_.size());
    before.swap(entries_);
    for (const Entry& entry : before)
      if (entry.key != none) entries_[place_of(entry.key)] = entry;
  }

  std::vector<Entry> entries_;
  std::size_t count_ = 0;
};

} // namespace hyperiso::track_detail
