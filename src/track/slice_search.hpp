#pragma once
// Searches in a slice of the slab just before or just after a moment.

#include "track/side.hpp"

#include <map>
#include <set>

namespace hyperiso::track_detail {

// The slice just after (or before) `moment`: its cells are the simplices that meet it.
template <int C>
struct Slice {
  Slab<C>& slab;
  double moment;
  Direction direction;

  // Whether the vertex is on the later side of the slice.
  bool is_after(Vertex vertex) const {
    return direction == Direction::after ? slab.time(vertex) > moment : slab.time(vertex) >= moment;
  }
  bool meets(SimplexNumber number) const {
    bool before = false, after = false;
    for (const Vertex vertex : slab.simplex(number)) (is_after(vertex) ? after : before) = true;
    return before && after;
  }
  // Calls use(before, after) for the edges of a simplex that cross the slice.
  template <class Use>
  void for_each_edge(SimplexNumber number, Use&& use) const {
    const auto corners = slab.simplex(number);
    for (const Vertex before : corners)
      if (!is_after(before))
        for (const Vertex after : corners)
          if (is_after(after)) use(before, after);
  }
  // Calls use(number) for the simplices around an edge that crosses the slice.
  template <class Use>
  void for_each_around(Vertex before, Vertex after, Use&& use) const {
    for (const SimplexNumber number : slab.star(before)) {
      const auto corners = slab.simplex(number);
      if (std::find(corners.begin(), corners.end(), after) != corners.end()) use(number);
    }
  }
};

// Which of several places in a slice are connected within it. All searches advance in turn, and the last
// that is neither exhausted nor met is left unfinished: the cost is that of the smaller pieces.
template <int C>
class PieceSearch {
 public:
  struct Piece {
    std::vector<SimplexNumber> simplices; // all of them if finished, else as far as the search went
    bool finished = false;
  };

  // `seeds`: for each place some simplices that meet the slice and are connected near it. The pieces come in
  // the order of their first seeds.
  std::vector<Piece> find(const Slice<C>& slice, const std::vector<std::vector<SimplexNumber>>& seeds) {
    ++search_;
    UnionFind groups(seeds.size());
    std::vector<std::vector<SimplexNumber>> found(seeds.size());
    std::vector<std::size_t> next(seeds.size(), 0); // what of `found` has been expanded
    NumberMap edges;                                // whose simplices are claimed: each is gone round once
    for (std::size_t seed = 0; seed < seeds.size(); ++seed)
      for (const SimplexNumber simplex : seeds[seed]) claim(simplex, seed, groups, found);

    const auto unfinished = [&] {
      std::set<std::uint64_t> open;
      for (std::size_t seed = 0; seed < seeds.size(); ++seed)
        if (next[seed] < found[seed].size()) open.insert(groups.find(seed));
      return open;
    };
    std::set<std::uint64_t> open = unfinished();
    while (open.size() > 1) {
      for (std::size_t seed = 0; seed < seeds.size(); ++seed)
        for (int turns = 0; turns < 16 && next[seed] < found[seed].size(); ++turns) {
          const SimplexNumber simplex = found[seed][next[seed]++];
          slice.for_each_edge(simplex, [&](Vertex before, Vertex after) {
            if (!edges.insert(std::uint64_t{before} << 32 | after, 0).second) return;
            slice.for_each_around(before, after,
                                  [&](SimplexNumber other) { claim(other, seed, groups, found); });
          });
        }
      open = unfinished();
    }

    std::map<std::uint64_t, Piece> pieces;
    for (std::size_t seed = 0; seed < seeds.size(); ++seed) {
      Piece& piece = pieces[groups.find(seed)];
      piece.finished = !open.contains(groups.find(seed));
      piece.simplices.insert(piece.simplices.end(), found[seed].begin(), found[seed].end());
    }
    std::vector<Piece> result;
    for (auto& [root, piece] : pieces) result.push_back(std::move(piece));
    return result;
  }

 private:
  void claim(SimplexNumber simplex, std::size_t seed, UnionFind& groups,
             std::vector<std::vector<SimplexNumber>>& found) {
    if (simplex >= owner_.size()) owner_.resize(2 * std::size_t{simplex} + 64);
    Owner& owner = owner_[simplex];
    if (owner.search == search_) return groups.unite(owner.seed, seed);
    owner = {search_, static_cast<std::uint32_t>(seed)};
    found[seed].push_back(simplex);
  }

  struct Owner {
    std::uint32_t search = 0, seed = 0;
  };
  std::vector<Owner> owner_; // of each simplex
  std::uint32_t search_ = 0;
};

// The boundary curves of a slice of a surface in 3D: where M ends at walls of the domain, or of the data.
class RimCounter {
 public:
  // The number of curves with a point in one of the simplices, all of which meet the slice.
  static std::int64_t count(const Slice<4>& slice, std::span<const SimplexNumber> simplices) {
    std::set<Facet> seen;
    std::int64_t curves = 0;
    for (const SimplexNumber simplex : simplices)
      for_each_rim_facet(slice, simplex, [&](const Facet& facet) {
        if (!seen.insert(facet).second) return;
        ++curves;
        follow(slice, facet, seen);
      });
    return curves;
  }

 private:
  using Facet = std::array<Vertex, 3>; // ascending

  static void follow(const Slice<4>& slice, const Facet& start, std::set<Facet>& seen) {
    std::vector<Facet> waiting{start};
    while (!waiting.empty()) {
      const Facet facet = waiting.back();
      waiting.pop_back();
      for (const Vertex before : facet)
        for (const Vertex after : facet) {
          if (slice.is_after(before) || !slice.is_after(after)) continue;
          for (const SimplexNumber number : slice.slab.star(before))
            for_each_rim_facet(slice, number, [&](const Facet& other) {
              if (contains(other, before) && contains(other, after) && seen.insert(other).second)
                waiting.push_back(other);
            });
        }
    }
  }

  template <class Use>
  static void for_each_rim_facet(const Slice<4>& slice, SimplexNumber number, Use&& use) {
    const auto corners = slice.slab.simplex(number);
    for (std::size_t left_out = 0; left_out < 4; ++left_out) {
      Facet facet;
      std::size_t size = 0;
      int after = 0;
      for (std::size_t corner = 0; corner < 4; ++corner)
        if (corner != left_out) {
          facet[size++] = corners[corner];
          after += slice.is_after(corners[corner]);
        }
      if (after == 0 || after == 3 || simplices_with(slice.slab, facet) != 1) continue;
      std::ranges::sort(facet);
      use(facet);
    }
  }

  static int simplices_with(Slab<4>& slab, const Facet& facet) {
    int count = 0;
    for (const SimplexNumber number : slab.star(facet[0])) {
      const auto corners = slab.simplex(number);
      const auto is_corner = [&](Vertex v) {
        return std::find(corners.begin(), corners.end(), v) != corners.end();
      };
      count += is_corner(facet[1]) && is_corner(facet[2]);
    }
    return count;
  }
  static bool contains(const Facet& facet, Vertex vertex) {
    return std::find(facet.begin(), facet.end(), vertex) != facet.end();
  }
};

} // namespace hyperiso::track_detail
