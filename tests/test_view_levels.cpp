// Pages of interval volumes: the volume as the surface in one dimension more that it is the projection of.

#include "core/determinant.hpp"
#include "hyperiso/interval.hpp"
#include "hyperiso/sample.hpp"
#include "view/lift.hpp"

#include <gtest/gtest.h>

namespace hyperiso {
namespace {

template <int D>
VolumeMesh<D> blob_levels(std::vector<std::int64_t> dims) {
  SampleOptions options;
  options.dims = std::move(dims);
  options.time = false;
  const Field field = *make_sample("gaussians", options);
  const double levels[] = {0.3, 0.45, 0.7};
  return *interval(field.view<float, D>(), levels);
}

// The normal points towards larger isovalues, as that of a field less the isovalue does: det[n; ...] > 0.
template <int D>
void expect_oriented(const VolumeMesh<D>& volume) {
  const std::optional<Mesh> surface = lifted(volume);
  ASSERT_TRUE(surface);
  ASSERT_GT(surface->simplex_count(), 100u);
  std::size_t wrong = 0;
  for (std::size_t simplex = 0; simplex < surface->simplex_count(); ++simplex) {
    std::vector<double> rows(D + 1, 0);
    rows[D] = 1;
    const auto position = [&](std::size_t corner, std::size_t axis) {
      return surface->positions[surface->simplices[simplex * (D + 1) + corner] * (D + 1) + axis];
    };
    for (std::size_t corner = 1; corner <= D; ++corner)
      for (std::size_t axis = 0; axis <= D; ++axis)
        rows.push_back(position(corner, axis) - position(0, axis));
    wrong += determinant(rows, D + 1) < -1e-9;
  }
  EXPECT_LE(wrong, surface->simplex_count() / 50); // those that fold
}

TEST(PageLevels, lifted_volumes_are_oriented) {
  expect_oriented(blob_levels<3>({14, 13, 12}));
  expect_oriented(blob_levels<2>({40, 41}));
}

TEST(PageLevels, the_axis_has_the_levels_as_samples) {
  const Axis axis = isovalue_axis(blob_levels<3>({14, 13, 12}));
  EXPECT_EQ(axis.count, 3);
  EXPECT_EQ(axis.coordinates, (std::vector<double>{0.3, 0.45, 0.7}));
}

TEST(PageLevels, a_volume_without_isovalues_is_refused) {
  VolumeMesh<3> volume = blob_levels<3>({14, 13, 12});
  volume.attributes.clear();
  EXPECT_FALSE(lifted(volume));
  EXPECT_EQ(isovalue_axis(volume).count, 0);
}

} // namespace
} // namespace hyperiso
