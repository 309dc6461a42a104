#pragma once
// Phase 1: rows of samples -> crossed edges and codes of active cells.
//
// The rows are worked on in strips, some along axis 1 at a time: first the masks of all, then the crossed
// edges and the active cells of all, as words of bits, then what is in the words that are not 0. So loops are
// long, and nothing is read right after it was written in other pieces, which would make the processor wait.

#include "extract/kernels/codes.hpp"
#include "extract/kernels/vertices.hpp"

namespace hyperiso {
namespace {

template <int D, Method M>
class Scan {
 public:
  explicit Scan(ScanJob<D>& job)
      : job_(job), samples_(*job.samples), grid_(*job.grid), unit_(job.unit), cells_(*job.cells),
        window_(*job.window), memory_(*job.memory), numbers_(*job.numbers), words_(grid_.words),
        strip_rows_(std::clamp<std::int64_t>(strip_samples / grid_.dims[0], 1, most_strip_rows)),
        queue_(job, memory_) {
    for (unsigned back = 0; back < places; ++back) {
      rows_back_[back] = grid_.rows_before_top(top ^ back);
      window_back_[back] = back & last_axis ? rows_back_[back] - grid_.layer_rows : rows_back_[back];
    }
    const std::int64_t rest = grid_.dims[0] % 64;
    last_word_bits_ = rest == 0 ? ~std::uint64_t{0} : (std::uint64_t{1} << rest) - 1;
    prepare_memory();
  }

  void run() {
    prepare_window();
    begin_result();
    if (unit_.first_layer > 0 && window_.last_layer != unit_.first_layer - 1 &&
        !fill_masks(unit_.first_layer - 1, unit_.first_row - halo(), unit_.end_row))
      return;
    for (std::int64_t layer = unit_.first_layer; layer < unit_.end_layer; ++layer) {
      if (!fill_masks(layer, unit_.first_row - halo(), unit_.first_row)) return;
      const bool complete = for_each_strip(layer, unit_.first_row, unit_.end_row, [&](std::int64_t rows) {
        if (!fill_strip(rows)) return false;
        note_ranges(rows);
        examine_strip(rows);
        return true;
      });
      if (!complete) return;
      window_.last_layer = layer;
    }
    flush_queue();
    end_result();
  }

 private:
  using Edges = CellEdges<D, M>;
  static constexpr unsigned places = Edges::column, top = Edges::top_place, last_axis = 1u << (D - 2);
  // Neighbours along axis 1 lie in the same layer, but for images, whose layers are rows.
  static constexpr unsigned axis_1 = D > 2 ? 1 : 0;

  // So much fits the first-level cache, and so many rows a vector of bytes. While the masks of a strip are
  // made, the next one is fetched, for it takes the memory longer than the masks, and less long than all the
  // rest.
  static constexpr std::int64_t strip_samples = 8192, most_strip_rows = 32;

  // Rows before the unit's that its cells touch, in the same layer.
  std::int64_t halo() const { return unit_.first_row > 0 ? grid_.halo : 0; }

  void prepare_memory() {
    const auto row_words = static_cast<std::size_t>(words_), rows = static_cast<std::size_t>(strip_rows_);
    const std::size_t most = rows * row_words * Edges::directions + margin;
    memory_.edges_exist.reset(row_words + margin);
    memory_.cells_exist.reset(row_words + margin);
    memory_.crossed.reset(most);
    memory_.active.reset(rows * row_words + margin);
    memory_.listed.reset(most);
    memory_.listed_at.reset(most);
    if (samples_.strides[0] != 1)
      memory_.gathered.reset(static_cast<std::size_t>(grid_.dims[0]) * samples_.sample_size);
    // Of a row's edges along axis 0 the first sample ends none; of its cells the last sample starts none.
    std::uint64_t *edges = memory_.edges_exist.data(), *cells = memory_.cells_exist.data();
    std::fill_n(edges, row_words, ~std::uint64_t{0});
    std::fill_n(cells, row_words, ~std::uint64_t{0});
    edges[row_words - 1] = last_word_bits_;
    cells[row_words - 1] = last_word_bits_ >> 1;
    edges[0] &= ~std::uint64_t{1};
    std::fill_n(edges + row_words, margin, 0);
    std::fill_n(cells + row_words, margin, 0);
  }
  void prepare_window() { window_.set_size(unit_.end_row - unit_.first_row + grid_.halo, words_); }
  void begin_result() {
    UnitCells& result = *job_.result;
    result.first_run = cells_.run_count;
    result.first_code = cells_.code_count;
    result.active_cells = result.simplices = result.vertices = 0;
  }
  void end_result() {
    job_.result->end_run = cells_.run_count;
    job_.result->active_cells = cells_.code_count - job_.result->first_code;
    job_.result->simplices = count_simplices();
  }
  void flush_queue() {
    queue_.flush(*job_.batch);
    if (job_.batch->count >= large_batch) job_.batch_is_large(job_.owner);
  }

