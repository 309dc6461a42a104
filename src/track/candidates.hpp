#pragma once
// The vertices between two steps at which something may happen.

#include "track/cell_links.hpp"
#include "track/crossings.hpp"

namespace hyperiso::track_detail {

// Passes over the cells with crossings along time and lists the edges of those crossings that the cells
// around them do not tell to be regular (cell_links.hpp). Of equal times the one on the smaller edge counts
// as earlier. That changes nothing: if all vertices of a cluster with one time are regular when passed one
// after the other, nothing happens when they are passed at once.
template <int D>
class CandidateSearch {
 public:
  explicit CandidateSearch(Method method) : links_(CellLinks<D>::of(method)), pole_table_(space) {}

  std::vector<GridEdge> find(const Crossings<D>& crossings) {
    crossings_ = &crossings;
    poles_.assign(crossings.count(), 0);
    const auto& dims = crossings.dims();
    const std::size_t row_length = static_cast<std::size_t>(dims[1]);
    for (std::size_t row = 0; row < crossings.rows(); ++row) {
      if (static_cast<std::int64_t>(row % row_length) == dims[1] - 1) continue;
      if (D == 4 && row + row_length >= crossings.rows()) break;
      pass_cells(row);
    }
    return list();
  }

 private:
  static constexpr int space = D - 1;
  static constexpr unsigned lines = 1u << (space - 1); // rows of samples beside a row of cells
  static constexpr unsigned columns = CellLinks<D>::columns;

  std::size_t row_of_line(std::size_t row, unsigned line) const {
    return row + (line & 1) + (line >> 1) * static_cast<std::size_t>(crossings_->dims()[1]);
  }

  // The row of cells above sample row `row`.
  void pass_cells(std::size_t row) {
    bool any = false;
    std::array<std::size_t, lines> next{}; // number of the first crossing not yet passed
    for (unsigned line = 0; line < lines; ++line) {
      const std::size_t number = row_of_line(row, line);
      any |= crossings_->any(number);
      next[line] = crossings_->first(number);
    }
    if (!any) return;
    for (unsigned line = 0; line < lines; ++line) {
      below_[line] = crossings_->lower().row(row_of_line(row, line));
      above_[line] = crossings_->upper().row(row_of_line(row, line));
    }
    const auto cells = static_cast<std::size_t>(crossings_->dims()[0] - 1);
    const std::size_t words = crossings_->lower().words();
    const auto changes = [&](std::size_t word) {
      std::uint64_t changed = 0;
      for (unsigned line = 0; line < lines; ++line) changed |= below_[line][word] ^ above_[line][word];
      return changed;
    };
    std::uint64_t here = changes(0);
    for (std::size_t word = 0; word < words; ++word) {
      const std::uint64_t behind = word + 1 < words ? changes(word + 1) : 0;
      std::uint64_t touched = here | here >> 1 | behind << 63;
      for (; touched != 0; touched &= touched - 1) {
        const std::size_t x = 64 * word + static_cast<std::size_t>(std::countr_zero(touched));
        if (x < cells) pass_cell(x, next);
      }
      here = behind;
    }
  }

  void pass_cell(std::size_t x, std::array<std::size_t, lines>& next) {
    typename CellLinks<D>::Signs signs;
    std::array<std::size_t, columns> number; // of the crossing at each corner that changes
    std::array<double, columns> time;
    for (unsigned line = 0; line < lines; ++line) {
      const unsigned below = pair_at(below_[line], x), changed = below ^ pair_at(above_[line], x);
      signs.below |= below << (2 * line);
      signs.changed |= changed << (2 * line);
      if (changed & 1) number[2 * line] = next[line]++, time[2 * line] = crossings_->time(number[2 * line]);
      if (changed & 2) number[2 * line + 1] = next[line], time[2 * line + 1] = crossings_->time(next[line]);
    }
    links_.for_each_crossing(signs, signs.changed, time,
                             [&](unsigned corner, std::uint8_t poles) { poles_[number[corner]] |= poles; });
  }

  std::vector<GridEdge> list() const {
    std::vector<GridEdge> edges;
    std::size_t number = 0;
    for (std::size_t row = 0; row < crossings_->rows(); ++row) {
      if (!crossings_->any(row)) continue;
      unsigned present = 0;
      auto rest = static_cast<std::int64_t>(row);
      for (int axis = 1; axis < space; rest /= crossings_->dims()[axis++])
        present |= PoleTable::present(axis, rest % crossings_->dims()[axis], crossings_->dims()[axis]);
      for (std::size_t word = 0; word < crossings_->lower().words(); ++word)
        for (std::uint64_t changed = crossings_->changes(row, word); changed != 0; changed &= changed - 1) {
          const std::size_t x = 64 * word + static_cast<std::size_t>(std::countr_zero(changed));
          const unsigned along = PoleTable::present(0, static_cast<std::int64_t>(x), crossings_->dims()[0]);
          if (!pole_table_.is_regular(present | along, poles_[number++]))
            edges.push_back(crossings_->edge(row, x));
        }
    }
    return edges;
  }
  const CellLinks<D>& links_;
  PoleTable pole_table_;
  const Crossings<D>* crossings_ = nullptr;
  std::array<const std::uint64_t*, lines> below_{}, above_{}; // masks beside a row of cells, at both steps
  std::vector<std::uint8_t> poles_; // of each crossing that are earlier, or not_simple
};

} // namespace hyperiso::track_detail
