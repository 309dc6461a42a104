#pragma once
// The surface of a packed field: the same function in the writer and in the page.

#include "extract/extract_with.hpp"
#include "view/sample_codes.hpp"

#include <limits>

namespace hyperiso {

// `isovalue` in codes; on the grid that the codes were packed from. Throws std::bad_alloc.
template <int D>
Status surface_of_codes(const SampleLayers& layers, const Grid<D>& grid, double isovalue,
                        const ExtractOptions& options, SimplexMesh<D>& mesh) {
  if (!layers.scale().special)
    return extract_with(contiguous_view<const std::uint16_t, D>(layers.codes.data(), grid), isovalue, options,
                        EngineOptions{}, mesh);
  constexpr float infinity = std::numeric_limits<float>::infinity();
  std::vector<float> samples(layers.codes.begin(), layers.codes.end());
  for (float& sample : samples) {
    if (sample == CodeScale::missing) sample = std::numeric_limits<float>::quiet_NaN();
    if (sample == CodeScale::infinity) sample = infinity;
    if (sample == CodeScale::minus_infinity) sample = -infinity;
  }
  return extract_with(contiguous_view<const float, D>(samples.data(), grid), isovalue, options,
                      EngineOptions{}, mesh);
}

} // namespace hyperiso