  // Strips ------------------------------------------------------------------------------------------------

  // Calls use(count) for the strips of some rows of a layer, given by their numbers in it, until it returns
  // false; the strip's first row is the current one. Returns whether it never did.
  template <class Use>
  bool for_each_strip(std::int64_t layer, std::int64_t first_row, std::int64_t end_row, Use&& use) {
    index_ = {};
    index_[D - 1] = layer;
    std::int64_t rest = first_row;
    for (int axis = 1; axis < D - 1; ++axis) {
      index_[axis] = rest % grid_.dims[axis];
      rest /= grid_.dims[axis];
    }
    for (std::int64_t row = first_row, count; row < end_row; row += count) {
      row_ = layer * grid_.layer_rows + row;
      window_row_ = row - unit_.first_row + grid_.halo;
      row_samples_ = samples_.at(index_);
      count = std::min(strip_rows_, end_row - row);
      if constexpr (D > 2) count = std::min(count, grid_.dims[1] - index_[1]);
      count = std::min(count, numbers_.plane_rows - row_ % numbers_.plane_rows);
      if (!use(count)) return false;
      if constexpr (D > 2) {
        index_[1] += count;
        for (int axis = 1; axis < D - 2 && index_[axis] == grid_.dims[axis]; ++axis)
          index_[axis] = 0, ++index_[axis + 1];
      }
    }
    return true;
  }
  std::size_t parity() const { return static_cast<std::size_t>(index_[D - 1] & 1); }

  // Makes the masks of a strip. False: the field has NaN, against expectation.
  bool fill_strip(std::int64_t rows) {
    std::uint64_t* masks = window_.mask(parity(), window_row_);
    std::uint8_t* uniform = window_.uniform(parity(), window_row_);
    if (job_.given.masks) {
      std::copy_n(job_.given.masks + row_ * words_, rows * words_, masks);
      std::copy_n(job_.given.uniform + row_, rows, uniform);
      return true;
    }
    const InsideTest& test = samples_.test_in_layer(index_[D - 1]);
    bool missing = false;
    if (samples_.strides[0] == 1) {
      const SampleRows strip{row_samples_, rows, row_bytes_apart(), grid_.dims[0], next_strip(rows)};
      const NotedRanges& ranges = job_.ranges;
      missing = ranges.known ? job_.row_kernels->inside_by_ranges(strip, test, ranges.low + first_range(),
                                                                  ranges.high + first_range(), masks, uniform)
                             : job_.row_kernels->inside(strip, test, masks, uniform);
    } else {
      auto* gathered = static_cast<std::byte*>(memory_.gathered.data());
      for (std::int64_t row = 0; row < rows; ++row) {
        job_.row_kernels->gather(row_samples_ + row * row_bytes_apart(), samples_.strides[0], grid_.dims[0],
                                 gathered);
        missing |= job_.row_kernels->inside({gathered, 1, 0, grid_.dims[0]}, test, masks + row * words_,
                                            uniform + row);
      }
    }
    if (test.never) { // a level beyond the range of the type
      std::fill_n(masks, rows * words_, 0);
      std::fill_n(uniform, rows, 0);
    }
    job_.found_missing = missing && job_.present->all();
    return !job_.found_missing;
  }
  // Notes down the ranges of the samples of the strip, while the cache has them.
  void note_ranges(std::int64_t rows) const {
    const NotedRanges& ranges = job_.ranges;
    if (ranges.low == nullptr || ranges.known) return;
    job_.row_kernels->ranges({row_samples_, rows, row_bytes_apart(), grid_.dims[0]},
                             ranges.low + first_range(), ranges.high + first_range());
  }
  // In bytes.
  std::int64_t first_range() const { return row_ * words_ * static_cast<std::int64_t>(samples_.sample_size); }
  std::int64_t row_bytes_apart() const {
    return D > 2 ? samples_.strides[1] * static_cast<std::int64_t>(samples_.sample_size) : 0;
  }
  // Where the next strip lies, in bytes from this one: rows of images follow each other as layers.
  std::int64_t next_strip(std::int64_t rows) const {
    const std::int64_t stride = samples_.strides[1] * static_cast<std::int64_t>(samples_.sample_size);
    return stride * std::max<std::int64_t>(rows, D > 2 ? 1 : 4);
  }
  // The same for some rows of a layer.
  bool fill_masks(std::int64_t layer, std::int64_t first_row, std::int64_t end_row) {
    return for_each_strip(layer, first_row, end_row, [&](std::int64_t rows) { return fill_strip(rows); });
  }

