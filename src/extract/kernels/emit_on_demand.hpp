#pragma once
// Phase 2 in five dimensions, where the table is made as it is used and label columns are too many for tables
// of their edges: as in emit.hpp, but edges are followed by their bits.

#include "extract/kernels/prelude.hpp"

namespace hyperiso {
namespace {

template <int D, Method M, class Index>
class EmitOnDemand {
 public:
  explicit EmitOnDemand(const EmitJob<D>& job) : job_(job), table_(*job.table) {
    for (unsigned place = 0; place < Edges::column; ++place)
      rows_before_[place] = job.grid->rows_before_top(place);
  }

  void run() {
    const auto* codes = job_.cells->codes.data() + job_.unit->first_code;
    auto* out = static_cast<Index*>(job_.corners);
    for (std::size_t run = job_.unit->first_run; run < job_.unit->end_run; ++run) {
      const CellRun& cells = job_.cells->runs[run];
      start(cells);
      for (std::uint32_t cell = 0; cell < cells.cells; ++cell) out = emit_cell(*codes++, out);
    }
  }

 private:
  using Edges = CellEdges<D, M>;

  // The numbers of the first vertices of a run, for every edge of a cell.
  void start(const CellRun& run) {
    const VertexNumbers& numbers = *job_.numbers;
    const auto first = [&](CellEdge edge, bool across) {
      const auto row = static_cast<std::uint64_t>(run.row - rows_before_[edge.upper]);
      const unsigned direction = static_cast<unsigned>(edge.lower ^ edge.upper) << 1 | across;
      return static_cast<Index>(
          numbers.plane_first[row / static_cast<std::uint64_t>(numbers.plane_rows)] +
          numbers.row_first[row * Edges::directions + Edges::direction_number(direction)]);
    };
    const std::uint32_t* before =
        run.restart == CellRun::no_restart ? nullptr : job_.cells->restarts.data() + run.restart;
    for (unsigned edge = 0; edge < Edges::in_column; ++edge)
      right_[edge] = first(Edges::in_column_edges[edge], false) + (before ? *before++ : 0);
    for (unsigned edge = 0; edge < Edges::across; ++edge)
      across_[edge] = first(Edges::across_edges[edge], true) + (before ? *before++ : 0);
  }

  Index* emit_cell(std::uint32_t code, Index* out) {
    const std::uint32_t left = code & ((1u << Edges::column) - 1), right = code >> Edges::column;
    for (unsigned edge = 0; edge < Edges::in_column; ++edge) {
      const CellEdge ends = Edges::in_column_edges[edge];
      slots_[Edges::left_slot + edge] = right_[edge];
      right_[edge] += (left >> ends.lower ^ left >> ends.upper) & 1;
      slots_[Edges::right_slot + edge] = right_[edge];
    }
    for (unsigned edge = 0; edge < Edges::across; ++edge) {
      const CellEdge ends = Edges::across_edges[edge];
      slots_[edge < Edges::half ? Edges::first_across_slot + edge
                                : Edges::second_across_slot + edge - Edges::half] = across_[edge];
      across_[edge] += (left >> ends.lower ^ right >> ends.upper) & 1;
    }
    for (const std::uint8_t slot : table_.corners(code)) *out++ = slots_[slot];
    return out;
  }

  const EmitJob<D>& job_;
  MarchTableReader<D> table_;
  std::array<std::int64_t, Edges::column> rows_before_{};
  Index right_[Edges::in_column], across_[Edges::across]; // of the right column, and between it and the next
  Index slots_[Edges::slots];
};

} // namespace
} // namespace hyperiso
