#pragma once
// Phase 1: rows of samples -> crossed edges and codes of active cells.

#include "extract/kernels/vertices.hpp"

namespace hyperiso {
namespace {

#if defined(HYPERISO_AVX512)
template <int Shift>
__m512i exchange(__m512i word, std::uint64_t mask) {
  const __m512i difference = _mm512_and_si512(_mm512_xor_si512(word, _mm512_srli_epi64(word, Shift)),
                                              _mm512_set1_epi64(static_cast<long long>(mask)));
  return _mm512_xor_si512(word, _mm512_xor_si512(difference, _mm512_slli_epi64(difference, Shift)));
}
#else
// Exchanges the bits in `mask` with those `Shift` above them.
template <int Shift>
std::uint64_t exchange(std::uint64_t word, std::uint64_t mask) {
  const std::uint64_t difference = (word ^ (word >> Shift)) & mask;
  return word ^ difference ^ (difference << Shift);
}
// Exchanges the bits above `Shift` of each word with those in `mask` of the one `Block` behind it.
template <int Block, int Shift>
void exchange_bytes(std::array<std::uint64_t, 8>& m, std::uint64_t mask) {
  for (unsigned r = 0; r < 8; ++r) {
    if (r & Block) continue;
    const std::uint64_t difference = ((m[r] >> Shift) ^ m[r | Block]) & mask;
    m[r] ^= difference << Shift;
    m[r | Block] ^= difference;
  }
}
#endif

// Row r of `rows` holds bit r of 64 columns; makes the columns: bit r of byte c is bit c of row r.
inline void transpose(const std::array<std::uint64_t, 8>& rows, std::uint8_t* columns) {
  // First whole bytes: byte b of row r becomes byte r of word b. Then the same with the bits of each word, by
  // exchanging ever larger blocks on both sides of the diagonal.
#if defined(HYPERISO_AVX512)
  alignas(64) static constexpr auto byte_order = [] {
    std::array<std::uint8_t, 64> order{};
    for (unsigned i = 0; i < 64; ++i) order[i] = static_cast<std::uint8_t>(i % 8 * 8 + i / 8);
    return order;
  }();
  const __m512i m = _mm512_setr_epi64(static_cast<long long>(rows[0]), static_cast<long long>(rows[1]),
                                      static_cast<long long>(rows[2]), static_cast<long long>(rows[3]),
                                      static_cast<long long>(rows[4]), static_cast<long long>(rows[5]),
                                      static_cast<long long>(rows[6]), static_cast<long long>(rows[7]));
  __m512i words = _mm512_permutexvar_epi8(_mm512_load_si512(byte_order.data()), m);
  words = exchange<7>(words, 0x00aa00aa00aa00aa);
  words = exchange<14>(words, 0x0000cccc0000cccc);
  words = exchange<28>(words, 0x00000000f0f0f0f0);
  _mm512_storeu_si512(columns, words);
#else
  std::array<std::uint64_t, 8> m = rows;
  exchange_bytes<4, 32>(m, 0x00000000ffffffff);
  exchange_bytes<2, 16>(m, 0x0000ffff0000ffff);
  exchange_bytes<1, 8>(m, 0x00ff00ff00ff00ff);
  for (std::uint64_t& word : m) {
    word = exchange<7>(word, 0x00aa00aa00aa00aa);
    word = exchange<14>(word, 0x0000cccc0000cccc);
    word = exchange<28>(word, 0x00000000f0f0f0f0);
  }
  std::memcpy(columns, m.data(), sizeof m);
#endif
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
    columns_.resize(static_cast<std::size_t>(64 * words_ + 64));
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
    job_.result->simplices = count_simplices();
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
    find_row();
  }
  // What follows from the index.
  void find_row() {
    row_samples_ = samples_.at(index_);
    existing_ = 0;
    for (int axis = 1; axis < D; ++axis) existing_ |= static_cast<unsigned>(index_[axis] > 0) << (axis - 1);
  }
  void advance() {
    ++row_, ++window_row_;
    if constexpr (D > 2) {
      row_samples_ += samples_.strides[1] * static_cast<std::int64_t>(samples_.sample_size);
      existing_ |= 1;
      if (++index_[1] < grid_.dims[1]) return;
      index_[1] = 0;
      for (int axis = 2; axis < D - 1 && ++index_[axis] == grid_.dims[axis]; ++axis) index_[axis] = 0;
      find_row();
    }
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
    const std::byte* row = row_samples_;
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
    unsigned any = 0, all = 255;
    for (unsigned back = 0; back < places; ++back) {
      const unsigned uniform = uniform_back(back & existing_);
      any |= uniform, all &= uniform;
    }
    if (any == 0 || all == 255) return;
    std::array<const std::uint64_t*, places> masks{};
    for (unsigned back = 0; back < places; ++back)
      if ((back & ~existing_) == 0) masks[back] = masks_back(back);
    find_crossed_edges(masks);
    if (existing_ == top) find_active_cells(masks);
  }

