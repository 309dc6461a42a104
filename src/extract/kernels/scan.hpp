#pragma once
// Phase 1: rows of samples -> crossed edges and codes of active cells.

#include "extract/kernels/vertices.hpp"

namespace hyperiso {
namespace {

// Row r of `rows` holds bit r of 64 columns; makes the columns: bit r of byte c is bit c of row r.
void transpose(const std::array<std::uint64_t, 8>& rows, std::uint8_t* columns) {
  std::array<std::uint64_t, 8> m = rows;
  // Bytes: byte b of row r goes to byte r of row b, by exchanging ever smaller blocks off the diagonal.
  const auto exchange = [&m](int block, int shift, std::uint64_t mask) {
    for (int r = 0; r < 8; ++r) {
      if (r & block) continue;
      const std::uint64_t difference = ((m[r] >> shift) ^ m[r | block]) & mask;
      m[r] ^= difference << shift;
      m[r | block] ^= difference;
    }
  };
  exchange(4, 32, 0x00000000ffffffff);
  exchange(2, 16, 0x0000ffff0000ffff);
  exchange(1, 8, 0x00ff00ff00ff00ff);
  // Bits: the same inside each word of eight bytes.
  for (std::uint64_t& word : m) {
    const auto swap = [&word](int shift, std::uint64_t mask) {
      const std::uint64_t difference = (word ^ (word >> shift)) & mask;
      word ^= difference ^ (difference << shift);
    };
    swap(7, 0x00aa00aa00aa00aa);
    swap(14, 0x0000cccc0000cccc);
    swap(28, 0x00000000f0f0f0f0);
  }
  std::memcpy(columns, m.data(), sizeof m);
}

template <int D, Method M>
class Scan {
 public:
  explicit Scan(ScanJob<D>& job)
      : job_(job), samples_(*job.samples), grid_(*job.grid), unit_(job.unit), cells_(*job.cells),
        window_(*job.window), numbers_(*job.numbers), words_(grid_.words), queue_(job) {
    for (unsigned back = 0; back < places; ++back) {
      rows_back_[back] = grid_.rows_before_top(top ^ back);
      window_back_[back] = back & last_axis ? rows_back_[back] - grid_.layer_rows : rows_back_[back];
    }
    if (samples_.strides[0] != 1)
      gathered_.resize(static_cast<std::size_t>(grid_.dims[0]) * samples_.sample_size);
    columns_.resize(static_cast<std::size_t>(64 * words_ + 1));
    active_.resize(static_cast<std::size_t>(words_));
    const std::int64_t rest = grid_.dims[0] % 64;
    last_word_bits_ = rest == 0 ? ~std::uint64_t{0} : (std::uint64_t{1} << rest) - 1;
  }

  void run() {
    if (!prepare_window()) return;
    begin_result();
    for (std::int64_t layer = unit_.first_layer; layer < unit_.end_layer; ++layer) {
      if (!fill_masks(layer, unit_.first_row - halo(), unit_.first_row)) return;
      seek(layer, unit_.first_row);
      for (std::int64_t row = unit_.first_row; row < unit_.end_row; ++row, advance()) {
        if (!fill_mask()) return;
        examine_row();
        if (queue_.has_enough()) flush_queue();
      }
      window_.last_layer = layer;
    }
    flush_queue();
    end_result();
  }

 private:
  using Edges = CellEdges<D, M>;
  using Column = std::conditional_t<D <= 4, std::uint8_t, std::uint16_t>;
  static constexpr unsigned places = Edges::column, top = Edges::top_place, last_axis = 1u << (D - 2);

  // Rows before the unit's that its cells touch, in the same layer.
  std::int64_t halo() const { return unit_.first_row > 0 ? grid_.halo : 0; }

  bool prepare_window() {
    const auto rows = static_cast<std::size_t>(unit_.end_row - unit_.first_row + grid_.halo);
    for (int parity = 0; parity < 2; ++parity) {
      if (window_.masks[parity].size() == rows * static_cast<std::size_t>(words_)) continue;
      window_.masks[parity].reset(rows * static_cast<std::size_t>(words_));
      window_.uniform[parity].reset(rows);
    }
    if (unit_.first_layer == 0 || window_.last_layer == unit_.first_layer - 1) return true;
    return fill_masks(unit_.first_layer - 1, unit_.first_row - halo(), unit_.end_row);
  }
  void begin_result() {
    UnitCells& result = *job_.result;
    result.first_run = cells_.runs.size();
    result.first_code = cells_.code_count;
    result.active_cells = result.simplices = result.vertices = 0;
  }
  void end_result() {
    job_.result->end_run = cells_.runs.size();
    job_.result->active_cells = cells_.code_count - job_.result->first_code;
  }
  void flush_queue() {
    queue_.flush(*job_.batch);
    if (job_.batch->count >= large_batch) job_.batch_is_large(job_.owner);
  }

