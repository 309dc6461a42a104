// Slices of known surfaces: their shapes, areas and contents.

#include "slice_fields.hpp"

using namespace hyperiso;
using namespace hyperiso::check;

namespace {

// The coefficients c with least sum of squares of row . c - value.
std::vector<double> least_squares(const std::vector<std::vector<double>>& rows,
                                  const std::vector<double>& values) {
  const std::size_t n = rows[0].size();
  std::vector<double> matrix(n * n), right(n), solution(n);
  for (std::size_t row = 0; row < rows.size(); ++row)
    for (std::size_t i = 0; i < n; ++i) {
      right[i] += rows[row][i] * values[row];
      for (std::size_t k = 0; k < n; ++k) matrix[i * n + k] += rows[row][i] * rows[row][k];
    }
  const double whole = determinant(matrix, static_cast<int>(n)); // Cramer's rule
  for (std::size_t k = 0; k < n; ++k) {
    auto replaced = matrix;
    for (std::size_t i = 0; i < n; ++i) replaced[i * n + k] = right[i];
    solution[k] = determinant(replaced, static_cast<int>(n)) / whole;
  }
  return solution;
}

} // namespace

// Paper 000, figure 5: f = (x-1/2)^2 + (y-1/2)^2 + (z-1/2)^2 - c w - d has a sphere for w = const and a
// paraboloid for x = const. Fitted to the vertices; what is left falls with the square of the grid's spacing.
TEST(Slice, sphere_and_paraboloid_of_figure_5) {
  constexpr double c = 0.1, d = 0.02, w = 0.437, x = 0.413;
  std::array<double, 2> sphere_residual{}, paraboloid_residual{};
  for (std::size_t fine = 0; fine < 2; ++fine) {
    const auto field = make_field<double, 4>(box_grid<4>(fine ? 25 : 13, 0, 1), [&](const auto& p) {
      double squared = 0;
      for (std::size_t k = 0; k < 3; ++k) squared += (p[k] - 0.5) * (p[k] - 0.5);
      return squared - c * p[3] - d;
    });
    const auto surface = extracted(field, 0, {.precision = Precision::f64});
    const double h = fine ? 1. / 24 : 1. / 12;

    const auto sphere = sliced(surface, Hyperplane<4>::at(3, w), {.precision = Precision::f64});
    EXPECT_TRUE(measure(sphere)->closed);
    std::vector<std::vector<double>> rows;
    std::vector<double> values;
    for (std::size_t vertex = 0; vertex < sphere.vertex_count(); ++vertex) {
      const double* p = static_cast<const double*>(sphere.positions.data()) + vertex * 3;
      rows.push_back({2 * p[0], 2 * p[1], 2 * p[2], 1});
      values.push_back(p[0] * p[0] + p[1] * p[1] + p[2] * p[2]);
    }
    auto fit = least_squares(rows, values); // centre, radius^2 - centre^2
    for (std::size_t k = 0; k < 3; ++k) EXPECT_NEAR(fit[k], 0.5, h * h);
    EXPECT_NEAR(fit[3] + fit[0] * fit[0] + fit[1] * fit[1] + fit[2] * fit[2], c * w + d, h * h);
    for (std::size_t row = 0; row < rows.size(); ++row)
      sphere_residual[fine] =
          std::max(sphere_residual[fine],
                   std::abs(std::inner_product(fit.begin(), fit.end(), rows[row].begin(), -values[row])));

    const auto paraboloid = sliced(surface, Hyperplane<4>::at(0, x), {.precision = Precision::f64});
    rows.clear(), values.clear();
    for (std::size_t vertex = 0; vertex < paraboloid.vertex_count(); ++vertex) {
      const double* p = static_cast<const double*>(paraboloid.positions.data()) + vertex * 3;
      rows.push_back({p[0] * p[0] + p[1] * p[1], p[0], p[1], 1});
      values.push_back(c * p[2]);
    }
    fit = least_squares(rows, values);
    EXPECT_NEAR(fit[0], 1, 20 * h * h);
    EXPECT_NEAR(fit[1], -1, 20 * h * h);
    EXPECT_NEAR(fit[2], -1, 20 * h * h);
    EXPECT_NEAR(fit[3], 0.5 + (x - 0.5) * (x - 0.5) - d, 20 * h * h);
    for (std::size_t row = 0; row < rows.size(); ++row)
      paraboloid_residual[fine] =
          std::max(paraboloid_residual[fine],
                   std::abs(std::inner_product(fit.begin(), fit.end(), rows[row].begin(), -values[row])));
  }
  // Linear interpolation along an axis misses a unit quadratic by up to h^2 / 4.
  for (std::size_t fine = 0; fine < 2; ++fine) {
    const double h = fine ? 1. / 24 : 1. / 12;
    EXPECT_LT(sphere_residual[fine], 0.75 * h * h);
    EXPECT_LT(paraboloid_residual[fine], 0.75 * h * h);
  }
}

// No popping between steps: the area of a moving ball's slices, and its change, go on steadily.
TEST(SliceIndex, area_of_a_moving_ball_is_smooth_in_time) {
  const auto surface = extracted(moving_ball(), 0, {.precision = Precision::f64});
  const SliceIndex<4> index(surface);
  std::vector<double> areas;
  constexpr int moments = 100;
  for (int moment = 0; moment <= moments; ++moment)
    areas.push_back(
        measure(*index.slice(surface, Hyperplane<4>::at(3, 2 + static_cast<double>(moment) / moments)))
            ->content);
  for (std::size_t i = 1; i < areas.size(); ++i) {
    EXPECT_NEAR(areas[i] / areas[i - 1], 1, 1e-3) << i;
    if (i == 1) continue;
    EXPECT_NEAR((areas[i] - 2 * areas[i - 1] + areas[i - 2]) / areas[i], 0, 1e-3) << i;
  }
}

// Coarea: the content of the slices, summed over all offsets, is that of the surface weighed by its slope.
TEST(Slice, contents_of_all_slices_add_up_to_the_surface) {
  const auto surface =
      extracted(random_field<double, 4>({3, 3, 3, 3}, 1000, 2), 0.5, {.precision = Precision::f64});
  for (const std::array<double, 4>& normal :
       {std::array<double, 4>{0, 0, 0, 1}, {0.5, 0.5, -0.5, 0.5}, {0.6, 0, 0.8, 0}}) {
    double weighed = 0;
    for (std::size_t simplex = 0; simplex < surface.simplex_count(); ++simplex) {
      Mesh one(4, 3); // its content and unit normal
      one.positions = surface.positions;
      one.simplices.reset(4, false);
      for (std::size_t corner = 0; corner < 4; ++corner)
        one.simplices.set(corner, surface.simplices[simplex * 4 + corner]);
      const auto found = measure(one);
      double along = 0;
      for (std::size_t k = 0; k < 4; ++k) along += found->vector_area[k] * normal[k];
      weighed += std::sqrt(std::max(0.0, found->content * found->content - along * along));
    }
    double sum = 0;
    const int steps = 1000;
    const double low = -2.1, high = 4.1, width = (high - low) / steps;
    for (int step = 0; step < steps; ++step)
      sum += measure(sliced(surface, {normal, low + (step + 0.5) * width}, {.precision = Precision::f64}))
                 ->content *
             width;
    EXPECT_NEAR(sum / weighed, 1, 2e-3);
  }
}
