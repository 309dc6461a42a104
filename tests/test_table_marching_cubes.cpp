// The 3D hull table against modified marching cubes, made here face by face without any table: on the faces
// of the cube the surface leaves loops, and modified marching cubes fills each loop with a disc (paper 000
// section 4 and Appendix I).
#include "hyperiso/table.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <gtest/gtest.h>
#include <map>
#include <set>
#include <vector>

using namespace hyperiso;

namespace {

using EdgeSet = std::set<int>;

// The edges of a cube that lie on a face, as its corners in a cycle.
std::vector<int> face_corners(int axis, int side) {
  const int a = 1 << (axis + 1) % 3, b = 1 << (axis + 2) % 3, base = side << axis;
  return {base, base | a, base | a | b, base | b};
}

int edge_between(int a, int b) {
  const int axis = std::countr_zero(static_cast<unsigned>(a ^ b));
  return cube_edge<3>(std::min(a, b), axis);
}

bool is_ambiguous(CubeLabels labels) {
  for (int face = 0; face < 6; ++face) {
    const auto c = face_corners(face / 2, face % 2);
    const auto positive = [&](std::size_t i) { return labels >> c[i] & 1; };
    if (positive(0) == positive(2) && positive(1) == positive(3) && positive(0) != positive(1)) return true;
  }
  return false;
}

// The loops on the faces, each by its edges. A face with + corners on a diagonal joins these: it parts its
// two
// - corners, one by one.
std::set<EdgeSet> loops(CubeLabels labels) {
  std::map<int, std::vector<int>> neighbours; // of a crossed edge along the loop
  const auto join = [&](int a, int b) {
    neighbours[a].push_back(b);
    neighbours[b].push_back(a);
  };
  for (int face = 0; face < 6; ++face) {
    const auto c = face_corners(face / 2, face % 2);
    std::vector<int> crossed;
    for (std::size_t i = 0; i < 4; ++i)
      if ((labels >> c[i] & 1) != (labels >> c[(i + 1) % 4] & 1))
        crossed.push_back(edge_between(c[i], c[(i + 1) % 4]));
    if (crossed.size() == 2) join(crossed[0], crossed[1]);
    if (crossed.size() == 4)
      for (std::size_t i = 0; i < 4; ++i)
        if (!(labels >> c[i] & 1))
          join(edge_between(c[(i + 3) % 4], c[i]), edge_between(c[i], c[(i + 1) % 4]));
  }
  std::set<EdgeSet> found;
  std::set<int> seen;
  for (const auto& [start, unused] : neighbours) {
    if (seen.contains(start)) continue;
    EdgeSet loop;
    std::vector<int> waiting{start};
    while (!waiting.empty()) {
      const int edge = waiting.back();
      waiting.pop_back();
      if (!loop.insert(edge).second) continue;
      EXPECT_EQ(neighbours[edge].size(), 2u) << "an edge is on two faces";
      waiting.insert(waiting.end(), neighbours[edge].begin(), neighbours[edge].end());
    }
    seen.insert(loop.begin(), loop.end());
    found.insert(loop);
  }
  return found;
}

// The connected pieces of a table entry: their edges, and how many triangles each has.
std::map<EdgeSet, std::size_t> pieces(CubeLabels labels) {
  const auto edges = hull_table<3>().simplices(labels);
  std::vector<std::pair<EdgeSet, std::size_t>> found;
  for (std::size_t i = 0; i < edges.size(); i += 3) {
    std::pair<EdgeSet, std::size_t> joined{{edges.begin() + i, edges.begin() + i + 3}, 1};
    std::erase_if(found, [&](const auto& piece) {
      const bool touches = std::ranges::any_of(piece.first, [&](int e) { return joined.first.contains(e); });
      if (touches) {
        joined.first.insert(piece.first.begin(), piece.first.end());
        joined.second += piece.second;
      }
      return touches;
    });
    found.push_back(joined);
  }
  return {found.begin(), found.end()};
}

// The least labelling that the cube's symmetries and the exchange of + and - take this one to.
CubeLabels class_of(CubeLabels labels) {
  CubeLabels least = 0xff;
  std::array<int, 3> axes{0, 1, 2};
  do
    for (int mirrored = 0; mirrored < 8; ++mirrored) {
      CubeLabels image = 0;
      for (int vertex = 0; vertex < 8; ++vertex) {
        int to = mirrored;
        for (std::size_t k = 0; k < 3; ++k) to ^= (vertex >> k & 1) << axes[k];
        image |= (labels >> vertex & 1) << to;
      }
      least = std::min({least, image, image ^ 0xff});
    }
  while (std::ranges::next_permutation(axes).found);
  return least;
}

} // namespace

// A disc around each loop has two triangles less than the loop has edges.
TEST(MarchingCubes, every_loop_bounds_a_disc_but_for_two_opposite_positive_corners) {
  std::vector<CubeLabels> others;
  for (CubeLabels labels = 0; labels < 256; ++labels) {
    std::map<EdgeSet, std::size_t> discs;
    for (const EdgeSet& loop : loops(labels)) discs.emplace(loop, loop.size() - 2);
    if (pieces(labels) != discs) others.push_back(labels);
  }
  EXPECT_EQ(others, (std::vector<CubeLabels>{0x18, 0x24, 0x42, 0x81}));
  for (const CubeLabels labels : others) {
    EXPECT_EQ(loops(labels).size(), 2u) << "modified marching cubes: two triangles";
    EXPECT_EQ(pieces(labels), (std::map<EdgeSet, std::size_t>{{*pieces(labels).begin()}}));
    EXPECT_EQ(pieces(labels).begin()->second, 6u) << "the hull: a tunnel";
    EXPECT_FALSE(is_ambiguous(labels));
    EXPECT_EQ(pieces(labels ^ 0xff).size(), 2u) << "two opposite - corners: two triangles";
  }
}

// Six of the fourteen classes have a face with + and - corners on its diagonals.
TEST(MarchingCubes, six_classes_are_ambiguous) {
  std::set<CubeLabels> all, ambiguous;
  for (CubeLabels labels = 0; labels < 256; ++labels) {
    all.insert(class_of(labels));
    if (is_ambiguous(labels)) ambiguous.insert(class_of(labels));
  }
  EXPECT_EQ(all.size(), 14u);
  EXPECT_EQ(ambiguous, (std::set<CubeLabels>{0x06, 0x16, 0x19, 0x1e, 0x3c, 0x69}));
}
