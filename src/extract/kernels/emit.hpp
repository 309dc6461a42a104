#pragma once
// Phase 2: codes of active cells -> simplices.
//
// Along a row the vertices of each direction are numbered on. So it takes only the codes to follow the number
// of every edge of the cell: where a column's labels differ at the ends of an edge, there is one more.

#include "extract/kernels/emit_on_demand.hpp"

namespace hyperiso {
namespace {

// As stream_lines, with the widest stores there are.
inline void stream_vectors(std::byte* to, const std::byte* from, std::ptrdiff_t bytes) {
#if defined(HYPERISO_AVX512)
  for (std::ptrdiff_t i = 0; i < bytes; i += 64)
    _mm512_stream_si512(reinterpret_cast<__m512i*>(to + i), _mm512_loadu_si512(from + i));
#elif defined(HYPERISO_AVX2)
  for (std::ptrdiff_t i = 0; i < bytes; i += 32)
    _mm256_stream_si256(reinterpret_cast<__m256i*>(to + i),
                        _mm256_loadu_si256(reinterpret_cast<const __m256i*>(from + i)));
#else
  stream_lines(to, from, bytes);
#endif
}

// Writes whole cache lines, past the caches, from a buffer that stays in the first of them.
template <class T>
class LineWriter {
 public:
  explicit LineWriter(T* to)
      : to_(reinterpret_cast<std::byte*>(to)), skip_(reinterpret_cast<std::uintptr_t>(to) % line) {
    to_ -= skip_; // the buffer begins like the line that `to` is in
    out_ = reinterpret_cast<T*>(buffer_ + skip_);
  }
  // Where to write next. There is room for the simplices of a cell, and for a vector that is written beyond
  // them, unless it is full.
  T* end() { return out_; }
  bool is_full(const T* end) const { return reinterpret_cast<const std::byte*>(end) - buffer_ >= full; }
  T* make_room(T* end) {
    out_ = end;
    flush();
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
    stream_vectors(to_ + done, buffer_ + done, bytes - done);
    to_ += bytes;
    std::memcpy(buffer_, buffer_ + bytes, line);
    out_ = reinterpret_cast<T*>(reinterpret_cast<std::byte*>(out_) - bytes);
  }

  std::byte* to_;
  T* out_;
  std::size_t skip_; // bytes of the first line that are others'
  alignas(line) std::byte buffer_[full + room_bytes + line];
};

// Which edges within a column are crossed, by its labels: as bytes and as a bit mask.
template <int D, Method M>
constexpr auto crossed_in_column = [] {
  using Edges = CellEdges<D, M>;
  std::array<std::array<std::uint8_t, (Edges::in_column + 15) / 16 * 16>, 1 << Edges::column> crossed{};
  for (unsigned labels = 0; labels < crossed.size(); ++labels)
    for (unsigned edge = 0; edge < Edges::in_column; ++edge) {
      const CellEdge ends = Edges::in_column_edges[edge];
      crossed[labels][edge] = ((labels >> ends.lower) ^ (labels >> ends.upper)) & 1;
    }
  return crossed;
}();
template <int D, Method M>
constexpr auto crossed_mask = [] {
  std::array<std::uint32_t, 1 << CellEdges<D, M>::column> masks{};
  for (unsigned labels = 0; labels < masks.size(); ++labels)
    for (unsigned edge = 0; edge < CellEdges<D, M>::in_column; ++edge)
      masks[labels] |= std::uint32_t{crossed_in_column<D, M>[labels][edge]} << edge;
  return masks;
}();

// The labels of the lower and of the upper ends of the edges across, by the labels of their columns.
template <int D, Method M>
struct AcrossLabels {
  static constexpr unsigned across = (CellEdges<D, M>::across + 7) / 8 * 8;
  std::array<std::array<std::uint8_t, across>, 1 << CellEdges<D, M>::column> lower{}, upper{};
};
template <int D, Method M>
constexpr AcrossLabels<D, M> across_labels = [] {
  using Edges = CellEdges<D, M>;
  AcrossLabels<D, M> table;
  for (unsigned labels = 0; labels < table.lower.size(); ++labels)
    for (unsigned edge = 0; edge < Edges::across; ++edge) {
      table.lower[labels][edge] = labels >> Edges::across_edges[edge].lower & 1;
      table.upper[labels][edge] = labels >> Edges::across_edges[edge].upper & 1;
    }
  return table;
}();

// The same as bit masks.
template <int D, Method M>
struct AcrossMask {
  std::array<std::uint32_t, 1 << CellEdges<D, M>::column> lower{}, upper{};
};
template <int D, Method M>
constexpr AcrossMask<D, M> across_mask = [] {
  AcrossMask<D, M> masks;
  for (unsigned labels = 0; labels < masks.lower.size(); ++labels)
    for (unsigned edge = 0; edge < CellEdges<D, M>::across; ++edge) {
      masks.lower[labels] |= std::uint32_t{across_labels<D, M>.lower[labels][edge]} << edge;
      masks.upper[labels] |= std::uint32_t{across_labels<D, M>.upper[labels][edge]} << edge;
    }
  return masks;
}();

// The rows of a run of cells, by their place in a column: the numbers of the first vertices of each direction
// in the row, counted from those of the row's plane.
template <int D>
struct RunStart {
  std::array<const std::uint32_t*, 1 << (D - 1)> row_first;
  std::array<std::uint64_t, 1 << (D - 1)> plane_first;
};
// The number of the first vertex on an edge of the cells of a run.
template <class Index, Method M, int D>
Index first(const RunStart<D>& run, CellEdge edge, bool across) {
  const unsigned direction = static_cast<unsigned>(edge.lower ^ edge.upper) << 1 | across;
  return static_cast<Index>(run.plane_first[edge.upper] +
                            run.row_first[edge.upper][CellEdges<D, M>::direction_number(direction)]);
}

// The numbers of the vertices on the edges of a cell, while the march goes from cell to cell.
//
// `enter(left, right)` takes the labels of the next cell's columns. Then `write` looks up the corners of its
// simplices, and may write some beyond them; then `leave(left, right)` counts on.
template <int D, Method M, class Index>
class CellNumbers {
 public:
  using Edges = CellEdges<D, M>;

