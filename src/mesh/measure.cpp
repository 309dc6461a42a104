#include "hyperiso/measure.hpp"

#include "core/determinant.hpp"
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

double factorial(int n) { return n <= 1 ? 1 : n * factorial(n - 1); }

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

// Adds up content and vector area.
class ContentSum {
 public:
  explicit ContentSum(const Mesh& mesh)
      : dimension_(static_cast<std::size_t>(mesh.dimension)),
        corners_(static_cast<std::size_t>(mesh.simplex_dimension) + 1), edges_((corners_ - 1) * dimension_) {}

  template <class Real, class Index>
  void add(std::span<const Real> positions, std::span<const Index> simplex, Contents& sums) {
    const std::size_t start = simplex[0] * dimension_;
    for (std::size_t corner = 1; corner < corners_; ++corner)
      for (std::size_t k = 0; k < dimension_; ++k)
        edges_[(corner - 1) * dimension_ + k] =
            static_cast<double>(positions[simplex[corner] * dimension_ + k]) -
            static_cast<double>(positions[start + k]);
    const double signed_content = corners_ == dimension_ + 1 ? volume() : area(sums.vector_area);
    const double content = std::abs(signed_content);
    sums.content += content;
    if (signed_content < 0 && corners_ == dimension_ + 1 && -determinant_ > rounding_of(positions, simplex))
      ++sums.inverted_simplices;
    if (content == 0) ++sums.zero_content_simplices;
  }

 private:
  double volume() {
    determinant_ = determinant(edges_, static_cast<int>(dimension_));
    return determinant_ / factorial(static_cast<int>(dimension_));
  }

  // The most that the rounding of coordinates can change the determinant by. With every coordinate off by
  // some units in its last place, a row of lengths n is off by d at most, and (Hadamard) the determinant by
  // no more than the sum over the rows of d times the lengths n + d of the others.
  template <class Real, class Index>
  double rounding_of(std::span<const Real> positions, std::span<const Index> simplex) const {
    constexpr double units = 4; // of interpolation between two samples, in each corner
    double largest = 0;
    for (const Index vertex : simplex)
      for (std::size_t k = 0; k < dimension_; ++k)
        largest = std::max(largest, std::abs(static_cast<double>(positions[vertex * dimension_ + k])));
    const double off = 2 * units * static_cast<double>(std::numeric_limits<Real>::epsilon()) * largest *
                       std::sqrt(static_cast<double>(dimension_));
    double sum = 0;
    for (std::size_t row = 0; row < dimension_; ++row) {
      double product = off;
      for (std::size_t other = 0; other < dimension_; ++other) {
        if (other == row) continue;
        double squared = 0;
        for (std::size_t k = 0; k < dimension_; ++k)
          squared += edges_[other * dimension_ + k] * edges_[other * dimension_ + k];
        product *= std::sqrt(squared) + off;
      }
      sum += product;
    }
    return sum;
  }

  // The normal n with det[n; edges] = |n|^2 has the cofactors of the first row as coordinates.
  double area(std::vector<double>& sum) {
    const double scale = 1 / factorial(static_cast<int>(dimension_) - 1);
    double squared = 0;
    for (std::size_t left_out = 0; left_out < dimension_; ++left_out) {
      minor_.clear();
      for (std::size_t row = 0; row + 1 < dimension_; ++row)
        for (std::size_t k = 0; k < dimension_; ++k)
          if (k != left_out) minor_.push_back(edges_[row * dimension_ + k]);
      const double cofactor =
          determinant(minor_, static_cast<int>(dimension_) - 1) * (left_out % 2 == 0 ? 1 : -1);
      sum[left_out] += cofactor * scale;
      squared += cofactor * cofactor;
    }
    return std::sqrt(squared) * scale;
  }

  std::size_t dimension_, corners_;
  std::vector<double> edges_, minor_; // rows
  double determinant_ = 0;            // of the edges of a volume's simplex
};

template <std::size_t Corners, class Real, class Index>
void measure_arrays(const Mesh& mesh, std::span<const Real> positions, std::span<const Index> simplices,
                    Measure& measure) {
  const std::size_t vertices = mesh.vertex_count();
  ContentSum content(mesh);
  UnionFind components(vertices);
  for (std::size_t start = 0; start < simplices.size(); start += Corners) {
    const auto simplex = simplices.subspan(start, Corners);
    content.add(positions, simplex, measure);
    for (const Index vertex : simplex) components.unite(simplex[0], vertex);
  }

  const Incidence incidence(simplices, Corners, vertices);
  FaceCounter<Corners> faces;
  for (std::size_t vertex = 0; vertex < vertices; ++vertex) {
    const auto around = incidence.of(vertex);
    if (!around.empty() && components.find(vertex) == vertex) ++measure.components;
    faces.count(vertex, around, simplices, measure);
  }
  measure.closed = measure.boundary_facets == 0;
}

template <std::size_t Corners = 2>
void measure_mesh(const Mesh& mesh, Measure& measure) {
  if constexpr (Corners <= max_corners) {
    if (static_cast<std::size_t>(mesh.simplex_dimension) + 1 != Corners)
      return measure_mesh<Corners + 1>(mesh, measure);
    mesh.positions.visit([&](auto positions) {
      mesh.simplices.visit(
          [&](auto simplices) { measure_arrays<Corners>(mesh, positions, simplices, measure); });
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

std::vector<double> no_area(const Mesh& mesh) {
  return std::vector<double>(
      mesh.simplex_dimension < mesh.dimension ? static_cast<std::size_t>(mesh.dimension) : 0);
}

} // namespace

Result<Measure> measure(const Mesh& mesh) {
  if (const Status valid = check(mesh); !valid) return valid.error();
  try {
    Measure measure;
    measure.vector_area = no_area(mesh);
    measure_mesh(mesh, measure);
    return measure;
  } catch (const std::bad_alloc&) {
    return Error{Code::out_of_memory,
                 text("not enough memory to measure ", mesh.simplex_count(), " simplices")};
  }
}

Result<Contents> measure_contents(const Mesh& mesh) {
  if (const Status valid = check(mesh); !valid) return valid.error();
  try {
    Contents sums;
    sums.vector_area = no_area(mesh);
    ContentSum content(mesh);
    const auto corners = static_cast<std::size_t>(mesh.simplex_dimension) + 1;
    mesh.positions.visit([&](auto positions) {
      mesh.simplices.visit([&](auto simplices) {
        for (std::size_t start = 0; start < simplices.size(); start += corners)
          content.add(positions, simplices.subspan(start, corners), sums);
      });
    });
    return sums;
  } catch (const std::bad_alloc&) {
    return Error{Code::out_of_memory, "not enough memory to measure a simplex"};
  }
}

} // namespace hyperiso
