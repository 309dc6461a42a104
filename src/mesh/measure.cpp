#include "hyperiso/measure.hpp"

#include "core/determinant.hpp"
#include "core/parallel.hpp"
#include "core/text.hpp"
#include "core/union_find.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <limits>
#include <new>

namespace hyperiso {
namespace {

constexpr int max_dimension = 8;
constexpr std::size_t max_corners = max_dimension + 1;

constexpr double factorial(int n) { return n <= 1 ? 1 : n * factorial(n - 1); }

// The simplices around each vertex.
class Incidence {
 public:
  template <class Index>
  Incidence(std::span<const Index> simplices, std::size_t corners, std::size_t vertices)
      : first_(vertices + 1), simplices_(simplices.size()) {
    for (const Index vertex : simplices) ++first_[vertex];
    std::uint64_t position = 0;
    for (std::uint64_t& entry : first_) entry = std::exchange(position, position + entry);
    for (std::size_t corner = 0; corner < simplices.size(); ++corner)
      simplices_[first_[simplices[corner]]++] = corner / corners;
    for (std::size_t vertex = vertices; vertex > 0; --vertex) first_[vertex] = first_[vertex - 1];
    first_[0] = 0;
  }
  std::span<const std::uint64_t> of(std::size_t vertex) const {
    return std::span(simplices_).subspan(first_[vertex], first_[vertex + 1] - first_[vertex]);
  }

 private:
  std::vector<std::uint64_t> first_;
  std::vector<std::uint64_t> simplices_;
};

// Counts the faces whose lowest corner is a given vertex, from the simplices around it.
template <std::size_t Corners>
class FaceCounter {
 public:
  template <class Index>
  void count(std::uint64_t vertex, std::span<const std::uint64_t> around, std::span<const Index> simplices,
             Measure& measure) {
    if (around.empty()) return;
    measure.euler_characteristic += 1; // the vertex itself
    for (auto& list : faces_) list.clear();
    for (const std::uint64_t simplex : around)
      add_faces(vertex, simplices.subspan(simplex * Corners).template first<Corners>());
    for (std::size_t size = 2; size <= Corners; ++size) {
      std::ranges::sort(faces_[size]);
      count_distinct(size, measure);
    }
    if constexpr (Corners == 2) count_point_facets(vertex, around, simplices, measure);
  }

 private:
  struct Face {
    std::array<std::uint64_t, Corners> corners{}; // ascending, unused places 0
    bool even = true; // of a facet: the orientation its simplex gives it is that of its ascending corners
    auto operator<=>(const Face&) const = default;
  };

  template <class Index>
  void add_faces(std::uint64_t vertex, std::span<const Index, Corners> simplex) {
    std::array<std::uint64_t, Corners> sorted{};
    bool even = true; // the permutation that sorts the simplex
    for (std::size_t corner = 0; corner < Corners; ++corner) {
      std::size_t place = corner;
      for (; place > 0 && sorted[place - 1] > simplex[corner]; --place) {
        sorted[place] = sorted[place - 1];
        even = !even;
      }
      sorted[place] = simplex[corner];
    }
    const auto lowest = static_cast<std::size_t>(std::ranges::find(sorted, vertex) - sorted.begin());
    const unsigned all_above = (1u << (Corners - 1 - lowest)) - 1;
    for (unsigned subset = 1; subset <= all_above; ++subset) {
      Face face;
      std::size_t size = 0;
      face.corners[size++] = vertex;
      for (unsigned rest = subset; rest != 0; rest &= rest - 1)
        face.corners[size++] = sorted[lowest + 1 + static_cast<std::size_t>(std::countr_zero(rest))];
      if (size == Corners - 1) { // leaving out one corner alternates with its place
        const auto left_out = lowest == 1 ? 0 : 1 + std::countr_one(subset);
        face.even = left_out % 2 == 0 ? even : !even;
      }
      faces_[size].push_back(face);
    }
  }

  void count_distinct(std::size_t size, Measure& measure) const {
    const std::vector<Face>& list = faces_[size];
    for (std::size_t begin = 0; begin < list.size();) {
      std::size_t end = begin + 1;
      while (end < list.size() && list[end].corners == list[begin].corners) ++end;
      measure.euler_characteristic += size % 2 == 1 ? 1 : -1;
      if (size == Corners - 1) {
        if (end - begin == 1)
          ++measure.boundary_facets;
        else if (end - begin > 2 || list[begin].even == list[begin + 1].even)
          ++measure.bad_facets;
      }
      begin = end;
    }
  }

