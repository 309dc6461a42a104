#pragma once
// Where the convex hulls of cube vertices meet.

#include "hyperiso/table.hpp"

#include <array>
#include <bitset>
#include <cstddef>

namespace hyperiso {

// Decides whether the relative interiors of the convex hulls of two sets of cube vertices meet.
//
// They do not iff a hyperplane separates the sets properly: one on or below it, the other on or above, not
// both within it (Rockafellar, Convex Analysis, theorem 11.3). The functionals that separate two sets form a
// polyhedral cone. An extreme ray of it, up to functionals that vanish on both sets, is fixed by the vertices
// of the sets on which it vanishes; if these span less than a hyperplane, further cube vertices may be added
// to them. So if any hyperplane separates, one that is spanned by cube vertices does: 6, 20 and 140
// candidates for D = 2, 3, 4.
template <int D>
class VertexHulls {
 public:
  static constexpr std::size_t hyperplanes = D == 2 ? 6 : D == 3 ? 20 : 140;

  // Bit h: the set lies on or below, on or above, hyperplane h.
  struct Sides {
    std::bitset<hyperplanes> below, above;
  };

  VertexHulls();
  Sides sides(CubeLabels vertices) const;
  static bool meet(const Sides& a, const Sides& b) {
    return (a.below & b.above) == (a.above & b.below); // otherwise in one but not both: proper separation
  }

 private:
  std::array<Sides, 1 << D> sides_of_vertex_;
};

} // namespace hyperiso
