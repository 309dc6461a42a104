#pragma once
// What lies inside and outside at one step: connected regions of samples, as runs along the rows.

#include "core/sign.hpp"
#include "core/union_find.hpp"
#include "track/step_mask.hpp"

#include <algorithm>
#include <bit>
#include <unordered_map>

namespace hyperiso::track_detail {

using Region = std::uint32_t;

// The sizes of the cells' shares around each sample of an axis: half the way to each neighbour; their
// products count every cell once, by the share of its corners (paper 003 section 3.3).
inline std::vector<double> shares(const Axis& axis) {
  std::vector<double> share(static_cast<std::size_t>(axis.count));
  for (std::int64_t i = 0; i + 1 < axis.count; ++i) {
    const double half = std::abs(axis.coordinate(i + 1) - axis.coordinate(i)) / 2;
    share[static_cast<std::size_t>(i)] += half;
    share[static_cast<std::size_t>(i + 1)] += half;
  }
  return share;
}

// Samples of one kind that hang together.
template <int D>
class Regions {
 public:
  enum class Kind : std::uint8_t { outside, inside, missing };

  struct Run {
    std::int64_t begin, end; // along axis 0
    Kind kind;
    Region region;
  };

  // What the surface of a step does not part: with `hull`, all inside samples of a cell are connected and
  // outside ones along its edges; with `simplicial` both along the edges of the Kuhn grid. `mask`: of the
  // samples of `field`.
  template <class T>
  Regions(const FieldView<const T, D>& field, const StepMask& mask, Method method)
      : dims_(field.dims()), has_missing_(mask.has_missing()) {
    if (has_missing_)
      find_runs(field, mask);
    else
      find_runs(
          mask.rows(), [&](std::size_t row, std::size_t word) { return mask.row(row)[word]; },
          [](std::size_t, std::size_t) { return std::uint64_t{0}; });
    unite(reaches(method));
  }
  // Connected along the edges of the grid. `inside`, `missing`: words of the masks of these, by the row and
  // the number of the word in it.
  template <class Inside, class Missing>
  Regions(const std::array<std::int64_t, D>& dims, std::size_t rows, Inside&& inside, Missing&& missing)
      : dims_(dims), has_missing_(true) {
    find_runs(rows, inside, missing);
    unite(reaches_along_edges());
  }

  std::size_t count() const { return kinds_.size(); }
  Kind kind(Region region) const { return kinds_[region]; }
  bool has_missing() const { return has_missing_; }
  std::size_t rows() const { return first_.size() - 1; }
  std::span<const Run> row(std::size_t number) const {
    return std::span(runs_).subspan(first_[number], first_[number + 1] - first_[number]);
  }

  Region at(const std::array<std::int64_t, D>& sample) const {
    std::int64_t number = 0;
    for (int axis = D - 1; axis > 0; --axis) number = number * dims_[axis] + sample[axis];
    const auto runs = row(static_cast<std::size_t>(number));
    const auto after =
        std::ranges::upper_bound(runs, sample[0], {}, [](const Run& run) { return run.begin; });
    return std::prev(after)->region;
  }

 private:
  template <class Inside, class Missing>
  void find_runs(std::size_t rows, Inside&& inside, Missing&& missing) {
    for (std::size_t row = 0; row < rows; ++row) {
      first_.push_back(runs_.size());
      for (std::int64_t begin = 0; begin < dims_[0];) {
        std::size_t word = static_cast<std::size_t>(begin / 64);
        const auto all_if = [&](std::uint64_t bits) { return -(bits >> (begin % 64) & 1); };
        const std::uint64_t inside_here = all_if(inside(row, word)),
                            missing_here = all_if(missing(row, word));
        const auto unlike = [&] {
          return (inside(row, word) ^ inside_here) | (missing(row, word) ^ missing_here);
        };
        std::uint64_t other = unlike() & (~std::uint64_t{0} << (begin % 64));
        while (other == 0 && 64 * (static_cast<std::int64_t>(word) + 1) < dims_[0]) ++word, other = unlike();
        const std::int64_t end =
            other == 0 ? dims_[0]
                       : std::min(64 * static_cast<std::int64_t>(word) + std::countr_zero(other), dims_[0]);
        const Kind kind = missing_here != 0 ? Kind::missing : inside_here != 0 ? Kind::inside : Kind::outside;
        runs_.push_back({begin, end, kind, 0});
        begin = end;
      }
    }
    first_.push_back(runs_.size());
  }

