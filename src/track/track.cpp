// Tracking: the Reeb graph of time on the isosurface M in space and time, slab by slab (docs/tracking.md);
// or on the region that it bounds, a mesh of one dimension more.
//
// tracking_run.hpp passes the steps in order. What is tracked is told by surface_target.hpp or by
// region_target.hpp; track_surface.cpp and track_region.cpp compile the two.
// Of a region all that lies between two steps is made (region_mesh.hpp, region_slab.hpp). Of the surface
// surface_steps.hpp makes, for each step:
//   step_mask.hpp     which samples are inside, in bits
//   step_pieces.hpp   the connected pieces of the surface there
// and for each slab, which is what lies between two steps:
//   crossings.hpp     the vertices strictly inside it, each with its time, a fraction of the step: the
//                     weight of its crossing, so that equal samples give equal times and only vertices on a
//                     step have 0 or 1
//   candidates.hpp    those of them that tables of cells (cell_links.hpp) do not tell to be regular
//   slab.hpp          the slab's part of M, which unfolds from the signs (signed_cells.hpp) where something
//                     asks for it; or all of it, where samples are missing or equal the isovalue
// Then, in order of time:
//   level.hpp         decides the nodes at the step where the slab begins, from the closed level set of that
//                     time: which arcs of the slab before reach each of its pieces, which strands of this
//                     one leave it
//   sweep.hpp         passes the candidates in order of time and decides the nodes there
//     link_test.hpp     whether one is regular, in bits
//     side.hpp          the slices just before and after a cluster of vertices with one time: their pieces,
//                       their Euler characteristic
//     slice_search.hpp  whether several places of a slice are connected, and how many boundary curves pass
//                       some; landmarks.hpp ends them early
//   graph_builder.hpp collects events and arcs
//   step_features.hpp measures the components at the step, on regions of samples (regions.hpp)
//   region_features.hpp measures those of a region, on its mesh
//   exact_overlap.hpp cuts what two steps have in common
//   links.hpp         says which rows of the last step each row comes from, for overlaps
// After the last step:
//   tracks.hpp        names what goes on through events
//
// A strand is a component of the slices within one slab, an arc one from node to node; a strand has an arc,
// and at a step an arc goes on to a strand of the next slab. Nothing compares times or places with a
// tolerance: a node is what is connected at exactly its time.

#include "hyperiso/track.hpp"

#include "track/check_source.hpp"
#include "track/tracking_run.hpp"
#include "track/with_fields.hpp"

#include <new>

namespace hyperiso {

const char* name_of(EventType type) {
  constexpr const char* names[] = {"birth", "death", "merge", "split",      "compound", "genus",
                                   "enter", "exit",  "touch", "open_start", "open_end"};
  return names[static_cast<std::size_t>(type)];
}

Result<TrackingGraph> track(StepSource& source, double isovalue, const TrackOptions& options) {
  if (const Status valid = track_detail::check_source(source.info(), options.extraction.method); !valid)
    return valid.error();
  if (const Status valid = track_detail::check_tracked(isovalue, options); !valid) return valid.error();
  if (const Status valid = track_detail::check_with(source.info(), options.with); !valid)
    return valid.error();
  try {
    return options.tracked == Tracked::region ? track_detail::track_region(source, isovalue, options)
                                              : track_detail::track_surface(source, isovalue, options);
  } catch (const track_detail::TrackingCancelled&) {
    return Error{Code::cancelled, "tracking was cancelled"};
  } catch (const std::bad_alloc&) {
    return Error{Code::out_of_memory, "not enough memory to track"};
  }
}

} // namespace hyperiso
