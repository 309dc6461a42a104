#pragma once
// The surface in the barycentric subdivision of the cells: a baseline for comparison (papers 000 and 004).

#include "extract/march_table.hpp"
#include "extract/samples.hpp"

namespace hyperiso {

constexpr int highest_barycentric_dimension = 5;

// Replaces what `mesh` holds, but for its axes. Every axis has at least two samples. Throws std::bad_alloc.
template <int D>
Status extract_barycentric(const Samples<D>& samples, TableForm form, const ExtractOptions& options,
                           SimplexMesh<D>& mesh);

} // namespace hyperiso
