#pragma once
// The loops of the engine, once for each set of instructions; all give the same bytes.

#include "extract/march_table.hpp"
#include "extract/samples.hpp"

#include <vector>

namespace hyperiso {

enum class Instructions { baseline, avx2, avx512 };

// The best set that this processor has.
Instructions best_instructions();
bool has_instructions(Instructions instructions);

// Where the lower and the upper ends of edges lie.
struct RowPair {
  const std::byte *lower, *upper;
};

// Some rows of `count` samples each, one after the other; the rows begin `bytes_apart`.
struct SampleRows {
  const std::byte* first;
  std::int64_t rows, bytes_apart, count;
  std::int64_t next = 0; // how far behind those lie that will be asked for next
};

// Functions on rows of samples of one type. Rows become bit masks: bit x of word x / 64; the bits behind the
// last sample are 0.
struct RowKernels {
  // Which samples are inside, row after row, and for each row 0 if none is, 255 if all are, 1 otherwise.
  // Returns whether one of them is NaN.
  bool (*inside)(const SampleRows& rows, const InsideTest& test, std::uint64_t* words, std::uint8_t* uniform);
  // The least and the greatest of every 64 of a row, row after row; both NaN if one of them is.
  void (*ranges)(const SampleRows& rows, std::byte* low, std::byte* high);
  // As `inside`, but reads samples only where their range does not decide.
  bool (*inside_by_ranges)(const SampleRows& rows, const InsideTest& test, const std::byte* low,
                           const std::byte* high, std::uint64_t* words, std::uint8_t* uniform);
  // Which of them are not NaN.
  void (*present)(const std::byte* row, std::int64_t count, std::uint64_t* words);
  // Copies samples that lie `stride` apart next to each other.
  void (*gather)(const std::byte* row, std::int64_t stride, std::int64_t count, std::byte* gathered);
  // lower[i], upper[i] = sample at[i] of both rows of pair pair[i]. Samples lie `stride` apart, the pairs
  // `pair_bytes`.
  void (*load)(const RowPair* pairs, std::size_t pair_bytes, const std::uint32_t* pair,
               const std::uint32_t* at, std::int64_t stride, std::size_t count, double* lower, double* upper);
};

// Rows of samples (along axis 0), numbered in memory order.
template <int D>
struct RowGrid {
  explicit RowGrid(const std::array<std::int64_t, D>& dims_) : dims(dims_) {
    std::int64_t rows_ = 1;
    for (int axis = 1; axis < D; ++axis) {
      stride[axis] = rows_;
      rows_ *= dims[axis];
    }
    rows = rows_;
    layer_rows = stride[D - 1];
    halo = D > 2 ? stride[D - 2] : 0;
    words = (dims[0] + 63) / 64;
  }
  // How many rows the row at `place` in a column lies before the one at the top place.
  std::int64_t rows_before_top(unsigned place) const {
    std::int64_t before = 0;
    for (int axis = 1; axis < D; ++axis)
      if ((place >> (axis - 1) & 1) == 0) before += stride[axis];
    return before;
  }

  std::array<std::int64_t, D> dims;
  std::array<std::int64_t, D> stride{}; // rows from one index to the next along each axis but 0
  std::int64_t rows;
  std::int64_t layer_rows; // a layer: all rows of one index along the last axis
  std::int64_t halo;       // rows of one index along the axis before it: how far back in a layer cells reach
  std::int64_t words;      // of a row's mask
};

// Which samples are not NaN, and which cells touch no NaN: a bit for each sample, and for each cell at its
// lowest corner; rows of `words` words. Empty for fields without NaN.
struct PresentCells {
  Array<std::uint64_t> words;
  bool all() const { return words.empty(); }
};

// A piece of the field that one worker scans: some rows of each of some layers.
struct Unit {
  std::int64_t first_layer, end_layer;
  std::int64_t first_row, end_row; // in the layer
  std::size_t window;              // which of the mask windows it uses
};

// Masks of the rows of a unit and of those before it that its cells touch, in two layers: that of the last
// even and that of the last odd index. Units on the same rows of successive layers share one. Before and
// behind the rows there is memory that vectors may read.
class MaskWindow {
 public:
  void set_size(std::int64_t rows, std::int64_t words) {
    if (rows == rows_ && words == words_) return;
    rows_ = rows, words_ = words;
    for (int parity = 0; parity < 2; ++parity) {
      masks_[parity].reset(static_cast<std::size_t>(rows * words + 2 * mask_margin));
      uniform_[parity].reset(static_cast<std::size_t>(rows + 2 * uniform_margin));
    }
  }
  std::uint64_t* mask(std::size_t parity, std::int64_t row) {
    return masks_[parity].data() + mask_margin + row * words_;
  }
  // Of each row: 0 no sample is inside, 255 all, 1 neither.
  std::uint8_t* uniform(std::size_t parity, std::int64_t row) {
    return uniform_[parity].data() + uniform_margin + row;
  }
  void swap_layers() {
    std::swap(masks_[0], masks_[1]);
    std::swap(uniform_[0], uniform_[1]);
  }
  std::int64_t last_layer = -1; // up to which layer they are filled

