#pragma once
// The extraction engine. Read this first.
//
// A field is rows of samples along axis 0. The engine marches over the rows twice: once over the samples,
// once over what it noted down.
//
// Phase 1, scan (kernels/row_masks.hpp, scan.hpp, codes.hpp, vertices.hpp). The rows are taken in strips,
// some along axis 1 at a time; while a strip is worked on, the next one is on its way from memory. Each row
// of samples becomes a bit mask: which samples are inside. The exclusive or of a row's mask with that of the
// row before it along an axis is the set of crossed edges of that direction that end in the row; each becomes
// a vertex at once, while the samples are in the cache. No index array leads from edges to vertices: the
// number of a vertex is that of the first of its row and direction, which is noted down, plus the number of
// bits before its own. A cell is active if its 2^(D-1) rows' masks, at x and x + 1, are neither all 0 nor
// all 1. The masks of a row of cells are transposed into columns of labels; two neighbouring columns are a
// cell's code, and the codes of the active cells go to a list, row by row.
//
// Phase 2, emit (kernels/emit.hpp). The codes alone tell how the numbers of the vertices go on along a row of
// cells (cell_edges.hpp has the numbering). A table (march_table.hpp) gives the simplices of a code; their
// corners are looked up among the numbers of the cell's edges and written out. In five dimensions the table
// is made as it is used (kernels/emit_on_demand.hpp).
//
// Threads (units.hpp, vertex_output.hpp). The rows are parted into units, in memory order; a worker takes the
// next unit when it has done one. A worker cannot know how many vertices the units before its own will give:
// it keeps its vertices in a small batch until that is known, then writes them where they belong. After phase
// 1 all counts are known, and every unit of phase 2 knows where it writes. So the result does not depend on
// the number of threads.
//
// Slabs (slab_engine.hpp). Two steps of a field are enough for the part of the surface between them: the same
// passes over two layers, which go on with the masks and the vertex numbers of the layer before.
//
// Again and again (workspace.hpp). The scratch memory of an extraction may serve the next. For the next
// isovalue on the same field, the first extraction notes down the range of the 64 samples of each word of the
// masks: where the range has one label, the word is known without the samples.
//
// Only the functions on one row of samples know the sample type (samples.hpp). The loops are compiled once
// for each set of instructions (kernels.hpp) and give the same bytes with each. The reference loop
// (reference.hpp) defines what they must give.

#include "extract/kernels.hpp"

namespace hyperiso {

// What tests choose, and nobody else; and masks that tracking has.
struct EngineOptions {
  Instructions instructions = best_instructions();
  bool wide_indices = false;     // 64-bit vertex numbers although 32 bits would do
  std::int64_t unit_samples = 0; // about how many samples a unit has; 0: as fits the caches and the threads
  GivenMasks given_masks = {};   // of the whole field
};

// Extracts into `mesh`, in the memory it has if that is enough. `mesh.positions`, `simplices`, `edges` and
// `active_cells` are set. Every axis has at least two samples. Throws std::bad_alloc.
template <int D>
Status run_engine(const Samples<D>& samples, TableForm form, const ExtractOptions& options,
                  const EngineOptions& engine_options, SimplexMesh<D>& mesh);

} // namespace hyperiso