  void start(const RunStart<D>& run) {
    for (unsigned edge = 0; edge < Edges::in_column; ++edge)
      in_column_[edge] = first<Index, M>(run, Edges::in_column_edges[edge], false);
    for (unsigned edge = 0; edge < Edges::across; ++edge)
      across_[edge] = first<Index, M>(run, Edges::across_edges[edge], true);
  }
  // Some vertices of the row come before the run.
  void skip(const std::uint32_t* in_column, const std::uint32_t* across) {
    for (unsigned edge = 0; edge < Edges::in_column; ++edge) in_column_[edge] += in_column[edge];
    for (unsigned edge = 0; edge < Edges::across; ++edge) across_[edge] += across[edge];
  }
  void enter(unsigned left, unsigned) {
    for (unsigned edge = 0; edge < Edges::in_column; ++edge)
      slots_[Edges::left_slot + edge] = in_column_[edge];
    for (unsigned edge = 0; edge < Edges::in_column; ++edge)
      slots_[Edges::right_slot + edge] = in_column_[edge] += crossed_in_column<D, M>[left][edge];
    for (unsigned edge = 0; edge < Edges::half; ++edge)
      slots_[Edges::first_across_slot + edge] = across_[edge];
    for (unsigned edge = Edges::half; edge < Edges::across; ++edge)
      slots_[Edges::second_across_slot + edge - Edges::half] = across_[edge];
  }
  void write(const std::uint8_t* corners, std::uint32_t count, Index* out) const {
    for (const std::uint8_t* end = corners + count; corners != end; corners += D, out += D)
      for (int k = 0; k < D; ++k) out[k] = slots_[corners[k]];
  }
  void leave(unsigned left, unsigned right) {
    for (unsigned edge = 0; edge < Edges::across; ++edge)
      across_[edge] += across_labels<D, M>.lower[left][edge] ^ across_labels<D, M>.upper[right][edge];
  }

 private:
  Index in_column_[Edges::in_column], across_[Edges::across];
  Index slots_[Edges::slots];
};

#if defined(HYPERISO_AVX512)

// Two vectors hold all slots; a permutation of both looks up 16 corners.
template <>
class CellNumbers<4, Method::hull, std::uint32_t> {
 public:
  using Edges = CellEdges<4, Method::hull>;

