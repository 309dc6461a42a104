#pragma once
// The cells that groups of simplices lie in.

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace hyperiso::track_detail {

// Counts them for simplices that come cell by cell.
template <int D> // axes of the grid
class CellCounter {
 public:
  void resize(std::size_t groups) {
    Cell none;
    none.fill(-1);
    last_.assign(groups, none);
  }

  // Whether a simplex of a group lies in another cell than the one before: a cell begins at the lowest of the
  // samples that the simplex's vertices lie above (`lower`).
  template <class Vertex, class Corners>
  bool is_next(std::size_t group, const std::vector<Vertex>& vertices, const Corners& corners) {
    Cell& last = last_[group];
    bool is_next = false;
    for (std::size_t axis = 0; axis < D; ++axis) {
      std::int32_t lowest = vertices[corners[0]].lower[axis];
      for (const auto corner : corners) lowest = std::min(lowest, vertices[corner].lower[axis]);
      is_next |= lowest != last[axis];
      last[axis] = lowest;
    }
    return is_next;
  }

 private:
  using Cell = std::array<std::int32_t, D>;
  std::vector<Cell> last_; // of each group
};

} // namespace hyperiso::track_detail
