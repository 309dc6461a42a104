#pragma once
/// \file
/// The isosurface of a field of any length, slab by slab, with two steps in memory.

#include "hyperiso/extract.hpp"
#include "hyperiso/step_source.hpp"

#include <functional>

namespace hyperiso {

/// The part of an isosurface between two consecutive samples of the last axis (steps, if that is time).
struct SurfaceSlab {
  std::int64_t step; ///< the slab lies between the steps `step` and `step` + 1
  /// How many vertices and simplices the slabs before it have.
  std::uint64_t first_vertex, first_simplex;
  /// The simplices of the slab, and the vertices that no slab before it has: those of step `step` + 1 and of
  /// the edges that lead there (in the first slab those of step 0, too). Corners are numbers in the surface
  /// as a whole: corner v is the vertex v - first_vertex of this mesh, or for v < first_vertex a vertex that
  /// the slab before handed over. `edges` and `grid_axes` are those of the whole grid, `active_cells` are
  /// those of the slab. The sink may move the mesh away or change it; what it leaves is memory for the next
  /// slab.
  Mesh& mesh;
};

/// Takes a slab; an error ends the stream.
using SlabSink = std::function<Status(SurfaceSlab& slab)>;

/// Extracts the isosurface of a field that is read step by step, and hands it to `sink` slab by slab, in the
/// order of the steps: once for each pair of steps, also where no surface lies between them.
///
/// Guarantees: those of `extract`. The positions, edges and simplices of all slabs, one after the other, are
/// the bytes that `extract` gives for the whole field. So to concatenate slabs is to append their arrays.
/// Only the width of vertex numbers may differ: 64 bits from the slab on in which the numbers pass 2^32,
/// where `extract` uses them throughout.
///
/// Memory: two steps of the field, as they lie in the memory of the source if their samples are one after the
/// other there, else copied; one slab's mesh; about 2 % of a step (float) for labels. Where samples are
/// missing (NaN) three steps, for whether a vertex exists at a step depends on the cells on both sides of it.
/// The mesh takes memory as the largest slab so far needs it.
///
/// `options.memory_limit`: bytes that the mesh of one slab may take; `options.progress` is told the share of
/// all slabs. Types: all of SampleType. Methods: hull, component and simplicial; dimensions 2 to 5. A field
/// with fewer than two samples along an axis has no slab with a surface; with one step it has no slab.
/// Cost: that of `extract`, and reading. Each step is read once, in order. Errors: those of `extract`, of the
/// source and of `sink`; invalid_argument for Method::barycentric, whose vertices come in no order, and if a
/// step that the source gives is not of the type and size of its description.
Status stream(StepSource& source, double isovalue, const SlabSink& sink, const ExtractOptions& options = {});

} // namespace hyperiso