  // The four numbers of a row are those of its edges across and along each axis.
  void start(const RunStart<4>& run) {
    const auto row = [&](unsigned place) {
      return _mm_add_epi32(_mm_loadu_si128(reinterpret_cast<const __m128i*>(run.row_first[place])),
                           _mm_set1_epi32(static_cast<int>(run.plane_first[place])));
    };
    __m512i low = _mm512_castsi128_si512(row(0)), high = _mm512_castsi128_si512(row(4));
    low = _mm512_inserti32x4(low, row(1), 1), high = _mm512_inserti32x4(high, row(5), 1);
    low = _mm512_inserti32x4(low, row(2), 2), high = _mm512_inserti32x4(high, row(6), 2);
    low = _mm512_inserti32x4(low, row(3), 3), high = _mm512_inserti32x4(high, row(7), 3);
    left_ = _mm512_permutex2var_epi32(low, _mm512_load_si512(row_number_of_slot.data()), high);
    right_ = _mm512_permutex2var_epi32(low, _mm512_load_si512(row_number_of_slot.data() + 16), high);
  }
  void skip(const std::uint32_t* in_column, const std::uint32_t* across) {
    const __m512i columns = _mm512_maskz_loadu_epi32(column_lanes, in_column);
    left_ = _mm512_add_epi32(left_, _mm512_mask_loadu_epi32(columns, 0xf000, across - 12));
    right_ = _mm512_add_epi32(right_, _mm512_mask_loadu_epi32(columns, 0xf000, across + 4 - 12));
  }
  void enter(unsigned left, unsigned) {
    right_ = _mm512_mask_mov_epi32(right_, column_lanes, left_);
    right_ = _mm512_mask_add_epi32(right_, static_cast<__mmask16>(crossed_mask<4, Method::hull>[left]),
                                   right_, _mm512_set1_epi32(1));
  }
  void write(const std::uint8_t* corners, std::uint32_t count, std::uint32_t* out) const {
    // Up to 12 simplices without a branch, for how many a cell has is hard to guess.
    for (std::uint32_t i = 0; i < 48; i += 16) write_16(corners + i, out + i);
    for (std::uint32_t i = 48; i < count; i += 16) write_16(corners + i, out + i);
  }
  void leave(unsigned left, unsigned right) {
    const unsigned crossed = left ^ right;
    left_ = _mm512_mask_mov_epi32(left_, column_lanes, right_);
    left_ = _mm512_mask_add_epi32(left_, static_cast<__mmask16>(crossed << 12), left_, _mm512_set1_epi32(1));
    right_ = _mm512_mask_add_epi32(right_, static_cast<__mmask16>(crossed >> 4 << 12), right_,
                                   _mm512_set1_epi32(1));
  }

 private:
  void write_16(const std::uint8_t* corners, std::uint32_t* out) const {
    const __m512i slots = _mm512_cvtepu8_epi32(_mm_loadu_si128(reinterpret_cast<const __m128i*>(corners)));
    _mm512_storeu_si512(out, _mm512_permutex2var_epi32(left_, slots, right_));
  }
  static constexpr __mmask16 column_lanes = 0x0fff;
  // For each slot, the number of its first vertex among those of the rows: 4 place + axis.
  alignas(64) static constexpr std::array<std::uint32_t, 32> row_number_of_slot = [] {
    std::array<std::uint32_t, 32> numbers{};
    for (unsigned edge = 0; edge < Edges::in_column; ++edge) {
      const CellEdge ends = Edges::in_column_edges[edge];
      const unsigned number =
          4u * ends.upper + 1 +
          static_cast<unsigned>(std::countr_zero(static_cast<unsigned>(ends.lower ^ ends.upper)));
      numbers[Edges::left_slot + edge] = numbers[Edges::right_slot + edge] = number;
    }
    for (unsigned place = 0; place < 4; ++place) {
      numbers[Edges::first_across_slot + place] = 4 * place;
      numbers[Edges::second_across_slot + place] = 4 * (place + 4);
    }
    return numbers;
  }();
  __m512i left_, right_;
};

template <>
class CellNumbers<3, Method::hull, std::uint32_t> {
 public:
  void start(const RunStart<3>& run) {
    using Edges = CellEdges<3, Method::hull>;
    const auto along = [&](unsigned edge) {
      return static_cast<int>(first<std::uint32_t, Method::hull>(run, Edges::in_column_edges[edge], false));
    };
    const auto across = [&](unsigned edge) {
      return static_cast<int>(first<std::uint32_t, Method::hull>(run, Edges::across_edges[edge], true));
    };
    left_ = _mm_setr_epi32(along(0), along(1), along(2), along(3));
    across_ = _mm_setr_epi32(across(0), across(1), across(2), across(3));
  }
  void skip(const std::uint32_t* in_column, const std::uint32_t* across) {
    left_ = _mm_add_epi32(left_, _mm_loadu_si128(reinterpret_cast<const __m128i*>(in_column)));
    across_ = _mm_add_epi32(across_, _mm_loadu_si128(reinterpret_cast<const __m128i*>(across)));
  }
  void enter(unsigned left, unsigned) {
    const __m128i right = _mm_mask_add_epi32(
        left_, static_cast<__mmask8>(crossed_mask<3, Method::hull>[left]), left_, _mm_set1_epi32(1));
    slots_ = _mm512_inserti32x4(_mm512_castsi128_si512(left_), right, 1);
    slots_ = _mm512_inserti32x4(slots_, across_, 2);
    left_ = right;
  }
  void write(const std::uint8_t* corners, std::uint32_t count, std::uint32_t* out) const {
    const std::uint8_t* end = corners + count;
    do {
      const __m512i slots = _mm512_cvtepu8_epi32(_mm_loadu_si128(reinterpret_cast<const __m128i*>(corners)));
      _mm512_storeu_si512(out, _mm512_permutexvar_epi32(slots, slots_));
      corners += 16, out += 16;
    } while (corners < end);
  }
  void leave(unsigned left, unsigned right) {
    across_ = _mm_mask_add_epi32(across_, static_cast<__mmask8>(left ^ right), across_, _mm_set1_epi32(1));
  }