  // Crossed edges that end in the strip, active cells of which its rows are the top rows.
  void examine_strip(std::int64_t rows) {
    begin_plane();
    find_neighbours();
    const std::size_t found = find_crossed_rows(rows);
    if (found == 0) return;
    add_vertices(found);
    add_cells(found);
  }

  void begin_plane() {
    if (row_ % numbers_.plane_rows != 0) return;
    plane_vertices_ = 0;
    numbers_.plane_first[static_cast<std::size_t>(row_ / numbers_.plane_rows)] = job_.result->vertices;
  }

  // Which neighbours the rows of the strip have, and their masks. Only the first row may have none along
  // axis 1.
  void find_neighbours() {
    strip_existing_ = axis_1;
    for (int axis = D > 2 ? 2 : 1; axis < D; ++axis)
      strip_existing_ |= static_cast<unsigned>(index_[axis] > 0) << (axis - 1);
    for (unsigned back = 0; back < places; ++back) {
      if ((back & ~strip_existing_) != 0) continue;
      masks_[back] =
          window_.mask(back & last_axis ? parity() ^ 1 : parity(), window_row_ - window_back_[back]);
    }
  }
  unsigned existing(std::int64_t row) const {
    return row == 0 && D > 2 && index_[1] == 0 ? strip_existing_ & ~axis_1 : strip_existing_;
  }
  const std::uint64_t* mask(unsigned back, std::int64_t row) const { return masks_[back] + row * words_; }

  // Which rows of the strip, with all their neighbours, are not of one label.
  std::array<std::uint64_t, 4> mixed_rows() {
    typedef std::uint8_t Bytes __attribute__((vector_size(most_strip_rows)));
    Bytes any{}, all = ~any;
    for (unsigned back = 0; back < places; ++back) {
      if ((back & ~strip_existing_) != 0) continue;
      Bytes uniform;
      std::memcpy(
          &uniform,
          window_.uniform(back & last_axis ? parity() ^ 1 : parity(), window_row_ - window_back_[back]),
          sizeof uniform);
      any |= uniform, all &= uniform;
    }
    const auto mixed = (any != 0) & (all != 255);
    std::array<std::uint64_t, 4> bytes;
    std::memcpy(&bytes, &mixed, sizeof bytes);
    return bytes;
  }

  // Writes the words of crossed edges and active cells of the rows that may have some, and lists those rows.
  std::size_t find_crossed_rows(std::int64_t rows) {
    std::size_t found = 0;
    const std::array<std::uint64_t, 4> mixed = mixed_rows();
    for (std::int64_t first = 0; first < rows; first += 8) {
      std::uint64_t eight = mixed[static_cast<std::size_t>(first / 8)];
      if (rows - first < 8) eight &= (std::uint64_t{1} << (8 * (rows - first))) - 1;
      for (; eight != 0; ++found) {
        const int byte = std::countr_zero(eight) / 8;
        eight &= ~(std::uint64_t{255} << (8 * byte));
        found_rows_[found] = first + byte;
        find_crossed_edges(first + byte, memory_.crossed.data() + found * Edges::directions * row_words());
        find_active_cells(first + byte, memory_.active.data() + found * row_words());
      }
    }
    std::fill_n(memory_.crossed.data() + found * Edges::directions * row_words(), word_lanes, 0);
    std::fill_n(memory_.active.data() + found * row_words(), word_lanes, 0);
    return found;
  }
  std::size_t row_words() const { return static_cast<std::size_t>(words_); }

