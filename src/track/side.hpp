#pragma once
// What the surface is like just before or just after some of its vertices, all at one time.

#include "core/union_find.hpp"
#include "track/slab.hpp"

#include <algorithm>
#include <bit>

namespace hyperiso::track_detail {

enum class Direction { before, after };

inline bool is_beyond(double time, double moment, Direction direction) {
  return direction == Direction::before ? time < moment : time > moment;
}

// The slice just before or just after a set of vertices with equal time, as far as it is near them: its cells
// are the simplices with corners both in the set and beyond it. `components` counts the pieces of the edges
// among them, united through triangles; for a single vertex these are the components of its lower or upper
// link, and `euler` is the Euler characteristic of that link.
struct Side {
  std::vector<std::vector<SimplexNumber>> components; // simplices of the star with an edge in each
  std::int64_t euler = 0;
};

template <int C>
class SideFinder {
 public:
  // `star`: all simplices with a corner in the set, in the order of their cells. `contains(vertex)`: is it in
  // the set.
  template <class Contains>
  Side find(const Slab<C>& slab, std::span<const SimplexNumber> star, double moment, Direction direction,
            Contains&& contains) {
    edges_.clear();
    faces_.clear();
    beyond_.clear();
    for (const SimplexNumber number : star) {
      Simplex members, others;
      for (const Vertex vertex : slab.simplex(number)) {
        if (is_beyond(slab.time(vertex), moment, direction))
          others.add(vertex);
        else if (slab.time(vertex) == moment && contains(vertex))
          members.add(vertex);
      }
      if (others.size == 0) continue;
      for (int m = 0; m < members.size; ++m)
        for (int o = 0; o < others.size; ++o)
          edges_.push_back({members.corners[m], others.corners[o], beyond_.size()});
      beyond_.push_back(number);
      add_faces(members, others);
    }
    return Side{components(), euler()};
  }

 private:
  struct Simplex {
    std::array<Vertex, C> corners{};
    int size = 0;
    void add(Vertex vertex) { corners[static_cast<std::size_t>(size++)] = vertex; }
  };
  struct Edge {
    Vertex member, other;
    std::size_t simplex; // place in beyond_
    auto operator<=>(const Edge&) const = default;
  };
  using Face = std::array<Vertex, C>; // ascending, filled up with the largest number

  void add_faces(const Simplex& members, const Simplex& others) {
    for (unsigned m = 1; m < 1u << members.size; ++m)
      for (unsigned o = 1; o < 1u << others.size; ++o) {
        Face face;
        face.fill(UINT32_MAX);
        std::size_t size = 0;
        const auto insert = [&](Vertex vertex) {
          std::size_t place = size++;
          for (; place > 0 && face[place - 1] > vertex; --place) face[place] = face[place - 1];
          face[place] = vertex;
        };
        for (unsigned rest = m; rest != 0; rest &= rest - 1)
          insert(members.corners[static_cast<std::size_t>(std::countr_zero(rest))]);
        for (unsigned rest = o; rest != 0; rest &= rest - 1)
          insert(others.corners[static_cast<std::size_t>(std::countr_zero(rest))]);
        faces_.push_back(face);
      }
  }

  std::vector<std::vector<SimplexNumber>> components() {
    std::ranges::sort(edges_);
    UnionFind united(beyond_.size());
    for (std::size_t i = 1; i < edges_.size(); ++i)
      if (edges_[i].member == edges_[i - 1].member && edges_[i].other == edges_[i - 1].other)
        united.unite(edges_[i].simplex, edges_[i - 1].simplex);
    std::vector<std::vector<SimplexNumber>> result;
    std::vector<std::size_t> component_of(beyond_.size());
    for (std::size_t i = 0; i < beyond_.size(); ++i) {
      const std::size_t root = united.find(i);
      if (root == i) {
        component_of[i] = result.size();
        result.emplace_back();
      }
      result[component_of[root]].push_back(beyond_[i]);
    }
    return result;
  }

  // A cell of the slice has one dimension less than its simplex.
  std::int64_t euler() {
    std::ranges::sort(faces_);
    faces_.erase(std::unique(faces_.begin(), faces_.end()), faces_.end());
    std::int64_t sum = 0;
    for (const Face& face : faces_) {
      const auto corners = C - std::count(face.begin(), face.end(), UINT32_MAX);
      sum += corners % 2 == 0 ? 1 : -1;
    }
    return sum;
  }

  std::vector<Edge> edges_;
  std::vector<Face> faces_;
  std::vector<SimplexNumber> beyond_;
};

} // namespace hyperiso::track_detail
