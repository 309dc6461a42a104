#pragma once
// What coordinates that fall with the index do to orientation.

#include "hyperiso/grid.hpp"

#include <algorithm>
#include <span>

namespace hyperiso {

// Whether the coordinates mirror the grid: if an odd number of axes fall. What is oriented for axes that
// all increase has to be turned round then.
inline bool mirror_space(std::span<const Axis> axes) {
  return std::ranges::count_if(axes, [](const Axis& axis) { return !axis.increasing(); }) % 2 == 1;
}

} // namespace hyperiso
