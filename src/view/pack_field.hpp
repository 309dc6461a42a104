#pragma once
// A field as the codes that a page holds.

#include "view/sample_codes.hpp"

namespace hyperiso {

// All samples, or, of a `band`, those that the surface at `isovalue` needs: the corners of the cells that it
// meets.
//
// Integers of up to 16 bits are kept as they are. Others get codes of 16 bits: of a band over the range of
// the samples kept, else over that of all. Every sample stays on its side of the isovalue, which is a code
// itself where samples lie on both sides of it: so the surface at it has the same simplices, and its vertices
// move by what half a step of the samples moves them. Throws std::bad_alloc.
SampleLayers pack_field(const Field& field, double isovalue, Inside inside, bool band);

} // namespace hyperiso
