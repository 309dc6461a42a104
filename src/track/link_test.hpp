#pragma once
// The common case, quickly: a vertex at which nothing happens.

#include "track/slab.hpp"

#include <bit>

namespace hyperiso::track_detail {

// Tells for most vertices that their lower and upper links have one component each and the same Euler
// characteristic, in bits: SideFinder decides what it leaves open.
template <int C>
class LinkTest {
 public:
  // Of neighbours with the same time those on smaller edges count as earlier (candidates.hpp says why). False
  // also if the link is too large.
  bool is_regular(Slab<C>& slab, Vertex vertex) {
    if constexpr (C > 4) return is_regular_in_volume(slab, vertex);
    std::uint64_t below = 0, above = 0;
    int simplices_below = 0, simplices_above = 0;
    const bool fits = pass_star(
        slab, vertex,
        [&](Vertex other, std::uint64_t bit) { (slab.is_earlier(other, vertex) ? below : above) |= bit; },
        [&](std::uint64_t corners) {
          simplices_below += (corners & above) == 0;
          simplices_above += (corners & below) == 0;
        });
    return fits && is_connected(below) && is_connected(above) &&
           euler(below, simplices_below) == euler(above, simplices_above);
  }

  // Whether what M has next to a vertex just after its time is in one piece, or nothing. False also if the
  // link is too large, or M of more dimensions.
  bool is_in_one_piece_after(Slab<C>& slab, Vertex vertex) {
    if constexpr (C > 4) return false;
    std::uint64_t after = 0;
    const bool fits = pass_star(
        slab, vertex,
        [&](Vertex other, std::uint64_t bit) { after |= slab.time(other) > slab.time(vertex) ? bit : 0; },
        [](std::uint64_t) {});
    return fits && (after == 0 || is_connected(after));
  }

 private:
  // Numbers the vertices of the link, as bits, and notes which share a simplex: use_vertex(vertex, bit) for
  // each of them, use_simplex(bits) for each simplex after its vertices. False if they are more than 64.
  template <class UseVertex, class UseSimplex>
  bool pass_star(Slab<C>& slab, Vertex vertex, UseVertex&& use_vertex, UseSimplex&& use_simplex) {
    int count = 0;
    const auto star = slab.star(vertex);
    begin_star(slab);
    for (const SimplexNumber simplex : star) {
      std::uint64_t bits = 0;
      for (const Vertex other : slab.simplex(simplex)) {
        if (other == vertex) continue;
        if (seen_in_[other] != star_) {
          if (count == 64) return false;
          seen_in_[other] = star_;
          number_[other] = static_cast<std::uint8_t>(count);
          neighbours_[static_cast<std::size_t>(count)] = 0;
          use_vertex(other, std::uint64_t{1} << count++);
        }
        bits |= std::uint64_t{1} << number_[other];
      }
      for (std::uint64_t rest = bits; rest != 0; rest &= rest - 1)
        neighbours_[static_cast<std::size_t>(std::countr_zero(rest))] |= bits;
      use_simplex(bits);
    }
    return true;
  }
  void begin_star(const Slab<C>& slab) {
    ++star_;
    if (seen_in_.size() >= slab.vertex_count()) return;
    seen_in_.resize(slab.vertex_count());
    number_.resize(slab.vertex_count());
  }

  bool is_connected(std::uint64_t vertices) const {
    std::uint64_t reached = vertices & -vertices;
    for (std::uint64_t next = reached; next != 0;) {
      const auto vertex = static_cast<std::size_t>(std::countr_zero(next));
      next &= next - 1;
      const std::uint64_t found = neighbours_[vertex] & vertices & ~reached;
      reached |= found;
      next |= found;
    }
    return vertices != 0 && reached == vertices;
  }