  // Segments: the facets are the vertices, each to be the start of one segment and the end of another.
  template <class Index>
  static void count_point_facets(std::uint64_t vertex, std::span<const std::uint64_t> around,
                                 std::span<const Index> simplices, Measure& measure) {
    if (around.size() == 1) ++measure.boundary_facets;
    const auto starts =
        std::ranges::count_if(around, [&](std::uint64_t s) { return simplices[2 * s] == vertex; });
    if (around.size() > 2 || (around.size() == 2 && starts != 1)) ++measure.bad_facets;
  }

  std::array<std::vector<Face>, Corners + 1> faces_; // by number of corners
};

// What simplices add up to.
template <std::size_t D>
struct ContentSums {
  double content = 0;
  std::array<double, D> vector_area{};
  std::uint64_t inverted_simplices = 0, zero_content_simplices = 0;
};

// Simplices with `Corners` corners in D dimensions, one after the other.
template <std::size_t D, std::size_t Corners>
class ContentAdder {
 public:
  template <class Real, class Index>
  void add(std::span<const Real> positions, std::span<const Index> simplex, ContentSums<D>& sums) {
    const std::size_t start = simplex[0] * D;
    for (std::size_t corner = 1; corner < Corners; ++corner)
      for (std::size_t k = 0; k < D; ++k)
        edges_[(corner - 1) * D + k] = static_cast<double>(positions[simplex[corner] * D + k]) -
                                       static_cast<double>(positions[start + k]);
    double content = 0;
    if constexpr (Corners == D + 1) {
      auto rows = edges_;
      const double determinant = eliminate(rows.data(), D);
      content = std::abs(determinant / factorial(D));
      if (determinant < 0 && -determinant > rounding_of(positions, simplex)) ++sums.inverted_simplices;
    } else {
      content = area(sums.vector_area);
    }
    sums.content += content;
    if (content == 0) ++sums.zero_content_simplices;
  }

 private:
  // The most that the rounding of coordinates can change the determinant by. With every coordinate off by
  // some units in its last place, a row of lengths n is off by d at most, and (Hadamard) the determinant by
  // no more than the sum over the rows of d times the lengths n + d of the others.
  template <class Real, class Index>
  double rounding_of(std::span<const Real> positions, std::span<const Index> simplex) const {
    constexpr double units = 4; // of interpolation between two samples, in each corner
    double largest = 0;
    for (const Index vertex : simplex)
      for (std::size_t k = 0; k < D; ++k)
        largest = std::max(largest, std::abs(static_cast<double>(positions[vertex * D + k])));
    const double off = 2 * units * static_cast<double>(std::numeric_limits<Real>::epsilon()) * largest *
                       std::sqrt(static_cast<double>(D));
    double sum = 0;
    for (std::size_t row = 0; row < D; ++row) {
      double product = off;
      for (std::size_t other = 0; other < D; ++other) {
        if (other == row) continue;
        double squared = 0;
        for (std::size_t k = 0; k < D; ++k) squared += edges_[other * D + k] * edges_[other * D + k];
        product *= std::sqrt(squared) + off;
      }
      sum += product;
    }
    return sum;
  }

  // The normal n with det[n; edges] = |n|^2 has the cofactors of the first row as coordinates.
  double area(std::array<double, D>& sum) const {
    const double scale = 1 / factorial(D - 1);
    double squared = 0;
    for (std::size_t left_out = 0; left_out < D; ++left_out) {
      std::array<double, (D - 1) * (D - 1)> minor;
      std::size_t place = 0;
      for (std::size_t row = 0; row + 1 < D; ++row)
        for (std::size_t k = 0; k < D; ++k)
          if (k != left_out) minor[place++] = edges_[row * D + k];
      const double cofactor = eliminate(minor.data(), D - 1) * (left_out % 2 == 0 ? 1 : -1);
      sum[left_out] += cofactor * scale;
      squared += cofactor * cofactor;
    }
    return std::sqrt(squared) * scale;
  }

