#pragma once
// Volumes that the components of two steps have in common, exactly: of the piecewise linear interpolants on
// the Kuhn simplices of the cells.

#include "core/cell.hpp"
#include "core/determinant.hpp"
#include "core/sign.hpp"
#include "hyperiso/extract.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <functional>
#include <numeric>
#include <optional>
#include <span>
#include <unordered_map>

namespace hyperiso::track_detail {

// Where the field of a step is on one side of a level.
struct HalfSpace {
  double level = 0;
  bool above = true;
  bool open = false; // without the level itself
  bool contains(double value) const {
    return open ? (above ? value > level : value < level) : above ? value >= level : value <= level;
  }
};

// What of a simplex belongs to one owner: that is the part in all these half-spaces.
struct SimplexPart {
  std::uint32_t owner = UINT32_MAX;
  std::array<HalfSpace, 2> bounds{};
  int count = 1;
};

// One step: its samples, and who owns what. Owners are numbers; UINT32_MAX is nobody.
template <int D>
class StepShape {
 public:
  using Sample = std::array<std::int64_t, D>;
  static constexpr std::uint32_t nobody = UINT32_MAX;

  // Of the parts all the samples in one and one simplex have one owner; `parts` themselves name none.
  template <class T>
  StepShape(const FieldView<const T, D>& step, std::vector<SimplexPart> parts,
            std::vector<std::uint32_t> owner_of_sample)
      : dims_(step.dims()), parts_(std::move(parts)), owners_(std::move(owner_of_sample)) {
    for (int axis = 0; axis < D; ++axis)
      for (std::int64_t i = 0; i + 1 < dims_[axis]; ++i)
        lengths_[axis].push_back(
            std::abs(step.grid.axes[axis].coordinate(i + 1) - step.grid.axes[axis].coordinate(i)));
    values_.reserve(owners_.size());
    Sample index{};
    for (std::size_t number = 0; number < owners_.size(); ++number) {
      // Infinite values are very large ones, so that crossings are at the other end.
      constexpr double huge = 1e300;
      values_.push_back(std::clamp(static_cast<double>(step.at(index)), -huge, huge));
      for (int axis = 0; axis < D && ++index[axis] == dims_[axis]; ++axis) index[axis] = 0;
    }
  }

  // Who owns what lies between two samples next to each other that own nothing, if anybody does.
  std::function<std::uint32_t(const Sample&, const Sample&)> owner_between;

  const Sample& dims() const { return dims_; }
  double length(int axis, std::int64_t cell) const { return lengths_[axis][static_cast<std::size_t>(cell)]; }
  double value(const Sample& at) const { return values_[number(at)]; }

  // Whether all of a cell has one owner, or nobody: then who; if more is to be seen, nothing.
  std::optional<std::uint32_t> owner_of_cell(const Sample& cell) const {
    std::optional<std::uint32_t> owner;
    for (unsigned corner = 0; corner < 1u << D; ++corner) {
      const Sample at = corner_of(cell, corner);
      const std::uint32_t one = owners_[number(at)];
      if (owner && one != *owner) return std::nullopt;
      owner = one;
      if (one == nobody ? owner_between != nullptr : !contains(parts_[0], value(at))) return std::nullopt;
    }
    return owner;
  }

  // The parts of a simplex that somebody owns. Requires that no corner is missing.
  template <class Use>
  void for_each_part(const std::array<Sample, D + 1>& corners, Use&& use) const {
    for (SimplexPart part : parts_) {
      part.owner = owner_of(part, corners);
      if (part.owner != nobody) use(part);
    }
  }