  template <class T>
  void find_runs(const FieldView<const T, D>& field, const StepMask& mask) {
    std::array<std::int64_t, D> index{};
    for (std::size_t number = 0; number < mask.rows(); ++number) {
      first_.push_back(runs_.size());
      const T* samples = &field.at(index);
      for (std::int64_t x = 0; x < dims_[0]; ++x) {
        const Kind kind = mask.inside(number, static_cast<std::size_t>(x)) ? Kind::inside
                          : is_missing(samples[x * field.strides[0]])      ? Kind::missing
                                                                           : Kind::outside;
        if (x == 0 || runs_.back().kind != kind) runs_.push_back({x, x, kind, 0});
        runs_.back().end = x + 1;
      }
      for (int axis = 1; axis < D && ++index[axis] == dims_[axis]; ++axis) index[axis] = 0;
    }
    first_.push_back(runs_.size());
  }

  // How far a run reaches to runs of its kind in an earlier row: from begin + low to end + high.
  struct Reach {
    std::int64_t row_offset;
    std::array<int, D> step; // along axes 1, 2, ...
    int low, high;
    Kind kind;
  };

  Reach reach(const std::array<int, D>& step, Kind kind, int low, int high) const {
    std::int64_t offset = 0;
    for (int axis = D - 1; axis > 0; --axis) offset = offset * dims_[axis] + step[axis];
    return {offset, step, low, high, kind};
  }
  std::vector<Reach> reaches_along_edges() const {
    std::vector<Reach> result;
    for (int axis = 1; axis < D; ++axis) {
      std::array<int, D> step{};
      step[axis] = -1;
      result.push_back(reach(step, Kind::inside, 0, 0));
      result.push_back(reach(step, Kind::outside, 0, 0));
    }
    return result;
  }
  std::vector<Reach> reaches(Method method) const {
    std::vector<Reach> result;
    std::array<int, D> step{};
    const auto add = [&](Kind kind, int low, int high) { result.push_back(reach(step, kind, low, high)); };
    int combinations = 1;
    for (int axis = 1; axis < D; ++axis) combinations *= 3;
    for (int code = 0; code < combinations; ++code) {
      int moved = 0, last = 0, forward = 0, rest = code;
      for (int axis = 1; axis < D; ++axis, rest /= 3) {
        step[axis] = rest % 3 - 1;
        moved += step[axis] != 0;
        forward += step[axis] > 0;
        if (step[axis] != 0) last = step[axis];
      }
      if (last >= 0) continue; // only rows before
      if (method == Method::simplicial) {
        if (forward > 0) continue;
        add(Kind::inside, -1, 0);
        add(Kind::outside, -1, 0);
      } else {
        // A cell joins all its samples of one side, those of the other only along its edges.
        const bool joins_outside = method == Method::component;
        add(joins_outside ? Kind::outside : Kind::inside, -1, 1);
        if (moved == 1) add(joins_outside ? Kind::inside : Kind::outside, 0, 0);
      }
    }
    return result;
  }

  void unite(const std::vector<Reach>& all) {
    std::vector<Reach> of_outside; // most rows have nothing else
    for (const Reach& reach : all)
      if (reach.kind == Kind::outside) of_outside.push_back(reach);
    UnionFind united(runs_.size());
    std::array<std::int64_t, D> index{};
    for (std::size_t number = 0; number < rows(); ++number) {
      const bool all_outside =
          first_[number + 1] == first_[number] + 1 && runs_[first_[number]].kind == Kind::outside;
      for (const Reach& reach : all_outside ? of_outside : all) {
        bool exists = true;
        for (int axis = 1; axis < D; ++axis)
          exists &= index[axis] + reach.step[axis] >= 0 && index[axis] + reach.step[axis] < dims_[axis];
        if (exists) unite_rows(number, reach, united);
      }
      for (int axis = 1; axis < D && ++index[axis] == dims_[axis]; ++axis) index[axis] = 0;
    }
    for (std::size_t run = 0; run < runs_.size(); ++run) {
      const std::uint64_t root = united.find(run);
      if (root == run) {
        runs_[run].region = static_cast<Region>(kinds_.size());
        kinds_.push_back(runs_[run].kind);
      } else {
        runs_[run].region = runs_[root].region;
      }
    }
  }

