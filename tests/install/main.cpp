#include <hyperiso/hyperiso.hpp>

#include <cmath>
#include <iostream>
#include <vector>

// A ball that moves along x: 32 x 32 x 32 samples at 20 times, x varying fastest.
std::vector<float> moving_ball() {
  std::vector<float> samples;
  for (int t = 0; t < 20; ++t)
    for (int z = 0; z < 32; ++z)
      for (int y = 0; y < 32; ++y)
        for (int x = 0; x < 32; ++x) {
          const double radius = std::hypot(x - 10 - 0.5 * t, y - 15.5, z - 15.5);
          samples.push_back(static_cast<float>(8 - radius));
        }
  return samples;
}

int main() {
  const std::vector<float> samples = moving_ball();
  const auto field = hyperiso::contiguous_view(samples.data(), hyperiso::unit_grid<4>({32, 32, 32, 20}));

  const auto surface = hyperiso::extract(field, 0.0); // tetrahedra in space and time
  if (!surface) return std::cerr << surface.error().message << '\n', 1;
  std::cout << surface->vertex_count() << " vertices, " << surface->simplex_count() << " tetrahedra\n";

  const auto moment = hyperiso::slice(*surface, hyperiso::Hyperplane<4>::at(3, 7.25)); // triangles in space
  if (!moment) return std::cerr << moment.error().message << '\n', 1;
  const auto measured = hyperiso::measure(*moment);
  if (!measured) return std::cerr << measured.error().message << '\n', 1;
  std::cout << "at t = 7.25: area " << measured->content << ", Euler characteristic "
            << measured->euler_characteristic << (measured->closed ? ", closed\n" : ", open\n");

  const auto written = hyperiso::write_mesh(*moment, "ball_7.25.ply");
  return written ? 0 : 1;
}
