#pragma once
// The keys under which our NRRD files tell what the format has no field for. They name an axis by its label:
// its number would be wrong once another program has permuted the axes, and these keep keys they do not know.

#include <string>

namespace hyperiso {

// The coordinates of an uneven axis, one for each sample.
inline std::string nrrd_coordinates_key(const std::string& label) {
  return "hyperiso axis coordinates " + label;
}

// Origin and first sample number of a cropped axis (Axis::origin and Axis::first). The position of sample 0,
// which is in the file as well, does not tell them, and without them later samples could be rounded otherwise
// than in the whole.
inline std::string nrrd_crop_key(const std::string& label) { return "hyperiso axis cropped from " + label; }

} // namespace hyperiso
