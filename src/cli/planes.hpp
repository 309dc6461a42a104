#pragma once
// Where to cut: --time, --axis, --plane.

#include "hyperiso/field.hpp"
#include "hyperiso/slice.hpp"

#include <CLI/App.hpp>

#include <string>
#include <vector>

namespace hyperiso::cli {

// A plane in the coordinates of the output: those of the axes, or of the world where the field has a map to
// it.
struct Plane {
  std::vector<double> normal;
  double offset = 0;
  std::string name; // of what `offset` is a value of: "t", "y", "plane"
  double value = 0; // along an axis; the offset of an oblique plane
  int axis = -1;    // that it lies across; -1: oblique

  template <int D>
  Hyperplane<D> hyperplane() const {
    Hyperplane<D> result;
    for (int k = 0; k < D; ++k) result.normal[k] = normal[static_cast<std::size_t>(k)];
    result.offset = offset;
    return result;
  }
};

struct PlaneOptions {
  std::vector<std::string> times, axes, planes;
  std::string frame = "orthonormal";

  void add_to(CLI::App& app);
  SliceFrame slice_frame() const;
  // The planes in the order times, axes, planes, for a space with these axes. Fails if there are none.
  std::vector<Plane> parse(const std::vector<Axis>& space) const;
};

// A cut of a field that has a map to the world: the plane in axis coordinates, and the map from the cut made
// there, in SliceFrame::axes, to the coordinates of the plane in the world, in `frame`.
struct MappedPlane {
  Plane plane;
  std::optional<Affine> map; // none: they are the same
};
MappedPlane in_axis_coordinates(const Plane& plane, const std::optional<Affine>& world, SliceFrame frame);

} // namespace hyperiso::cli