  // Vertices ----------------------------------------------------------------------------------------------

  // The upper ends of the crossed edges that end in a row, for each direction; and words of no meaning
  // behind.
  void find_crossed_edges(std::int64_t row, std::uint64_t* crossed) const {
    const unsigned exist = existing(row);
    const std::uint64_t* upper = mask(0, row);
    for (unsigned number = 0; number < Edges::directions; ++number, crossed += words_) {
      const unsigned direction = Edges::direction(number), back = direction >> 1;
      if ((back & ~exist) != 0) {
        std::fill_n(crossed, words_, 0);
        continue;
      }
      const std::uint64_t* lower = mask(back, row);
      const std::uint64_t* edges_exist = memory_.edges_exist.data();
      for (std::int64_t word = 0; word < words_; word += word_lanes) {
        const Words ends = load_words(upper + word), starts = load_words(lower + word);
        if (direction & 1)
          store_words(crossed + word, (ends ^ (starts << 1 | load_words(lower + word - 1) >> 63)) &
                                          load_words(edges_exist + word));
        else
          store_words(crossed + word, ends ^ starts);
      }
      if (!job_.present->all())
        for (std::int64_t word = 0; word < words_; ++word)
          crossed[word] &= edges_of_present_cells(direction, 0, row, word);
    }
  }

  // The upper ends of the edges of a direction that belong to a cell without NaN and end in the row `end`
  // before one of the strip. Such a cell starts in a row that lies further back along the edge's axes, and
  // maybe along others.
  std::uint64_t edges_of_present_cells(unsigned direction, unsigned end, std::int64_t row,
                                       std::int64_t word) const {
    std::uint64_t edges = 0;
    for (unsigned back = 0; back < places; ++back) {
      if ((direction >> 1 & ~back) != 0 || !row_exists(end, back, row)) continue;
      const std::uint64_t* cells = present_cells(row, rows_back_[end] + rows_back_[back]);
      edges |= cells[word] << 1 | (word > 0 ? cells[word - 1] >> 63 : 0);
      if ((direction & 1) == 0) edges |= cells[word];
    }
    return edges;
  }
  bool row_exists(unsigned end, unsigned back, std::int64_t row) const {
    for (int axis = 1; axis < D; ++axis)
      if (index_[axis] + (axis == 1 ? row : 0) < (end >> (axis - 1) & 1) + (back >> (axis - 1) & 1))
        return false;
    return true;
  }
  // Cells without NaN whose lowest corners are in the row so many rows before one of the strip.
  const std::uint64_t* present_cells(std::int64_t row, std::int64_t rows_back) const {
    return job_.present->words.data() + (row_ + row - rows_back) * words_;
  }

  // Adds the vertices on the crossed edges of the rows found.
  void add_vertices(std::size_t found) {
    if (!queue_.has_room_for(found)) {
      flush_queue();
      queue_.forget_rows();
    }
    std::uint32_t first_group = 0;
    const std::uint64_t* crossed = memory_.crossed.data();
    const std::uint32_t before = plane_vertices_;
    for (std::size_t i = 0; i < found; ++i) {
      const std::int64_t row = found_rows_[i];
      auto index = index_;
      if constexpr (D > 2) index[1] += row;
      const std::uint32_t group = queue_.add_row(row_ + row, index, samples_.at(index));
      if (i == 0) first_group = group; // those of the others follow
      std::uint32_t* row_first =
          &numbers_.row_first[static_cast<std::size_t>(row_ + row) * Edges::directions];
      for (unsigned number = 0; number < Edges::directions; ++number) {
        row_first[number] = plane_vertices_;
        for (std::int64_t word = 0; word < words_; ++word)
          plane_vertices_ += static_cast<std::uint32_t>(std::popcount(*crossed++));
      }
    }
    job_.result->vertices += plane_vertices_ - before;

    const std::size_t listed = list_nonzero(memory_.crossed.data(), found * Edges::directions * row_words(),
                                            memory_.listed.data(), memory_.listed_at.data());
    const auto words = static_cast<std::uint32_t>(words_);
    for (std::size_t i = 0; i < listed; ++i) {
      const std::uint32_t at = memory_.listed_at[i], group = at / words;
      queue_.add(memory_.listed[i], at - group * words, first_group + group);
      if (queue_.has_enough()) flush_queue();
    }
  }

