// The kernels with AVX-512 as Ice Lake and Zen 4 have it: compiled for every x86-64, called where the
// processor has them.
#if defined(__x86_64__)
#include "extract/kernels/prelude.hpp" // before the instructions are switched on

#pragma GCC push_options
#pragma GCC target(                                                                                          \
    "avx2,bmi,bmi2,lzcnt,popcnt,avx512f,avx512bw,avx512vl,avx512dq,avx512vbmi,avx512vbmi2,gfni")
// GCC 12 warns of its own intrinsics, which leave masked-out lanes undefined on purpose.
#pragma GCC diagnostic ignored "-Wmaybe-uninitialized"
#pragma GCC diagnostic ignored "-Wuninitialized"
#define HYPERISO_AVX512
#define HYPERISO_INSTRUCTIONS avx512
#include "extract/kernels/instantiate.hpp"
#pragma GCC pop_options
#endif
