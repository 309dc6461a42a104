#include "track/surface_target.hpp"
#include "track/tracking_run.hpp"

namespace hyperiso::track_detail {

Result<TrackingGraph> track_surface(StepSource& source, double isovalue, const TrackOptions& options) {
  return run_tracking<SurfaceTarget>(source, isovalue, options);
}

} // namespace hyperiso::track_detail
