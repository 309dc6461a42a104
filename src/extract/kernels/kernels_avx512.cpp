// The kernels with AVX-512 (F, BW, VL, DQ): compiled for every x86-64, called where the processor has them.
#if defined(__x86_64__)
#include "extract/kernels/prelude.hpp" // before the instructions are switched on

#pragma GCC push_options
#pragma GCC target("avx2,bmi,bmi2,lzcnt,popcnt,avx512f,avx512bw,avx512vl,avx512dq")
#define HYPERISO_AVX512
#define HYPERISO_INSTRUCTIONS avx512
#include "extract/kernels/instantiate.hpp"
#pragma GCC pop_options
#endif
