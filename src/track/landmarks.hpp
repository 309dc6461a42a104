#pragma once
// Places of one slice that are known to hang together.

#include "track/crossings.hpp"
#include "track/regions.hpp"

#include <optional>

namespace hyperiso::track_detail {

enum class Direction { before, after };

// Of the slice just before or just after a moment between two steps, for the surface of the method `hull` (or
// `component`) where no sample is missing.
//
// On the face that an edge of the grid spans with time, the surface has a line for each of its corners that
// is apart from the others; two inside corners across from each other are joined by `hull`, two outside ones
// by `component`. So the slice passes nowhere between two samples of the side that is joined, nor between two
// of the other side of which one or none changes sides in this slab; and it passes once between two samples
// of different sides unless both change. Such a place between a sample of the joined side and one of the
// other side that does not change is a landmark. It is named by two sets that hang together along edges: that
// of the first sample, and that of the second one among those that do not change.
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
  // `of_rim`: of those curves, else of the slice. Takes about as long as passing over the masks and
  // crossings.
  Landmarks(const Crossings<D>& crossings, Method method, double moment, Direction direction, bool of_rim)
      : dims_(crossings.dims()) {
    // On such a grid neighbours on walls need not share one.
    if (of_rim && *std::min_element(dims_.begin(), dims_.end() - 1) < 3) return;
    const StepMask &lower = crossings.lower(), &upper = crossings.upper();
    std::vector<std::uint64_t> inside(lower.row(0), lower.row(0) + lower.rows() * lower.words());
    std::size_t number = 0;
    for (std::size_t word = 0; word < inside.size(); ++word)
      for (std::uint64_t changed = inside[word] ^ upper.row(0)[word]; changed != 0; changed &= changed - 1) {
        const double time = crossings.time(number++);
        if (direction == Direction::after ? time <= moment : time < moment)
          inside[word] ^= changed & -changed;
      }
    const std::size_t words = lower.words();
    const std::uint64_t outside_is_joined = method == Method::component ? ~std::uint64_t{0} : 0;
    const auto inside_at = [&](std::size_t row, std::size_t word) { return inside[row * words + word]; };
    const auto left_out = [&](std::size_t row, std::size_t word) {
      const std::uint64_t changed = lower.row(row)[word] ^ upper.row(row)[word];
      const std::uint64_t joined = inside_at(row, word) ^ outside_is_joined;
      return (changed & ~joined) | (of_rim ? within(row, word) : 0);
    };
    const auto is_uniform = [&](std::size_t row) {
      return !of_rim && !crossings.any(row) && lower.uniform(row) != 1;
    };
    regions_.emplace(in_space(dims_), is_uniform, inside_at, left_out);
  }

  // Of the place where the slice passes the edge of the surface between its vertices on two edges of the
  // grid, if that is a landmark. For curves on the walls both must lie on one.
  std::optional<std::uint64_t> name(GridEdge a, GridEdge b) const {
    if (!regions_) return std::nullopt;
    if (is_along_time(a)) std::swap(a, b);
    if (is_along_time(a)) return std::nullopt; // both are
    const auto ends = grid_edge_ends<D>(dims_, a);
    const auto at_step = [&](std::array<std::int64_t, D> index, std::int64_t step, unsigned direction) {
      index[space] = step;
      return grid_edge<D>(dims_, index, direction);
    };
    const bool spans_face =
        is_along_time(b) ? b == at_step(ends.lower, 1, along_time) || b == at_step(ends.upper, 1, along_time)
                         : b == at_step(ends.upper, 1 - ends.upper[space], ends.direction);
    if (!spans_face) return std::nullopt;

    using Kind = typename Regions<space>::Kind;
    Region at_inside = regions_->at(in_space(ends.lower)), at_outside = regions_->at(in_space(ends.upper));
    if (regions_->kind(at_inside) != Kind::inside) std::swap(at_inside, at_outside);
    if (regions_->kind(at_inside) != Kind::inside || regions_->kind(at_outside) != Kind::outside)
      return std::nullopt;
    return std::uint64_t{at_inside} << 32 | at_outside;
  }

 private:
  static constexpr unsigned along_time = 1u << space; // a direction

  static std::array<std::int64_t, space> in_space(const std::array<std::int64_t, D>& index) {
    std::array<std::int64_t, space> result;
    std::copy_n(index.begin(), space, result.begin());
    return result;
  }
  bool is_along_time(GridEdge edge) const { return edge / static_cast<GridEdge>(dims_[0]) >> space & 1; }
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
