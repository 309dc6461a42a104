#pragma once
// Copies past the caches, for output that nobody reads soon: it saves reading what is overwritten, and leaves
// the caches to the input.

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstring>
#if defined(__SSE2__)
#include <immintrin.h>
#endif

namespace hyperiso {

// Copies whole cache lines. Requires that `to` is at the start of a line and `bytes` a multiple of 64.
inline void stream_lines(std::byte* to, const std::byte* from, std::ptrdiff_t bytes) {
#if defined(__SSE2__)
  for (std::ptrdiff_t i = 0; i < bytes; i += 16)
    _mm_stream_si128(reinterpret_cast<__m128i*>(to + i),
                     _mm_loadu_si128(reinterpret_cast<const __m128i*>(from + i)));
#else
  std::memcpy(to, from, static_cast<std::size_t>(bytes));
#endif
}

// Other threads see the copies only behind this and what synchronises with them.
inline void end_streaming() {
#if defined(__SSE2__)
  _mm_sfence();
#endif
}

inline void stream_copy(void* to_, const void* from_, std::size_t bytes) {
  auto* to = static_cast<std::byte*>(to_);
  const auto* from = static_cast<const std::byte*>(from_);
  const std::size_t head = std::min(bytes, (64 - reinterpret_cast<std::uintptr_t>(to) % 64) % 64);
  const std::size_t lines = (bytes - head) / 64 * 64;
  std::memcpy(to, from, head);
  stream_lines(to + head, from + head, static_cast<std::ptrdiff_t>(lines));
  std::memcpy(to + head + lines, from + head + lines, bytes - head - lines);
  end_streaming();
}

} // namespace hyperiso
