#pragma once
// Disjoint sets of 0 ... n-1.

#include <cstdint>
#include <numeric>
#include <vector>

namespace hyperiso {

// The representative of a set is its smallest element, whatever the order of the unions.
class UnionFind {
 public:
  explicit UnionFind(std::size_t size) : parent_(size) {
    std::iota(parent_.begin(), parent_.end(), std::uint64_t{0});
  }

  std::uint64_t size() const { return parent_.size(); }
  std::uint64_t add() {
    parent_.push_back(parent_.size());
    return parent_.back();
  }
  std::uint64_t find(std::uint64_t element) {
    while (parent_[element] != element) element = parent_[element] = parent_[parent_[element]];
    return element;
  }
  void unite(std::uint64_t a, std::uint64_t b) {
    if (parent_[a] == parent_[b]) return;
    a = find(a);
    b = find(b);
    if (a < b)
      parent_[b] = a;
    else
      parent_[a] = b;
  }

 private:
  std::vector<std::uint64_t> parent_;
};

} // namespace hyperiso
