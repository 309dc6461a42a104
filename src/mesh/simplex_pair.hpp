#pragma once
// Whether two simplices pass through each other, decided exactly.

#include <cstddef>
#include <span>

namespace hyperiso {

// Whether the relative interiors of the simplices with these corners have a point in common: (D-1)- or
// D-simplices in R^D, 2 <= D <= 8, of which some corners may be the same: then given by the same pointer to D
// finite coordinates. False if one of them has content 0.
bool interiors_meet(std::size_t dimension, std::span<const double* const> a,
                    std::span<const double* const> b);

} // namespace hyperiso
