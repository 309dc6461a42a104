#pragma once
// Compression as browsers undo it.

#include <span>
#include <vector>

namespace hyperiso {

// Raw deflate, without a header. Throws std::bad_alloc.
std::vector<unsigned char> deflated(std::span<const unsigned char> bytes);

} // namespace hyperiso
