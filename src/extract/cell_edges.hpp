#pragma once
// The edges of a cell, numbered for a march along a row of cells.
//
// The march follows axis 0. A cell is two columns of samples, the left at x and the right at x + 1. A place
// in a column is a bit set over the other axes: bit j of it is set where the sample is the upper one along
// axis j + 1. The code of a cell is the label set of its columns: bit `place` of the left one, bit `place +
// column` of the right one; so the right half of a cell's code is the left half of the next one's.

#include "hyperiso/extract.hpp"

#include <array>
#include <bit>
#include <cstdint>

namespace hyperiso {

// The samples that an edge of a cell joins: places in their columns, `lower` a subset of `upper`.
struct CellEdge {
  std::uint8_t lower, upper;
};

template <int D, Method M>
struct CellEdges {
  static constexpr unsigned column = 1u << (D - 1); // samples in a column
  static constexpr unsigned top_place = column - 1; // the place of the upper sample along all axes

 private:
  static constexpr bool is_edge(unsigned lower, unsigned upper, bool across) {
    if ((lower & ~upper) != 0) return false;
    const int axes = std::popcount(lower ^ upper) + across;
    return M == Method::hull ? axes == 1 : axes >= 1;
  }
  static constexpr unsigned count(bool across) {
    unsigned edges = 0;
    for (unsigned lower = 0; lower < column; ++lower)
      for (unsigned upper = 0; upper < column; ++upper) edges += is_edge(lower, upper, across);
    return edges;
  }
  template <unsigned Count>
  static constexpr std::array<CellEdge, Count> list(bool across) {
    std::array<CellEdge, Count> edges{};
    unsigned edge = 0;
    for (unsigned lower = 0; lower < column; ++lower)
      for (unsigned upper = 0; upper < column; ++upper)
        if (is_edge(lower, upper, across))
          edges[edge++] = {static_cast<std::uint8_t>(lower), static_cast<std::uint8_t>(upper)};
    return edges;
  }
  static constexpr unsigned find(unsigned lower, unsigned upper, bool across) {
    unsigned edge = 0;
    for (unsigned low = 0; low < column; ++low)
      for (unsigned up = 0; up < column; ++up)
        if (is_edge(low, up, across)) {
          if (low == lower && up == upper) return edge;
          ++edge;
        }
    return edge;
  }

 public:
  static constexpr unsigned in_column = count(false), across = count(true);
  static constexpr std::array<CellEdge, in_column> in_column_edges =
      list<in_column>(false); // of either column
  static constexpr std::array<CellEdge, across> across_edges =
      list<across>(true); // from the left to the right

  // Slots for the vertex numbers of a cell's edges: those of the left column, some of those across, those of
  // the right column, the rest. Laid out for vectors of 16: for D = 4 by hull they fill two; by the
  // simplicial method each of the three kinds starts on a pair of its own.
  static constexpr bool fills_vectors = M == Method::hull && D == 4,
                        pairs_of_vectors = M == Method::simplicial && D == 4;
  static constexpr unsigned half = fills_vectors ? across / 2 : 0;
  static constexpr unsigned left_slot = 0, first_across_slot = in_column,
                            right_slot = pairs_of_vectors ? 32 : in_column + half,
                            second_across_slot = pairs_of_vectors ? 64 : right_slot + in_column,
                            slots = second_across_slot + across - half;

  // The slot of the edge between two corners of the cube, numbered as in table.hpp (bit k: axis k).
  static constexpr unsigned slot(unsigned lower_corner, unsigned upper_corner) {
    const bool starts_right = lower_corner & 1, ends_right = upper_corner & 1;
    const unsigned edge = find(lower_corner >> 1, upper_corner >> 1, starts_right != ends_right);
    if (starts_right) return right_slot + edge;
    if (!ends_right) return left_slot + edge;
    return edge < half ? first_across_slot + edge : second_across_slot + edge - half;
  }

  // The directions of grid edges, ascending as in GridEdge.
  static constexpr unsigned directions = M == Method::hull ? D : (1u << D) - 1;
  static constexpr unsigned direction(unsigned number) {
    return M == Method::hull ? 1u << number : number + 1;
  }
  static constexpr unsigned direction_number(unsigned direction) {
    return M == Method::hull ? static_cast<unsigned>(std::countr_zero(direction)) : direction - 1;
  }
};

// The labels of a cube's corners, numbered as in table.hpp, that a code stands for.
template <int D>
constexpr std::uint32_t labels_of_code(std::uint32_t code) {
  std::uint32_t labels = 0;
  for (unsigned corner = 0; corner < 1u << D; ++corner)
    labels |= (code >> (corner >> 1 | (corner & 1) << (D - 1)) & 1) << corner;
  return labels;
}

} // namespace hyperiso
