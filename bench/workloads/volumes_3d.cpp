// Three dimensions, where Flying Edges and marching cubes do the same job.

#include "workload.hpp"

namespace hyperiso::bench {
namespace {

[[maybe_unused]] const int added[] = {
    add_workload({.title = "gyroid 256^3", .sample = "gyroid", .dims = {256, 256, 256}, .peers = true}),
    add_workload({.title = "marschner-lobb 256^3",
                  .sample = "marschner-lobb",
                  .dims = {256, 256, 256},
                  .peers = true}),
    add_workload({.title = "gyroid 512^3", .sample = "gyroid", .dims = {512, 512, 512}, .peers = true}),
};

} // namespace
} // namespace hyperiso::bench
