#pragma once
// All that the kernels include. It comes before a file that compiles them switches to its instructions, so
// that no function shared with the rest of the program is compiled with them.

#include "extract/kernels.hpp"
#include "extract/stream_copy.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>
#include <type_traits>
#include <vector>
#if defined(__SSE2__)
#include <immintrin.h>
#endif