 private:
  std::size_t number(const Sample& at) const {
    std::int64_t number = 0;
    for (int axis = D - 1; axis >= 0; --axis) number = number * dims_[axis] + at[axis];
    return static_cast<std::size_t>(number);
  }
  static bool contains(const SimplexPart& part, double value) {
    for (int i = 0; i < part.count; ++i)
      if (!part.bounds[static_cast<std::size_t>(i)].contains(value)) return false;
    return true;
  }
  // All corners in a part are connected within the simplex. Where none is, the field passes from one bound to
  // the other, along one of the edges of the grid from corner to corner too.
  std::uint32_t owner_of(const SimplexPart& part, const std::array<Sample, D + 1>& corners) const {
    for (const Sample& corner : corners)
      if (contains(part, value(corner)) && owners_[number(corner)] != nobody) return owners_[number(corner)];
    if (part.count == 1 || !owner_between) return nobody;
    for (std::size_t k = 0; k < D; ++k)
      if (part.bounds[0].contains(value(corners[k])) != part.bounds[0].contains(value(corners[k + 1])))
        return owner_between(corners[k], corners[k + 1]);
    return nobody;
  }

  Sample dims_;
  std::vector<SimplexPart> parts_; // their owners are those of the corners
  std::vector<std::uint32_t> owners_;
  std::vector<double> values_;
  std::array<std::vector<double>, D> lengths_;
};

// The share of a simplex that lies in half-spaces of two linear functions on it.
template <int D>
class SimplexShare {
 public:
  struct Corner {
    std::array<double, D + 1> weights; // barycentric
    std::array<double, 2> values;      // of the two functions
  };
  using Corners = std::array<Corner, D + 1>;
  struct Bound {
    std::size_t function;
    HalfSpace half_space;
  };

  static double of(const Corners& corners, std::span<const Bound> bounds) {
    if (bounds.empty()) return size(corners);
    const auto& [function, half_space] = bounds.front();
    std::array<std::size_t, D + 1> in{}, out{};
    std::size_t inner = 0, outer = 0;
    for (std::size_t corner = 0; corner <= D; ++corner)
      (half_space.contains(corners[corner].values[function]) ? in[inner++] : out[outer++]) = corner;
    if (inner == 0) return 0;
    if (outer == 0) return of(corners, bounds.subspan(1));

    // As KuhnRegion cuts: staircases over the corners inside and those that cut their edges off.
    double sum = 0;
    for (unsigned steps = 0; steps < 1u << D; ++steps) {
      if (static_cast<std::size_t>(std::popcount(steps)) != inner - 1) continue;
      Corners piece;
      std::size_t p = 0, n = 0;
      for (unsigned step = 0; step <= D; ++step) {
        piece[step] = n == 0 ? corners[in[p]]
                             : between(corners[in[p]], corners[out[n - 1]], function, half_space.level);
        if (step < D) (steps >> step & 1 ? p : n) += 1;
      }
      sum += of(piece, bounds.subspan(1));
    }
    return sum;
  }

 private:
  static Corner between(const Corner& a, const Corner& b, std::size_t function, double level) {
    const double weight = crossing(a.values[function], b.values[function], level);
    Corner corner;
    for (std::size_t i = 0; i <= D; ++i) corner.weights[i] = std::lerp(a.weights[i], b.weights[i], weight);
    for (std::size_t i = 0; i < 2; ++i) corner.values[i] = std::lerp(a.values[i], b.values[i], weight);
    corner.values[function] = level;
    return corner;
  }

  static double size(const Corners& corners) {
    std::array<std::array<double, D + 1>, D + 1> weights;
    for (std::size_t i = 0; i <= D; ++i) weights[i] = corners[i].weights;
    return std::abs(determinant(weights));
  }
};

// The volumes of the owners of two steps and of what they have in common.
template <int D>
class ExactOverlap {
 public:
  ExactOverlap(const StepShape<D>& first, const StepShape<D>& second) : first_(first), second_(second) {
    std::array<std::int64_t, D> cell{};
    for (bool more = true; more;) {
      add_cell(cell);
      int axis = 0;
      while (axis < D && ++cell[axis] > first.dims()[axis] - 2) cell[axis] = 0, ++axis;
      more = axis < D;
    }
  }

  double first(std::uint32_t owner) const { return find(volumes_[0], owner); }
  double second(std::uint32_t owner) const { return find(volumes_[1], owner); }
  double common(std::uint32_t first, std::uint32_t second) const { return find(common_, key(first, second)); }

 private:
  using Sample = std::array<std::int64_t, D>;
  using Share = SimplexShare<D>;

