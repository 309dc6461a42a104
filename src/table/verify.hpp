#pragma once
// The checks of one entry of a hull table, from its simplices alone.

#include "hyperiso/table.hpp"
#include "table/vertex_hulls.hpp"

#include <cstdint>
#include <span>

namespace hyperiso {

// Adds what the checks of one entry count. The lower table is hull_table<D - 1>().
template <int D>
class EntryVerifier {
 public:
  // `simplices`: D cube edges each.
  void verify(CubeLabels labels, std::span<const std::uint8_t> simplices, TableVerification& counts);

 private:
  VertexHulls<D> hulls_;
};

} // namespace hyperiso
