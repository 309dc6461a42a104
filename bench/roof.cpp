#include "roof.hpp"

#include "clock.hpp"
#include "core/parallel.hpp"
#include "extract/stream_copy.hpp"

#include <benchmark/benchmark.h>

namespace hyperiso::bench {
namespace {

#if defined(__x86_64__)
__attribute__((target_clones("default", "avx2")))
#endif
std::uint64_t
sum(const std::uint64_t* words, std::size_t count) {
  std::uint64_t sums[16] = {};
  for (std::size_t i = 0; i + 16 <= count; i += 16)
    for (std::size_t k = 0; k < 16; ++k) sums[k] += words[i + k];
  std::uint64_t total = 0;
  for (const std::uint64_t part : sums) total += part;
  return total;
}

#if defined(__x86_64__)
__attribute__((target("avx2"))) void fill_avx2(std::byte* to, std::size_t bytes) {
  const __m256i value = _mm256_set1_epi32(1);
  for (std::size_t i = 0; i < bytes; i += 32) _mm256_stream_si256(reinterpret_cast<__m256i*>(to + i), value);
}
#endif

// Requires whole cache lines.
void fill(std::byte* to, std::size_t bytes) {
#if defined(__x86_64__)
  if (__builtin_cpu_supports("avx2")) return fill_avx2(to, bytes), end_streaming();
#endif
  alignas(64) const std::byte line[64] = {};
  for (std::size_t i = 0; i < bytes; i += 64) stream_lines(to + i, line, 64);
  end_streaming();
}

} // namespace

double roof_seconds(const void* input, std::size_t input_bytes, void* output, std::size_t output_bytes,
                    int threads) {
  const Clock clock;
  run_workers(threads, [&](int worker) {
    const auto share = [&](std::size_t count, int end) {
      return count * static_cast<std::size_t>(end) / static_cast<std::size_t>(threads);
    };
    const std::size_t words = input_bytes / 8, lines = output_bytes / 64;
    const std::size_t first_word = share(words, worker), first_line = share(lines, worker);
    benchmark::DoNotOptimize(
        sum(static_cast<const std::uint64_t*>(input) + first_word, share(words, worker + 1) - first_word));
    fill(static_cast<std::byte*>(output) + 64 * first_line, 64 * (share(lines, worker + 1) - first_line));
  });
  return clock.seconds();
}

} // namespace hyperiso::bench
