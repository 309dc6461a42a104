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
  // Which are NaN.
  static std::uint64_t missing(const T* samples) {
    if constexpr (std::is_same_v<T, float>) {
      const __m512 values = _mm512_loadu_ps(samples);
      return _mm512_cmp_ps_mask(values, values, _CMP_UNORD_Q);
    } else {
      const __m512d values = _mm512_loadu_pd(samples);
      return _mm512_cmp_pd_mask(values, values, _CMP_UNORD_Q);
    }
  }
  // In which lanes one of two vectors is NaN: half the comparisons for those who only ask whether any is.
  static std::uint64_t either_missing(const T* a, const T* b) {
    if constexpr (std::is_same_v<T, float>)
      return _mm512_cmp_ps_mask(_mm512_loadu_ps(a), _mm512_loadu_ps(b), _CMP_UNORD_Q);
    else
      return _mm512_cmp_pd_mask(_mm512_loadu_pd(a), _mm512_loadu_pd(b), _CMP_UNORD_Q);
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
  static std::uint64_t either_missing(const T* a, const T* b) {
    if constexpr (std::is_same_v<T, float>)
      return static_cast<std::uint32_t>(
          _mm256_movemask_ps(_mm256_cmp_ps(_mm256_loadu_ps(a), _mm256_loadu_ps(b), _CMP_UNORD_Q)));
    else
      return static_cast<std::uint32_t>(
          _mm256_movemask_pd(_mm256_cmp_pd(_mm256_loadu_pd(a), _mm256_loadu_pd(b), _CMP_UNORD_Q)));
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
  static std::uint64_t either_missing(const T* a, const T* b) {
    if constexpr (std::is_same_v<T, float>)
      return static_cast<std::uint32_t>(_mm_movemask_ps(_mm_cmpunord_ps(_mm_loadu_ps(a), _mm_loadu_ps(b))));
    else
      return static_cast<std::uint32_t>(_mm_movemask_pd(_mm_cmpunord_pd(_mm_loadu_pd(a), _mm_loadu_pd(b))));
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
  static std::uint64_t either_missing(const T* a, const T* b) { return missing(a) | missing(b); }
};

#endif

template <class T>
constexpr bool can_miss = std::is_floating_point_v<T>;

// The masks of 64 samples; `missing` collects which lanes hold NaN.
template <class T, bool Above>
std::uint64_t inside_word(const T* samples, T threshold, std::uint64_t& missing) {
  std::uint64_t word = 0;
  for (int lane = 0; lane < 64; lane += Lanes<T>::count)
    word |= Lanes<T>::template inside<Above>(samples + lane, threshold) << lane;
  if constexpr (can_miss<T>)
    for (int lane = 0; lane < 64; lane += 2 * Lanes<T>::count)
      missing |= Lanes<T>::either_missing(samples + lane, samples + lane + Lanes<T>::count);
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

// Fetches the 64 samples `next` bytes behind, into the second-level cache.
template <class T>
void prefetch_word(const T* samples, std::int64_t next) {
  const auto* line = reinterpret_cast<const std::byte*>(samples) + next;
  for (std::size_t i = 0; i < 64 * sizeof(T); i += 64) __builtin_prefetch(line + i, 0, 2);
}

template <class T, bool Above>
bool inside_rows(const SampleRows& rows, T threshold, std::uint64_t* words, std::uint8_t* uniform) {
  std::uint64_t missing = 0;
  const std::byte* row = rows.first;
  for (std::int64_t r = 0; r < rows.rows; ++r, row += rows.bytes_apart) {
    const auto* samples = reinterpret_cast<const T*>(row);
    std::uint64_t any = 0, all = ~std::uint64_t{0};
    for (std::int64_t word = 0; word < rows.count / 64; ++word) {
      prefetch_word(samples + 64 * word, rows.next);
      const std::uint64_t inside = inside_word<T, Above>(samples + 64 * word, threshold, missing);
      any |= inside, all &= inside;
      *words++ = inside;
    }
    if (rows.count % 64 != 0) {
      const LastSamples<T> last(samples, rows.count);
      const std::uint64_t inside = inside_word<T, Above>(last.samples, threshold, missing) & last.bits();
      any |= inside, all &= inside | ~last.bits();
      *words++ = inside;
    }
    uniform[r] = any == 0 ? 0 : ~all == 0 ? 255 : 1;
  }
  return missing != 0;
}

template <class T>
bool inside(const SampleRows& rows, const InsideTest& test, std::uint64_t* words, std::uint8_t* uniform) {
  const auto threshold = test.threshold_as<T>();
  return test.above ? inside_rows<T, true>(rows, threshold, words, uniform)
                    : inside_rows<T, false>(rows, threshold, words, uniform);
}

// The least and the greatest of 64 samples; both NaN if one of them is.
template <class T>
void find_range(const T* samples, T& low, T& high) {
  constexpr int lanes = 64 / sizeof(T); // compilers make vectors of these loops
  T least[lanes], greatest[lanes];
  std::copy_n(samples, lanes, least);
  std::copy_n(samples, lanes, greatest);
  for (int i = lanes; i < 64; i += lanes)
    for (int lane = 0; lane < lanes; ++lane) {
      const T sample = samples[i + lane];
      least[lane] = sample < least[lane] ? sample : least[lane];
      greatest[lane] = sample > greatest[lane] ? sample : greatest[lane];
    }
  for (int half = lanes / 2; half > 0; half /= 2)
    for (int lane = 0; lane < half; ++lane) {
      least[lane] = std::min(least[lane], least[lane + half]);
      greatest[lane] = std::max(greatest[lane], greatest[lane + half]);
    }
  low = least[0], high = greatest[0];
  if constexpr (can_miss<T>) {
    std::uint64_t missing = 0;
    for (int lane = 0; lane < 64; lane += 2 * Lanes<T>::count)
      missing |= Lanes<T>::either_missing(samples + lane, samples + lane + Lanes<T>::count);
    if (missing != 0) low = high = std::numeric_limits<T>::quiet_NaN();
  }
}

template <class T>
void ranges(const SampleRows& rows, std::byte* low_, std::byte* high_) {
  auto* low = reinterpret_cast<T*>(low_);
  auto* high = reinterpret_cast<T*>(high_);
  const std::byte* row = rows.first;
  for (std::int64_t r = 0; r < rows.rows; ++r, row += rows.bytes_apart) {
    const auto* samples = reinterpret_cast<const T*>(row);
    for (std::int64_t word = 0; word < rows.count / 64; ++word)
      find_range(samples + 64 * word, *low++, *high++);
    if (rows.count % 64 == 0) continue;
    LastSamples<T> last(samples, rows.count);
    std::fill(last.samples + last.rest, last.samples + 64, last.samples[0]);
    find_range(last.samples, *low++, *high++);
  }
}

template <class T, bool Above>
bool inside_rows_by_ranges(const SampleRows& rows, T threshold, const T* low, const T* high,
                           std::uint64_t* words, std::uint8_t* uniform) {
  std::uint64_t missing = 0;
  const std::byte* row = rows.first;
  const std::int64_t row_words = (rows.count + 63) / 64;
  const std::uint64_t last_bits = ~std::uint64_t{0} >> (64 * row_words - rows.count);
  for (std::int64_t r = 0; r < rows.rows; ++r, row += rows.bytes_apart) {
    const auto* samples = reinterpret_cast<const T*>(row);
    std::uint64_t any = 0, all = ~std::uint64_t{0};
    for (std::int64_t word = 0; word < row_words; ++word, ++low, ++high) {
      const std::uint64_t bits = word == row_words - 1 ? last_bits : ~std::uint64_t{0};
      std::uint64_t inside; // no comparison with NaN holds
      if (Above ? *high < threshold : *low > threshold)
        inside = 0;
      else if (Above ? *low >= threshold : *high <= threshold)
        inside = bits;
      else if (bits == ~std::uint64_t{0})
        inside = inside_word<T, Above>(samples + 64 * word, threshold, missing);
      else
        inside =
            inside_word<T, Above>(LastSamples<T>(samples, rows.count).samples, threshold, missing) & bits;
      any |= inside, all &= inside | ~bits;
      *words++ = inside;
    }
    uniform[r] = any == 0 ? 0 : ~all == 0 ? 255 : 1;
  }
  return missing != 0;
}

template <class T>
bool inside_by_ranges(const SampleRows& rows, const InsideTest& test, const std::byte* low_,
                      const std::byte* high_, std::uint64_t* words, std::uint8_t* uniform) {
  const auto threshold = test.threshold_as<T>();
  const auto* low = reinterpret_cast<const T*>(low_);
  const auto* high = reinterpret_cast<const T*>(high_);
  return test.above ? inside_rows_by_ranges<T, true>(rows, threshold, low, high, words, uniform)
                    : inside_rows_by_ranges<T, false>(rows, threshold, low, high, words, uniform);
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
    return RowKernels{inside<T>, ranges<T>, inside_by_ranges<T>, present<T>, gather<T>, load<T>};
  });
}

} // namespace
} // namespace hyperiso