  static std::uint64_t key(std::uint32_t first, std::uint32_t second) {
    return std::uint64_t{first} << 32 | second;
  }
  template <class Map>
  static double find(const Map& map, typename Map::key_type key) {
    const auto found = map.find(key);
    return found == map.end() ? 0 : found->second;
  }

  void add_cell(const Sample& cell) {
    double size = 1;
    for (int axis = 0; axis < D; ++axis) size *= first_.length(axis, cell[axis]) / (axis + 1);
    const auto before = first_.owner_of_cell(cell), after = second_.owner_of_cell(cell);
    if (before && after) {
      const double whole = size * (D == 2 ? 2 : 6);
      if (*before != StepShape<D>::nobody) volumes_[0][*before] += whole;
      if (*after != StepShape<D>::nobody) volumes_[1][*after] += whole;
      if (*before != StepShape<D>::nobody && *after != StepShape<D>::nobody)
        common_[key(*before, *after)] += whole;
      return;
    }
    std::array<bool, 2> has_data{true, true};
    for (unsigned corner = 0; corner < 1u << D; ++corner) {
      const Sample at = corner_of(cell, corner);
      has_data[0] &= !std::isnan(first_.value(at));
      has_data[1] &= !std::isnan(second_.value(at));
    }
    std::array<int, D> order;
    std::iota(order.begin(), order.end(), 0);
    do {
      std::array<Sample, D + 1> corners;
      corners[0] = cell;
      for (std::size_t k = 0; k < D; ++k) {
        corners[k + 1] = corners[k];
        ++corners[k + 1][static_cast<std::size_t>(order[k])];
      }
      add_simplex(corners, size, has_data);
    } while (std::ranges::next_permutation(order).found);
  }

  void add_simplex(const std::array<Sample, D + 1>& samples, double size, std::array<bool, 2> has_data) {
    typename Share::Corners corners{};
    for (std::size_t i = 0; i <= D; ++i) {
      corners[i].weights[i] = 1;
      corners[i].values = {first_.value(samples[i]), second_.value(samples[i])};
    }
    std::vector<SimplexPart>& before = parts_[0];
    std::vector<SimplexPart>& after = parts_[1];
    before.clear();
    after.clear();
    if (has_data[0]) first_.for_each_part(samples, [&](const SimplexPart& part) { before.push_back(part); });
    if (has_data[1]) second_.for_each_part(samples, [&](const SimplexPart& part) { after.push_back(part); });
    for (const SimplexPart& part : before) {
      const auto bounds = bounds_of(part, 0);
      volumes_[0][part.owner] += size * Share::of(corners, std::span(bounds).first(bounds_in(part)));
    }
    for (const SimplexPart& part : after) {
      const auto bounds = bounds_of(part, 1);
      volumes_[1][part.owner] += size * Share::of(corners, std::span(bounds).first(bounds_in(part)));
    }
    for (const SimplexPart& a : before)
      for (const SimplexPart& b : after) {
        std::array<typename Share::Bound, 4> bounds;
        const auto of_a = bounds_of(a, 0), of_b = bounds_of(b, 1);
        std::copy_n(of_b.begin(), bounds_in(b), std::copy_n(of_a.begin(), bounds_in(a), bounds.begin()));
        common_[key(a.owner, b.owner)] +=
            size * Share::of(corners, std::span(bounds).first(bounds_in(a) + bounds_in(b)));
      }
  }
  static std::size_t bounds_in(const SimplexPart& part) { return static_cast<std::size_t>(part.count); }
  static std::array<typename Share::Bound, 2> bounds_of(const SimplexPart& part, std::size_t function) {
    return {typename Share::Bound{function, part.bounds[0]}, {function, part.bounds[1]}};
  }

  const StepShape<D>&first_, &second_;
  std::array<std::vector<SimplexPart>, 2> parts_; // of the simplex at hand
  std::array<std::unordered_map<std::uint32_t, double>, 2> volumes_;
  std::unordered_map<std::uint64_t, double> common_;
};

} // namespace hyperiso::track_detail
