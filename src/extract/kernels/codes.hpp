#pragma once
// Rows of labels -> codes of cells.
//
// The bits of a word of each row round a row of cells, taken bit by bit, are the label columns of 64 cells: a
// transposition of bits. Two neighbouring columns are a cell's code.

#include "extract/kernels/words.hpp"

namespace hyperiso {
namespace {

#if !defined(HYPERISO_AVX512)
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

#if defined(HYPERISO_AVX512)
// Lane r of `rows` holds bit r of 64 columns; makes the columns: bit r of byte c is bit c of lane r.
inline __m512i transpose(__m512i rows) {
  // Bytes first: byte c of lane r becomes byte 7 - r of lane c. Then the bits of each lane, by a product of
  // matrices of bits: bit r of byte i is the parity of byte 7 - r of the lane and 1 << i.
  alignas(64) static constexpr auto byte_order = [] {
    std::array<std::uint8_t, 64> order{};
    for (unsigned i = 0; i < 64; ++i) order[i] = static_cast<std::uint8_t>((7 - i % 8) * 8 + i / 8);
    return order;
  }();
  const __m512i words = _mm512_permutexvar_epi8(_mm512_load_si512(byte_order.data()), rows);
  const __m512i units = _mm512_set1_epi64(static_cast<long long>(0x8040201008040201));
  return _mm512_gf2p8affine_epi64_epi8(units, words, 0);
}
#else
inline void transpose(const std::array<std::uint64_t, 8>& rows, std::uint8_t* columns) {
  // First whole bytes: byte b of row r becomes byte r of word b. Then the same with the bits of each word, by
  // exchanging ever larger blocks on both sides of the diagonal.
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
}
#endif

// Writes the codes of the cells in `active`, which start in one word of their rows, and maybe some behind
// them, up to 64. `row(place)` is the word of the row at that place in a column, followed by the next word of
// the row, or by anything if there is none.
template <int D, class Row>
void write_codes(std::uint64_t active, Row&& row, typename Cells<D>::Code* codes) {
  constexpr unsigned places = CellEdges<D, Method::hull>::column;
#if defined(HYPERISO_AVX512)
  if constexpr (D <= 4) {
    const auto word = [&](unsigned place, int behind) {
      return place < places ? static_cast<long long>(row(place)[behind]) : 0;
    };
    const auto words = [&](int behind) {
      return _mm512_setr_epi64(word(0, behind), word(1, behind), word(2, behind), word(3, behind),
                               word(4, behind), word(5, behind), word(6, behind), word(7, behind));
    };
    alignas(64) static constexpr auto next_byte = [] {
      std::array<std::uint8_t, 64> order{};
      for (unsigned i = 0; i < 64; ++i) order[i] = static_cast<std::uint8_t>((i + 1) % 64);
      return order;
    }();
    const __m512i left_columns = transpose(words(0));
    __m512i right_columns = _mm512_permutexvar_epi8(_mm512_load_si512(next_byte.data()), left_columns);
    if (active >> 63 != 0) {
      const auto next_column = static_cast<char>(_mm512_test_epi64_mask(words(1), _mm512_set1_epi64(1)));
      right_columns = _mm512_mask_set1_epi8(right_columns, std::uint64_t{1} << 63, next_column);
    }
    const __m512i left = _mm512_maskz_compress_epi8(active, left_columns);
    const __m512i right = _mm512_maskz_compress_epi8(active, right_columns);
    const bool many = std::popcount(active) > 32;
    if constexpr (D == 4) {
      // `unpack` takes 8 of every 16 codes: they are put in order.
      const __m512i low = _mm512_unpacklo_epi8(left, right), high = _mm512_unpackhi_epi8(left, right);
      const __m512i first = _mm512_setr_epi64(0, 1, 8, 9, 2, 3, 10, 11),
                    second = _mm512_setr_epi64(4, 5, 12, 13, 6, 7, 14, 15);
      _mm512_storeu_si512(codes, _mm512_permutex2var_epi64(low, first, high));
      if (many) _mm512_storeu_si512(codes + 32, _mm512_permutex2var_epi64(low, second, high));
    } else {
      // Labels of 2 or 4 bits leave room for both in a byte.
      const __m512i both = _mm512_or_si512(left, _mm512_slli_epi16(right, places));
      _mm512_storeu_si512(codes, _mm512_cvtepu8_epi16(_mm512_castsi512_si256(both)));
      if (many) _mm512_storeu_si512(codes + 32, _mm512_cvtepu8_epi16(_mm512_extracti64x4_epi64(both, 1)));
    }
    return;
  }
#endif
  using Code = typename Cells<D>::Code;
  constexpr unsigned groups = (places + 7) / 8;
  alignas(64) std::array<std::array<std::uint8_t, 72>, groups> columns; // 64, and the next one
  for (unsigned group = 0; group < groups; ++group) {
    std::array<std::uint64_t, 8> rows{};
    std::uint8_t next = 0;
    for (unsigned place = 0; place < std::min(places, 8u); ++place) {
      const std::uint64_t* words = row(8 * group + place);
      rows[place] = words[0];
      next = static_cast<std::uint8_t>(next | (words[1] & 1) << place);
    }
#if defined(HYPERISO_AVX512)
    _mm512_storeu_si512(columns[group].data(), transpose(_mm512_loadu_si512(rows.data())));
#else
    transpose(rows, columns[group].data());
#endif
    columns[group][64] = next;
  }
  for (; active != 0; active &= active - 1) {
    const auto x = static_cast<std::size_t>(std::countr_zero(active));
    Code left = 0, right = 0;
    for (unsigned group = 0; group < groups; ++group) {
      left = static_cast<Code>(left | static_cast<Code>(columns[group][x]) << (8 * group));
      right = static_cast<Code>(right | static_cast<Code>(columns[group][x + 1]) << (8 * group));
    }
    *codes++ = static_cast<Code>(left | right << places);
  }
}

} // namespace
} // namespace hyperiso
