#pragma once
// The lookup tables in the numbering of the march (cell_edges.hpp): code of a cell -> its simplices.

#include "extract/cell_edges.hpp"
#include "hyperiso/number_array.hpp"

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

namespace hyperiso {

// The whole table, for D <= 4.
template <int D>
struct MarchTable {
  static constexpr std::uint32_t codes = 1u << (1 << D);

  std::vector<std::uint32_t> first;  // codes + 1 positions in `corners`
  std::vector<std::uint8_t> corners; // D slots for each simplex
  std::vector<std::uint8_t> count;   // simplices of each code

  // So many bytes past the last entry may be read.
  static constexpr std::size_t padding = 64;
};
// In five dimensions there are 2^32 codes: entries are made when they occur, and kept in a bounded cache.
template <>
struct MarchTable<5>;

// How a table is taken.
struct TableForm {
  bool mirrored = false;        // every simplex is turned round, for grids whose axes reflect space
  bool last_axis_first = false; // the last axis of the grid is axis 0 of the table, the most significant in
                                // its order, and axis k is axis k + 1
};

// The table of a method that has its vertices on edges of the grid (`hull`, `component`) or of the Kuhn grid
// (`simplicial`), built at the first call in the process; thread-safe. `corners` of an entry are in the order
// of the method's own table.
template <int D>
const MarchTable<D>& march_table(Method method, TableForm form);

// What one worker looks up.
template <int D>
class MarchTableReader {
 public:
  explicit MarchTableReader(const MarchTable<D>& table) : count_(table.count.data()) {}
  std::size_t simplex_count(std::uint32_t code) const { return count_[code]; }

 private:
  const std::uint8_t* count_;
};

// Compiled once, not with each set of instructions.
template <>
class MarchTableReader<5> {
 public:
  explicit MarchTableReader(const MarchTable<5>& table);
  ~MarchTableReader();

  // 5 slots for each simplex; valid until the next call.
  std::span<const std::uint8_t> corners(std::uint32_t code);
  std::size_t simplex_count(std::uint32_t code);

 private:
  struct State;
  std::unique_ptr<State> state_;
};

} // namespace hyperiso
