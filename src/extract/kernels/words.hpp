#pragma once
// Words of bit masks, several at a time, by the vectors of whatever processor the compiler makes code for.

#include "extract/kernels/prelude.hpp"

namespace hyperiso {
namespace {

#if defined(HYPERISO_AVX512)
constexpr std::int64_t word_lanes = 8;
#elif defined(HYPERISO_AVX2)
constexpr std::int64_t word_lanes = 4;
#else
constexpr std::int64_t word_lanes = 2;
#endif
typedef std::uint64_t Words __attribute__((vector_size(8 * word_lanes)));

inline Words load_words(const std::uint64_t* from) {
  Words words;
  std::memcpy(&words, from, sizeof words);
  return words;
}
inline void store_words(std::uint64_t* to, const Words& words) { std::memcpy(to, &words, sizeof words); }

// The words one place on: all but the first of `words`, and the first of `next`.
inline Words following(const Words& words, const Words& next) {
#if defined(HYPERISO_AVX512)
  return __builtin_shufflevector(words, next, 1, 2, 3, 4, 5, 6, 7, 8);
#elif defined(HYPERISO_AVX2)
  return __builtin_shufflevector(words, next, 1, 2, 3, 4);
#else
  return __builtin_shufflevector(words, next, 1, 2);
#endif
}

// Lists those of `count` words that are not 0, and where they are; behind the words there are as many zeros
// as a vector has. Returns how many there are. The lists have room for a vector more.
inline std::size_t list_nonzero(const std::uint64_t* words, std::size_t count, std::uint64_t* found,
                                std::uint32_t* at) {
  std::size_t listed = 0;
#if defined(HYPERISO_AVX512)
  __m256i place = _mm256_setr_epi32(0, 1, 2, 3, 4, 5, 6, 7);
  for (std::size_t i = 0; i < count; i += 8) {
    const __m512i eight = _mm512_loadu_si512(words + i);
    const __mmask8 nonzero = _mm512_test_epi64_mask(eight, eight);
    _mm512_storeu_si512(found + listed, _mm512_maskz_compress_epi64(nonzero, eight));
    _mm256_storeu_si256(reinterpret_cast<__m256i*>(at + listed), _mm256_maskz_compress_epi32(nonzero, place));
    listed += static_cast<std::size_t>(std::popcount(static_cast<unsigned>(nonzero)));
    place = _mm256_add_epi32(place, _mm256_set1_epi32(8));
  }
#else
  for (std::size_t i = 0; i < count; ++i) {
    found[listed] = words[i];
    at[listed] = static_cast<std::uint32_t>(i);
    listed += words[i] != 0;
  }
#endif
  return listed;
}

// Writes base + b for every set bit b of `bits`, in ascending order, and maybe some numbers behind them.
inline void write_bit_numbers(std::uint64_t bits, std::uint32_t base, std::uint32_t* out) {
#if defined(HYPERISO_AVX512)
  alignas(64) static constexpr auto numbers = [] {
    std::array<std::uint8_t, 64> all{};
    for (unsigned i = 0; i < 64; ++i) all[i] = static_cast<std::uint8_t>(i);
    return all;
  }();
  const __m512i found = _mm512_maskz_compress_epi8(bits, _mm512_load_si512(numbers.data()));
  const __m512i offset = _mm512_set1_epi32(static_cast<int>(base));
  _mm512_storeu_si512(out, _mm512_add_epi32(offset, _mm512_cvtepu8_epi32(_mm512_castsi512_si128(found))));
  const int count = std::popcount(bits);
  if (count <= 16) return;
  const auto write_next = [&](__m128i bytes, std::uint32_t* to) {
    _mm512_storeu_si512(to, _mm512_add_epi32(offset, _mm512_cvtepu8_epi32(bytes)));
  };
  write_next(_mm512_extracti32x4_epi32(found, 1), out + 16);
  if (count <= 32) return;
  write_next(_mm512_extracti32x4_epi32(found, 2), out + 32);
  write_next(_mm512_extracti32x4_epi32(found, 3), out + 48);
#else
  for (; bits != 0; out += 4)
    for (int i = 0; i < 4; ++i) {
      out[i] = base + static_cast<std::uint32_t>(std::countr_zero(bits));
      bits &= bits - 1;
    }
#endif
}

} // namespace
} // namespace hyperiso
