// Moving blobs: few cells are active, reading decides. The first has the size of paper 000's Jet Shockwave.

#include "workload.hpp"

namespace hyperiso::bench {
namespace {

[[maybe_unused]] const int added[] = {
    add_workload({.title = "gaussians 256^3 x 10", .sample = "gaussians", .dims = {256, 256, 256, 10}}),
    add_workload({.title = "gaussians 128^3 x 32, 2 % active",
                  .sample = "gaussians",
                  .dims = {128, 128, 128, 32},
                  .blobs = 8}),
    add_workload(
        {.title = "gaussians 64^3 x 32", .sample = "gaussians", .dims = {64, 64, 64, 32}, .peers = true}),
};

} // namespace
} // namespace hyperiso::bench
