// The tables against a second generator that shares nothing with the first: one convex hull per labelling, by
// trying every D midpoints, and the placing triangulation as a regular triangulation.
#include "hyperiso/table.hpp"

#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <gtest/gtest.h>
#include <numeric>
#include <random>
#include <utility>
#include <vector>

using namespace hyperiso;

namespace {

using Matrix = std::vector<std::vector<int>>;

int expanded_determinant(const Matrix& rows) {
  if (rows.empty()) return 1;
  int sum = 0;
  for (std::size_t column = 0; column < rows.size(); ++column) {
    if (rows[0][column] == 0) continue;
    Matrix rest(rows.begin() + 1, rows.end());
    for (auto& row : rest) row.erase(row.begin() + static_cast<std::ptrdiff_t>(column));
    sum += (column % 2 == 0 ? 1 : -1) * rows[0][column] * expanded_determinant(rest);
  }
  return sum;
}

template <int D>
class DirectHull {
 public:
  explicit DirectHull(CubeLabels labels) {
    for (int i = 0; i < 1 << D; ++i) {
      std::vector<int> vertex(D);
      for (int k = 0; k < D; ++k) vertex[static_cast<std::size_t>(k)] = i >> k & 1 ? 2 : 0;
      if (labels >> i & 1) w_plus_.push_back(vertex);
      for (int k = 0; k < D; ++k) {
        if (i >> k & 1 || (labels >> i & 1) == (labels >> (i | 1 << k) & 1)) continue;
        auto midpoint = vertex;
        midpoint[static_cast<std::size_t>(k)] = 1;
        midpoints_.emplace_back(midpoint, static_cast<std::uint8_t>(cube_edge<D>(i, k)));
        w_plus_.push_back(midpoint);
      }
    }
    std::sort(midpoints_.begin(), midpoints_.end());
  }

  // In the order that the table promises.
  std::vector<std::uint8_t> simplices() const {
    std::vector<std::pair<std::vector<int>, Chosen>> found; // by outward normal and vertices in placing order
    if (midpoints_.size() < D) return {};
    std::vector<bool> chosen(midpoints_.size(), false);
    std::fill_n(chosen.begin(), D, true);
    do {
      Chosen simplex;
      for (std::size_t i = 0; i < chosen.size(); ++i)
        if (chosen[i]) simplex.push_back(i);
      const std::vector<int> normal = outward_normal(simplex);
      if (!normal.empty() && is_placed(simplex, normal)) found.emplace_back(normal, simplex);
    } while (std::prev_permutation(chosen.begin(), chosen.end()));
    std::sort(found.begin(), found.end());
    std::vector<std::uint8_t> edges;
    for (auto& [normal, simplex] : found) {
      if (volume(simplex, normal) < 0) std::swap(simplex[D - 2], simplex[D - 1]);
      for (const std::size_t i : simplex) edges.push_back(midpoints_[i].second);
    }
    return edges;
  }

 private:
  using Chosen = std::vector<std::size_t>;

  std::vector<int> side(std::size_t from, std::size_t to) const {
    std::vector<int> vector = midpoints_[to].first;
    for (std::size_t k = 0; k < D; ++k) vector[k] -= midpoints_[from].first[k];
    return vector;
  }
  static int height(const std::vector<int>& normal, const std::vector<int>& point) {
    return std::inner_product(normal.begin(), normal.end(), point.begin(), 0);
  }
  int volume(const Chosen& simplex, const std::vector<int>& normal) const {
    Matrix rows{normal};
    for (std::size_t i = 1; i < D; ++i) rows.push_back(side(simplex[0], simplex[i]));
    return expanded_determinant(rows);
  }

  // Coprime; empty unless the midpoints span a facet of the hull of W+ that is not on the cube's boundary.
  std::vector<int> outward_normal(const Chosen& simplex) const {
    std::vector<int> normal(D);
    for (std::size_t k = 0; k < D; ++k) {
      std::vector<int> axis(D, 0);
      axis[k] = 1;
      normal[k] = volume(simplex, axis);
    }
    int divisor = 0;
    for (const int x : normal) divisor = std::gcd(divisor, x);
    if (divisor == 0) return {};
    const int offset = height(normal, midpoints_[simplex[0]].first);
    bool below = true, above = true, has_vertex = false;
    for (const auto& point : w_plus_) {
      below &= height(normal, point) <= offset;
      above &= height(normal, point) >= offset;
      has_vertex |= height(normal, point) == offset &&
                    std::none_of(point.begin(), point.end(), [](int x) { return x == 1; });
    }
    if (below == above || has_vertex) return {};
    // A facet of the cube without + vertices has no midpoints either.
    for (int& x : normal) x /= below ? divisor : -divisor;
    return normal;
  }

  // The placing triangulation is the regular one where each point is lifted far higher than those before it:
  // a simplex belongs to it iff every other point of the facet lies above the lifted simplex. The sign of its
  // height there is that of the last point that occurs in its affine dependence on the simplex.
  bool is_placed(const Chosen& simplex, const std::vector<int>& normal) const {
    const int whole = volume(simplex, normal);
    for (std::size_t other = 0; other < midpoints_.size(); ++other) {
      if (height(normal, midpoints_[other].first) != height(normal, midpoints_[simplex[0]].first)) continue;
      if (std::find(simplex.begin(), simplex.end(), other) != simplex.end()) continue;
      for (std::size_t i = D; i-- > 0;) {
        Chosen replaced = simplex;
        replaced[i] = other;
        const int part = volume(replaced, normal);
        if (part == 0) continue;
        if (simplex[i] > other && (part > 0) == (whole > 0)) return false;
        break;
      }
    }
    return true;
  }

  std::vector<std::vector<int>> w_plus_;
  std::vector<std::pair<std::vector<int>, std::uint8_t>> midpoints_; // with their edges, in placing order
};

template <int D>
void expect_direct_hull(CubeLabels labels) {
  const auto simplices = hull_table<D>().simplices(labels);
  ASSERT_EQ(std::vector(simplices.begin(), simplices.end()), DirectHull<D>(labels).simplices())
      << "labels " << labels;
}

} // namespace

TEST(HullTable, every_2d_and_3d_entry_is_the_direct_hull) {
  for (CubeLabels labels = 0; labels < HullTable<2>::entries; ++labels) expect_direct_hull<2>(labels);
  for (CubeLabels labels = 0; labels < HullTable<3>::entries; ++labels) expect_direct_hull<3>(labels);
}

TEST(HullTable, sampled_4d_entries_are_the_direct_hull) {
  std::mt19937 random(1);
  std::uniform_int_distribution<CubeLabels> any(0, 0xffff);
  for (int i = 0; i < 60; ++i) expect_direct_hull<4>(any(random));
  // None and all, the largest, and the one where every edge is crossed.
  for (const CubeLabels labels : {0x0000u, 0xffffu, 0x2184u, 0x4182u, 0x8241u, 0x8421u, 0x6996u})
    expect_direct_hull<4>(labels);
}
