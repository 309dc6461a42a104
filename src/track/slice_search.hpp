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
  // Calls use(before, after) for the edges between corners that cross the slice.
  template <class Corners, class Use>
  void for_each_edge_of(const Corners& corners, Use&& use) const {
    for (const Vertex before : corners)
      if (!is_after(before))
        for (const Vertex after : corners)
          if (is_after(after)) use(before, after);
  }
};

// What a search passes: parts of a slice, numbered, which hang together where they share an edge of M that
// crosses it. Here these are the simplices that meet it.
template <int C>
struct PartsOfSlice : Slice<C> {
  static constexpr bool of_rim = false;

  // Calls use(before, after) for the edges of a part that cross the slice.
  template <class Use>
  void for_each_edge(std::uint32_t part, Use&& use) const {
    this->for_each_edge_of(this->slab.simplex(part), use);
  }
  // Calls use(part) for the parts around an edge that crosses the slice.
  template <class Use>
  void for_each_around(Vertex before, Vertex after, Use&& use) const {
    this->slab.for_each_around(before, after, use);
  }
};

// The boundary curves of a slice of a surface in 3D: its parts are the triangles where M ends, at walls of
// the domain or of the data, each as 4 times its simplex plus the corner left out.
struct PartsOfRims : Slice<4> {
  static constexpr bool of_rim = true;

  template <class Use>
  void for_each_edge(std::uint32_t part, Use&& use) const {
    for_each_edge_of(triangle(part), use);
  }
  template <class Use>
  void for_each_around(Vertex before, Vertex after, Use&& use) const {
    slab.for_each_around(before, after, [&](SimplexNumber simplex) {
      const auto corners = slab.simplex(simplex);
      for (std::uint32_t left_out = 0; left_out < 4; ++left_out)
        if (corners[left_out] != before && corners[left_out] != after)
          if (const std::uint32_t part = 4 * simplex + left_out; slab.is_on_boundary(triangle(part)))
            use(part);
    });
  }
  // Calls use(part) for those of a simplex.
  template <class Use>
  void for_each_part(SimplexNumber simplex, Use&& use) const {
    for (std::uint32_t left_out = 0; left_out < 4; ++left_out) {
      const std::uint32_t part = 4 * simplex + left_out;
      const auto corners = triangle(part);
      const auto after = std::ranges::count_if(corners, [&](Vertex vertex) { return is_after(vertex); });
      if (after != 0 && after != 3 && slab.is_on_boundary(corners)) use(part);
    }
  }

  std::array<Vertex, 3> triangle(std::uint32_t part) const {
    const auto corners = slab.simplex(part / 4);
    std::array<Vertex, 3> result;
    for (std::size_t corner = 0, size = 0; corner < 4; ++corner)
      if (corner != part % 4) result[size++] = corners[corner];
    return result;
  }
};

// Which of several places in a slice are connected within it. All searches advance in turn, those that have
// met as one, and the last that is not exhausted is left unfinished: the cost is that of the smaller pieces.
// Once landmarks are known, those that come to some of one name have as good as met.
class PieceSearch {
 public:
  struct Piece {
    std::vector<std::uint32_t> parts; // all of them if finished, else as far as the search went
    bool finished = false;
  };

  // `seeds`: for each place some parts that are connected near it. The pieces come in the order of their
  // first seeds.
  template <class Parts>
  std::vector<Piece> find(const Parts& parts, const std::vector<std::vector<std::uint32_t>>& seeds) {
    ++search_;
    UnionFind groups(seeds.size());
    std::vector<std::vector<std::uint32_t>> found(seeds.size());
    std::vector<std::size_t> next(seeds.size(), 0); // what of `found` has been expanded
    NumberMap edges;                                // whose parts are claimed: each is gone round once
    NumberMap seed_at_landmark;
    for (std::size_t seed = 0; seed < seeds.size(); ++seed)
      for (const std::uint32_t part : seeds[seed]) claim(part, seed, groups, found);

    const auto unfinished = [&] {
      std::set<std::uint64_t> open;
      for (std::size_t seed = 0; seed < seeds.size(); ++seed)
        if (next[seed] < found[seed].size()) open.insert(groups.find(seed));
      return open;
    };
    std::set<std::uint64_t> open = unfinished();
    std::vector<int> turns(seeds.size()); // of each group, in a round
    for (std::size_t round = 0; open.size() > 1; ++round) {
      const auto* const landmarks = parts.slab.landmarks(Parts::of_rim);
      turns.assign(seeds.size(), 16);
      for (std::size_t i = 0; i < seeds.size(); ++i) {
        const std::size_t seed = (i + round) % seeds.size();
        while (next[seed] < found[seed].size() && turns[groups.find(seed)]-- > 0)
          parts.for_each_edge(found[seed][next[seed]++], [&](Vertex before, Vertex after) {
            if (!edges.insert(std::uint64_t{before} << 32 | after, 0).second) return;
            if (landmarks && parts.slab.edge(after) == parts.slab.edge(before) + parts.slab.step_offset)
              if (const auto name = landmarks->name(parts.slab.edge(before)))
                groups.unite(seed_at_landmark.insert(*name, static_cast<std::uint32_t>(seed)).first, seed);
            parts.for_each_around(before, after,
                                  [&](std::uint32_t other) { claim(other, seed, groups, found); });
          });
      }
      parts.slab.add_searched(16 * open.size(), Parts::of_rim); // or fewer
      open = unfinished();
    }

    std::map<std::uint64_t, Piece> pieces;
    for (std::size_t seed = 0; seed < seeds.size(); ++seed) {
      Piece& piece = pieces[groups.find(seed)];
      piece.finished = !open.contains(groups.find(seed));
      piece.parts.insert(piece.parts.end(), found[seed].begin(), found[seed].end());
    }
    std::vector<Piece> result;
    for (auto& [root, piece] : pieces) result.push_back(std::move(piece));
    return result;
  }

 private:
  void claim(std::uint32_t part, std::size_t seed, UnionFind& groups,
             std::vector<std::vector<std::uint32_t>>& found) {
    if (part >= owner_.size()) owner_.resize(2 * std::size_t{part} + 64);
    Owner& owner = owner_[part];
    if (owner.search == search_) return groups.unite(owner.seed, seed);
    owner = {search_, static_cast<std::uint32_t>(seed)};
    found[seed].push_back(part);
  }

  struct Owner {
    std::uint32_t search = 0, seed = 0;
  };
  std::vector<Owner> owner_; // of each part
  std::uint32_t search_ = 0;
};

} // namespace hyperiso::track_detail