 private:
  __m128i left_, across_;
  __m512i slots_;
};

// Pairs of vectors hold the slots of either column and those across; of each a permutation looks up 16
// corners, and the slots' upper bits choose among them.
template <>
class CellNumbers<4, Method::simplicial, std::uint32_t> {
 public:
  using Edges = CellEdges<4, Method::simplicial>;

  void start(const RunStart<4>& run) {
    std::uint32_t in_column[32] = {}, across[32] = {};
    for (unsigned edge = 0; edge < Edges::in_column; ++edge)
      in_column[edge] = first<std::uint32_t, Method::simplicial>(run, Edges::in_column_edges[edge], false);
    for (unsigned edge = 0; edge < Edges::across; ++edge)
      across[edge] = first<std::uint32_t, Method::simplicial>(run, Edges::across_edges[edge], true);
    right_ = left_ = load(in_column);
    across_ = load(across);
  }
  void skip(const std::uint32_t* in_column, const std::uint32_t* across) {
    std::uint32_t padded[2][32] = {};
    std::copy_n(in_column, Edges::in_column, padded[0]);
    std::copy_n(across, Edges::across, padded[1]);
    left_ = {_mm512_add_epi32(left_.low, load(padded[0]).low),
             _mm512_add_epi32(left_.high, load(padded[0]).high)};
    across_ = {_mm512_add_epi32(across_.low, load(padded[1]).low),
               _mm512_add_epi32(across_.high, load(padded[1]).high)};
  }
  void enter(unsigned left, unsigned) { right_ = counted(left_, crossed_mask<4, Method::simplicial>[left]); }
  void write(const std::uint8_t* corners, std::uint32_t count, std::uint32_t* out) const {
    const std::uint8_t* end = corners + count;
    do {
      const __m512i slots = _mm512_cvtepu8_epi32(_mm_loadu_si128(reinterpret_cast<const __m128i*>(corners)));
      const __m512i in_left = _mm512_permutex2var_epi32(left_.low, slots, left_.high);
      const __m512i in_right = _mm512_permutex2var_epi32(right_.low, slots, right_.high);
      const __m512i is_across = _mm512_permutex2var_epi32(across_.low, slots, across_.high);
      __m512i number =
          _mm512_mask_mov_epi32(in_left, _mm512_test_epi32_mask(slots, _mm512_set1_epi32(32)), in_right);
      number = _mm512_mask_mov_epi32(number, _mm512_test_epi32_mask(slots, _mm512_set1_epi32(64)), is_across);
      _mm512_storeu_si512(out, number);
      corners += 16, out += 16;
    } while (corners < end);
  }
  void leave(unsigned left, unsigned right) {
    left_ = right_;
    across_ = counted(across_, across_mask<4, Method::simplicial>.lower[left] ^
                                   across_mask<4, Method::simplicial>.upper[right]);
  }

