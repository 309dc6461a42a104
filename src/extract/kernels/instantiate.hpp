#pragma once
// The kernels of one set of instructions, for whoever chooses among them.

#include "extract/kernels/emit.hpp"
#include "extract/kernels/row_masks.hpp"
#include "extract/kernels/scan.hpp"

#define HYPERISO_JOIN_(a, b) a##b
#define HYPERISO_JOIN(a, b) HYPERISO_JOIN_(a, b)

namespace hyperiso {

RowKernels HYPERISO_JOIN(row_kernels_, HYPERISO_INSTRUCTIONS)(SampleType type) {
  return row_kernels_here(type);
}

template <int D, Method M>
Kernels<D, M> HYPERISO_JOIN(kernels_, HYPERISO_INSTRUCTIONS)() {
  return {scan<D, M>, emit<D, M, std::uint32_t>, emit<D, M, std::uint64_t>};
}

#define HYPERISO_INSTANTIATE(D)                                                                              \
  template Kernels<D, Method::hull> HYPERISO_JOIN(kernels_, HYPERISO_INSTRUCTIONS)<D, Method::hull>();       \
  template Kernels<D, Method::simplicial> HYPERISO_JOIN(kernels_,                                            \
                                                        HYPERISO_INSTRUCTIONS)<D, Method::simplicial>();
HYPERISO_INSTANTIATE(2)
HYPERISO_INSTANTIATE(3)
HYPERISO_INSTANTIATE(4)
HYPERISO_INSTANTIATE(5)

} // namespace hyperiso
