#pragma once
// The cells between two steps, and what the surface has in each, made when asked for.

#include "core/cell.hpp"
#include "extract/march_table.hpp"
#include "track/crossings.hpp"
#include "track/landmarks.hpp"

namespace hyperiso::track_detail {

// The surface of the method `hull` (or `component`) between two steps without missing samples. A cell is
// numbered as its lowest sample. Where the signs and times come from is for others to say.
template <int D>
class SignedCells {
  using Index = std::array<std::int64_t, D>;

 public:
  using Ends = GridEdgeEnds<D>;

  SignedCells(const MarchTable<D>& table, const std::array<std::int64_t, D>& dims)
      : table_(table), dims_(dims) {
    for (unsigned upper = 1; upper < 1u << D; ++upper)
      for (int axis = 0; axis < D; ++axis)
        if (upper >> axis & 1) {
          Index end; // of an edge of the first cell
          for (int a = 0; a < D; ++a) end[a] = upper >> a & 1;
          const unsigned lower = upper & ~(1u << axis), slot = CellEdges<D, Method::hull>::slot(lower, upper);
          slot_[lower][static_cast<std::size_t>(axis)] = static_cast<std::uint8_t>(slot);
          corners_[slot] = {static_cast<std::uint8_t>(lower), static_cast<std::uint8_t>(upper)};
          edge_offset_[slot] = grid_edge<D>(dims_, end, 1u << axis);
        }
  }
  virtual ~SignedCells() = default;

  const std::array<std::int64_t, D>& dims() const { return dims_; }

  // Calls use(cell, slot) for the cells around a grid edge, ascending, with the slot of the edge in each.
  template <class Use>
  void for_each_cell_around(GridEdge edge, Use&& use) const {
    const Ends ends = ends_of(edge);
    for_each_cell_with(ends.lower, ends.upper,
                       [&](std::uint64_t cell, const Index& index) { use(cell, slot(ends, index)); });
  }
  // The same for two grid edges of one cell: use(cell, slot, slot of the other).
  template <class Use>
  void for_each_cell_around(GridEdge edge, GridEdge other_edge, Use&& use) const {
    const Ends ends = ends_of(edge), other = ends_of(other_edge);
    Index lower, upper;
    for (int axis = 0; axis < D; ++axis) {
      lower[axis] = std::min(ends.lower[axis], other.lower[axis]);
      upper[axis] = std::max(ends.upper[axis], other.upper[axis]);
    }
    for_each_cell_with(lower, upper, [&](std::uint64_t cell, const Index& index) {
      use(cell, slot(ends, index), slot(other, index));
    });
  }

  // The code of a cell in the table.
  virtual std::uint32_t code_of(std::uint64_t cell) const = 0;
  // The slots of the simplices of a code, D each, in the order of the table.
  std::span<const std::uint8_t> simplices(std::uint32_t code) const {
    return std::span(table_.corners).subspan(table_.first[code], table_.first[code + 1] - table_.first[code]);
  }
  GridEdge edge(std::uint64_t cell, unsigned slot) const { return edge_of_origin(cell) + edge_offset_[slot]; }
  // The edges at the slots of a cell.
  class Edges {
   public:
    Edges(const SignedCells& cells, std::uint64_t cell)
        : cells_(cells), origin_(cells.edge_of_origin(cell)), lowest_(cells.lowest_sample(cell)) {}
    GridEdge operator[](unsigned slot) const { return origin_ + cells_.edge_offset_[slot]; }
    Ends ends(unsigned slot) const {
      const auto [lower, upper] = cells_.corners_[slot];
      return {corner_of(lowest_, lower), corner_of(lowest_, upper), static_cast<unsigned>(lower ^ upper)};
    }

   private:
    const SignedCells& cells_;
    GridEdge origin_;
    Index lowest_;
  };
  Ends ends_of(GridEdge edge) const { return grid_edge_ends<D>(dims_, edge); }

  // Whether the surface crosses an edge.
  bool crosses(const Ends& ends) const { return inside(ends.lower) != inside(ends.upper); }
  // Of a crossing, from 0 to 1.
  double time(const Ends& ends) const {
    if (ends.lower[D - 1] == ends.upper[D - 1]) return static_cast<double>(ends.lower[D - 1]);
    return time_between(ends.lower);
  }

  // The walls of the domain's space that an edge lies on: bit 2 axis for the first, 2 axis + 1 for the last.
  std::uint8_t walls(const Ends& ends) const {
    unsigned walls = 0;
    for (int axis = 0; axis < D - 1; ++axis)
      walls |= ((ends.upper[axis] == 0 ? 1u : 0u) | (ends.lower[axis] == dims_[axis] - 1 ? 2u : 0u))
               << (2 * axis);
    return static_cast<std::uint8_t>(walls);
  }

  // Of its slices, or of the curves where they end (landmarks.hpp), if they are known; and how many parts of
  // slices are searched in the time that it takes to find them.
  virtual std::unique_ptr<Landmarks<D>> landmarks(bool /*of_rim*/) const { return nullptr; }
  virtual std::size_t cost_of_landmarks() const { return SIZE_MAX; }