 private:
  struct Pair {
    __m512i low, high;
  };
  static Pair load(const std::uint32_t* from) {
    return {_mm512_loadu_si512(from), _mm512_loadu_si512(from + 16)};
  }
  // One more where a bit is set.
  static Pair counted(Pair numbers, std::uint32_t bits) {
    const __m512i one = _mm512_set1_epi32(1);
    return {_mm512_mask_add_epi32(numbers.low, static_cast<__mmask16>(bits), numbers.low, one),
            _mm512_mask_add_epi32(numbers.high, static_cast<__mmask16>(bits >> 16), numbers.high, one)};
  }
  Pair left_, right_, across_;
};

#elif defined(HYPERISO_AVX2)

// Four vectors hold all slots; a permutation of each, and a choice among them, looks up 8 corners.
template <>
class CellNumbers<4, Method::hull, std::uint32_t> {
 public:
  using Edges = CellEdges<4, Method::hull>;

  void start(const RunStart<4>& run) {
    const auto along = [&](unsigned edge) {
      return static_cast<int>(first<std::uint32_t, Method::hull>(run, Edges::in_column_edges[edge], false));
    };
    const auto across = [&](unsigned edge) {
      return static_cast<int>(first<std::uint32_t, Method::hull>(run, Edges::across_edges[edge], true));
    };
    right_ = left_ =
        _mm256_setr_epi32(along(0), along(1), along(2), along(3), along(4), along(5), along(6), along(7));
    left_rest_ = _mm256_setr_epi32(along(8), along(9), along(10), along(11), across(0), across(1), across(2),
                                   across(3));
    right_rest_ = _mm256_setr_epi32(along(8), along(9), along(10), along(11), across(4), across(5), across(6),
                                    across(7));
  }
  void skip(const std::uint32_t* in_column, const std::uint32_t* across) {
    left_ = _mm256_add_epi32(left_, load(in_column));
    left_rest_ = _mm256_add_epi32(left_rest_, _mm256_setr_m128i(load_half(in_column + 8), load_half(across)));
    right_rest_ =
        _mm256_add_epi32(right_rest_, _mm256_setr_m128i(load_half(in_column + 8), load_half(across + 4)));
  }
  void enter(unsigned left, unsigned) {
    const std::uint8_t* crossed = crossed_in_column<4, Method::hull>[left].data();
    right_ = _mm256_add_epi32(left_, widen(crossed));
    right_rest_ = _mm256_add_epi32(_mm256_blend_epi32(left_rest_, right_rest_, 0xf0), widen(crossed + 8));
  }
  void write(const std::uint8_t* corners, std::uint32_t count, std::uint32_t* out) const {
    const std::uint8_t* end = corners + count;
    do {
      const __m256i slots = widen(corners);
      const __m256i low = choose(_mm256_slli_epi32(slots, 28), _mm256_permutevar8x32_epi32(left_, slots),
                                 _mm256_permutevar8x32_epi32(left_rest_, slots));
      const __m256i high = choose(_mm256_slli_epi32(slots, 28), _mm256_permutevar8x32_epi32(right_, slots),
                                  _mm256_permutevar8x32_epi32(right_rest_, slots));
      _mm256_storeu_si256(reinterpret_cast<__m256i*>(out), choose(_mm256_slli_epi32(slots, 27), low, high));
      corners += 8, out += 8;
    } while (corners < end);
  }
  void leave(unsigned left, unsigned right) {
    const unsigned crossed = left ^ right;
    left_ = right_;
    left_rest_ =
        _mm256_add_epi32(_mm256_blend_epi32(right_rest_, left_rest_, 0xf0), widen(nibble_[crossed & 15]));
    right_rest_ = _mm256_add_epi32(right_rest_, widen(nibble_[crossed >> 4]));
  }

