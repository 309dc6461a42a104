#pragma once
// Where the points of space are in a picture.

#include "hyperiso/render.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace hyperiso {

using Vector = std::array<double, 3>;

inline double dot(const Vector& a, const Vector& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }
inline Vector cross(const Vector& a, const Vector& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}
inline Vector unit(const Vector& a) {
  const double length = std::sqrt(dot(a, a));
  return length > 0 ? Vector{a[0] / length, a[1] / length, a[2] / length} : a;
}

// Looks from a distance at a box, whose middle is the origin of its coordinates and whose largest half-edge
// is 1 in them: whatever the units, single precision will do for what is near.
class Camera {
 public:
  explicit Camera(const RenderOptions& options)
      : width_(options.width), height_(options.height), aspect_(width_ / height_) {
    double largest = 0;
    for (std::size_t k = 0; k < 3; ++k) {
      middle_[k] = options.low[k] / 2 + options.high[k] / 2;
      half_[k] = options.high[k] / 2 - options.low[k] / 2;
      largest = std::max(largest, half_[k]);
    }
    if (largest > 0) scale_ = 1 / largest;
    for (double& half : half_) half *= scale_;
    const double azimuth = options.azimuth * std::numbers::pi / 180;
    const double elevation = options.elevation * std::numbers::pi / 180;
    back = {std::cos(elevation) * std::cos(azimuth), std::cos(elevation) * std::sin(azimuth),
            std::sin(elevation)};
    right = {-std::sin(azimuth), std::cos(azimuth), 0};
    up = cross(back, right);
    for (unsigned corner = 0; corner < 8; ++corner) {
      const Vector point = box_corner(corner);
      const double sideways = std::abs(dot(point, right)) / (tangent * aspect_ * share_of_width);
      const double upwards = std::abs(dot(point, up)) / (tangent * share_of_height);
      distance = std::max(distance, dot(point, back) + std::max(sideways, upwards));
    }
    if (distance == 0) distance = 1;
  }

  Vector near_origin(const Vector& point) const {
    Vector result;
    for (std::size_t k = 0; k < 3; ++k) result[k] = (point[k] - middle_[k]) * scale_;
    return result;
  }
  // Bit k of `corner`: the upper end of axis k.
  Vector box_corner(unsigned corner) const {
    Vector point;
    for (std::size_t k = 0; k < 3; ++k) point[k] = corner >> k & 1 ? half_[k] : -half_[k];
    return point;
  }

  // The pixel of a point near the origin, x to the right and y down.
  std::array<double, 2> pixel(const Vector& point) const {
    const double depth = distance - dot(point, back);
    return {(1 + dot(point, right) / (depth * tangent * aspect_)) * width_ / 2,
            (1 - dot(point, up) / (depth * tangent)) * height_ / 2};
  }
  // The direction from the camera through a place in the picture.
  Vector towards(double x, double y) const {
    const double sideways = (2 * x / width_ - 1) * tangent * aspect_,
                 upwards = (1 - 2 * y / height_) * tangent;
    Vector direction;
    for (std::size_t k = 0; k < 3; ++k) direction[k] = sideways * right[k] + upwards * up[k] - back[k];
    return unit(direction);
  }
  Vector position() const { return {distance * back[0], distance * back[1], distance * back[2]}; }

  Vector right, up, back; // of the picture; orthonormal
  double distance = 0;    // of the camera from the middle of the box

 private:
  static constexpr double tangent = 0.2679; // of half the angle of view, 15 degrees
  static constexpr double share_of_width = 0.78, share_of_height = 0.8; // that the box may fill

  double width_, height_, aspect_, scale_ = 1;
  Vector middle_{}, half_{};
};

} // namespace hyperiso
