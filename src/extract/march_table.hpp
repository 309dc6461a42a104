#pragma once
// The lookup tables in the numbering of the march (cell_edges.hpp): code of a cell -> its simplices.

#include "extract/cell_edges.hpp"
#include "hyperiso/number_array.hpp"

#include <cstdint>
#include <vector>

namespace hyperiso {

template <int D>
struct MarchTable {
  static constexpr std::uint32_t codes = 1u << (1 << D);

  std::vector<std::uint32_t> first;  // codes + 1 positions in `corners`
  std::vector<std::uint8_t> corners; // D slots for each simplex
  std::vector<std::uint8_t> count;   // simplices of each code

  // So many bytes past the last entry may be read.
  static constexpr std::size_t padding = 64;
};

// How a table is taken.
struct TableForm {
  bool mirrored = false;        // every simplex is turned round, for grids whose axes reflect space
  bool last_axis_first = false; // the last axis of the grid is axis 0 of the table, the most significant in
                                // its order, and axis k is axis k + 1
};

// The table of a method, built at the first call in the process; thread-safe, immutable. `corners` of an
// entry are in the order of the method's own table.
template <int D, Method M>
const MarchTable<D>& march_table(TableForm form);

} // namespace hyperiso
