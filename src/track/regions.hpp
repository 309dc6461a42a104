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
  // Neighbouring rows of a plane, the rows with one index along all axes but 0 and 1: one row, or several
  // that share their only run.
  struct Band {
    std::int64_t begin, end; // along axis 1
    std::uint32_t first_run, end_run;

    bool is_uniform() const { return end_run == first_run + 1; }
  };

  // What the surface of a step does not part: with `hull`, all inside samples of a cell are connected and
  // outside ones along its edges; with `simplicial` both along the edges of the Kuhn grid. `mask`: of the
  // samples of `field`.
  template <class T>
  Regions(const FieldView<const T, D>& field, const StepMask& mask, Method method)
      : dims_(field.dims()), has_missing_(mask.has_missing()) {
    const auto is_uniform = [&](std::size_t row) { return mask.uniform(row) != 1; };
    const auto inside = [&](std::size_t row, std::size_t word) { return mask.row(row)[word]; };
    if (has_missing_)
      find_bands(never, inside, missing_in(field));
    else
      find_bands(is_uniform, inside, [](std::size_t, std::size_t) { return std::uint64_t{0}; });
    unite(reaches(method));
  }
  // Connected along the edges of the grid. `inside`, `missing`: words of the masks of these, by the row and
  // the number of the word in it; `is_uniform(row)`: whether a row is known to be all inside or all outside.
  template <class Uniform, class Inside, class Missing>
  Regions(const std::array<std::int64_t, D>& dims, Uniform&& is_uniform, Inside&& inside, Missing&& missing)
      : dims_(dims), has_missing_(true) {
    find_bands(is_uniform, inside, missing);
    unite(reaches_along_edges());
  }

  std::size_t count() const { return kinds_.size(); }
  Kind kind(Region region) const { return kinds_[region]; }
  bool has_missing() const { return has_missing_; }

  std::size_t planes() const { return first_band_.size() - 1; }
  std::span<const Band> bands(std::size_t plane) const {
    return std::span(bands_).subspan(first_band_[plane], first_band_[plane + 1] - first_band_[plane]);
  }
  std::span<const Run> runs(const Band& band) const {
    return std::span(runs_).subspan(band.first_run, band.end_run - band.first_run);
  }

  Region at(const std::array<std::int64_t, D>& sample) const {
    std::int64_t plane = 0;
    for (int axis = D - 1; axis > 1; --axis) plane = plane * dims_[axis] + sample[axis];
    const auto in_plane = bands(static_cast<std::size_t>(plane));
    const auto band = std::prev(std::ranges::upper_bound(in_plane, sample[1], {}, &Band::begin));
    return std::prev(std::ranges::upper_bound(runs(*band), sample[0], {}, &Run::begin))->region;
  }

 private:
  static bool never(std::size_t) { return false; }

  // Words of the mask of the samples that are missing.
  template <class T>
  auto missing_in(const FieldView<const T, D>& field) const {
    return [&field, dims = dims_](std::size_t row, std::size_t word) {
      std::array<std::int64_t, D> index{};
      auto rest = static_cast<std::int64_t>(row);
      for (int axis = 1; axis < D; rest /= dims[axis++]) index[axis] = rest % dims[axis];
      index[0] = 64 * static_cast<std::int64_t>(word);
      const T* sample = &field.at(index);
      std::uint64_t bits = 0;
      for (std::int64_t x = index[0]; x < std::min(index[0] + 64, dims[0]); ++x, sample += field.strides[0])
        bits |= std::uint64_t{is_missing(*sample)} << (x % 64);
      return bits;
    };
  }

  template <class Uniform, class Inside, class Missing>
  void find_bands(Uniform&& is_uniform, Inside&& inside, Missing&& missing) {
    std::size_t planes = 1, row = 0;
    for (int axis = 2; axis < D; ++axis) planes *= static_cast<std::size_t>(dims_[axis]);
    for (std::size_t plane = 0; plane < planes; ++plane) {
      first_band_.push_back(bands_.size());
      for (std::int64_t y = 0; y < dims_[1]; ++y, ++row) {
        const auto first_run = static_cast<std::uint32_t>(runs_.size());
        if (!is_uniform(row)) {
          find_runs(row, inside, missing);
        } else if (const Kind kind = kind_of(inside(row, 0) & 1, false);
                   y > 0 && bands_.back().is_uniform() && runs_.back().kind == kind) {
          bands_.back().end = y + 1;
          continue;
        } else {
          runs_.push_back({0, dims_[0], kind, 0});
        }
        bands_.push_back({y, y + 1, first_run, static_cast<std::uint32_t>(runs_.size())});
      }
    }
    first_band_.push_back(bands_.size());
  }
  static Kind kind_of(bool is_inside, bool is_missing) {
    return is_missing ? Kind::missing : is_inside ? Kind::inside : Kind::outside;
  }

  template <class Inside, class Missing>
  void find_runs(std::size_t row, Inside&& inside, Missing&& missing) {
    std::uint64_t last_inside = inside(row, 0) & 1, last_missing = missing(row, 0) & 1; // samples
    runs_.push_back({0, dims_[0], kind_of(last_inside, last_missing), 0});
    for (std::size_t word = 0; 64 * static_cast<std::int64_t>(word) < dims_[0]; ++word) {
      const std::uint64_t in = inside(row, word), none = missing(row, word);
      for (std::uint64_t changes = (in ^ (in << 1 | last_inside)) | (none ^ (none << 1 | last_missing));
           changes != 0; changes &= changes - 1) {
        const int bit = std::countr_zero(changes);
        const std::int64_t x = 64 * static_cast<std::int64_t>(word) + bit;
        if (x >= dims_[0]) break;
        const Kind kind = kind_of(in >> bit & 1, none >> bit & 1);
        if (kind == runs_.back().kind) continue; // missing samples count as neither inside nor outside
        runs_.back().end = x;
        runs_.push_back({x, dims_[0], kind, 0});
      }
      last_inside = in >> 63;
      last_missing = none >> 63;
    }
  }

  // How far a run reaches to runs of its kind in an earlier row: from begin + low to end + high.
  struct Reach {
    std::int64_t plane_offset;
    std::array<int, D> step; // along axes 1, 2, ...
    int low, high;
    Kind kind;
  };

  Reach reach(const std::array<int, D>& step, Kind kind, int low, int high) const {
    std::int64_t offset = 0;
    for (int axis = D - 1; axis > 1; --axis) offset = offset * dims_[axis] + step[axis];
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

  void unite(const std::vector<Reach>& reaches) {
    UnionFind united(runs_.size());
    std::array<std::int64_t, D> index{}; // of a plane
    for (std::size_t plane = 0; plane < planes(); ++plane) {
      for (const Reach& reach : reaches) {
        bool exists = true;
        for (int axis = 2; axis < D; ++axis)
          exists &= index[axis] + reach.step[axis] >= 0 && index[axis] + reach.step[axis] < dims_[axis];
        if (exists) unite_planes(plane, reach, united);
      }
      for (int axis = 2; axis < D && ++index[axis] == dims_[axis]; ++axis) index[axis] = 0;
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

  void unite_planes(std::size_t plane, const Reach& reach, UnionFind& united) const {
    const auto others =
        bands(static_cast<std::size_t>(static_cast<std::int64_t>(plane) + reach.plane_offset));
    auto first = others.begin();
    for (const Band& band : bands(plane)) {
      if (band.is_uniform() && runs_[band.first_run].kind != reach.kind) continue;
      const std::int64_t begin = std::max<std::int64_t>(band.begin + reach.step[1], 0),
                         end = band.end + reach.step[1];
      while (first != others.end() && first->end <= begin) ++first;
      for (auto other = first; other != others.end() && other->begin < end; ++other)
        unite_rows(band, *other, reach, united);
    }
  }

  void unite_rows(const Band& band, const Band& earlier, const Reach& reach, UnionFind& united) const {
    std::uint32_t other = earlier.first_run;
    for (std::uint32_t run = band.first_run; run < band.end_run; ++run) {
      if (runs_[run].kind != reach.kind) continue;
      const std::int64_t low = runs_[run].begin + reach.low, high = runs_[run].end + reach.high;
      while (other > earlier.first_run && runs_[other - 1].end > low) --other;
      while (other < earlier.end_run && runs_[other].end <= low) ++other;
      for (; other < earlier.end_run && runs_[other].begin < high; ++other)
        if (runs_[other].kind == reach.kind) united.unite(run, other);
    }
  }

  std::array<std::int64_t, D> dims_;
  std::vector<Run> runs_;
  std::vector<Band> bands_;
  std::vector<std::size_t> first_band_; // of each plane, and the end
  std::vector<Kind> kinds_;             // of each region
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
    const auto any_wanted = [](const auto& runs, const std::vector<bool>& wanted) {
      return runs.size() > 1 || wanted[runs[0].region];
    };
    for (std::size_t plane = 0; plane < first.planes(); ++plane) {
      auto other = second.bands(plane).begin();
      for (const auto& band : first.bands(plane)) {
        const auto in_first = first.runs(band);
        if (!any_wanted(in_first, first_wanted)) continue;
        while (other->end <= band.begin) ++other;
        for (auto reached = other; reached != second.bands(plane).end() && reached->begin < band.end;
             ++reached) {
          const auto in_second = second.runs(*reached);
          if (!any_wanted(in_second, second_wanted)) continue;
          for (std::int64_t y = std::max(band.begin, reached->begin); y < std::min(band.end, reached->end);
               ++y) {
            index[1] = static_cast<std::size_t>(y);
            double row_share = 1;
            for (std::size_t axis = 1; axis < D; ++axis) row_share *= share[axis][index[axis]];
            add_row(in_first, first_wanted, in_second, second_wanted, row_share, up_to);
          }
        }
      }
      for (std::size_t axis = 2; axis < D && ++index[axis] == share[axis].size(); ++axis) index[axis] = 0;
    }
  }
  double of(Region first, Region second) const {
    const auto found = sizes_.find(key(first, second));
    return found == sizes_.end() ? 0 : found->second;
  }

 private:
  using Runs = std::span<const typename Regions<D>::Run>;

  // `up_to`: the shares of the samples of a row up to each.
  void add_row(Runs first, const std::vector<bool>& first_wanted, Runs second,
               const std::vector<bool>& second_wanted, double row_share, const std::vector<double>& up_to) {
    auto other = second.begin();
    for (const auto& run : first) {
      while (other->end <= run.begin) ++other;
      for (auto reached = other; reached != second.end() && reached->begin < run.end; ++reached)
        if (first_wanted[run.region] && second_wanted[reached->region])
          sizes_[key(run.region, reached->region)] +=
              row_share * (up_to[static_cast<std::size_t>(std::min(run.end, reached->end))] -
                           up_to[static_cast<std::size_t>(std::max(run.begin, reached->begin))]);
    }
  }
  static std::uint64_t key(Region first, Region second) { return std::uint64_t{first} << 32 | second; }
  std::unordered_map<std::uint64_t, double> sizes_;
};

} // namespace hyperiso::track_detail