  // Goes to a row of a layer, given by its number in the layer.
  void seek(std::int64_t layer, std::int64_t row_in_layer) {
    index_[D - 1] = layer;
    row_ = layer * grid_.layer_rows + row_in_layer;
    std::int64_t rest = row_in_layer;
    for (int axis = 1; axis < D - 1; ++axis) {
      index_[axis] = rest % grid_.dims[axis];
      rest /= grid_.dims[axis];
    }
    window_row_ = row_in_layer - unit_.first_row + grid_.halo;
  }
  void advance() {
    ++row_, ++window_row_;
    for (int axis = 1; axis < D - 1 && ++index_[axis] == grid_.dims[axis]; ++axis) index_[axis] = 0;
  }
  std::size_t parity() const { return static_cast<std::size_t>(index_[D - 1] & 1); }

  // The masks of the row `back` (a set like a place) before the current one along the axes in `back`.
  std::size_t window_row_back(unsigned back) const {
    return static_cast<std::size_t>(window_row_ - window_back_[back]);
  }
  const std::uint64_t* masks_back(unsigned back) const {
    const auto& masks = window_.masks[back & last_axis ? parity() ^ 1 : parity()];
    return masks.data() + window_row_back(back) * static_cast<std::size_t>(words_);
  }
  std::uint8_t uniform_back(unsigned back) const {
    return window_.uniform[back & last_axis ? parity() ^ 1 : parity()][window_row_back(back)];
  }

  // Makes the mask of the current row. False: the field has NaN, against expectation.
  bool fill_mask() {
    std::uint64_t* mask = window_.masks[parity()].data() + window_row_ * words_;
    const std::byte* row = samples_.at(index_);
    if (samples_.strides[0] != 1) {
      job_.row_kernels->gather(row, samples_.strides[0], grid_.dims[0], gathered_.data());
      row = gathered_.data();
    }
    const InsideTest& test = samples_.test_in_layer(index_[D - 1]);
    const bool missing = job_.row_kernels->inside(row, grid_.dims[0], test, mask);
    if (test.never) std::fill_n(mask, words_, 0); // a level beyond the range of the type
    std::uint64_t any = 0, all = ~std::uint64_t{0};
    for (std::int64_t word = 0; word < words_ - 1; ++word) any |= mask[word], all &= mask[word];
    any |= mask[words_ - 1], all &= mask[words_ - 1] | ~last_word_bits_;
    window_.uniform[parity()][static_cast<std::size_t>(window_row_)] = any == 0 ? 0 : ~all == 0 ? 255 : 1;
    job_.found_missing = missing && job_.present->all();
    return !job_.found_missing;
  }
  // The same for some rows of a layer.
  bool fill_masks(std::int64_t layer, std::int64_t first_row, std::int64_t end_row) {
    if (first_row == end_row) return true;
    seek(layer, first_row);
    for (std::int64_t row = first_row; row < end_row; ++row, advance())
      if (!fill_mask()) return false;
    return true;
  }

  // Crossed edges that end in the current row, active cells of which it is the top row.
  void examine_row() {
    begin_row_numbers();
    unsigned existing = 0; // axes along which there is a row before this one
    for (int axis = 1; axis < D; ++axis) existing |= static_cast<unsigned>(index_[axis] > 0) << (axis - 1);
    unsigned any = 0, all = 255;
    for (unsigned back = 0; back < places; ++back) {
      if ((back & ~existing) != 0) continue;
      any |= uniform_back(back), all &= uniform_back(back);
    }
    if (any == 0 || all == 255) return;
    std::array<const std::uint64_t*, places> masks{};
    for (unsigned back = 0; back < places; ++back)
      if ((back & ~existing) == 0) masks[back] = masks_back(back);
    find_crossed_edges(existing, masks);
    if (existing == top) find_active_cells(masks);
  }

  void begin_row_numbers() {
    if (row_ % numbers_.plane_rows == 0) {
      plane_vertices_ = 0;
      numbers_.plane_first[static_cast<std::size_t>(row_ / numbers_.plane_rows)] = job_.result->vertices;
    }
  }

  void find_crossed_edges(unsigned existing, const std::array<const std::uint64_t*, places>& masks) {
    std::uint32_t* row_first = &numbers_.row_first[static_cast<std::size_t>(row_) * Edges::directions];
    const std::size_t before = queue_.size();
    for (unsigned number = 0; number < Edges::directions; ++number) {
      const unsigned direction = Edges::direction(number), back = direction >> 1;
      row_first[number] = plane_vertices_ + static_cast<std::uint32_t>(queue_.size() - before);
      if ((back & ~existing) != 0) continue;
      queue_.begin_group(edge_group(direction));
      std::uint64_t carry = 0; // of the shift by one sample; the first has none before it
      for (std::int64_t word = 0; word < words_; ++word)
        queue_.add(crossed_edges(direction, 0, masks[0], masks[back], word, carry), word);
      queue_.end_group((back & last_axis) != 0);
    }
    const std::size_t found = queue_.size() - before;
    plane_vertices_ += static_cast<std::uint32_t>(found);
    job_.result->vertices += found;
  }

