#pragma once
// What others need for the same job on the same samples: seconds, or nothing where the peer is not installed
// or does not do the job. Fresh output, normals off. The fastest of a few runs, for no longer than a few
// seconds.

#include <array>
#include <optional>

namespace hyperiso::bench {

// A volume of floats, axis 0 fastest.
struct Volume {
  const float* samples;
  std::array<int, 3> dims;
};

// VTK's Flying Edges on float volumes.
std::optional<double> vtk_flying_edges_seconds(const Volume& volume, double isovalue, int threads);

// scikit-image's marching cubes (Lewiner), one thread, in a Python process of its own, its start not counted.
std::optional<double> skimage_marching_cubes_seconds(const Volume& volume, double isovalue);

// GUDHI's Manifold_tracing of a sphere of radius 1/2 in [-1, 1]^4 on a Kuhn triangulation of `samples` points
// per axis, from the function itself, from a seed: what it costs to find the crossed simplices.
std::optional<double> gudhi_manifold_tracing_seconds(int samples);

} // namespace hyperiso::bench
