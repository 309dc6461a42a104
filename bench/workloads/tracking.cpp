// Components through time: few cells active, many of them, and one component among others.

#include "tracking.hpp"

#include <cstdlib>

namespace hyperiso::bench {
namespace {

std::string viscous_fingers() {
  const char* folder = std::getenv("HYPERISO_SHARED_DATA");
  return std::string(folder ? folder : "../shared/data") + "/viscous_fingers";
}

[[maybe_unused]] const int added[] = {
    add_tracking_workload(
        {.title = "gaussians 128^3 x 32", .sample = "gaussians", .dims = {128, 128, 128, 32}}),
    add_tracking_workload({.title = "gaussians 128^3 x 32, percent",
                           .sample = "gaussians",
                           .dims = {128, 128, 128, 32},
                           .percent = true}),
    add_tracking_workload({.title = "gyroid 64^3 x 32", .sample = "gyroid", .dims = {64, 64, 64, 32}}),
    add_tracking_workload({.title = "viscous fingers 64^3 x 60", .files = viscous_fingers(), .isovalue = 30}),
    add_tracking_workload({.title = "gaussians 76^3 x 32 from a seed",
                           .sample = "gaussians",
                           .dims = {76, 76, 76, 32},
                           .local = true}),
};

} // namespace
} // namespace hyperiso::bench