  // Of a part of the link, which has the dimension C - 2: 1 or 2.
  int euler(std::uint64_t vertices, int simplices) const {
    int corners_of_edges = 0;
    for (std::uint64_t rest = vertices; rest != 0; rest &= rest - 1)
      corners_of_edges +=
          std::popcount(neighbours_[static_cast<std::size_t>(std::countr_zero(rest))] & vertices) - 1;
    return std::popcount(vertices) - corners_of_edges / 2 + (C == 4 ? simplices : 0);
  }

  // The part of a link of dimension 3 on one side of a vertex: its faces by the numbers of their corners.
  struct Part {
    std::array<std::uint8_t, 256> root{}; // of each vertex, in its component
    std::vector<std::uint32_t> edges, triangles;
    int vertices = 0, tetrahedra = 0, components = 0;

    void clear() {
      edges.clear();
      triangles.clear();
      vertices = tetrahedra = components = 0;
    }
    void add_vertex(std::uint8_t vertex) {
      root[vertex] = vertex;
      ++vertices;
      ++components;
    }
    // Of ascending corners.
    void add(const std::array<std::uint8_t, C>& corners, std::size_t size) {
      tetrahedra += size == 4;
      for (std::size_t i = 0; i < size; ++i)
        for (std::size_t j = i + 1; j < size; ++j) {
          edges.push_back(static_cast<std::uint32_t>(corners[i] << 8 | corners[j]));
          unite(corners[i], corners[j]);
          for (std::size_t k = j + 1; k < size; ++k)
            triangles.push_back(static_cast<std::uint32_t>(corners[i] << 16 | corners[j] << 8 | corners[k]));
        }
    }
    int euler() { return vertices - distinct(edges) + distinct(triangles) - tetrahedra; }

   private:
    std::uint8_t find(std::uint8_t vertex) {
      while (root[vertex] != vertex) vertex = root[vertex] = root[root[vertex]];
      return vertex;
    }
    void unite(std::uint8_t a, std::uint8_t b) {
      a = find(a);
      b = find(b);
      if (a == b) return;
      root[b] = a;
      --components;
    }
    static int distinct(std::vector<std::uint32_t>& faces) {
      std::ranges::sort(faces);
      return static_cast<int>(std::unique(faces.begin(), faces.end()) - faces.begin());
    }
  };

  // For 4-simplices. False also if the link has more than 256 vertices.
  bool is_regular_in_volume(Slab<C>& slab, Vertex vertex) {
    begin_star(slab);
    below_.clear();
    above_.clear();
    for (const SimplexNumber simplex : slab.star(vertex)) {
      std::array<std::uint8_t, C> low{}, high{};
      std::size_t lows = 0, highs = 0;
      for (const Vertex other : slab.simplex(simplex)) {
        if (other == vertex) continue;
        const bool earlier = slab.is_earlier(other, vertex);
        if (seen_in_[other] != star_) {
          const int count = below_.vertices + above_.vertices;
          if (count == 256) return false;
          seen_in_[other] = star_;
          number_[other] = static_cast<std::uint8_t>(count);
          (earlier ? below_ : above_).add_vertex(number_[other]);
        }
        if (earlier)
          insert(number_[other], low, lows);
        else
          insert(number_[other], high, highs);
      }
      below_.add(low, lows);
      above_.add(high, highs);
    }
    return below_.components == 1 && above_.components == 1 && below_.euler() == above_.euler();
  }

  // Into numbers that ascend.
  static void insert(std::uint8_t number, std::array<std::uint8_t, C>& ascending, std::size_t& size) {
    std::size_t place = size++;
    for (; place > 0 && ascending[place - 1] > number; --place) ascending[place] = ascending[place - 1];
    ascending[place] = number;
  }

  Part below_, above_;
  std::vector<std::uint8_t> number_;           // of each vertex of the slab in the link
  std::vector<std::uint32_t> seen_in_;         // the last star that each vertex was met in
  std::uint32_t star_ = 0;                     // how many were passed
  std::array<std::uint64_t, 64> neighbours_{}; // of each vertex of the link, itself included
};

} // namespace hyperiso::track_detail
