#pragma once
// Numbers for the edges of a mesh, in the order they are first asked for.

#include "hyperiso/number_array.hpp"

#include <cstdint>
#include <vector>

namespace hyperiso {

// Two vertices of a mesh, lower < upper.
template <class Index>
struct MeshEdge {
  Index lower, upper;
  friend bool operator==(const MeshEdge&, const MeshEdge&) = default;
};

// A hash table with open addressing. `number` is near its last neighbours in memory when asked in the order
// of a mesh, so it costs less than a sort of all edges would.
template <class Index>
class EdgeNumbers {
 public:
  // Puts every edge at its number in `edges`, which must be empty.
  explicit EdgeNumbers(Array<MeshEdge<Index>>& edges) : slots_(1024), edges_(edges) {}

  Index number(MeshEdge<Index> edge) {
    if (edges_.size() * 2 >= slots_.size()) grow();
    std::size_t slot = hash(edge) & (slots_.size() - 1);
    for (;; slot = (slot + 1) & (slots_.size() - 1)) {
      if (slots_[slot].number == 0) {
        edges_.push_back(edge);
        slots_[slot] = {edge, static_cast<Index>(edges_.size())};
      }
      if (slots_[slot].edge == edge) return slots_[slot].number - 1;
    }
  }

 private:
  struct Slot {
    MeshEdge<Index> edge{};
    Index number = 0; // from 1; 0: free
  };

  static std::size_t hash(MeshEdge<Index> edge) {
    const auto mixed = static_cast<std::uint64_t>(edge.lower) * 0x9e3779b97f4a7c15u ^
                       static_cast<std::uint64_t>(edge.upper) * 0xc2b2ae3d27d4eb4fu;
    return static_cast<std::size_t>(mixed ^ mixed >> 32);
  }
  void grow() {
    std::vector<Slot> slots(slots_.size() * 2);
    for (const Slot& old : slots_) {
      if (old.number == 0) continue;
      std::size_t slot = hash(old.edge) & (slots.size() - 1);
      while (slots[slot].number != 0) slot = (slot + 1) & (slots.size() - 1);
      slots[slot] = old;
    }
    slots_ = std::move(slots);
  }

  std::vector<Slot> slots_; // a power of two of them, at most half in use
  Array<MeshEdge<Index>>& edges_;
};

} // namespace hyperiso
