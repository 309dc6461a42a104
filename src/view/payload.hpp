#pragma once
// A mesh as the bytes that the page reads.

#include "hyperiso/mesh.hpp"

#include <cstdint>
#include <string>
#include <vector>

namespace hyperiso {

inline constexpr int top_level = 65535; // of coordinates and of attributes

// How coordinates along one axis become levels: coordinate = origin + level * scale.
struct Quantiser {
  double origin = 0;
  double scale = 1;
  std::uint16_t cell = 1; // levels per grid cell, for the order of simplices
  std::uint16_t level(double coordinate) const;
};

// The levels of an axis: if it is even, its samples fall on whole levels; if it has no samples, or uneven
// ones, the levels go evenly from its first to its last coordinate, or from `minimum` to `maximum` of the
// mesh.
Quantiser quantiser_of(const Axis& axis, double minimum, double maximum);

// An attribute with 16 bits per vertex.
struct EncodedAttribute {
  std::string name;
  bool is_label = false;
  double minimum = 0, maximum = 0;   // of a scalar: level 0 and the top level
  std::vector<std::int64_t> labels;  // of a label: what each level stands for, ascending
  std::vector<std::uint16_t> levels; // one per vertex of the mesh
};

// Simplices in blocks of 65536 and, within them, chunks of 256. A block begins with the vertices that it uses
// and no block before it does; vertices are numbered in the order of their first use.
//
// Bytes of a block: for each axis, then for each attribute, the steps from one new vertex's level to the next
// one's (16 bits, zigzag), low bytes and then high bytes; then, for all corners of all simplices, low, middle
// and high bytes of (vertices so far - vertex number): 0 is a new vertex.
class Payload {
 public:
  static constexpr std::size_t chunk_simplices = 256;
  static constexpr std::size_t block_simplices = 256 * chunk_simplices;

  // `time_slabs`: the last axis is time: order by its cell first. Keeps a reference to `mesh`.
  // Throws std::bad_alloc.
  Payload(const Mesh& mesh, std::vector<Quantiser> quantisers, bool time_slabs);

  struct Block {
    std::size_t first_simplex, simplices;
    std::size_t first_vertex, vertices;
  };
  const std::vector<Block>& blocks() const { return blocks_; }
  std::size_t vertex_count() const { return used_vertices_.size(); } // those in a simplex
  std::size_t simplex_count() const { return order_.size(); }
  const std::vector<Quantiser>& quantisers() const { return quantisers_; }

  // The bytes of a block, compressed (raw deflate).
  std::vector<unsigned char> encode(const Block& block,
                                    const std::vector<EncodedAttribute>& attributes) const;
  // The bytes of the attributes alone, of all vertices.
  std::vector<unsigned char> encode(const std::vector<EncodedAttribute>& attributes) const;

  // All as a page's viewer holds it: of each vertex 4 levels, 0 for a fourth axis that is not there; of each
  // simplex 4 vertices, of a triangle the last one twice.
  void unpack(std::uint16_t* levels, std::uint32_t* simplices) const;

 private:
  void order_simplices(bool time_slabs);
  void number_vertices();
  std::uint16_t level(std::uint64_t vertex, int axis) const {
    const auto entry =
        vertex * static_cast<std::uint64_t>(mesh_.dimension) + static_cast<std::uint64_t>(axis);
    return levels_[entry];
  }

  const Mesh& mesh_;
  std::vector<Quantiser> quantisers_;
  std::vector<std::uint16_t> levels_;        // vertices x D
  std::vector<std::uint32_t> order_;         // simplices in the order of the payload
  std::vector<std::uint32_t> number_;        // of each vertex of the mesh, in the payload
  std::vector<std::uint32_t> used_vertices_; // of the mesh, in the order of the payload
  std::vector<Block> blocks_;
};

// The mesh's attributes that a page can colour by.
std::vector<EncodedAttribute> encode_attributes(const Mesh& mesh);

// One label per vertex.
EncodedAttribute encode_labels(std::string name, const std::vector<std::int32_t>& labels);

} // namespace hyperiso
