#pragma once
// Places of a slice that are known to hang together.

#include "track/crossings.hpp"
#include "track/regions.hpp"

#include <optional>

namespace hyperiso::track_detail {

// Of all slices between two steps, for the surface of the method `hull` (or `component`) where no sample is
// missing.
//
// On the face that an edge of the grid spans with time, the surface has a line for each of its corners that
// is apart from the others; two inside corners across from each other are joined by `hull`, two outside ones
// by `component`. So between two samples that do not change sides in this slab a slice passes once if they
// are on different sides, else not at all. Such a place is a landmark: it is on an edge of the surface that
// runs from the edge of the grid at one step to the same at the other. It is named by two sets of samples
// that do not change and hang together along edges: that of the inside sample and that of the outside one.
//
// Landmarks of one name are on one component of the slice. Go along the edge of one, through the set at its
// end to the other landmark, along its edge, and back through the other set. This loop meets the slice at
// these two places only; in a box any loop meets a component of a slice, which has no boundary but on the
// walls, an even number of times. So both are on the same. It is no other on the surface of a box, with the
// curves along which the slice meets it and sets that hang together along the walls.
template <int D>
class Landmarks {
  static constexpr int space = D - 1;

 public:
  // `of_rim`: of those curves, else of the slices. Takes about as long as passing over the masks.
  Landmarks(const Crossings<D>& crossings, bool of_rim) : dims_(crossings.dims()) {
    // On such a grid neighbours on walls need not share one.
    if (of_rim && *std::min_element(dims_.begin(), dims_.end() - 1) < 3) return;
    const StepMask& lower = crossings.lower();
    const auto is_uniform = [&](std::size_t row) {
      return !of_rim && !crossings.any(row) && lower.uniform(row) != 1;
    };
    const auto inside = [&](std::size_t row, std::size_t word) { return lower.row(row)[word]; };
    const auto left_out = [&](std::size_t row, std::size_t word) {
      return crossings.changes(row, word) | (of_rim ? within(row, word) : 0);
    };
    regions_.emplace(in_space(dims_), is_uniform, inside, left_out);
  }

  // Of the places where slices pass the edge of the surface from its vertex on an edge of the grid within the
  // lower step to that on the same at the upper one, if they are landmarks. For curves on the walls the edge
  // must lie on one.
  std::optional<std::uint64_t> name(GridEdge edge) const {
    if (!regions_) return std::nullopt;
    const auto ends = grid_edge_ends<D>(dims_, edge);
    using Kind = typename Regions<space>::Kind;
    Region inside = regions_->at(in_space(ends.lower)), outside = regions_->at(in_space(ends.upper));
    if (regions_->kind(inside) != Kind::inside) std::swap(inside, outside);
    if (regions_->kind(inside) != Kind::inside || regions_->kind(outside) != Kind::outside)
      return std::nullopt; // one is left out
    return std::uint64_t{inside} << 32 | outside;
  }

 private:
  static std::array<std::int64_t, space> in_space(const std::array<std::int64_t, D>& index) {
    std::array<std::int64_t, space> result;
    std::copy_n(index.begin(), space, result.begin());
    return result;
  }
  // Samples that are on no wall.
  std::uint64_t within(std::size_t row, std::size_t word) const {
    auto rest = static_cast<std::int64_t>(row);
    for (int axis = 1; axis < space; ++axis) {
      const std::int64_t index = rest % dims_[axis];
      if (index == 0 || index == dims_[axis] - 1) return 0;
      rest /= dims_[axis];
    }
    std::uint64_t bits = ~std::uint64_t{0};
    const auto last = static_cast<std::size_t>(dims_[0] - 1);
    if (word == 0) bits &= ~std::uint64_t{1};
    if (word == last / 64) bits &= ~(std::uint64_t{1} << (last % 64));
    return bits;
  }

  std::array<std::int64_t, D> dims_;
  std::optional<Regions<space>> regions_;
};

} // namespace hyperiso::track_detail
