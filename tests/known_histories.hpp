#pragma once
// Fields in space and time whose history can be computed by hand, each on a grid as large as what happens in
// it, spacing 1. `first` and `steps` cut a part out of their time.

#include "track_fields.hpp"

namespace hyperiso::check {

using SpaceTimePoint = std::array<double, 4>;

struct Box {
  std::array<int, 3> low, high;
};

template <class Function>
Field field_on(const Box& box, int first, int steps, Function&& f) {
  Grid<4> grid;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    grid.axes[axis].origin = box.low[axis];
    grid.axes[axis].count = box.high[axis] - box.low[axis] + 1;
  }
  grid.axes[3].origin = first;
  grid.axes[3].count = steps;
  return time_field<double, 4>(make_field<double, 4>(grid, std::forward<Function>(f)));
}

inline double squared(double x) { return x * x; }
inline double distance_squared(const SpaceTimePoint& p, double x, double y, double z) {
  return squared(p[0] - x) + squared(p[1] - y) + squared(p[2] - z);
}
inline double ball_volume(double radius) { return 4.0 / 3 * M_PI * radius * radius * radius; }

// At 0.5: two balls that become one at the origin at 7.916247; or one becomes two at 15 less that.
inline Field two_gaussians(bool reversed = false) {
  return field_on({{-19, -8, -8}, {19, 8, 8}}, 0, 16, [=](const auto& p) {
    const double a = 13 - 0.8 * (reversed ? 15 - p[3] : p[3]);
    return std::exp(-distance_squared(p, a, 0, 0) / 32) + std::exp(-distance_squared(p, -a, 0, 0) / 32);
  });
}

// At 0.5: a ball that is born at 2 and dies at 12.
inline double growing_ball_amplitude(double time) { return 0.5 + 0.02 * (time - 2) * (12 - time); }
inline double growing_ball_radius(double time) {
  return 4 * std::sqrt(2 * std::log(growing_ball_amplitude(time) / 0.5));
}
inline Field growing_ball() {
  return field_on({{-7, -7, -7}, {7, 7, 7}}, 0, 15, [](const auto& p) {
    return growing_ball_amplitude(p[3]) * std::exp(-distance_squared(p, 0, 0, 0) / 32);
  });
}

// At 0.4: what lies between two concentric spheres, of which the inner one shrinks to nothing at 8.455366.
inline std::array<double, 2> shell_radii(double time) {
  const double half = 4 * std::sqrt(2 * std::log((0.8 + 0.5 * time) / 0.4));
  return {std::max(9 - half, 0.0), 9 + half};
}
inline Field shell(int first = 0, int steps = 12) {
  const int reach = static_cast<int>(std::ceil(shell_radii(first + steps - 1)[1]));
  return field_on({{-reach, -reach, -reach}, {reach, reach, reach}}, first, steps, [](const auto& p) {
    return (0.8 + 0.5 * p[3]) * std::exp(-squared(std::sqrt(distance_squared(p, 0, 0, 0)) - 9) / 32);
  });
}

// At 0: a ball of radius 6 that meets the wall x = 20 at 8 and has left through it at 16, where the last
// sample equals the isovalue.
inline Field leaving_ball(int first = 0, int steps = 18) {
  return field_on({{-6, -7, -7}, {20, 7, 7}}, first, steps,
                  [](const auto& p) { return 6 - std::sqrt(distance_squared(p, 2 + 1.5 * p[3], 0, 0)); });
}

// At 0.9: a crescent is born at 2, closes to a ring at 13.78458 where it is weak, whose hole fills at
// 26.40881.
inline Field ring(int first = 0, int steps = 28) {
  return field_on({{-18, -19, -11}, {20, 19, 11}}, first, steps, [](const auto& p) {
    const double rho = std::hypot(p[0], p[1]);
    return (1 + 0.3 * p[0] / 9) * std::exp(-(squared(rho - 9) + squared(p[2])) / 32) + 0.05 * (p[3] - 10);
  });
}

// At 0.5: three balls at the corners of a triangle that meet, make a hole, and fill it.
inline Field three_gaussians() {
  const double h = std::sqrt(3.0);
  return field_on({{-13, -11, -7}, {13, 14, 7}}, 0, 10, [=](const auto& p) {
    double sum = 0;
    for (const auto& [x, y] : {std::pair{6.0, -2 * h}, {-6.0, -2 * h}, {0.0, 4 * h}})
      sum += std::exp(-distance_squared(p, x, y, 0) / (2 * 3.5 * 3.5));
    return (0.6 + 0.08 * p[3]) * sum;
  });
}

// At 0: a plane that moves through the box, with 144 * (6 + 3.3 - 0.7 t) inside.
inline Field moving_plane() {
  return field_on({{-6, -6, -6}, {6, 6, 6}}, 0, 9, [](const auto& p) { return p[0] + 3.3 - 0.7 * p[3]; });
}

// At 0: all is inside until 2.5, when a plane appears and parts in two that move away from each other.
inline Field parting_planes() {
  return field_on({{-5, -5, -5}, {5, 5, 5}}, 0, 8,
                  [](const auto& p) { return std::abs(p[0]) - 0.5 * (p[3] - 2.5); });
}

} // namespace hyperiso::check
