#pragma once
// Which part of a surface is seen in each pixel, and its light.

#include "render/camera.hpp"
#include "render/canvas.hpp"

#include <vector>

namespace hyperiso {

// Of triangles in R^3, for each pixel from the top left. Throws std::bad_alloc.
std::vector<Shaded> cast_rays(const Mesh& mesh, const Camera& camera, const RenderOptions& options);

} // namespace hyperiso