  void begin_row_numbers() {
    if (rows_left_in_plane_ == 0) {
      rows_left_in_plane_ = numbers_.plane_rows;
      plane_vertices_ = 0;
      numbers_.plane_first[static_cast<std::size_t>(row_ / numbers_.plane_rows)] = job_.result->vertices;
    }
    --rows_left_in_plane_;
  }

  void find_crossed_edges(const std::array<const std::uint64_t*, places>& masks) {
    std::uint32_t* row_first = &numbers_.row_first[static_cast<std::size_t>(row_) * Edges::directions];
    const std::size_t before = queue_.size();
    queue_.set_row(row_, index_, row_samples_);
    for (unsigned number = 0; number < Edges::directions; ++number) {
      const unsigned direction = Edges::direction(number), back = direction >> 1;
      row_first[number] = plane_vertices_ + static_cast<std::uint32_t>(queue_.size() - before);
      if ((back & ~existing_) != 0) continue;
      std::uint64_t carry = 0; // of the shift by one sample; the first has none before it
      for (std::int64_t word = 0; word < words_; ++word)
        queue_.add(crossed_edges(direction, 0, masks[0], masks[back], word, carry), word);
      queue_.end_group(direction, (back & last_axis) != 0);
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

  void find_active_cells(const std::array<const std::uint64_t*, places>& masks) {
    const std::size_t first_code = cells_.code_count;
    if (!find_active_words(masks)) return;
    make_columns(masks);
    // `add_cells` may write a word's codes whole, wherever its cells begin.
    const std::size_t most = first_code + static_cast<std::size_t>(64 * words_ + 64);
    if (most > cells_.codes.size()) cells_.codes.resize(std::max(2 * cells_.codes.size(), most));
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
    const Column* columns = columns_.data() + 64 * word;
    typename Cells<D>::Code* codes = cells_.codes.data() + cells_.code_count;
    cells_.code_count += static_cast<std::size_t>(std::popcount(active));
#if defined(HYPERISO_AVX512)
    if constexpr (D == 3) {
      const __m512i left = _mm512_maskz_compress_epi8(active, _mm512_loadu_si512(columns));
      const __m512i right = _mm512_maskz_compress_epi8(active, _mm512_loadu_si512(columns + 1));
      const __m512i both = _mm512_or_si512(left, _mm512_slli_epi16(right, 4)); // labels of 4 bits
      _mm512_storeu_si512(codes, _mm512_cvtepu8_epi16(_mm512_castsi512_si256(both)));
      _mm512_storeu_si512(codes + 32, _mm512_cvtepu8_epi16(_mm512_extracti64x4_epi64(both, 1)));
      return;
    }
    if constexpr (D == 4) {
      const __m512i left = _mm512_maskz_compress_epi8(active, _mm512_loadu_si512(columns));
      const __m512i right = _mm512_maskz_compress_epi8(active, _mm512_loadu_si512(columns + 1));
      const __m512i low = _mm512_unpacklo_epi8(left, right), high = _mm512_unpackhi_epi8(left, right);
      // Each holds 8 of every 16 codes: put them in order.
      const __m512i first = _mm512_setr_epi64(0, 1, 8, 9, 2, 3, 10, 11),
                    second = _mm512_setr_epi64(4, 5, 12, 13, 6, 7, 14, 15);
      _mm512_storeu_si512(codes, _mm512_permutex2var_epi64(low, first, high));
      _mm512_storeu_si512(codes + 32, _mm512_permutex2var_epi64(low, second, high));
      return;
    }
#endif
    for (; active != 0; active &= active - 1) {
      const int x = std::countr_zero(active);
      *codes++ = static_cast<typename Cells<D>::Code>(columns[x] | static_cast<std::uint32_t>(columns[x + 1])
                                                                       << places);
    }
  }
  // How many simplices the unit's cells hold.
  std::uint64_t count_simplices() const {
    std::uint64_t simplices = 0;
    MarchTableReader<D> table(*job_.table);
    for (std::size_t cell = job_.result->first_code; cell < cells_.code_count; ++cell)
      simplices += table.simplex_count(cells_.codes[cell]);
    return simplices;
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
  const std::byte* row_samples_ = nullptr;
  unsigned existing_ = 0;               // axes along which there is a row before it, a set like a place
  std::int64_t rows_left_in_plane_ = 0; // of VertexNumbers; units consist of whole planes
  std::uint32_t plane_vertices_ = 0;
};

template <int D, Method M>
void scan(ScanJob<D>& job) {
  Scan<D, M>(job).run();
}

} // namespace
} // namespace hyperiso
