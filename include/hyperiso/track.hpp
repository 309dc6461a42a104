#pragma once
/// \file
/// Components of an isosurface through time: when each is born, dies, merges, splits, and where.

#include "hyperiso/extract.hpp"
#include "hyperiso/step_source.hpp"

#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <vector>

namespace hyperiso {

/// What has components.
enum class Tracked {
  surface, ///< the isosurface
  region,  ///< what lies inside it, or between two isovalues: two surfaces that bound one shell are one thing
};

/// What happens to components at one moment in one connected piece of the surface (docs/tracking.md); of a
/// region in the same way.
enum class EventType {
  birth,      ///< nothing before, one component after
  death,      ///< one before, nothing after
  merge,      ///< several before, one after
  split,      ///< one before, several after
  compound,   ///< any other change of their number at one instant, nothing into two included
  genus,      ///< one before and after; a handle or a hole more or less
  enter,      ///< a birth on a wall of the domain
  exit,       ///< a death on a wall of the domain
  touch,      ///< one before and after; a wall of the domain begins or ends to cut it
  open_start, ///< it is there at the first step
  open_end,   ///< it is there at the last step
};
const char* name_of(EventType type);

/// How much of a component before an event is in one after it: paper 003's ratio between the last step before
/// and the first step after it.
struct TrackOverlap {
  std::int64_t track_in = -1, track_out = -1;
  double ratio = 0;
};

/// A node of the Reeb graph of time. Arcs and tracks are numbers in TrackingGraph.
struct TrackingEvent {
  EventType type{};
  double time = 0;
  std::vector<double> position; ///< on the axes of space
  std::vector<std::int64_t> arcs_in, arcs_out;
  std::vector<std::int64_t> tracks_in, tracks_out; ///< at a merge the surviving track stands in both
  std::int64_t delta_euler = 0; ///< change of the slice's Euler characteristic; 0 for open_start and open_end
  std::vector<TrackOverlap> overlaps; ///< of those that are there at these steps
  bool simplified = false;            ///< nothing happens here once simplified tracks are left out
};

/// A component between two events: it exists from the one to the other, and its topology does not change.
struct TrackingArc {
  std::int64_t start_event = -1, end_event = -1;
  std::int64_t track = -1; ///< of its first part, where weak links cut it
  double max_volume = 0;
  double least_overlap = 1; ///< of its links; 1 if it has none
};

/// A field beside the tracked one, over the samples that lie inside a component; missing ones do not count.
struct FieldSum {
  double mass = 0; ///< sum of the samples, each by its share of the cells
  double minimum = std::numeric_limits<double>::infinity(), maximum = -minimum; ///< infinite without samples
};

/// A component at a step: one row of features.csv. Where samples equal the isovalue, the level set may have a
/// piece where the surface at the step has none: all sizes are 0 then, and it lies in the middle of that
/// piece.
struct Feature {
  std::int64_t step = 0;
  double time = 0;
  std::int64_t track = -1;
  std::int64_t arc = -1;   ///< that passes the step, or -1:
  std::int64_t event = -1; ///< the event at the step that it is part of, or -1

  // Of a region all is that of its mesh, but for the cell volume.
  double volume = 0;      ///< enclosed, or inside it where walls cut it open: of the piecewise linear surface
  double cell_volume = 0; ///< the same as paper 003 counts it: cells by the share of their corners inside
  double surface_area = 0;
  double mass = 0; ///< sum of the samples inside, each by its share of the cells; of a region, the integral
  double minimum = 0, maximum = 0;       ///< of the samples inside; infinite without any
  std::vector<double> centroid;          ///< of the samples inside, each by its share of the cells
  std::vector<double> low, high;         ///< bounding box of the surface
  std::int64_t euler_characteristic = 0; ///< of the surface, or of the region
  std::int64_t wall_curves = 0;          ///< boundary curves of a surface in 3D; 0 for regions
  std::int64_t cells = 0;                ///< grid cells that it passes through
  bool on_wall = false;
  std::vector<FieldSum> with; ///< of TrackOptions::with, in that order

  /// (2 - wall_curves - euler_characteristic) / 2: handles, where it is one closed or cut surface in 3D.
  double genus() const { return 0.5 * static_cast<double>(2 - wall_curves - euler_characteristic); }
};

/// The same component, or what became of it, one step later.
struct FeatureLink {
  std::int64_t from = -1, to = -1; ///< features at consecutive steps
  double overlap = 0;              ///< V(both) / min(V(from), V(to)) (paper 003 section 3.3)
  bool weak = false;               ///< at or below the threshold: cut in the tracks
};

/// A component followed through time under one name.
struct Track {
  double start_time = 0, end_time = 0;
  std::string start_type, end_type; ///< of its first and last event; "weak" where a weak link was cut
  std::vector<std::int64_t> parents, children; ///< tracks it split from or merged from; into which it went
  std::int64_t steps = 0;
  double max_volume = 0;
  std::int64_t family = -1; ///< smallest number of a track that events connect it with
  bool clipped = false;     ///< touched a wall of the domain
  /// The indices of the lowest corner of a grid cell that it passes, time last: a seed for
  /// `track_from_seeds`. Empty for regions.
  std::vector<std::int64_t> cell;
  bool simplified = false; ///< left out by `simplify`
};

/// The Reeb graph of time on the surface, in order of time; what is measured at steps; tracks through it.
struct TrackingGraph {
  /// The feature that the piece of the surface at a step belongs to whose first vertex lies on `edge`.
  struct Piece {
    GridEdge edge; ///< on the grid of the step, for a region on that grid with an axis of its levels
    std::int64_t feature;
  };

