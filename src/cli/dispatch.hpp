#pragma once
// The one step from a dimension and a type known at run time to ones known to the compiler.

#include "cli/failure.hpp"
#include "core/text.hpp"
#include "hyperiso/field.hpp"
#include "hyperiso/mesh.hpp"

#include <type_traits>

namespace hyperiso::cli {

// The dimensions that all verbs are built for; surfaces are extracted, by one method or another, from more.
constexpr int lowest_dimension = 2, highest_dimension = 4, highest_extracted = 8;

template <int D, int Highest, class Use>
decltype(auto) with_known_dimension(int dimension, Use&& use) {
  if constexpr (D < Highest)
    if (dimension > D) return with_known_dimension<D + 1, Highest>(dimension, use);
  return use(std::integral_constant<int, D>{});
}

// Fails with a message about `what` if it does not have `lowest` to `highest` dimensions.
inline void check_dimension(int dimension, int lowest, int highest, const char* what) {
  if (dimension < lowest || dimension > highest)
    fail_usage(text(what, " has ", dimension, dimension == 1 ? " dimension" : " dimensions", "; from ",
                    lowest, " to ", highest, " are supported"));
}

// Calls use(std::integral_constant<int, D>) for the D in [Lowest, Highest] that is `dimension`; fails with a
// message about `what` if there is none.
template <int Lowest, int Highest = highest_dimension, class Use>
decltype(auto) with_dimension(int dimension, const char* what, Use&& use) {
  check_dimension(dimension, Lowest, Highest, what);
  return with_known_dimension<Lowest, Highest>(dimension, use);
}

// Calls use(view) with the field as a view of its type and dimension.
template <int Lowest, int Highest = highest_dimension, class Use>
decltype(auto) with_view(const Field& field, Use&& use) {
  return with_dimension<Lowest, Highest>(field.info.dimension(), "the field", [&](auto dimension) {
    return visit_sample_type(field.info.type, [&](auto sample) {
      return use(field.view<decltype(sample), decltype(dimension)::value>());
    });
  });
}

// Calls use(mesh) with a mesh in R^D, Lowest <= D <= Highest, of (D-1)- or D-simplices, as one that knows its
// dimensions.
template <int Lowest, int Highest = highest_dimension, class Use>
decltype(auto) with_simplex_mesh(Mesh&& mesh, Use&& use) {
  return with_dimension<Lowest, Highest>(mesh.dimension, "the mesh", [&](auto dimension) {
    constexpr int D = decltype(dimension)::value;
    if (mesh.simplex_dimension == D) return use(VolumeMesh<D>(std::move(mesh)));
    if (mesh.simplex_dimension == D - 1) return use(SimplexMesh<D>(std::move(mesh)));
    fail_usage(text("the mesh has ", mesh.simplex_dimension, "-simplices in ", D, " dimensions; ", D - 1,
                    "- or ", D, "-simplices are supported"));
  });
}

} // namespace hyperiso::cli
