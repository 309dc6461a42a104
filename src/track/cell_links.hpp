#pragma once
// The link of a vertex on an edge along time, cell by cell, from tables.

#include "extract/march_table.hpp"

#include <algorithm>
#include <array>
#include <atomic>
#include <bit>
#include <utility>
#include <vector>

namespace hyperiso::track_detail {

// Around an edge along time that the surface of the method `hull` (or `component`) crosses, the faces of the
// grid part the link of the crossing as the faces of space part an octahedron (a square, in two dimensions):
// a *pole* in each square that the edge bounds, which is the other vertex that the surface has on its rim, an
// arc from pole to pole in each 3-cube, a disk in each cell. Vertices of the link are earlier or later than
// the crossing. If both change no more than once along each arc and each disk is parted into no more than two
// pieces, then the link is parted as the labels of its poles say.
template <int D>
class CellLinks {
 public:
  static constexpr int space = D - 1;
  static constexpr unsigned columns = 1u << space; // edges along time of a cell, by their corner of space
  static constexpr std::uint8_t not_simple = 0x80;

  // Those of a method, made when first asked for and kept: what a cell tells is found once in a process,
  // whichever thread asks for it.
  static const CellLinks& of(Method method) {
    if (method == Method::component) {
      static const CellLinks links(march_table<D>(Method::component, {}));
      return links;
    }
    static const CellLinks links(march_table<D>(Method::hull, {}));
    return links;
  }

  // The signs of a cell's corners of space, as bits: which are inside at the lower step, and which change.
  struct Signs {
    unsigned below = 0, changed = 0;
  };
  // Of a code as the table has it: columns of places along all axes but the first.
  static Signs signs_of(std::uint32_t code) {
    Signs signs;
    for (unsigned corner = 0; corner < columns; ++corner) {
      const auto [lower, upper] = bits_of(corner);
      const unsigned below = code >> lower & 1, above = code >> upper & 1;
      signs.below |= below << corner;
      signs.changed |= (below ^ above) << corner;
    }
    return signs;
  }

  // Calls use(corner, poles) for the crossings of a cell that are wanted: `poles` are those of the edge at
  // `corner` that are earlier than its crossing, as bits 2 axis + (1 if it lies upwards), or `not_simple`
  // where the cell does not tell. `time`: of the crossing at each corner, where it matters for those wanted;
  // of equal ones that at the smaller corner is earlier.
  template <class Use>
  void for_each_crossing(Signs signs, unsigned wanted, const std::array<double, columns>& time,
                         Use&& use) const {
    std::array<std::uint8_t, columns> corners; // of the crossings
    std::array<std::uint8_t, columns> earlier; // of the other ones, in their order
    unsigned count = 0;
    for (unsigned rest = signs.changed; rest != 0; rest &= rest - 1) {
      corners[count] = static_cast<std::uint8_t>(std::countr_zero(rest));
      unsigned earlier_here = 0;
      for (unsigned other = 0; other < count; ++other) {
        const bool other_first = time[corners[other]] <= time[corners[count]];
        earlier_here |= static_cast<unsigned>(other_first) << other;
        earlier[other] |= static_cast<std::uint8_t>(static_cast<unsigned>(!other_first) << (count - 1));
      }
      earlier[count++] = static_cast<std::uint8_t>(earlier_here);
    }
    if (count == 0) return;
    const std::size_t of_each = std::size_t{1} << (count - 1);
    std::uint8_t* entries = &known_[first_[signs.changed] + signs.below * (of_each * count)];
    for (unsigned crossing = 0; crossing < count; ++crossing, entries += of_each) {
      if (!(wanted >> corners[crossing] & 1)) continue;
      const std::atomic_ref entry(entries[earlier[crossing]]); // threads that find it find the same
      std::uint8_t poles = entry.load(std::memory_order_relaxed);
      if (poles == 0) {
        poles = is_known | find_poles(signs, corners, crossing, earlier[crossing]);
        entry.store(poles, std::memory_order_relaxed);
      }
      use(unsigned{corners[crossing]}, static_cast<std::uint8_t>(poles & ~is_known));
    }
  }

 private:
  using Edges = CellEdges<D, Method::hull>;
  using Face = std::array<std::uint8_t, D - 1>; // slots of the corners of a simplex of the link

