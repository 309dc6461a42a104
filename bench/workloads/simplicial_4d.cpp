// The simplicial method: about five times as many simplices.

#include "workload.hpp"

namespace hyperiso::bench {
namespace {

[[maybe_unused]] const int added[] = {
    add_workload({.title = "gyroid 64^3 x 32, simplicial",
                  .sample = "gyroid",
                  .dims = {64, 64, 64, 32},
                  .method = Method::simplicial}),
    add_workload({.title = "ball 40^4, simplicial",
                  .sample = "ball",
                  .dims = {40, 40, 40, 40},
                  .method = Method::simplicial,
                  .peers = true}),
};

} // namespace
} // namespace hyperiso::bench
