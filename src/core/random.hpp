#pragma once
// Numbers that look random and are the same everywhere: a function of a seed and a count, no state.

#include <cstdint>

namespace hyperiso {

// 64 bits (the finaliser of SplitMix64: Steele, Lea, Flood 2014).
inline std::uint64_t scramble(std::uint64_t seed, std::uint64_t number) {
  std::uint64_t bits = seed + (number + 1) * 0x9e3779b97f4a7c15u;
  bits = (bits ^ (bits >> 30)) * 0xbf58476d1ce4e5b9u;
  bits = (bits ^ (bits >> 27)) * 0x94d049bb133111ebu;
  return bits ^ (bits >> 31);
}

// In [0, 1). The seed is scrambled first, so that neighbouring seeds do not share a sequence.
inline double uniform(std::uint64_t seed, std::uint64_t number) {
  return static_cast<double>(scramble(scramble(seed, 0), number) >> 11) * 0x1p-53;
}

} // namespace hyperiso