  // The upper ends of the crossed edges of a direction that end in the row `end` before the current one, in
  // one word: from the masks of that row and of the one where they start.
  std::uint64_t crossed_edges(unsigned direction, unsigned end, const std::uint64_t* upper_mask,
                              const std::uint64_t* lower_mask, std::int64_t word,
                              std::uint64_t& carry) const {
    std::uint64_t lower = lower_mask[word], exist = ~std::uint64_t{0};
    if (direction & 1) {
      const std::uint64_t shifted = lower << 1 | carry;
      carry = lower >> 63;
      lower = shifted;
      exist = word == words_ - 1 ? last_word_bits_ : exist;
      if (word == 0) exist &= ~std::uint64_t{1};
    }
    if (!job_.present->all()) exist &= edges_of_present_cells(direction, end, word);
    return (upper_mask[word] ^ lower) & exist;
  }

  // The upper ends of the edges of a direction, ending in that row, that belong to a cell without NaN. Such
  // a cell starts in a row that lies further back along the edge's axes, and maybe along others.
  std::uint64_t edges_of_present_cells(unsigned direction, unsigned end, std::int64_t word) const {
    std::uint64_t edges = 0;
    for (unsigned back = 0; back < places; ++back) {
      if ((direction >> 1 & ~back) != 0 || !row_exists(end, back)) continue;
      const std::uint64_t* cells = present_cells(rows_back_[end] + rows_back_[back]);
      edges |= cells[word] << 1 | (word > 0 ? cells[word - 1] >> 63 : 0);
      if ((direction & 1) == 0) edges |= cells[word];
    }
    return edges;
  }
  bool row_exists(unsigned end, unsigned back) const {
    for (int axis = 1; axis < D; ++axis)
      if (index_[axis] < (end >> (axis - 1) & 1) + (back >> (axis - 1) & 1)) return false;
    return true;
  }
  // Cells without NaN whose lowest corners are in the row so many rows before the current one.
  const std::uint64_t* present_cells(std::int64_t rows_back) const {
    return job_.present->words.data() + (row_ - rows_back) * words_;
  }

  EdgeGroup<D> edge_group(unsigned direction) const {
    EdgeGroup<D> group{};
    group.direction = direction;
    group.row = row_;
    group.upper = index_;
    group.upper_row = samples_.at(index_);
    auto lower = index_;
    for (int axis = 0; axis < D; ++axis) lower[axis] -= direction >> axis & 1;
    group.lower_row = samples_.at(lower);
    return group;
  }

  void find_active_cells(const std::array<const std::uint64_t*, places>& masks) {
    const std::size_t first_code = cells_.code_count;
    if (!find_active_words(masks)) return;
    make_columns(masks);
    if (first_code + static_cast<std::size_t>(grid_.dims[0]) > cells_.codes.size())
      cells_.codes.resize(
          std::max(2 * cells_.codes.size(), first_code + static_cast<std::size_t>(grid_.dims[0])));
    if (job_.present->all() || row_of_cells_is_present()) {
      for (std::int64_t word = 0; word < words_; ++word) add_cells(active_[word], word);
      cells_.runs.push_back(
          {row_, static_cast<std::uint32_t>(cells_.code_count - first_code), CellRun::no_restart});
    } else {
      add_runs_between_missing();
    }
  }

  // Which cells have both labels; false if none has.
  bool find_active_words(const std::array<const std::uint64_t*, places>& masks) {
    std::uint64_t any_next = 0, all_next = 0, found = 0; // of the word behind
    for (std::int64_t word = words_ - 1; word >= 0; --word) {
      std::uint64_t any = 0, all = ~std::uint64_t{0};
      for (const std::uint64_t* mask : masks) any |= mask[word], all &= mask[word];
      const std::uint64_t any_right = any >> 1 | any_next << 63, all_right = all >> 1 | all_next << 63;
      any_next = any, all_next = all;
      std::uint64_t active = (any | any_right) & ~(all & all_right);
      if (word == words_ - 1) active &= last_word_bits_ >> 1; // the last sample starts no cell
      if (!job_.present->all()) active &= present_cells(rows_back_[top])[word];
      active_[word] = active;
      found |= active;
    }
    return found != 0;
  }