 private:
  static __m256i load(const std::uint32_t* from) {
    return _mm256_loadu_si256(reinterpret_cast<const __m256i*>(from));
  }
  static __m128i load_half(const std::uint32_t* from) {
    return _mm_loadu_si128(reinterpret_cast<const __m128i*>(from));
  }
  static __m256i widen(const std::uint8_t* from) {
    return _mm256_cvtepu8_epi32(_mm_loadl_epi64(reinterpret_cast<const __m128i*>(from)));
  }
  // By the sign bits of `by`.
  static __m256i choose(__m256i by, __m256i if_clear, __m256i if_set) {
    return _mm256_castps_si256(_mm256_blendv_ps(_mm256_castsi256_ps(if_clear), _mm256_castsi256_ps(if_set),
                                                _mm256_castsi256_ps(by)));
  }
  // The bits of a nibble in the upper half of a vector.
  static constexpr std::uint8_t nibble_[16][8] = {
      {0, 0, 0, 0, 0, 0, 0, 0}, {0, 0, 0, 0, 1, 0, 0, 0}, {0, 0, 0, 0, 0, 1, 0, 0}, {0, 0, 0, 0, 1, 1, 0, 0},
      {0, 0, 0, 0, 0, 0, 1, 0}, {0, 0, 0, 0, 1, 0, 1, 0}, {0, 0, 0, 0, 0, 1, 1, 0}, {0, 0, 0, 0, 1, 1, 1, 0},
      {0, 0, 0, 0, 0, 0, 0, 1}, {0, 0, 0, 0, 1, 0, 0, 1}, {0, 0, 0, 0, 0, 1, 0, 1}, {0, 0, 0, 0, 1, 1, 0, 1},
      {0, 0, 0, 0, 0, 0, 1, 1}, {0, 0, 0, 0, 1, 0, 1, 1}, {0, 0, 0, 0, 0, 1, 1, 1}, {0, 0, 0, 0, 1, 1, 1, 1}};

  // Slots 0 to 7, 8 to 15, 16 to 23, 24 to 31.
  __m256i left_, left_rest_, right_, right_rest_;
};

#endif

template <int D, Method M, class Index>
class Emit {
 public:
  explicit Emit(const EmitJob<D>& job) : job_(job), writer_(static_cast<Index*>(job.corners)) {
    for (unsigned place = 0; place < Edges::column; ++place)
      rows_before_[place] = job.grid->rows_before_top(place);
  }

  void run() {
    const auto* codes = job_.cells->codes.data() + job_.unit->first_code;
    for (std::size_t run = job_.unit->first_run; run < job_.unit->end_run; ++run) {
      const CellRun& cells = job_.cells->runs[run];
      start(cells);
      emit_cells(codes, cells.cells);
      codes += cells.cells;
    }
    writer_.finish();
  }

 private:
  using Edges = CellEdges<D, M>;
  void emit_cells(const typename Cells<D>::Code* codes, std::uint32_t count) {
    const std::uint32_t* first = job_.table->first.data();
    const std::uint8_t* corners = job_.table->corners.data();
    CellNumbers<D, M, Index> numbers = numbers_;
    Index* out = writer_.end();
    for (std::uint32_t cell = 0; cell < count; ++cell) {
      const std::uint32_t code = codes[cell];
      const unsigned left = code & ((1u << Edges::column) - 1), right = code >> Edges::column;
      numbers.enter(left, right);
      numbers.write(corners + first[code], first[code + 1] - first[code], out);
      numbers.leave(left, right);
      out += first[code + 1] - first[code];
      if (writer_.is_full(out)) out = writer_.make_room(out);
    }
    writer_.set_end(out);
  }

  void start(const CellRun& run) {
    const VertexNumbers& numbers = *job_.numbers;
    RunStart<D> rows;
    for (unsigned place = 0; place < Edges::column; ++place) {
      const auto row = static_cast<std::uint64_t>(run.row - rows_before_[place]);
      rows.row_first[place] = numbers.row_first.data() + row * Edges::directions;
      rows.plane_first[place] = numbers.plane_first[row / static_cast<std::uint64_t>(numbers.plane_rows)];
    }
    numbers_.start(rows);
    if (run.restart == CellRun::no_restart) return;
    const std::uint32_t* before = job_.cells->restarts.data() + run.restart;
    numbers_.skip(before, before + Edges::in_column);
  }

  const EmitJob<D>& job_;
  std::array<std::int64_t, Edges::column> rows_before_{};
  CellNumbers<D, M, Index> numbers_;
  LineWriter<Index> writer_;
};

template <int D, Method M, class Index>
void emit(const EmitJob<D>& job) {
  if constexpr (D <= 4)
    Emit<D, M, Index>(job).run();
  else
    EmitOnDemand<D, M, Index>(job).run();
}

} // namespace
} // namespace hyperiso