  // Cells -------------------------------------------------------------------------------------------------

  // Which cells below a row have both labels.
  void find_active_cells(std::int64_t row, std::uint64_t* active) const {
    if (existing(row) != top) {
      std::fill_n(active, words_, 0);
      return;
    }
    const std::uint64_t* cells_exist = memory_.cells_exist.data();
    std::int64_t word = (words_ - 1) / word_lanes * word_lanes;
    // From the end, for a cell in the last place of a word ends in the next. Behind the row there is
    // anything, but no cell.
    Words next_any{}, next_all{};
    for (; word >= 0; word -= word_lanes) {
      Words any{}, all = ~any;
      for (unsigned back = 0; back < places; ++back) {
        const Words labels = load_words(mask(back, row) + word);
        any |= labels, all &= labels;
      }
      const Words any_right = any >> 1 | following(any, next_any) << 63;
      const Words all_right = all >> 1 | following(all, next_all) << 63;
      next_any = any, next_all = all;
      const Words both = (any | any_right) & ~(all & all_right) & load_words(cells_exist + word);
      if (word + word_lanes <= words_)
        store_words(active + word, both);
      else
        std::memcpy(active + word, &both, static_cast<std::size_t>(words_ - word) * sizeof(std::uint64_t));
    }
    if (!job_.present->all())
      for (word = 0; word < words_; ++word) active[word] &= present_cells(row, rows_back_[top])[word];
  }

  // Adds the codes of the active cells below the rows found, and lists them as runs.
  void add_cells(std::size_t found) {
    const std::size_t listed = list_nonzero(memory_.active.data(), found * row_words(), memory_.listed.data(),
                                            memory_.listed_at.data());
    if (listed == 0) return;
    // A word's codes may be written whole, wherever they begin.
    make_room(cells_.codes, cells_.code_count + 64 * listed + 64);
    make_room(cells_.runs, cells_.run_count + found * most_runs_in_row());
    std::uint32_t last = UINT32_MAX; // of the rows found
    for (std::size_t i = 0; i < listed; ++i) {
      const std::uint64_t active = memory_.listed[i];
      const std::uint32_t at = memory_.listed_at[i], number = at / static_cast<std::uint32_t>(words_);
      const auto word = static_cast<std::int64_t>(at) - number * words_;
      const std::int64_t row = found_rows_[number];
      const std::int64_t offset = row * words_ + word;
      write_codes<D>(
          active, [&](unsigned place) { return masks_[top ^ place] + offset; },
          cells_.codes.data() + cells_.code_count);
      const auto cells = static_cast<std::uint32_t>(std::popcount(active));
      cells_.code_count += cells;
      if (!job_.present->all() && !row_of_cells_is_present(row)) {
        if (number != last) add_runs_between_missing(number);
      } else {
        // Without a branch: whether a row goes on is hard to guess.
        const std::uint32_t before = number == last ? cells_.runs[cells_.run_count - 1].cells : 0;
        cells_.run_count += number != last;
        CellRun& run = cells_.runs[cells_.run_count - 1];
        run.row = row_ + row;
        run.cells = before + cells;
        run.restart = CellRun::no_restart;
      }
      last = number;
    }
  }
  std::size_t most_runs_in_row() const {
    return job_.present->all() ? 1 : static_cast<std::size_t>(grid_.dims[0] / 2 + 1);
  }
  template <class T>
  static void make_room(Array<T>& array, std::size_t size) {
    if (size > array.size()) array.resize(std::max(2 * array.size(), size));
  }

  // How many simplices the unit's cells hold.
  std::uint64_t count_simplices() const {
    std::uint64_t simplices = 0;
    MarchTableReader<D> table(*job_.table);
    for (std::size_t cell = job_.result->first_code; cell < cells_.code_count; ++cell)
      simplices += table.simplex_count(cells_.codes[cell]);
    return simplices;
  }

