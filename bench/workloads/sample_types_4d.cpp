// The same surface in other sample types: none may be slower than float.

#include "workload.hpp"

namespace hyperiso::bench {
namespace {

[[maybe_unused]] const int added[] = {
    add_workload({.title = "gyroid 64^3 x 32, u8",
                  .sample = "gyroid",
                  .dims = {64, 64, 64, 32},
                  .type = SampleType::u8}),
    add_workload({.title = "gyroid 64^3 x 32, u16",
                  .sample = "gyroid",
                  .dims = {64, 64, 64, 32},
                  .type = SampleType::u16}),
    add_workload({.title = "gyroid 64^3 x 32, f64",
                  .sample = "gyroid",
                  .dims = {64, 64, 64, 32},
                  .type = SampleType::f64}),
};

} // namespace
} // namespace hyperiso::bench
