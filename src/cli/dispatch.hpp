#pragma once
// The one step from a dimension and a type known at run time to ones known to the compiler.

#include "cli/failure.hpp"
#include "core/text.hpp"
#include "hyperiso/field.hpp"
#include "hyperiso/mesh.hpp"

#include <type_traits>

namespace hyperiso::cli {

// The dimensions that extraction is built for.
constexpr int lowest_dimension = 2, highest_dimension = 4;

// Calls use(std::integral_constant<int, D>) for the D in [Lowest, highest_dimension] that is `dimension`;
// fails with a message about `what` if there is none.
template <int Lowest, class Use>
decltype(auto) with_dimension(int dimension, const char* what, Use&& use) {
  static_assert(Lowest <= 4 && highest_dimension == 4);
  if constexpr (Lowest <= 2)
    if (dimension == 2) return use(std::integral_constant<int, 2>{});
  if constexpr (Lowest <= 3)
    if (dimension == 3) return use(std::integral_constant<int, 3>{});
  if (dimension == 4) return use(std::integral_constant<int, 4>{});
  fail_usage(text(what, " has ", dimension, dimension == 1 ? " dimension" : " dimensions", "; from ", Lowest,
                  " to ", highest_dimension, " are supported"));
}

// Fails as with_dimension does, before any work.
template <int Lowest>
void check_dimension(int dimension, const char* what) {
  with_dimension<Lowest>(dimension, what, [](auto) {});
}

// Calls use(view) with the field as a view of its type and dimension.
template <int Lowest, class Use>
decltype(auto) with_view(const Field& field, Use&& use) {
  return with_dimension<Lowest>(field.info.dimension(), "the field", [&](auto dimension) {
    return visit_sample_type(field.info.type, [&](auto sample) {
      return use(field.view<decltype(sample), decltype(dimension)::value>());
    });
  });
}

// Calls use(mesh) with a mesh in R^D, D >= Lowest, of (D-1)- or D-simplices, as one that knows its
// dimensions.
template <int Lowest, class Use>
decltype(auto) with_simplex_mesh(Mesh&& mesh, Use&& use) {
  return with_dimension<Lowest>(mesh.dimension, "the mesh", [&](auto dimension) {
    constexpr int D = decltype(dimension)::value;
    if (mesh.simplex_dimension == D) return use(VolumeMesh<D>(std::move(mesh)));
    if (mesh.simplex_dimension == D - 1) return use(SimplexMesh<D>(std::move(mesh)));
    fail_usage(text("the mesh has ", mesh.simplex_dimension, "-simplices in ", D, " dimensions; ", D - 1,
                    "- or ", D, "-simplices are supported"));
  });
}

} // namespace hyperiso::cli