  // Calls use(cell) for all cells that the surface may pass, ascending.
  template <class Use>
  void for_each_cell(Use&& use) const {
    const auto row_length = static_cast<std::uint64_t>(dims_[0]);
    std::uint64_t rows = 1;
    for (int axis = 1; axis < D - 1; ++axis) rows *= static_cast<std::uint64_t>(dims_[axis]);
    std::array<std::int64_t, D> index{};
    for (std::uint64_t row = 0; row < rows; ++row) {
      bool exists = true;
      for (int axis = 1; axis < D - 1; ++axis) exists &= index[axis] + 1 < dims_[axis];
      if (exists)
        for (std::uint64_t x = 0; x + 1 < row_length; ++x) use(row * row_length + x);
      for (int axis = 1; axis < D - 1 && ++index[axis] == dims_[axis]; ++axis) index[axis] = 0;
    }
  }

 protected:
  Index lowest_sample(std::uint64_t cell) const {
    Index lowest{};
    for (int axis = 0; axis < D - 1; ++axis) {
      const auto length = static_cast<std::uint64_t>(dims_[axis]);
      lowest[axis] = static_cast<std::int64_t>(cell % length);
      cell /= length;
    }
    return lowest;
  }
  // Whether a sample is inside; of a sample of the lower step and the one above it with different signs,
  // where the crossing lies, from 0 to 1.
  virtual bool inside(const std::array<std::int64_t, D>& sample) const = 0;
  virtual double time_between(const std::array<std::int64_t, D>& lower) const = 0;

 private:
  unsigned slot(const Ends& ends, const Index& cell) const {
    unsigned lower = 0; // corner of the cell
    for (int axis = 0; axis < D; ++axis)
      lower |= static_cast<unsigned>(ends.lower[axis] != cell[axis]) << axis;
    return slot_[lower][static_cast<std::size_t>(std::countr_zero(ends.direction))];
  }

  // What the edges at the slots of a cell have in common.
  GridEdge edge_of_origin(std::uint64_t cell) const {
    const auto row_length = static_cast<std::uint64_t>(dims_[0]);
    return (cell / row_length << D) * row_length + cell % row_length;
  }

  // Calls use(cell, index of its lowest sample) for the cells of which the samples between two are corners,
  // ascending.
  template <class Use>
  void for_each_cell_with(const Index& lower, const Index& upper, Use&& use) const {
    for (unsigned place = 0; place < 1u << (D - 1); ++place) { // bit clear: the cell ends there
      Index index{};
      std::int64_t cell = 0;
      bool exists = true;
      for (int axis = D - 2; axis >= 0; --axis) {
        const bool begins = place >> axis & 1;
        index[axis] = begins ? lower[axis] : upper[axis] - 1;
        exists &=
            !(begins && lower[axis] != upper[axis]) && index[axis] >= 0 && index[axis] + 1 < dims_[axis];
        cell = cell * dims_[axis] + index[axis];
      }
      if (exists) use(static_cast<std::uint64_t>(cell), index);
    }
  }

  const MarchTable<D>& table_;
  std::array<std::int64_t, D> dims_;
  static constexpr unsigned slots = CellEdges<D, Method::hull>::slots;
  std::array<std::array<std::uint8_t, D>, 1u << D> slot_{}; // of an edge, by its lower corner and axis
  std::array<CellEdge, slots> corners_{};                   // of each slot
  std::array<GridEdge, slots> edge_offset_{};
};

// By the masks of whole steps.
template <int D>
class MaskedCells final : public SignedCells<D> {
 public:
  // `table`: of the method.
  MaskedCells(const MarchTable<D>& table, Crossings<D> crossings)
      : SignedCells<D>(table, crossings.dims()), crossings_(std::move(crossings)) {
    for (unsigned place = 0; place < row_offset_.size(); ++place)
      for (int axis = D - 2; axis > 0; --axis)
        row_offset_[place] =
            row_offset_[place] * static_cast<std::size_t>(this->dims()[axis]) + (place >> (axis - 1) & 1);
  }

  std::uint32_t code_of(std::uint64_t cell) const override {
    const auto row_length = static_cast<std::uint64_t>(this->dims()[0]);
    const std::uint64_t row = cell / row_length, x = cell % row_length;
    std::uint32_t code = 0;
    for (unsigned place = 0; place < 1u << (D - 1); ++place) { // in a column: bit j stands for axis j + 1
      const StepMask& step = place >> (D - 2) & 1 ? crossings_.upper() : crossings_.lower();
      const unsigned pair = pair_at(step.row(row + row_offset_[place % row_offset_.size()]), x);
      code |= ((pair & 1) | (pair >> 1) << (1u << (D - 1))) << place;
    }
    return code;
  }

  std::unique_ptr<Landmarks<D>> landmarks(bool of_rim) const override {
    return std::make_unique<Landmarks<D>>(crossings_, of_rim);
  }
  std::size_t cost_of_landmarks() const override { return crossings_.rows() / 8; }

 private:
  std::size_t row_in_step(const std::array<std::int64_t, D>& sample) const {
    std::int64_t row = 0;
    for (int axis = D - 2; axis > 0; --axis) row = row * this->dims()[axis] + sample[axis];
    return static_cast<std::size_t>(row);
  }
  bool inside(const std::array<std::int64_t, D>& sample) const override {
    const StepMask& step = sample[D - 1] == 0 ? crossings_.lower() : crossings_.upper();
    return step.inside(row_in_step(sample), static_cast<std::size_t>(sample[0]));
  }
  double time_between(const std::array<std::int64_t, D>& lower) const override {
    return crossings_.time_at(row_in_step(lower), static_cast<std::size_t>(lower[0]));
  }

  Crossings<D> crossings_;
  std::array<std::size_t, 1u << (D - 2)> row_offset_{}; // of the rows of a cell, by their place in a column
};

} // namespace hyperiso::track_detail