  void unite_rows(std::size_t number, const Reach& reach, UnionFind& united) const {
    const auto earlier = static_cast<std::size_t>(static_cast<std::int64_t>(number) + reach.row_offset);
    if (first_[number + 1] - first_[number] == 1 && first_[earlier + 1] - first_[earlier] == 1) {
      const std::size_t run = first_[number], other = first_[earlier]; // of whole rows
      if (runs_[run].kind == reach.kind && runs_[other].kind == reach.kind) united.unite(run, other);
      return;
    }
    std::size_t other = first_[earlier];
    for (std::size_t run = first_[number]; run < first_[number + 1]; ++run) {
      if (runs_[run].kind != reach.kind) continue;
      const std::int64_t low = runs_[run].begin + reach.low, high = runs_[run].end + reach.high;
      while (other > first_[earlier] && runs_[other - 1].end > low) --other;
      while (other < first_[earlier + 1] && runs_[other].end <= low) ++other;
      for (; other < first_[earlier + 1] && runs_[other].begin < high; ++other)
        if (runs_[other].kind == reach.kind) united.unite(run, other);
    }
  }

  std::array<std::int64_t, D> dims_;
  std::vector<Run> runs_;
  std::vector<std::size_t> first_; // run of each row, and the end
  std::vector<Kind> kinds_;        // of each region
  bool has_missing_;
};

// Paper 003's ratio.
inline double share_of_smaller(double common, double first, double second) {
  const double smaller = std::min(first, second);
  return smaller > 0 ? common / smaller : 0;
}

// The size of the overlap of each pair of regions of two steps that overlap, by shares of samples. Pairs are
// (first << 32 | second); only those wanted in both steps.
template <int D>
class RegionOverlap {
 public:
  RegionOverlap(const Regions<D>& first, const std::vector<bool>& first_wanted, const Regions<D>& second,
                const std::vector<bool>& second_wanted, const std::array<std::vector<double>, D>& share) {
    std::vector<double> up_to(share[0].size() + 1);
    for (std::size_t x = 0; x < share[0].size(); ++x) up_to[x + 1] = up_to[x] + share[0][x];
    std::array<std::size_t, D> index{};
    for (std::size_t row = 0; row < first.rows(); ++row) {
      double row_share = 1;
      for (std::size_t axis = 1; axis < D; ++axis) row_share *= share[axis][index[axis]];
      const auto in_first = first.row(row), in_second = second.row(row);
      const bool none_wanted = (in_first.size() == 1 && !first_wanted[in_first[0].region]) ||
                               (in_second.size() == 1 && !second_wanted[in_second[0].region]);
      auto other = in_second.begin();
      for (const auto& run : in_first) {
        if (none_wanted) break;
        while (other->end <= run.begin) ++other;
        for (auto reached = other; reached != in_second.end() && reached->begin < run.end; ++reached)
          if (first_wanted[run.region] && second_wanted[reached->region])
            sizes_[key(run.region, reached->region)] +=
                row_share * (up_to[static_cast<std::size_t>(std::min(run.end, reached->end))] -
                             up_to[static_cast<std::size_t>(std::max(run.begin, reached->begin))]);
      }
      for (std::size_t axis = 1; axis < D && ++index[axis] == share[axis].size(); ++axis) index[axis] = 0;
    }
  }
  double of(Region first, Region second) const {
    const auto found = sizes_.find(key(first, second));
    return found == sizes_.end() ? 0 : found->second;
  }

 private:
  static std::uint64_t key(Region first, Region second) { return std::uint64_t{first} << 32 | second; }
  std::unordered_map<std::uint64_t, double> sizes_;
};

} // namespace hyperiso::track_detail
