#pragma once
// The vertices strictly between two steps: where samples change sign from the one to the other.

#include "track/step_mask.hpp"

#include <bit>
#include <memory>

namespace hyperiso::track_detail {

// The crossings of the edges along time, by row and place in it, with their times from 0 to 1.
template <int D>
class Crossings {
 public:
  // `slab`: both steps; the masks are of these.
  template <class T>
  Crossings(const FieldView<const T, D>& slab, double isovalue, std::shared_ptr<const StepMask> lower,
            std::shared_ptr<const StepMask> upper)
      : lower_(std::move(lower)), upper_(std::move(upper)), dims_(slab.dims()) {
    first_.reserve(lower_->rows() + 1);
    std::array<std::int64_t, D> index{};
    for (std::size_t row = 0; row < lower_->rows(); ++row) {
      first_.push_back(static_cast<std::uint32_t>(times_.size()));
      const bool alike = lower_->uniform(row) == upper_->uniform(row) && lower_->uniform(row) != 1;
      for (std::size_t word = 0; word < lower_->words() && !alike; ++word) {
        std::uint64_t changed = changes(row, word);
        if (changed == 0) continue;
        const T* samples = &slab.at(index);
        for (; changed != 0; changed &= changed - 1) {
          const T* sample = samples + static_cast<std::int64_t>(
                                          64 * word + static_cast<std::size_t>(std::countr_zero(changed))) *
                                          slab.strides[0];
          times_.push_back(crossing(static_cast<double>(*sample),
                                    static_cast<double>(sample[slab.strides[D - 1]]), isovalue));
          ties_ |= times_.back() == 0 || times_.back() == 1;
        }
      }
      for (int axis = 1; axis < D - 1 && ++index[axis] == dims_[axis]; ++axis) index[axis] = 0;
    }
    first_.push_back(static_cast<std::uint32_t>(times_.size()));
  }

  bool has_ties() const { return ties_; } // a time is that of a step
  const StepMask& lower() const { return *lower_; }
  const StepMask& upper() const { return *upper_; }
  const std::array<std::int64_t, D>& dims() const { return dims_; }
  std::size_t rows() const { return first_.size() - 1; }
  std::size_t count() const { return times_.size(); }

  // The samples of a row that change sign, and how many do in the rows before it.
  std::uint64_t changes(std::size_t row, std::size_t word) const {
    return lower_->row(row)[word] ^ upper_->row(row)[word];
  }
  std::size_t first(std::size_t row) const { return first_[row]; }
  bool any(std::size_t row) const { return first_[row] != first_[row + 1]; }
  double time(std::size_t number) const { return times_[number]; }

  double time_at(std::size_t row, std::size_t x) const {
    std::size_t number = first_[row];
    for (std::size_t word = 0; word < x / 64; ++word)
      number += static_cast<std::size_t>(std::popcount(changes(row, word)));
    const std::uint64_t before = (std::uint64_t{1} << (x % 64)) - 1;
    return times_[number + static_cast<std::size_t>(std::popcount(changes(row, x / 64) & before))];
  }

  // The edge along time that ends at a sample of the upper step.
  GridEdge edge(std::size_t row, std::size_t x) const {
    return (static_cast<GridEdge>(rows() + row) << D | GridEdge{1} << (D - 1)) *
               static_cast<GridEdge>(dims_[0]) +
           x;
  }

 private:
  std::shared_ptr<const StepMask> lower_, upper_;
  std::array<std::int64_t, D> dims_;
  std::vector<std::uint32_t> first_;
  std::vector<double> times_;
  bool ties_ = false;
};

} // namespace hyperiso::track_detail
