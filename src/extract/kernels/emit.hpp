#pragma once
// Phase 2: codes of active cells -> simplices.
//
// Along a row the vertices of each direction are numbered on. So it takes only the codes to follow the number
// of every edge of the cell: where a column's labels differ at the ends of an edge, there is one more.

#include "extract/kernels/prelude.hpp"

namespace hyperiso {
namespace {

// Writes whole cache lines, past the caches if `stream`, from a buffer that stays in the first of them.
template <class T>
class LineWriter {
 public:
  LineWriter(T* to, bool stream) : to_(reinterpret_cast<std::byte*>(to)), stream_(stream) {
    offset_ = reinterpret_cast<std::uintptr_t>(to_) % line;
    to_ -= offset_; // the buffer begins like the line that `to` is in
    skip_ = offset_;
    out_ = reinterpret_cast<T*>(buffer_ + offset_);
  }
  // Room for the simplices of a cell, and for a vector that is written beyond them.
  T* room() {
    if (reinterpret_cast<std::byte*>(out_) - buffer_ >= full) flush();
    return out_;
  }
  void set_end(T* end) { out_ = end; }
  void finish() {
    flush();
    const auto rest = static_cast<std::size_t>(reinterpret_cast<std::byte*>(out_) - buffer_);
    std::memcpy(to_ + skip_, buffer_ + skip_, rest - skip_);
    end_streaming();
  }

 private:
  static constexpr std::ptrdiff_t line = 64, full = 4096, room_bytes = 4096;

  void flush() {
    std::ptrdiff_t bytes = (reinterpret_cast<std::byte*>(out_) - buffer_) / line * line;
    if (bytes == 0) return;
    std::ptrdiff_t done = 0;
    if (skip_ > 0) { // of the first line only a part is ours
      std::memcpy(to_ + skip_, buffer_ + skip_, static_cast<std::size_t>(line) - skip_);
      skip_ = 0;
      done = line;
    }
    if (stream_)
      stream_lines(to_ + done, buffer_ + done, bytes - done);
    else
      std::memcpy(to_ + done, buffer_ + done, static_cast<std::size_t>(bytes - done));
    to_ += bytes;
    std::memcpy(buffer_, buffer_ + bytes, line);
    out_ = reinterpret_cast<T*>(reinterpret_cast<std::byte*>(out_) - bytes);
  }

  std::byte* to_;
  T* out_;
  std::size_t offset_, skip_;
  bool stream_;
  alignas(line) std::byte buffer_[full + room_bytes + line];
};

// For each label column and edge within it, whether the edge is crossed; for each left and right column and
// edge between them, the labels of its ends.
template <int D, Method M>
struct ColumnEdges {
  using Edges = CellEdges<D, M>;
  static constexpr unsigned columns = 1u << Edges::column;
  static constexpr unsigned in_column = (Edges::in_column + 15) / 16 * 16,
                            across = (Edges::across + 7) / 8 * 8;
  std::uint8_t crossed[columns][in_column];
  std::uint8_t left[columns][across], right[columns][across];
};

template <int D, Method M>
constexpr ColumnEdges<D, M> make_column_edges() {
  using Edges = CellEdges<D, M>;
  ColumnEdges<D, M> table{};
  for (unsigned labels = 0; labels < table.columns; ++labels) {
    for (unsigned edge = 0; edge < Edges::in_column; ++edge) {
      const CellEdge ends = Edges::in_column_edges[edge];
      table.crossed[labels][edge] = ((labels >> ends.lower) ^ (labels >> ends.upper)) & 1;
    }
    for (unsigned edge = 0; edge < Edges::across; ++edge) {
      table.left[labels][edge] = labels >> Edges::across_edges[edge].lower & 1;
      table.right[labels][edge] = labels >> Edges::across_edges[edge].upper & 1;
    }
  }
  return table;
}
template <int D, Method M>
constexpr ColumnEdges<D, M> column_edges = make_column_edges<D, M>();

template <int D, Method M, class Index>
class Emit {
 public:
  explicit Emit(const EmitJob<D>& job) : job_(job), writer_(static_cast<Index*>(job.corners), job.stream) {
    for (unsigned place = 0; place < Edges::column; ++place)
      rows_before_[place] = job.grid->rows_before_top(place);
  }

