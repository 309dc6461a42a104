// Contours of images.

#include "workload.hpp"

namespace hyperiso::bench {
namespace {

[[maybe_unused]] const int added[] = {
    add_workload({.title = "gyroid 4096^2", .sample = "gyroid", .dims = {4096, 4096}, .peers = true}),
};

} // namespace
} // namespace hyperiso::bench
