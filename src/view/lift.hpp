#pragma once
// Interval volumes as pages show them.

#include "hyperiso/mesh.hpp"

#include <optional>

namespace hyperiso {

// The surface in one dimension more that an interval volume is the projection of: its last coordinate is the
// isovalue, so that its cut there is the isosurface at that value. Nothing if `volume` is no volume in R^2 or
// R^3 or has no vertex attribute `isovalue`. Throws std::bad_alloc.
std::optional<Mesh> lifted(const Mesh& volume);

// The axis of isovalues of such a volume: those of its levels, which its attribute `level` numbers; without
// samples if it has none.
Axis isovalue_axis(const Mesh& volume);

} // namespace hyperiso