  std::array<double, (Corners - 1) * D> edges_; // rows
};

// Sums run over blocks of so many simplices, and over the blocks in their order: whatever the number of
// threads, the same are added to the same.
constexpr std::size_t block_simplices = std::size_t{1} << 14;

template <std::size_t D, std::size_t Corners, class Real, class Index>
void add_contents(std::span<const Real> positions, std::span<const Index> simplices, int threads,
                  Contents& contents) {
  const std::size_t count = simplices.size() / Corners,
                    blocks = (count + block_simplices - 1) / block_simplices;
  std::vector<ContentSums<D>> sums(blocks);
  share_out(worker_count(threads), blocks, [&](int, std::size_t block) {
    ContentAdder<D, Corners> adder;
    ContentSums<D> sum;
    const std::size_t end = std::min(count, (block + 1) * block_simplices);
    for (std::size_t simplex = block * block_simplices; simplex < end; ++simplex)
      adder.add(positions, simplices.subspan(simplex * Corners, Corners), sum);
    sums[block] = sum;
  });
  for (const ContentSums<D>& sum : sums) {
    contents.content += sum.content;
    for (std::size_t axis = 0; axis < contents.vector_area.size(); ++axis)
      contents.vector_area[axis] += sum.vector_area[axis];
    contents.inverted_simplices += sum.inverted_simplices;
    contents.zero_content_simplices += sum.zero_content_simplices;
  }
}

// Of a surface or of a volume, as the mesh says.
template <std::size_t Corners, class Real, class Index>
void add_contents(const Mesh& mesh, std::span<const Real> positions, std::span<const Index> simplices,
                  int threads, Contents& contents) {
  if (mesh.simplex_dimension < mesh.dimension) {
    contents.vector_area.assign(static_cast<std::size_t>(mesh.dimension), 0);
    if constexpr (Corners <= max_dimension)
      add_contents<Corners, Corners>(positions, simplices, threads, contents);
  } else {
    if constexpr (Corners > 2) add_contents<Corners - 1, Corners>(positions, simplices, threads, contents);
  }
}

template <std::size_t Corners, class Real, class Index>
void measure_arrays(const Mesh& mesh, std::span<const Real> positions, std::span<const Index> simplices,
                    int threads, Measure& measure) {
  add_contents<Corners>(mesh, positions, simplices, threads, measure);
  const std::size_t vertices = mesh.vertex_count();
  UnionFind components(vertices);
  for (std::size_t start = 0; start < simplices.size(); start += Corners)
    for (std::size_t corner = 1; corner < Corners; ++corner)
      components.unite(simplices[start], simplices[start + corner]);

  const Incidence incidence(simplices, Corners, vertices);
  FaceCounter<Corners> faces;
  for (std::size_t vertex = 0; vertex < vertices; ++vertex) {
    const auto around = incidence.of(vertex);
    if (!around.empty() && components.find(vertex) == vertex) ++measure.components;
    faces.count(vertex, around, simplices, measure);
  }
  measure.closed = measure.boundary_facets == 0;
}

// Calls use(positions, simplices, corners), `corners` those of a simplex as a constant.
template <std::size_t Corners = 2, class Use>
void with_arrays(const Mesh& mesh, Use&& use) {
  if constexpr (Corners <= max_corners) {
    if (static_cast<std::size_t>(mesh.simplex_dimension) + 1 != Corners)
      return with_arrays<Corners + 1>(mesh, use);
    mesh.positions.visit([&](auto positions) {
      mesh.simplices.visit(
          [&](auto simplices) { use(positions, simplices, std::integral_constant<std::size_t, Corners>{}); });
    });
  }
}

Status check(const Mesh& mesh) {
  if (mesh.dimension < 2 || mesh.dimension > max_dimension || mesh.simplex_dimension < 1 ||
      mesh.simplex_dimension < mesh.dimension - 1 || mesh.simplex_dimension > mesh.dimension)
    return Error{Code::invalid_argument,
                 text("cannot measure ", mesh.simplex_dimension, "-simplices in ", mesh.dimension,
                      " dimensions; surfaces and volumes in 2 to ", max_dimension, " can")};
  const std::size_t vertices = mesh.vertex_count();
  const bool in_range = mesh.simplices.visit([&](auto simplices) {
    return std::ranges::all_of(simplices, [&](auto vertex) { return vertex < vertices; });
  });
  if (!in_range)
    return Error{Code::invalid_argument,
                 text("a simplex names a vertex beyond the ", vertices, " of the mesh")};
  return {};
}

} // namespace

Result<Measure> measure(const Mesh& mesh, int threads) {
  if (const Status valid = check(mesh); !valid) return valid.error();
  try {
    Measure measure;
    with_arrays(mesh, [&](auto positions, auto simplices, auto corners) {
      measure_arrays<corners()>(mesh, positions, simplices, threads, measure);
    });
    return measure;
  } catch (const std::bad_alloc&) {
    return Error{Code::out_of_memory,
                 text("not enough memory to measure ", mesh.simplex_count(), " simplices")};
  }
}

Result<Contents> measure_contents(const Mesh& mesh, int threads) {
  if (const Status valid = check(mesh); !valid) return valid.error();
  try {
    Contents contents;
    with_arrays(mesh, [&](auto positions, auto simplices, auto corners) {
      add_contents<corners()>(mesh, positions, simplices, threads, contents);
    });
    return contents;
  } catch (const std::bad_alloc&) {
    return Error{Code::out_of_memory, "not enough memory to measure a simplex"};
  }
}

} // namespace hyperiso
