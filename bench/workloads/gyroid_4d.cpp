// A surface everywhere: writing simplices decides.

#include "workload.hpp"

namespace hyperiso::bench {
namespace {

[[maybe_unused]] const int added[] = {
    add_workload({.title = "gyroid 64^3 x 32", .sample = "gyroid", .dims = {64, 64, 64, 32}, .peers = true}),
    add_workload({.title = "gyroid 128^3 x 32", .sample = "gyroid", .dims = {128, 128, 128, 32}}),
};

} // namespace
} // namespace hyperiso::bench
