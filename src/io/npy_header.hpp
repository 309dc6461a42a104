#pragma once
// What stands before the numbers in an .npy file.

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>

namespace hyperiso {

// Of numbers of a kind ('f', 'i', 'u') and a size in this machine's byte order; `shape`: the slowest axis
// first.
std::string npy_header(char kind, std::size_t bytes, std::span<const std::uint64_t> shape);

} // namespace hyperiso