  // The label columns that active cells need.
  void make_columns(const std::array<const std::uint64_t*, places>& masks) {
    for (std::int64_t word = 0; word < words_; ++word) {
      if (active_[word] == 0 && (word == 0 || active_[word - 1] >> 63 == 0)) continue;
      std::array<std::uint64_t, 8> rows{};
      alignas(64) std::array<std::array<std::uint8_t, 64>, (places + 7) / 8> bytes;
      for (unsigned group = 0; group < bytes.size(); ++group) {
        for (unsigned place = 0; place < std::min(places, 8u); ++place)
          rows[place] = masks[top ^ (8 * group + place)][word];
        transpose(rows, bytes[group].data());
      }
      for (int column = 0; column < 64; ++column) {
        Column labels = 0;
        for (unsigned group = 0; group < bytes.size(); ++group)
          labels = static_cast<Column>(labels | static_cast<Column>(bytes[group][column] << (8 * group)));
        columns_[64 * word + column] = labels;
      }
    }
  }

  // Appends the codes of the cells in `active`, a word of the row.
  void add_cells(std::uint64_t active, std::int64_t word) {
    using Code = typename Cells<D>::Code;
    const Column* columns = columns_.data() + 64 * word;
    Code* codes = cells_.codes.data();
    std::size_t count = cells_.code_count;
    std::uint64_t simplices = 0;
    for (; active != 0; active &= active - 1) {
      const int x = std::countr_zero(active);
      const auto code = static_cast<Code>(columns[x] | static_cast<Code>(columns[x + 1]) << places);
      codes[count++] = code;
      simplices += job_.table->count[code];
    }
    cells_.code_count = count;
    job_.result->simplices += simplices;
  }

  bool row_of_cells_is_present() const {
    const std::uint64_t* cells = present_cells(rows_back_[top]);
    for (std::int64_t word = 0; word < words_ - 1; ++word)
      if (~cells[word] != 0) return false;
    return cells[words_ - 1] == last_word_bits_ >> 1;
  }

  // Behind a cell with NaN, the next cell's labels do not tell how many vertices the row had so far: a run
  // starts wherever an active cell does not follow another.
  void add_runs_between_missing() {
    bool follows = false;
    for (std::int64_t word = 0; word < words_; ++word)
      for (int bit = 0; bit < 64; ++bit) {
        const std::uint64_t one = std::uint64_t{1} << bit;
        const bool is_active = active_[word] & one;
        if (is_active && !follows) begin_run(64 * word + bit);
        if (is_active) add_cells(one, word), ++cells_.runs.back().cells;
        follows = is_active;
      }
  }
  void begin_run(std::int64_t x) {
    cells_.runs.push_back({row_, 0, static_cast<std::uint32_t>(cells_.restarts.size())});
    // An edge within the left column ends at x, one across at x + 1.
    for (const CellEdge edge : Edges::in_column_edges)
      cells_.restarts.push_back(crossed_before(edge, false, x));
    for (const CellEdge edge : Edges::across_edges)
      cells_.restarts.push_back(crossed_before(edge, true, x + 1));
  }
  // How many crossed edges of the direction of `edge` end in its row before x.
  std::uint32_t crossed_before(CellEdge edge, bool across, std::int64_t x) const {
    const unsigned direction = static_cast<unsigned>(edge.lower ^ edge.upper) << 1 | across;
    const unsigned end = top ^ edge.upper;
    const std::uint64_t *upper = masks_back(end), *lower = masks_back(top ^ edge.lower);
    std::uint64_t carry = 0;
    std::uint32_t count = 0;
    for (std::int64_t word = 0; 64 * word < x; ++word) {
      std::uint64_t crossed = crossed_edges(direction, end, upper, lower, word, carry);
      if (x < 64 * (word + 1)) crossed &= (std::uint64_t{1} << (x - 64 * word)) - 1;
      count += static_cast<std::uint32_t>(std::popcount(crossed));
    }
    return count;
  }

  static constexpr std::size_t large_batch = 8192;

  ScanJob<D>& job_;
  const Samples<D>& samples_;
  const RowGrid<D>& grid_;
  const Unit unit_;
  Cells<D>& cells_;
  MaskWindow& window_;
  VertexNumbers& numbers_;
  const std::int64_t words_;
  std::uint64_t last_word_bits_;                   // of samples in the last word of a row
  std::array<std::int64_t, places> rows_back_{};   // how far the row `back` before one lies in the field
  std::array<std::int64_t, places> window_back_{}; // and in the window, but for the layer
  EdgeQueue<D, M> queue_;
  std::vector<std::byte> gathered_;
  std::vector<Column> columns_;
  std::vector<std::uint64_t> active_;

  std::array<std::int64_t, D> index_{}; // of the current row's first sample
  std::int64_t row_ = 0, window_row_ = 0;
  std::uint32_t plane_vertices_ = 0;
};

template <int D, Method M>
void scan(ScanJob<D>& job) {
  Scan<D, M>(job).run();
}

} // namespace
} // namespace hyperiso