  std::vector<Axis> axes; ///< of the field, time last
  std::int64_t steps = 0;
  Tracked tracked = Tracked::surface;
  double isovalue = 0;
  std::optional<double> upper_isovalue; ///< of a region that lies between two
  std::vector<std::string> with;        ///< names of TrackOptions::with
  std::vector<TrackingEvent> events;
  std::vector<TrackingArc> arcs;
  std::vector<Feature> features; ///< by step
  std::vector<FeatureLink> links;
  std::vector<std::vector<Piece>> pieces; ///< of each step, by edge
  std::vector<Track> tracks;
};

/// How the volumes of an overlap and of what overlaps are taken.
enum class OverlapVolumes {
  cells, ///< as paper 003 counts them: cells by the share of their corners inside
  exact, ///< of the interpolants that are linear on the Kuhn simplices of the cells: what `simplicial`
         ///< bounds; with `hull`, where cells are ambiguous, a simplex that touches two cavities counts for
         ///< one of them
};

/// Another field on the same grid of samples.
struct FieldBeside {
  std::string name;
  StepSource* source = nullptr;
};

struct TrackOptions {
  /// method, inside, memory_limit and progress count: the limit is for each surface that is made, progress is
  /// told at each event too, since what a slab of noise takes and holds is not known before.
  ExtractOptions extraction = {};
  Tracked tracked = Tracked::surface;        ///< a region only with the methods hull and simplicial
  std::optional<double> upper_isovalue = {}; ///< of a region: it lies between `isovalue` and this one
  bool measure_features = true;              ///< else features and links stay empty, and identity goes by age
  std::optional<double> overlap_threshold = {}; ///< links at or below it are weak; none: no link is
  OverlapVolumes overlap_volumes = OverlapVolumes::cells;
  std::vector<FieldBeside> with = {}; ///< summed over the features; each as many samples along each axis
};

/// Tracks the components of the isosurface of `source` through the time that is its last axis, two steps in
/// memory at a time (D = 3 and 4: 2D and 3D through time). Between steps the field is linear in time along
/// each edge, and the events are those of the isosurface in space and time that `extract` makes: exact, ties
/// included, found without any tolerance.
///
/// With Tracked::region the components are those of the inside, or of what lies between two isovalues: the
/// events are those of the interval volume in space and time that `interval` makes, `genus` where one
/// component changes its Euler characteristic. It costs more, as the inside is filled with simplices.
///
/// An axis of space with one sample has no cells, so there is nothing: leave it out of the field, as the
/// program does. The graph does not depend on the number of threads.
/// Cost: about three times that of `stream` where a percent or two of the cells are active; many times that
/// where events are many or samples equal the isovalue (docs/performance.md). Errors: those of `extract` and
/// of the source; invalid_argument for fewer than two steps or a time axis that does not increase.
Result<TrackingGraph> track(StepSource& source, double isovalue, const TrackOptions& options = {});

/// The history of a few components, and what it took.
struct LocalTracking {
  TrackingGraph graph;
  std::uint64_t samples = 0; ///< that were looked at; again where a slab was looked at again
};

/// Tracks only the components that pass the seed cells (a cell by the indices of its lowest corner, time
/// last), and all that they come from and turn into: the families of these, as `track` finds them. Goes
/// forward and backward in time from slab to slab, and only along the surface: cost follows the family, not
/// the field, at some 45 ns for each simplex that it has with `hull` (paper 003 section 3.1). Features are
/// not measured: `features`, `links` and `pieces` stay empty, and at merges and splits the older track goes
/// on.
///
/// Errors: those of `track`; outside_domain for a cell that is not on the grid or that the surface does not
/// pass.
Result<LocalTracking> track_from_seeds(StepSource& source, double isovalue,
                                       const std::vector<std::vector<std::int64_t>>& cells,
                                       const TrackOptions& options = {});

/// Marks tracks as simplified: those that never reach `minimum_volume`, and those that last less than
/// `minimum_duration` and are a leaf (one end is a birth, a death, or on a wall) or a loop (they split from
/// the track that they merge into). Tracks cut by the first or last step are not judged by their duration.
/// Events that are left with the same track before and after and none else are marked too. Nothing is removed
/// and no number changes. Returns how many tracks are marked.
std::int64_t simplify(TrackingGraph& graph, double minimum_volume, double minimum_duration);

/// The graph as line segments in space: a point for each feature, at its centroid, and each event, at its
/// position; lines along the arcs. Point data under the names that TTK uses for tracking graphs:
/// SequenceIndex (the step, or -1 at events between steps), Time, Size (volume), BranchId (track), Type (of
/// the event, as in EventType, or -1); line data BranchId and Overlap (1 at events).
Mesh graph_mesh(const TrackingGraph& graph);

/// The surface at a step, or the region as a mesh of triangles or tetrahedra, with the tracks of its pieces:
/// simplex data `track_id` and `family_id`, -1 where no track passes (beside missing samples). `step` is that
/// step alone, as `source.read(number, number + 1)` gives it. Requires that `graph` came from the same field
/// with the same options and with features measured. Errors: those of `extract`.
Result<Mesh> tracked_surface(const TrackingGraph& graph, const Field& step, std::int64_t number,
                             const TrackOptions& options = {});

} // namespace hyperiso
