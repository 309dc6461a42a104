#pragma once
// What the tests of slices share.

#include "check.hpp"
#include "hyperiso/slice.hpp"

#include <cmath>

namespace hyperiso::check {

template <int D, int K>
SimplexMesh<D - 1, K - 1> sliced(const SimplexMesh<D, K>& mesh, const Hyperplane<D>& plane,
                                 const SliceOptions& options = {}) {
  auto cut = slice(mesh, plane, options);
  EXPECT_TRUE(cut) << cut.error().message;
  return *std::move(cut);
}

// A ball of radius 1.1 that moves along x; its surface in R^4 is a tube, open at the first and last step.
inline OwnedField<double, 4> moving_ball() {
  Grid<4> grid = box_grid<4>(25, -1.7, 1.7);
  grid.axes[3] = Axis{.count = 5, .origin = 2, .spacing = 0.25};
  return make_field<double, 4>(grid, [](const auto& p) {
    const double x = p[0] - 0.4 * (p[3] - 2.5);
    return 1.1 - std::sqrt(x * x + p[1] * p[1] + p[2] * p[2]);
  });
}

// Random with a constant layer on the walls of all axes but the last: open at the first and the last step
// only.
inline OwnedField<float, 4> random_island(unsigned seed, int range) {
  const std::array<std::int64_t, 4> dims{6, 5, 5, 4};
  auto field = random_field<float, 4>(dims, range, seed);
  std::size_t sample = 0;
  for_each_index<4>(dims, [&](const auto& index) {
    for (int axis = 0; axis < 3; ++axis)
      if (index[axis] == 0 || index[axis] == dims[axis] - 1)
        field.samples[sample] = static_cast<float>(-range);
    ++sample;
  });
  return field;
}

} // namespace hyperiso::check
