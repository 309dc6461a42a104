#pragma once
// The engine on a field of which two steps are in memory at a time (steps: samples along the last axis).
//
// It goes on from slab to slab: the masks of the upper step, and the numbers of its vertices, are those of
// the lower step of the next slab. So every step is scanned once, as in a whole field.

#include "extract/engine.hpp"
#include "hyperiso/stream.hpp"

#include <functional>
#include <memory>

namespace hyperiso {

// Sample 0 of the step behind the slab, or nothing if there is none. Asked for only where samples are
// missing.
using FollowingStep = std::function<Result<const std::byte*>()>;

template <int D>
class SlabEngine {
 public:
  virtual ~SlabEngine() = default;
  // Extracts the next slab, from sample 0 of its steps. `lower` holds what `upper` held in the last call.
  // The mesh gets the vertices that no slab before it had; corners count those of all slabs.
  // Throws std::bad_alloc.
  virtual Status extract(const std::byte* lower, const std::byte* upper, const FollowingStep& following) = 0;
};

// `field` is the field as a whole: the strides along its last axis and its first sample do not matter, those
// along the other axes are the same in all steps, and the distance of two steps in memory is a whole number
// of samples. At least two samples along every axis; not by Method::barycentric. Options and mesh outlive the
// engine. Throws std::bad_alloc.
template <int D>
std::unique_ptr<SlabEngine<D>> make_slab_engine(const Samples<D>& field, TableForm form,
                                                const ExtractOptions& options,
                                                const EngineOptions& engine_options, SimplexMesh<D>& mesh);

// `stream` with the choices that only tests make.
Status stream_with(StepSource& source, double isovalue, const SlabSink& sink, const ExtractOptions& options,
                   const EngineOptions& engine_options);

} // namespace hyperiso