  struct Ends {
    std::uint8_t lower, upper;
  };

  // What is found of the link of an edge.
  struct Change {  // between earlier and later
    unsigned edge; // of the link: its slots
    std::size_t face;
  };
  struct Link {
    std::vector<Face> faces;
    std::vector<Change> changes; // of the edges of each face
  };

  static constexpr std::uint8_t is_known = 0x40;
  static constexpr unsigned time_bit = 1u << space;

  explicit CellLinks(const MarchTable<D>& table) : table_(table) {
    for (unsigned upper = 1; upper < 1u << D; ++upper)
      for (int axis = 0; axis < D; ++axis)
        if (upper >> axis & 1) {
          const unsigned lower = upper & ~(1u << axis);
          ends_[Edges::slot(lower, upper)] = {static_cast<std::uint8_t>(lower),
                                              static_cast<std::uint8_t>(upper)};
        }
    std::size_t entries = 0;
    for (std::size_t changed = 1; changed < first_.size(); ++changed) {
      first_[changed] = static_cast<std::uint32_t>(entries);
      const int count = std::popcount(changed);
      entries += static_cast<std::size_t>(count) << (count - 1) << columns;
    }
    known_.reset(entries);
    std::fill_n(known_.data(), entries, 0);
  }

  bool is_earlier(unsigned slot, unsigned earlier) const {
    const auto [lower, upper] = ends_[slot];
    if (!(upper & time_bit)) return true;
    if (lower & time_bit) return false;
    return earlier >> lower & 1;
  }
  // Whether the slot lies in the facet of the cell that holds the edge at `corner` and is normal to the axis.
  bool beside(unsigned slot, unsigned corner, int axis) const {
    const unsigned differs = (ends_[slot].lower ^ corner) | (ends_[slot].upper ^ corner);
    return !(differs >> axis & 1);
  }

  // Of a code: the samples of a corner of space at both steps.
  static std::pair<unsigned, unsigned> bits_of(unsigned corner) {
    const unsigned lower = corner >> 1 | (corner & 1) << space;
    return {lower, lower + (1u << (space - 1))};
  }
  static std::uint32_t code_of(Signs signs) {
    std::uint32_t code = 0;
    for (unsigned corner = 0; corner < columns; ++corner) {
      const auto [lower, upper] = bits_of(corner);
      const unsigned below = signs.below >> corner & 1, above = below ^ (signs.changed >> corner & 1);
      code |= below << lower | above << upper;
    }
    return code;
  }
  // Of the given one of the crossings at `corners`; `earlier` as in `for_each_crossing`.
  std::uint8_t find_poles(Signs signs, const std::array<std::uint8_t, columns>& corners, unsigned crossing,
                          unsigned earlier) const {
    unsigned earlier_corners = 0;
    for (; earlier != 0; earlier &= earlier - 1) {
      const auto other = static_cast<unsigned>(std::countr_zero(earlier));
      earlier_corners |= 1u << corners[other < crossing ? other : other + 1];
    }
    return find_poles(code_of(signs), corners[crossing], earlier_corners);
  }
  // `earlier`: corners.
  std::uint8_t find_poles(std::uint32_t code, unsigned corner, unsigned earlier) const {
    Link link;
    link.faces = find_faces(code, Edges::slot(corner, corner | time_bit));
    std::uint8_t poles = 0;
    std::array<int, space> changes_of_arc{}; // in the facet normal to the axis
    for (std::size_t face = 0; face < link.faces.size(); ++face)
      for (std::size_t i = 0; i < link.faces[face].size(); ++i) {
        const unsigned a = link.faces[face][i];
        const bool a_is_earlier = is_earlier(a, earlier);
        for (int axis = 0; axis < space; ++axis)
          if (a_is_earlier && is_pole(a, corner, axis))
            poles |= static_cast<std::uint8_t>(1u << (2 * axis + (corner >> axis & 1 ? 0 : 1)));
        for (std::size_t j = 0; j < i; ++j) {
          const unsigned b = link.faces[face][j];
          if (a_is_earlier == is_earlier(b, earlier)) continue;
          link.changes.push_back({std::min(a, b) << 8 | std::max(a, b), face});
          for (int axis = 0; axis < space; ++axis)
            if (beside(a, corner, axis) && beside(b, corner, axis)) ++changes_of_arc[axis];
        }
      }
    return is_simple(link.changes, changes_of_arc) ? poles : not_simple;
  }

