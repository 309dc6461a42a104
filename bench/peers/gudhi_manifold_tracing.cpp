#include "peers.hpp"

#include "clock.hpp"

#ifdef HYPERISO_BENCH_GUDHI
#include <gudhi/Freudenthal_triangulation.h>
#include <gudhi/Functions/Function_Sm_in_Rd.h>
#include <gudhi/Implicit_manifold_intersection_oracle.h>
#include <gudhi/Manifold_tracing.h>
#endif

namespace hyperiso::bench {

std::optional<double> gudhi_manifold_tracing_seconds([[maybe_unused]] int samples) {
#ifdef HYPERISO_BENCH_GUDHI
  using namespace Gudhi::coxeter_triangulation;
  const double spacing = 2.0 / (samples - 1);
  const Function_Sm_in_Rd sphere(0.5, 3);
  const auto oracle = make_oracle(sphere);
  Freudenthal_triangulation<> grid(4);
  grid.change_matrix(spacing * Eigen::MatrixXd::Identity(4, 4));
  grid.change_offset(Eigen::VectorXd::Constant(4, spacing / 3)); // no sample on the sphere
  using Tracing = Manifold_tracing<Freudenthal_triangulation<>>;
  Tracing::Out_simplex_map crossed;
  const Clock clock;
  Tracing().manifold_tracing_algorithm(std::vector<Eigen::VectorXd>{sphere.seed()}, grid, oracle, crossed);
  return clock.seconds();
#else
  return std::nullopt;
#endif
}

} // namespace hyperiso::bench