  bool row_of_cells_is_present(std::int64_t row) const {
    const std::uint64_t* cells = present_cells(row, rows_back_[top]);
    for (std::int64_t word = 0; word < words_ - 1; ++word)
      if (~cells[word] != 0) return false;
    return cells[words_ - 1] == last_word_bits_ >> 1;
  }

  // Behind a cell with NaN, the next cell's labels do not tell how many vertices the row had so far: a run
  // starts wherever an active cell does not follow another. `number`: of the rows found.
  void add_runs_between_missing(std::size_t number) {
    const std::uint64_t* active = memory_.active.data() + number * row_words();
    bool follows = false;
    for (std::int64_t x = 0; x < 64 * words_; ++x) {
      const bool is_active = active[x / 64] >> (x % 64) & 1;
      if (is_active && !follows) begin_run(found_rows_[number], x);
      if (is_active) ++cells_.runs[cells_.run_count - 1].cells;
      follows = is_active;
    }
  }
  void begin_run(std::int64_t row, std::int64_t x) {
    cells_.runs[cells_.run_count++] = {row_ + row, 0, static_cast<std::uint32_t>(cells_.restarts.size())};
    // An edge within the left column ends at x, one across at x + 1.
    for (const CellEdge edge : Edges::in_column_edges)
      cells_.restarts.push_back(crossed_before(edge, false, row, x));
    for (const CellEdge edge : Edges::across_edges)
      cells_.restarts.push_back(crossed_before(edge, true, row, x + 1));
  }
  // How many crossed edges of the direction of `edge` end in its row before x.
  std::uint32_t crossed_before(CellEdge edge, bool across, std::int64_t row, std::int64_t x) const {
    const unsigned direction = static_cast<unsigned>(edge.lower ^ edge.upper) << 1 | across;
    const unsigned end = top ^ edge.upper;
    const std::uint64_t *upper = mask(end, row), *lower = mask(top ^ edge.lower, row);
    std::uint32_t count = 0;
    for (std::int64_t word = 0; 64 * word < x; ++word) {
      std::uint64_t starts = lower[word];
      if (across) starts = starts << 1 | lower[word - 1] >> 63;
      std::uint64_t crossed = (upper[word] ^ starts) & edges_of_present_cells(direction, end, row, word);
      if (across) crossed &= memory_.edges_exist[static_cast<std::size_t>(word)];
      if (x < 64 * (word + 1)) crossed &= (std::uint64_t{1} << (x - 64 * word)) - 1;
      count += static_cast<std::uint32_t>(std::popcount(crossed));
    }
    return count;
  }

  static constexpr std::size_t large_batch = 8192;
  static constexpr std::size_t margin = 16; // words that a vector may read or write behind others

  ScanJob<D>& job_;
  const Samples<D>& samples_;
  const RowGrid<D>& grid_;
  const Unit unit_;
  Cells<D>& cells_;
  MaskWindow& window_;
  ScanMemory& memory_;
  VertexNumbers& numbers_;
  const std::int64_t words_, strip_rows_;
  std::uint64_t last_word_bits_;                   // of samples in the last word of a row
  std::array<std::int64_t, places> rows_back_{};   // how far the row `back` before one lies in the field
  std::array<std::int64_t, places> window_back_{}; // and in the window, but for the layer
  EdgeQueue<D, M> queue_;
  std::uint32_t plane_vertices_ = 0;

  // Of the strip's first row:
  std::array<std::int64_t, D> index_{}; // of its first sample
  std::int64_t row_ = 0, window_row_ = 0;
  const std::byte* row_samples_ = nullptr;
  unsigned strip_existing_ = 0; // axes along which there is a row before, a set like a place; for axis 1, of
                                // the others
  std::array<const std::uint64_t*, places> masks_{};       // of the row `back` before it
  std::array<std::int64_t, most_strip_rows> found_rows_{}; // of the strip, that may have crossed edges
};

template <int D, Method M>
void scan(ScanJob<D>& job) {
  Scan<D, M>(job).run();
}

} // namespace
} // namespace hyperiso
