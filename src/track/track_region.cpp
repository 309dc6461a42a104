#include "track/region_target.hpp"
#include "track/tracking_run.hpp"

namespace hyperiso::track_detail {

Result<TrackingGraph> track_region(StepSource& source, double isovalue, const TrackOptions& options) {
  return run_tracking<RegionTarget>(source, isovalue, options);
}

} // namespace hyperiso::track_detail
