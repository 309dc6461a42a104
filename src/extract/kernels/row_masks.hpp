#pragma once
// Rows -> bit masks: which samples are inside, which are NaN. 64 samples make one word.
//
// `Lanes<T>` compares one vector of samples with the threshold, by the instructions at hand, and gives a bit
// per sample. Integers are compared as "not on the outside" by a signed greater-than, the only comparison
// that x86 has before AVX-512; unsigned ones are shifted down by half their range for it.

#include "extract/kernels/prelude.hpp"

namespace hyperiso {
namespace {

template <class T, bool Above>
bool is_inside(T value, T threshold) {
  return Above ? value >= threshold : value <= threshold;
}

#if defined(HYPERISO_AVX512)

template <class T>
struct Lanes {
  static constexpr int count = 64 / sizeof(T);
  template <bool Above>
  static std::uint64_t inside(const T* samples, T threshold) {
    const auto* address = reinterpret_cast<const void*>(samples);
    if constexpr (std::is_same_v<T, float>) {
      return _mm512_cmp_ps_mask(_mm512_loadu_ps(address), _mm512_set1_ps(threshold),
                                Above ? _CMP_GE_OQ : _CMP_LE_OQ);
    } else if constexpr (std::is_same_v<T, double>) {
      return _mm512_cmp_pd_mask(_mm512_loadu_pd(address), _mm512_set1_pd(threshold),
                                Above ? _CMP_GE_OQ : _CMP_LE_OQ);
    } else {
      constexpr int order = Above ? _MM_CMPINT_NLT : _MM_CMPINT_LE;
      const __m512i values = _mm512_loadu_si512(address);
      if constexpr (std::is_same_v<T, std::uint8_t>)
        return _mm512_cmp_epu8_mask(values, _mm512_set1_epi8(static_cast<char>(threshold)), order);
      else if constexpr (std::is_same_v<T, std::int8_t>)
        return _mm512_cmp_epi8_mask(values, _mm512_set1_epi8(threshold), order);
      else if constexpr (std::is_same_v<T, std::uint16_t>)
        return _mm512_cmp_epu16_mask(values, _mm512_set1_epi16(static_cast<short>(threshold)), order);
      else if constexpr (std::is_same_v<T, std::int16_t>)
        return _mm512_cmp_epi16_mask(values, _mm512_set1_epi16(threshold), order);
      else if constexpr (std::is_same_v<T, std::uint32_t>)
        return _mm512_cmp_epu32_mask(values, _mm512_set1_epi32(static_cast<int>(threshold)), order);
      else
        return _mm512_cmp_epi32_mask(values, _mm512_set1_epi32(threshold), order);
    }
  }
  static std::uint64_t missing(const T* samples) {
    if constexpr (std::is_same_v<T, float>) {
      const __m512 values = _mm512_loadu_ps(samples);
      return _mm512_cmp_ps_mask(values, values, _CMP_UNORD_Q);
    } else {
      const __m512d values = _mm512_loadu_pd(samples);
      return _mm512_cmp_pd_mask(values, values, _CMP_UNORD_Q);
    }
  }
};

#elif defined(HYPERISO_AVX2)

template <class T>
struct Lanes {
  static constexpr int count = 32 / sizeof(T);
  template <bool Above>
  static std::uint64_t inside(const T* samples, T threshold) {
    if constexpr (std::is_same_v<T, float>) {
      const __m256 inside =
          _mm256_cmp_ps(_mm256_loadu_ps(samples), _mm256_set1_ps(threshold), Above ? _CMP_GE_OQ : _CMP_LE_OQ);
      return static_cast<std::uint32_t>(_mm256_movemask_ps(inside));
    } else if constexpr (std::is_same_v<T, double>) {
      const __m256d inside =
          _mm256_cmp_pd(_mm256_loadu_pd(samples), _mm256_set1_pd(threshold), Above ? _CMP_GE_OQ : _CMP_LE_OQ);
      return static_cast<std::uint32_t>(_mm256_movemask_pd(inside));
    } else {
      using Signed = std::make_signed_t<T>;
      constexpr Signed bias = std::is_signed_v<T> ? 0 : std::numeric_limits<Signed>::min();
      const auto limit = static_cast<Signed>(static_cast<Signed>(threshold) ^ bias);
      __m256i values = _mm256_loadu_si256(reinterpret_cast<const __m256i*>(samples));
      if constexpr (sizeof(T) == 1) {
        values = _mm256_xor_si256(values, _mm256_set1_epi8(bias));
        const __m256i level = _mm256_set1_epi8(limit);
        const __m256i out = _mm256_cmpgt_epi8(Above ? level : values, Above ? values : level);
        return static_cast<std::uint32_t>(~_mm256_movemask_epi8(out));
      } else if constexpr (sizeof(T) == 2) {
        values = _mm256_xor_si256(values, _mm256_set1_epi16(bias));
        const __m256i level = _mm256_set1_epi16(limit);
        const __m256i out = _mm256_cmpgt_epi16(Above ? level : values, Above ? values : level);
        const __m128i bytes = _mm_packs_epi16(_mm256_castsi256_si128(out), _mm256_extracti128_si256(out, 1));
        return static_cast<std::uint32_t>(_mm_movemask_epi8(bytes)) ^ 0xffffu;
      } else {
        values = _mm256_xor_si256(values, _mm256_set1_epi32(bias));
        const __m256i level = _mm256_set1_epi32(limit);
        const __m256i out = _mm256_cmpgt_epi32(Above ? level : values, Above ? values : level);
        return static_cast<std::uint32_t>(_mm256_movemask_ps(_mm256_castsi256_ps(out))) ^ 0xffu;
      }
    }
  }
  static std::uint64_t missing(const T* samples) {
    if constexpr (std::is_same_v<T, float>) {
      const __m256 values = _mm256_loadu_ps(samples);
      return static_cast<std::uint32_t>(_mm256_movemask_ps(_mm256_cmp_ps(values, values, _CMP_UNORD_Q)));
    } else {
      const __m256d values = _mm256_loadu_pd(samples);
      return static_cast<std::uint32_t>(_mm256_movemask_pd(_mm256_cmp_pd(values, values, _CMP_UNORD_Q)));
    }
  }
};

#elif defined(__SSE2__)

template <class T>
struct Lanes {
  static constexpr int count = 16 / sizeof(T);
  template <bool Above>
  static std::uint64_t inside(const T* samples, T threshold) {
    if constexpr (std::is_same_v<T, float>) {
      const __m128 values = _mm_loadu_ps(samples), level = _mm_set1_ps(threshold);
      return static_cast<std::uint32_t>(
          _mm_movemask_ps(Above ? _mm_cmpge_ps(values, level) : _mm_cmple_ps(values, level)));
    } else if constexpr (std::is_same_v<T, double>) {
      const __m128d values = _mm_loadu_pd(samples), level = _mm_set1_pd(threshold);
      return static_cast<std::uint32_t>(
          _mm_movemask_pd(Above ? _mm_cmpge_pd(values, level) : _mm_cmple_pd(values, level)));
    } else {
      using Signed = std::make_signed_t<T>;
      constexpr Signed bias = std::is_signed_v<T> ? 0 : std::numeric_limits<Signed>::min();
      const auto limit = static_cast<Signed>(static_cast<Signed>(threshold) ^ bias);
      __m128i values = _mm_loadu_si128(reinterpret_cast<const __m128i*>(samples));
      if constexpr (sizeof(T) == 1) {
        values = _mm_xor_si128(values, _mm_set1_epi8(bias));
        const __m128i level = _mm_set1_epi8(limit);
        const __m128i out = _mm_cmpgt_epi8(Above ? level : values, Above ? values : level);
        return static_cast<std::uint32_t>(_mm_movemask_epi8(out)) ^ 0xffffu;
      } else if constexpr (sizeof(T) == 2) {
        values = _mm_xor_si128(values, _mm_set1_epi16(bias));
        const __m128i level = _mm_set1_epi16(limit);
        const __m128i out = _mm_cmpgt_epi16(Above ? level : values, Above ? values : level);
        return static_cast<std::uint32_t>(_mm_movemask_epi8(_mm_packs_epi16(out, out)) & 0xff) ^ 0xffu;
      } else {
        values = _mm_xor_si128(values, _mm_set1_epi32(bias));
        const __m128i level = _mm_set1_epi32(limit);
        const __m128i out = _mm_cmpgt_epi32(Above ? level : values, Above ? values : level);
        return static_cast<std::uint32_t>(_mm_movemask_ps(_mm_castsi128_ps(out))) ^ 0xfu;
      }
    }
  }
  static std::uint64_t missing(const T* samples) {
    if constexpr (std::is_same_v<T, float>) {
      const __m128 values = _mm_loadu_ps(samples);
      return static_cast<std::uint32_t>(_mm_movemask_ps(_mm_cmpunord_ps(values, values)));
    } else {
      const __m128d values = _mm_loadu_pd(samples);
      return static_cast<std::uint32_t>(_mm_movemask_pd(_mm_cmpunord_pd(values, values)));
    }
  }
};

#else

template <class T>
struct Lanes {
  static constexpr int count = 8;
  template <bool Above>
  static std::uint64_t inside(const T* samples, T threshold) {
    std::uint64_t bits = 0;
    for (int i = 0; i < count; ++i)
      bits |= static_cast<std::uint64_t>(is_inside<T, Above>(samples[i], threshold)) << i;
    return bits;
  }
  static std::uint64_t missing(const T* samples) {
    std::uint64_t bits = 0;
    for (int i = 0; i < count; ++i) bits |= static_cast<std::uint64_t>(is_missing(samples[i])) << i;
    return bits;
  }
};

#endif

template <class T>
constexpr bool can_miss = std::is_floating_point_v<T>;

// The masks of 64 samples; `missing` collects those that are NaN.
template <class T, bool Above>
std::uint64_t inside_word(const T* samples, T threshold, std::uint64_t& missing) {
  std::uint64_t word = 0;
  for (int lane = 0; lane < 64; lane += Lanes<T>::count) {
    word |= Lanes<T>::template inside<Above>(samples + lane, threshold) << lane;
    if constexpr (can_miss<T>) missing |= Lanes<T>::missing(samples + lane);
  }
  return word;
}

// The last word of a row that is not whole: its samples, filled up with zeros.
template <class T>
struct LastSamples {
  LastSamples(const T* row, std::int64_t count) : word(count / 64), rest(count % 64) {
    std::memcpy(samples, row + 64 * word, static_cast<std::size_t>(rest) * sizeof(T));
  }
  std::uint64_t bits() const { return (std::uint64_t{1} << rest) - 1; } // of samples in the row
  T samples[64] = {};
  std::int64_t word, rest;
};

template <class T, bool Above>
bool inside_words(const T* row, std::int64_t count, T threshold, std::uint64_t* words) {
  std::uint64_t missing = 0;
  for (std::int64_t word = 0; word < count / 64; ++word)
    words[word] = inside_word<T, Above>(row + 64 * word, threshold, missing);
  if (count % 64 != 0) {
    const LastSamples<T> last(row, count);
    words[last.word] = inside_word<T, Above>(last.samples, threshold, missing) & last.bits();
  }
  return missing != 0;
}

template <class T>
bool inside(const std::byte* row, std::int64_t count, const InsideTest& test, std::uint64_t* words) {
  const auto* samples = reinterpret_cast<const T*>(row);
  const auto threshold = test.threshold_as<T>();
  return test.above ? inside_words<T, true>(samples, count, threshold, words)
                    : inside_words<T, false>(samples, count, threshold, words);
}

template <class T>
std::uint64_t present_word([[maybe_unused]] const T* samples) {
  std::uint64_t missing = 0;
  if constexpr (can_miss<T>)
    for (int lane = 0; lane < 64; lane += Lanes<T>::count)
      missing |= Lanes<T>::missing(samples + lane) << lane;
  return ~missing;
}

template <class T>
void present(const std::byte* row, std::int64_t count, std::uint64_t* words) {
  const auto* samples = reinterpret_cast<const T*>(row);
  for (std::int64_t word = 0; word < count / 64; ++word) words[word] = present_word(samples + 64 * word);
  if (count % 64 != 0) {
    const LastSamples<T> last(samples, count);
    words[last.word] = present_word(last.samples) & last.bits();
  }
}

template <class T>
void gather(const std::byte* row, std::int64_t stride, std::int64_t count, std::byte* gathered) {
  const auto* from = reinterpret_cast<const T*>(row);
  auto* to = reinterpret_cast<T*>(gathered);
  for (std::int64_t i = 0; i < count; ++i) to[i] = from[i * stride];
}

template <class T>
void load(const RowPair* pairs, std::size_t pair_bytes, const std::uint32_t* pair, const std::uint32_t* at,
          std::int64_t stride, std::size_t count, double* lower, double* upper) {
  for (std::size_t i = 0; i < count; ++i) {
    const auto& rows =
        *reinterpret_cast<const RowPair*>(reinterpret_cast<const std::byte*>(pairs) + pair[i] * pair_bytes);
    const auto offset = static_cast<std::int64_t>(at[i]) * stride;
    lower[i] = static_cast<double>(reinterpret_cast<const T*>(rows.lower)[offset]);
    upper[i] = static_cast<double>(reinterpret_cast<const T*>(rows.upper)[offset]);
  }
}

RowKernels row_kernels_here(SampleType type) {
  return visit_sample_type(type, [](auto sample) {
    using T = decltype(sample);
    return RowKernels{inside<T>, present<T>, gather<T>, load<T>};
  });
}

} // namespace
} // namespace hyperiso
