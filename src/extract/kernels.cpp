#include "extract/kernels.hpp"

namespace hyperiso {

RowKernels row_kernels_baseline(SampleType type);
RowKernels row_kernels_avx2(SampleType type);
RowKernels row_kernels_avx512(SampleType type);
template <int D, Method M>
Kernels<D, M> kernels_baseline();
template <int D, Method M>
Kernels<D, M> kernels_avx2();
template <int D, Method M>
Kernels<D, M> kernels_avx512();

bool has_instructions([[maybe_unused]] Instructions instructions) {
#if defined(__x86_64__)
  if (instructions == Instructions::avx512)
    return has_instructions(Instructions::avx2) && __builtin_cpu_supports("avx512f") &&
           __builtin_cpu_supports("avx512bw") && __builtin_cpu_supports("avx512vl") &&
           __builtin_cpu_supports("avx512dq") && __builtin_cpu_supports("avx512vbmi") &&
           __builtin_cpu_supports("avx512vbmi2") && __builtin_cpu_supports("gfni");
  if (instructions == Instructions::avx2)
    return __builtin_cpu_supports("avx2") && __builtin_cpu_supports("bmi") &&
           __builtin_cpu_supports("bmi2") && __builtin_cpu_supports("lzcnt") &&
           __builtin_cpu_supports("popcnt");
#endif
  return instructions == Instructions::baseline;
}

Instructions best_instructions() {
  for (const Instructions instructions : {Instructions::avx512, Instructions::avx2})
    if (has_instructions(instructions)) return instructions;
  return Instructions::baseline;
}

RowKernels row_kernels(SampleType type, [[maybe_unused]] Instructions instructions) {
#if defined(__x86_64__)
  if (instructions == Instructions::avx512) return row_kernels_avx512(type);
  if (instructions == Instructions::avx2) return row_kernels_avx2(type);
#endif
  return row_kernels_baseline(type);
}

template <int D, Method M>
Kernels<D, M> kernels([[maybe_unused]] Instructions instructions) {
#if defined(__x86_64__)
  if (instructions == Instructions::avx512) return kernels_avx512<D, M>();
  if (instructions == Instructions::avx2) return kernels_avx2<D, M>();
#endif
  return kernels_baseline<D, M>();
}

template Kernels<2, Method::hull> kernels<2, Method::hull>(Instructions);
template Kernels<3, Method::hull> kernels<3, Method::hull>(Instructions);
template Kernels<4, Method::hull> kernels<4, Method::hull>(Instructions);
template Kernels<5, Method::hull> kernels<5, Method::hull>(Instructions);
template Kernels<2, Method::simplicial> kernels<2, Method::simplicial>(Instructions);
template Kernels<3, Method::simplicial> kernels<3, Method::simplicial>(Instructions);
template Kernels<4, Method::simplicial> kernels<4, Method::simplicial>(Instructions);
template Kernels<5, Method::simplicial> kernels<5, Method::simplicial>(Instructions);

} // namespace hyperiso