 private:
  static constexpr std::int64_t mask_margin = 16, uniform_margin = 64;
  std::int64_t rows_ = 0, words_ = 0;
  std::array<Array<std::uint64_t>, 2> masks_;
  std::array<Array<std::uint8_t>, 2> uniform_;
};

// Where the range of every 64 samples is noted down (FieldRanges), or found. Nowhere if `low` is null.
struct NotedRanges {
  std::byte *low = nullptr, *high = nullptr;
  bool known = false; // found
};

// Masks of all rows of a field, one after the other, and of each what MaskWindow::uniform says, where
// somebody has them already. None if null. The field has no NaN then.
struct GivenMasks {
  const std::uint64_t* masks = nullptr;
  const std::uint8_t* uniform = nullptr;
};

// What a worker needs while it scans, kept from unit to unit.
struct ScanMemory {
  Array<std::uint64_t> edges_exist, cells_exist; // of a row
  Array<std::uint64_t> crossed, active;          // of a strip of rows
  Array<std::uint64_t> listed;
  Array<std::uint32_t> listed_at;
  Array<std::uint32_t> edge_upper, edge_group;
  Array<double> lower_values, upper_values;
  Buffer groups, starts;
  Buffer gathered;
};

// Numbers of the vertices: for each row and direction, how many of its plane come before them; for each
// plane, which is a run of rows, how many come before it, in the unit while scanning and in all afterwards.
struct VertexNumbers {
  Array<std::uint32_t> row_first;
  Array<std::uint64_t> plane_first;
  std::int64_t plane_rows;
};

// Vertices on their way from the scan to the mesh.
struct VertexBatch {
  Buffer positions; // room for `capacity` vertices
  Array<GridEdge> edges;
  std::size_t capacity = 0, count = 0;
};

// Active cells of one row whose vertex numbers count on from each other. `row` is that of their top place.
struct CellRun {
  std::int64_t row;
  std::uint32_t cells;
  std::uint32_t restart; // position in Cells::restarts, or no_restart: counting starts with the row
  static constexpr std::uint32_t no_restart = UINT32_MAX;
};

// Active cells, as one worker finds them.
template <int D>
struct Cells {
  using Code = std::conditional_t<D <= 4, std::uint16_t, std::uint32_t>;
  Array<CellRun> runs;
  std::size_t run_count = 0;
  Array<Code> codes;
  std::size_t code_count = 0;
  std::vector<std::uint32_t> restarts; // where a run starts behind NaN: first its edges in the left column,
                                       // then those across: how many of their row and direction come before
};

// What a unit turned out to hold.
struct UnitCells {
  std::size_t worker;
  std::size_t first_run, end_run, first_code;
  std::uint64_t active_cells, simplices, vertices;
};

// Phase 1 on one unit.
template <int D>
struct ScanJob {
  const Samples<D>* samples;
  const RowGrid<D>* grid;
  const RowKernels* row_kernels;
  const PresentCells* present; // nothing missing if all()
  const MarchTable<D>* table;
  bool wide_positions, keep_edges;
  std::int64_t first_row; // number of row 0 in the whole field, for the numbers of edges
  NotedRanges ranges;
  GivenMasks given;
  VertexNumbers* numbers;

  Unit unit;
  MaskWindow* window;
  ScanMemory* memory;
  Cells<D>* cells;
  VertexBatch* batch;
  void* owner;
  void (*batch_is_large)(void* owner); // may empty the batch

  // Results.
  UnitCells* result;
  bool found_missing; // a NaN, in a field thought to have none: the scan has stopped
};

// Phase 2 on one unit: its simplices, to `corners`.
template <int D>
struct EmitJob {
  const RowGrid<D>* grid;
  const MarchTable<D>* table;
  const VertexNumbers* numbers;
  const Cells<D>* cells;
  const UnitCells* unit;
  void* corners;
};

template <int D, Method M>
struct Kernels {
  void (*scan)(ScanJob<D>&);
  void (*emit_narrow)(const EmitJob<D>&); // 32-bit vertex numbers
  void (*emit_wide)(const EmitJob<D>&);
};

RowKernels row_kernels(SampleType type, Instructions instructions);
template <int D, Method M>
Kernels<D, M> kernels(Instructions instructions);

} // namespace hyperiso