  void run() {
    const auto* codes = job_.cells->codes.data() + job_.unit->first_code;
    for (std::size_t run = job_.unit->first_run; run < job_.unit->end_run; ++run) {
      const CellRun& cells = job_.cells->runs[run];
      start(cells);
      for (std::uint32_t cell = 0; cell < cells.cells; ++cell) emit_cell(*codes++);
    }
    writer_.finish();
  }

 private:
  using Edges = CellEdges<D, M>;
  static constexpr const ColumnEdges<D, M>& table = column_edges<D, M>;

  // The numbers of the first vertices of a run, for every edge of a cell.
  void start(const CellRun& run) {
    const VertexNumbers& numbers = *job_.numbers;
    std::array<const std::uint32_t*, Edges::column> row_first;
    std::array<std::uint64_t, Edges::column> plane_first;
    for (unsigned place = 0; place < Edges::column; ++place) {
      const auto row = static_cast<std::uint64_t>(run.row - rows_before_[place]);
      row_first[place] = numbers.row_first.data() + row * Edges::directions;
      plane_first[place] = numbers.plane_first[row / static_cast<std::uint64_t>(numbers.plane_rows)];
    }
    const auto first = [&](CellEdge edge, bool across) {
      const unsigned direction = static_cast<unsigned>(edge.lower ^ edge.upper) << 1 | across;
      return static_cast<Index>(plane_first[edge.upper] +
                                row_first[edge.upper][Edges::direction_number(direction)]);
    };
    for (unsigned edge = 0; edge < Edges::in_column; ++edge)
      in_column_[edge] = first(Edges::in_column_edges[edge], false);
    for (unsigned edge = 0; edge < Edges::across; ++edge)
      across_[edge] = first(Edges::across_edges[edge], true);
    if (run.restart == CellRun::no_restart) return;
    const std::uint32_t* before = job_.cells->restarts.data() + run.restart;
    for (unsigned edge = 0; edge < Edges::in_column; ++edge) in_column_[edge] += *before++;
    for (unsigned edge = 0; edge < Edges::across; ++edge) across_[edge] += *before++;
  }

  void emit_cell(std::uint32_t code) {
    const std::uint32_t left = code & ((1u << Edges::column) - 1), right = code >> Edges::column;
    Index* slots = slots_;
    for (unsigned edge = 0; edge < Edges::in_column; ++edge)
      slots[Edges::left_slot + edge] = in_column_[edge];
    for (unsigned edge = 0; edge < Edges::half; ++edge)
      slots[Edges::first_across_slot + edge] = across_[edge];
    for (unsigned edge = 0; edge < Edges::in_column; ++edge)
      slots[Edges::right_slot + edge] = in_column_[edge] += table.crossed[left][edge];
    for (unsigned edge = Edges::half; edge < Edges::across; ++edge)
      slots[Edges::second_across_slot + edge - Edges::half] = across_[edge];
    for (unsigned edge = 0; edge < Edges::across; ++edge)
      across_[edge] += table.left[left][edge] ^ table.right[right][edge];

    const std::uint32_t first = job_.table->first[code], end = job_.table->first[code + 1];
    const std::uint8_t* corner = job_.table->corners.data() + first;
    Index* out = writer_.room();
    for (std::uint32_t i = first; i < end; i += D, corner += D, out += D)
      for (int k = 0; k < D; ++k) out[k] = slots[corner[k]];
    writer_.set_end(out);
  }

  const EmitJob<D>& job_;
  std::array<std::int64_t, Edges::column> rows_before_{};
  Index in_column_[Edges::in_column], across_[Edges::across];
  alignas(64) Index slots_[Edges::slots];
  LineWriter<Index> writer_;
};

template <int D, Method M, class Index>
void emit(const EmitJob<D>& job) {
  Emit<D, M, Index>(job).run();
}

} // namespace
} // namespace hyperiso
