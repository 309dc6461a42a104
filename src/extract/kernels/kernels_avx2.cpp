// The kernels with AVX2 and the bit instructions of its time: compiled for every x86-64, called where the
// processor has them.
#if defined(__x86_64__)
#include "extract/kernels/prelude.hpp" // before the instructions are switched on

#pragma GCC push_options
#pragma GCC target("avx2,bmi,bmi2,lzcnt,popcnt")
#define HYPERISO_AVX2
#define HYPERISO_INSTRUCTIONS avx2
#include "extract/kernels/instantiate.hpp"
#pragma GCC pop_options
#endif
