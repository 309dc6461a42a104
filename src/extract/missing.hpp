#pragma once
// Fields with NaN: which cells have all their samples.

#include "extract/kernels.hpp"

namespace hyperiso {

// Reads the whole field. Throws std::bad_alloc.
template <int D>
PresentCells find_present_cells(const Samples<D>& samples, const RowGrid<D>& grid, const RowKernels& kernels,
                                int workers);

} // namespace hyperiso
