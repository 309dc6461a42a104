#pragma once
// One entry of a hull table from its labelling alone, where the table is too large to be made whole.

#include "hyperiso/table.hpp"
#include "table/exact.hpp"

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace hyperiso {

// The (D-2)-faces of a growing surface, by their D-1 cube edges: each lacks a simplex or has both of its two.
template <int D>
class RidgeFront {
 public:
  struct Ridge {
    std::array<std::uint8_t, D - 1> edges; // ascending
    bool positive; // whether the boundary of the simplex that it lacks orients the edges in this order
  };

  void clear();
  // There is a simplex whose boundary has these edges in this order, or if not `positive` its mirror image.
  void add(std::array<std::uint8_t, D - 1> edges, bool positive);
  // A ridge that lacks a simplex; null when none does.
  const Ridge* next();

 private:
  struct Entry {
    Ridge ridge;
    bool open;
  };
  std::uint32_t& slot_of(const Ridge& ridge);
  void make_slots(std::size_t count);

  std::vector<Entry> entries_;
  std::vector<std::uint32_t> slots_; // a hash table of positions in entries_ plus 1; 0: empty
  std::size_t next_ = 0;             // the entries before it are not open
};

// Makes entries by wrapping. The boundary of the surface is known: on each facet of the cube it is the entry
// of the table of one dimension less. From a ridge on it, as from any other, the hyperplane through the ridge
// that has W+ on one side leads to the next facet, which is triangulated as those of the full tables are. All
// that the surface touches are midpoints of crossed edges, so the + vertices need not be looked at.
template <int D>
class HullEntryMaker {
 public:
  // D cube edges for each simplex: what HullTable<D> has, or would have. Valid until the next call.
  std::span<const std::uint8_t> make(LabelSet<D> labels);

 private:
  using Ridge = typename RidgeFront<D>::Ridge;

  struct Point {
    std::uint8_t edge;
    IntegerVector<D> midpoint;
  };
  struct Facet {
    IntegerVector<D> outward;
    std::size_t first, end; // in simplices_
  };

  void find_crossed_edges(LabelSet<D> labels);
  void start_at_boundary(LabelSet<D> labels);
  void add_facet_at(const Ridge& ridge);
  std::span<const std::uint8_t> sort_facets();

  std::vector<Point> crossed_; // in placing order
  RidgeFront<D> front_;
  std::vector<Facet> facets_;
  std::vector<std::uint8_t> touched_, simplices_, sorted_;
};

} // namespace hyperiso
