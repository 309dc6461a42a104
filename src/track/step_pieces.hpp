#pragma once
// The connected pieces of the surface at a step.

#include "hyperiso/mesh.hpp"

#include <algorithm>
#include <cstdint>
#include <numeric>
#include <optional>
#include <span>
#include <vector>

namespace hyperiso::track_detail {

// Numbered by their first vertices. Edges are taken and given as numbered in the lower step of a slab.
class StepPieces {
 public:
  // Of a surface with its edges, with or without positions, which is kept in place as long as this.
  // `row_length`: samples along axis 0.
  template <int S>
  StepPieces(const SimplexMesh<S>& surface, GridEdge row_length)
      : edges_(surface.edges.begin(), surface.edges.end()), row_length_(row_length), space_(S),
        piece_(surface.edges.size()) {
    std::iota(piece_.begin(), piece_.end(), 0u); // parents at first
    surface.simplices.visit([&](auto corners) {
      for (auto corner = corners.begin(); corner != corners.end();) {
        if (have_one_parent<S>(corner)) {
          corner += S;
          continue;
        }
        std::uint32_t first = root(static_cast<std::uint32_t>(*corner++));
        for (std::size_t i = 1; i < S; ++i) {
          const std::uint32_t other = root(static_cast<std::uint32_t>(*corner++));
          if (other > first)
            piece_[other] = first;
          else
            piece_[first] = other, first = other;
        }
      }
    });
    for (std::uint32_t vertex = 0; vertex < piece_.size(); ++vertex) {
      if (piece_[vertex] == vertex) {
        piece_[vertex] = static_cast<std::uint32_t>(first_.size());
        first_.push_back(vertex);
      } else {
        piece_[vertex] = piece_[piece_[vertex]]; // of an earlier vertex, so a piece already
      }
    }
  }

  // Of vertices on `edges`, as numbered in the lower step of a slab, in any order; `piece`: of each, any
  // numbers below their count.
  StepPieces(const std::vector<GridEdge>& edges, const std::vector<std::uint32_t>& piece, GridEdge row_length,
             int space)
      : row_length_(row_length), space_(space) {
    std::vector<std::pair<GridEdge, std::uint32_t>> vertices;
    for (std::size_t vertex = 0; vertex < edges.size(); ++vertex)
      vertices.emplace_back(at_step(edges[vertex]), piece[vertex]);
    std::ranges::sort(vertices);
    std::vector<std::uint32_t> number(edges.size(), UINT32_MAX); // of pieces
    for (const auto& [edge, name] : vertices) {
      if (number[name] == UINT32_MAX) {
        number[name] = static_cast<std::uint32_t>(first_.size());
        first_.push_back(static_cast<std::uint32_t>(piece_.size()));
      }
      piece_.push_back(number[name]);
      own_edges_.push_back(edge);
    }
    edges_ = own_edges_;
  }
  StepPieces(const StepPieces&) = delete; // refers to itself

  std::size_t count() const { return first_.size(); }
  std::size_t vertex_count() const { return edges_.size(); }
  std::uint32_t piece(std::size_t vertex) const { return piece_[vertex]; }
  GridEdge edge(std::size_t vertex) const {
    const GridEdge row_and_direction = edges_[vertex] / row_length_, x = edges_[vertex] % row_length_;
    return ((row_and_direction >> space_ << (space_ + 1)) | (row_and_direction & directions())) *
               row_length_ +
           x;
  }
  GridEdge edge_at_step(std::size_t vertex) const { return edges_[vertex]; } // as numbered at the step
  std::uint32_t first_vertex(std::size_t piece) const { return first_[piece]; }
  GridEdge first_edge(std::size_t piece) const { return edge(first_[piece]); }

  // Requires that the surface crosses the edge.
  std::uint32_t piece_at(GridEdge edge) const { return piece_[*find(edge)]; }
  std::optional<std::size_t> find(GridEdge edge) const {
    const GridEdge wanted = at_step(edge);
    const auto place = std::ranges::lower_bound(edges_, wanted);
    if (place == edges_.end() || *place != wanted) return std::nullopt;
    return static_cast<std::size_t>(place - edges_.begin());
  }

 private:
  GridEdge at_step(GridEdge edge) const {
    const GridEdge row_and_direction = edge / row_length_;
    return ((row_and_direction >> (space_ + 1) << space_) | (row_and_direction & directions())) *
               row_length_ +
           edge % row_length_;
  }
  GridEdge directions() const { return (GridEdge{1} << space_) - 1; }
  template <int S, class Corner>
  bool have_one_parent(Corner first) const { // the corners of a simplex: most are united already
    for (int i = 1; i < S; ++i)
      if (piece_[static_cast<std::size_t>(first[i])] != piece_[static_cast<std::size_t>(*first)])
        return false;
    return true;
  }
  std::uint32_t root(std::uint32_t vertex) {
    while (piece_[vertex] != vertex) vertex = piece_[vertex] = piece_[piece_[vertex]];
    return vertex;
  }

  std::vector<GridEdge> own_edges_; // where no mesh keeps them
  std::span<const GridEdge> edges_; // as numbered at the step
  GridEdge row_length_;
  int space_;
  std::vector<std::uint32_t> piece_; // of each vertex
  std::vector<std::uint32_t> first_; // vertex of each piece
};

} // namespace hyperiso::track_detail