  // The simplices of the link of an edge, given by its slot.
  std::vector<Face> find_faces(std::uint32_t code, unsigned edge) const {
    std::vector<Face> faces;
    for (std::size_t first = table_.first[code]; first < table_.first[code + 1]; first += D) {
      Face face;
      std::size_t size = 0;
      for (std::size_t i = 0; i < D; ++i)
        if (table_.corners[first + i] != edge && size < face.size()) face[size++] = table_.corners[first + i];
      if (std::find(&table_.corners[first], &table_.corners[first] + D, edge) != &table_.corners[first] + D)
        faces.push_back(face);
    }
    return faces;
  }

  bool is_pole(unsigned slot, unsigned corner, int axis) const {
    for (int other = 0; other < space; ++other)
      if (other != axis && !beside(slot, corner, other)) return false;
    return true;
  }

  // Whether the line between earlier and later, which runs from face to face through the edges that change,
  // is one that ends on two arcs, or none.
  static bool is_simple(const std::vector<Change>& changes, const std::array<int, space>& changes_of_arc) {
    if constexpr (D == 3) return changes.size() <= 1;
    int ends = 0;
    for (const int count : changes_of_arc) {
      if (count > 1) return false;
      ends += count;
    }
    if (ends == 0) return changes.empty();
    // From one of its ends to the other; what is left would be another line. Each face it passes has two.
    Change at = changes[0];
    std::size_t passed = 0;
    for (const Change& change : changes)
      if (partner(changes, change) == nullptr) at = change;
    for (const Change* next = &at; next != nullptr; next = partner(changes, at)) {
      at = *next;
      for (const Change& other : changes)
        if (other.face == at.face && other.edge != at.edge) {
          at = other;
          break;
        }
      passed += 2;
    }
    return passed == changes.size();
  }

  // The same edge in the face on its other side.
  static const Change* partner(const std::vector<Change>& changes, const Change& change) {
    for (const Change& other : changes)
      if (other.edge == change.edge && other.face != change.face) return &other;
    return nullptr;
  }

  const MarchTable<D>& table_;
  std::array<Ends, 256> ends_{}; // of each slot
  // By the corners that change: for all that may be inside below, for each crossing, for all that may be
  // earlier. 0 where nobody asked for it.
  std::array<std::uint32_t, std::size_t{1} << columns> first_{};
  mutable Array<std::uint8_t> known_;
};

// Whether a vertex is regular, by the labels of the poles of a link that they describe: earlier and later
// ones are connected, and where walls of the domain cut the link, each takes a part of its rim. Bits of poles
// as above; `present`: those within the domain.
inline bool poles_are_regular(unsigned present, unsigned earlier, int space) {
  earlier &= present;
  const unsigned later = present & ~earlier;
  if (earlier == 0 || later == 0) return false;
  unsigned rim = 0; // poles on it
  for (int axis = 0; axis < space; ++axis) {
    const unsigned pair = 3u << (2 * axis);
    if (earlier == pair || later == pair) return false; // opposite poles are joined by others only
    if ((present & pair) != pair) rim |= present & ~pair;
  }
  return rim == 0 || ((rim & earlier) != 0 && (rim & later) != 0);
}

// The same by table.
class PoleTable {
 public:
  explicit PoleTable(int space) {
    for (unsigned present = 0; present < regular_.size(); ++present)
      for (unsigned earlier = 0; earlier < 64; ++earlier)
        regular_[present][earlier] = poles_are_regular(present, earlier, space);
  }
  // `poles`: as all cells around the edge tell together.
  bool is_regular(unsigned present, std::uint8_t poles) const {
    return poles < 64 && regular_[present][poles];
  }
  // Which poles along an axis of `count` samples lie within the domain, for an edge at `index`.
  static unsigned present(int axis, std::int64_t index, std::int64_t count) {
    return ((index > 0 ? 1u : 0u) | (index + 1 < count ? 2u : 0u)) << (2 * axis);
  }

 private:
  std::array<std::array<bool, 64>, 64> regular_{};
};

} // namespace hyperiso::track_detail
