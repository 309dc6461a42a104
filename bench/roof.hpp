#pragma once
// The least that extraction can cost: reading the whole input once and writing as many bytes as the output
// has, past the caches, on the same threads.

#include <cstddef>

namespace hyperiso::bench {

// Seconds for it. `output` is overwritten.
double roof_seconds(const void* input, std::size_t input_bytes, void* output, std::size_t output_bytes,
                    int threads);

} // namespace hyperiso::bench
