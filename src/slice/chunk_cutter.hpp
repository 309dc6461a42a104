#pragma once
// Simplices in chunks, and their cuts. A chunk has its vertices and edges in lists of its own, small enough
// for the first cache, numbered in a byte and in two. A cut of a chunk is a few loops without branches: on
// which side of the plane the vertices are, which blocks of simplices have vertices on both, which simplices
// of these are cut, which edges of those, and their pieces by table.
//
// An edge that several chunks share belongs to the first of them, where it comes before the edges that belong
// to others. Chunks are cut in their order; so where a chunk finds such an edge crossed, its vertex has been
// numbered already.

#include "slice/cut.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <memory>
#include <vector>

namespace hyperiso {

template <int D>
struct Box {
  std::array<double, D> low, high;

  Box() {
    low.fill(HUGE_VAL);
    high.fill(-HUGE_VAL);
  }
  void add(const std::array<double, D>& point) {
    for (int k = 0; k < D; ++k) {
      low[k] = std::min(low[k], point[k]);
      high[k] = std::max(high[k], point[k]);
    }
  }
};

// The edges of a K-simplex, numbered: those of corner pairs (0, 1), (0, 2), ..., (K - 1, K).
template <int K>
struct SimplexEdges {
  static constexpr std::size_t count = K * (K + 1) / 2;
  static constexpr std::array<CornerPair, count> pairs = [] {
    std::array<CornerPair, count> all{};
    std::size_t number = 0;
    for (std::uint8_t lower = 0; lower <= K; ++lower)
      for (std::uint8_t upper = lower + 1; upper <= K; ++upper) all[number++] = {lower, upper};
    return all;
  }();
};

constexpr std::size_t most_vertices = 256, most_simplices = 1024; // of a chunk
constexpr std::size_t block_size = 16, most_blocks = most_simplices / block_size;

// The pieces of a cut simplex by its pattern of corners beyond the plane; `turned`: with the other
// orientation.
template <int K>
struct PieceTable {
  static constexpr std::size_t most_pieces = K - 1; // for K = 2, 3, 4
  static constexpr std::size_t most_crossed = (K + 1) * (K + 1) / 4;
  struct Crossed {
    std::uint8_t edge, lower, upper; // of the simplex, and the corners at its ends
  };
  struct Entry {
    std::uint32_t pieces = 0;
    std::array<Crossed, most_crossed> crossed{};         // each once, and the first again to the end
    std::array<std::uint8_t, most_pieces * K> corners{}; // of the pieces: which of the crossed edges
  };
  std::array<std::array<Entry, SimplexCut<K>::patterns>, 2> entries;

  PieceTable() {
    for (unsigned pattern = 0; pattern < SimplexCut<K>::patterns; ++pattern) {
      Entry entry;
      std::vector<CornerPair> crossed;
      for (const auto& piece : simplex_cut<K>().simplices(pattern)) {
        for (std::size_t corner = 0; corner < K; ++corner) {
          const auto known = std::ranges::find(crossed, piece[corner]) - crossed.begin();
          if (known == std::ssize(crossed)) crossed.push_back(piece[corner]);
          entry.corners[entry.pieces * K + corner] = static_cast<std::uint8_t>(known);
        }
        ++entry.pieces;
      }
      for (std::size_t i = 0; i < most_crossed && !crossed.empty(); ++i) {
        const CornerPair pair = crossed[i < crossed.size() ? i : 0];
        const auto edge = std::ranges::find(SimplexEdges<K>::pairs, pair) - SimplexEdges<K>::pairs.begin();
        entry.crossed[i] = {static_cast<std::uint8_t>(edge), pair.lower, pair.upper};
      }
      entries[0][pattern] = entry;
      for (std::size_t piece = 0; piece < entry.pieces; ++piece)
        std::swap(entry.corners[piece * K], entry.corners[piece * K + 1]);
      entries[1][pattern] = entry;
    }
  }
};

template <int K>
const PieceTable<K>& piece_table() {
  static const PieceTable<K> table;
  return table;
}

// Which vertices of a chunk, a bit for each.
struct VertexSet {
  std::array<std::uint64_t, most_vertices / 64> words{};

  VertexSet() = default;
  // `members`: 1 for those in the set, 0 for the others. Eight at a time, by a product that moves the lowest
  // bits of eight bytes into the highest byte; in which order is all the same.
  explicit VertexSet(const std::array<std::uint8_t, most_vertices>& members) {
    for (std::size_t i = 0; i < most_vertices; i += 8) {
      std::uint64_t bytes;
      std::memcpy(&bytes, &members[i], sizeof bytes);
      words[i / 64] |= bytes * 0x0102040810204080 >> 56 << i % 64;
    }
  }
  // Whether some but not all of these are among `others`.
  bool parted_by(const VertexSet& others) const {
    std::uint64_t in = 0, out = 0;
    for (std::size_t i = 0; i < words.size(); ++i) {
      in |= words[i] & others.words[i];
      out |= words[i] & ~others.words[i];
    }
    return (in != 0) & (out != 0);
  }
};

// Simplices of a chunk that lie together: their corners, ascending, as vertices of the chunk, and their edges
// as edges of the chunk. Places beyond the last simplex of a chunk hold one vertex many times.
template <int K>
struct alignas(64) Block {
  std::array<std::array<std::uint8_t, K + 1>, block_size> corners{};
  std::array<std::array<std::uint16_t, SimplexEdges<K>::count>, block_size> edges{};
};

// An edge of a chunk that belongs to another.
struct ForeignEdge {
  std::uint32_t chunk;
  std::uint32_t edge;
};

// Its edges: those of its own that others may know, the other ones of its own, those of others.
struct Chunk {
  std::uint64_t first_simplex, first_vertex, first_foreign, first_block;
  std::uint32_t simplices, vertices, shared, owned;

  std::size_t blocks() const { return (simplices + block_size - 1) / block_size; }
};

// A cut of the chunks that a plane meets. `Stored`: positions of the cut.
template <int D, int K, class Chunks, class Real, class Stored>
class ChunkCutter {
 public:
  ChunkCutter(const Chunks& chunks, const CutPlane<D>& plane, bool welded, bool with_attributes,
              SimplexMesh<D - 1, K - 1>& cut)
      : chunks_(chunks), plane_(plane), table_(piece_table<K>()), welded_(welded),
        with_attributes_(with_attributes), cut_(cut),
        positions_(static_cast<const Real*>(chunks.positions.data())) {
    slots_.fill(none);
  }

  void run() {
    const std::vector<std::uint32_t> met = chunks_.met_by(plane_);
    if (welded_) make_room_for_numbers(met);
    constexpr std::size_t ahead = 2;
    for (std::size_t i = 0; i < std::min(ahead, met.size()); ++i) fetch(chunks_.chunks[met[i]]);
    for (std::size_t i = 0; i <= met.size(); ++i) {
      if (i + ahead < met.size()) fetch(chunks_.chunks[met[i + ahead]]);
      if (i < met.size()) find_cut_blocks(met[i], sides_[i % 2]);
      if (i > 0 && sides_[(i - 1) % 2].cut_block_count > 0) cut_chunk(sides_[(i - 1) % 2]);
    }
  }

  Array<MeshEdge<std::uint64_t>> vertices; // with attributes: the edge of the mesh that each vertex lies on,
  Array<double> weights;                   // how far from its lower end,
  Array<std::uint64_t> sources;            // and the simplex of the mesh that each simplex lies in

 private:
  void make_room_for_numbers(const std::vector<std::uint32_t>& met) {
    first_number_.resize(chunks_.chunks.size());
    std::uint64_t count = 0;
    for (const std::uint32_t chunk : met) {
      first_number_[chunk] = count;
      count += chunks_.chunks[chunk].shared + 1; // the last one for all that are not shared
    }
    shared_numbers_ = std::make_unique_for_overwrite<std::uint32_t[]>(count);
  }

  // How a chunk lies to the plane.
  struct Sides {
    std::uint32_t chunk;
    std::array<double, most_vertices> beyond{}; // how far its vertices lie beyond it
    std::array<std::uint8_t, most_vertices> side{};
    std::array<std::uint8_t, most_blocks + 1> cut_blocks; // those with vertices on both sides
    std::size_t cut_block_count;
  };
  struct CrossedEdge {
    std::uint16_t edge;
    std::uint8_t lower, upper;
  };
  static constexpr std::size_t crossed_of_simplex = PieceTable<K>::most_crossed;
  static constexpr std::size_t most_crossed = most_simplices * crossed_of_simplex;
  static constexpr std::size_t most_edges = most_simplices * SimplexEdges<K>::count;
  static constexpr std::size_t most_corners = PieceTable<K>::most_pieces * K;
  static constexpr std::uint16_t none = UINT16_MAX; // no slot

  static void fetch_bytes(const void* from, std::size_t bytes) {
    for (std::size_t line = 0; line < bytes; line += 64)
      __builtin_prefetch(static_cast<const std::byte*>(from) + line);
  }
  void fetch(const Chunk& chunk) const {
    fetch_bytes(chunks_.block_vertices.data() + chunk.first_block, chunk.blocks() * sizeof(VertexSet));
    fetch_bytes(positions_ + chunk.first_vertex * D, chunk.vertices * D * sizeof(Real));
  }

  void find_cut_blocks(std::uint32_t number, Sides& sides) const {
    const Chunk& chunk = chunks_.chunks[number];
    sides.chunk = number;
    plane_.beyond_all(positions_ + chunk.first_vertex * D, chunk.vertices, sides.beyond.data());
    // beyond >= 0, by the sign, which sums that are 0 have not.
    for (std::size_t vertex = 0; vertex < most_vertices; ++vertex)
      sides.side[vertex] = std::bit_cast<std::uint64_t>(sides.beyond[vertex] + 0.0) >> 63 ^ 1;
    const VertexSet beyond(sides.side);
    const VertexSet* blocks = chunks_.block_vertices.data() + chunk.first_block;
    std::size_t cut = 0;
    for (std::size_t block = 0; block < chunk.blocks(); ++block) {
      sides.cut_blocks[cut] = static_cast<std::uint8_t>(block);
      cut += blocks[block].parted_by(beyond);
    }
    sides.cut_block_count = cut;
    for (std::size_t i = 0; i < cut; ++i)
      fetch_bytes(&chunks_.blocks[chunk.first_block + sides.cut_blocks[i]], sizeof(Block<K>));
  }

  void cut_chunk(const Sides& sides) {
    find_cut_simplices(sides);
    find_crossed_edges(sides);
    if (welded_) {
      number_vertices(sides);
      write_welded(sides);
    } else {
      write_unwelded(sides);
    }
  }

  void find_cut_simplices(const Sides& sides) {
    constexpr unsigned all_beyond = SimplexCut<K>::patterns - 1;
    const Block<K>* blocks = chunks_.blocks.data() + chunks_.chunks[sides.chunk].first_block;
    std::size_t cut = 0;
    for (std::size_t i = 0; i < sides.cut_block_count; ++i) {
      const Block<K>& block = blocks[sides.cut_blocks[i]];
      for (std::size_t simplex = 0; simplex < block_size; ++simplex) {
        unsigned pattern = 0;
        for (unsigned corner = 0; corner <= K; ++corner)
          pattern |= static_cast<unsigned>(sides.side[block.corners[simplex][corner]]) << corner;
        cut_simplices_[cut] = static_cast<std::uint16_t>(sides.cut_blocks[i] * block_size + simplex);
        patterns_[cut] = static_cast<std::uint8_t>(pattern);
        cut += (pattern != 0) & (pattern != all_beyond);
      }
    }
    cut_count_ = cut;
  }

  // Gives each crossed edge a slot, and each cut simplex those of its edges.
  void find_crossed_edges(const Sides& sides) {
    const Chunk& chunk = chunks_.chunks[sides.chunk];
    const Block<K>* blocks = chunks_.blocks.data() + chunk.first_block;
    std::size_t count = 0;
    for (std::size_t i = 0; i < cut_count_; ++i) {
      const auto& edges = blocks[cut_simplices_[i] / block_size].edges[cut_simplices_[i] % block_size];
      const auto& crossed = table_.entries[0][patterns_[i]].crossed;
      for (std::size_t j = 0; j < crossed_of_simplex; ++j) {
        const std::uint16_t edge = edges[crossed[j].edge], known = slots_[edge];
        const auto slot = known == none ? static_cast<std::uint16_t>(count) : known;
        slots_[edge] = simplex_slots_[i][j] = slot;
        found_[count] = static_cast<std::uint16_t>(i * crossed_of_simplex + j);
        count += known == none;
      }
    }
    const std::uint32_t owned = welded_ ? chunk.owned : UINT32_MAX;
    std::size_t own = 0, foreign = 0;
    for (std::size_t slot = 0; slot < count; ++slot) {
      const std::size_t i = found_[slot] / crossed_of_simplex, j = found_[slot] % crossed_of_simplex;
      const Block<K>& block = blocks[cut_simplices_[i] / block_size];
      const auto& corners = block.corners[cut_simplices_[i] % block_size];
      const auto& crossed = table_.entries[0][patterns_[i]].crossed[j];
      const std::uint16_t edge = block.edges[cut_simplices_[i] % block_size][crossed.edge];
      crossed_[slot] = {edge, corners[crossed.lower], corners[crossed.upper]};
      slots_[edge] = none;
      own_[own] = foreign_[foreign] = static_cast<std::uint16_t>(slot);
      own += edge < owned;
      foreign += edge >= owned;
    }
    own_count_ = own;
    foreign_count_ = foreign;
  }

  // Calls use(slot, points, place) for each of the chunk's own crossed edges, in their order: its point is at
  // `place` of `points`.
  template <class Use>
  void place_points(const Sides& sides, const Use& use) {
    const Chunk& chunk = chunks_.chunks[sides.chunk];
    const Real* positions = positions_ + chunk.first_vertex * D;
    for (std::size_t first = 0; first < own_count_; first += batch_.size) {
      const std::size_t filled = std::min(own_count_ - first, batch_.size);
      for (std::size_t i = 0; i < filled; ++i) {
        const CrossedEdge& edge = crossed_[own_[first + i]];
        batch_.lower_beyond[i] = sides.beyond[edge.lower];
        batch_.upper_beyond[i] = sides.beyond[edge.upper];
        for (std::size_t k = 0; k < D; ++k) {
          batch_.lower[k][i] = positions[k * chunk.vertices + edge.lower];
          batch_.upper[k][i] = positions[k * chunk.vertices + edge.upper];
        }
      }
      batch_.place(plane_);
      for (std::size_t i = 0; i < filled; ++i) use(own_[first + i], batch_, i);
    }
  }

  // Appends the vertices on the chunk's own edges and gives all crossed edges their numbers.
  void number_vertices(const Sides& sides) {
    const Chunk& chunk = chunks_.chunks[sides.chunk];
    std::uint32_t* shared = shared_numbers_.get() + first_number_[sides.chunk];

    const std::size_t first = cut_.positions.size() / (D - 1);
    if (first + own_count_ > UINT32_MAX) throw std::bad_alloc();
    cut_.positions.resize((first + own_count_) * (D - 1));
    auto* to = static_cast<Stored*>(cut_.positions.data()) + first * (D - 1);
    auto next = static_cast<std::uint32_t>(first);
    place_points(sides, [&](std::size_t slot, const auto& points, std::size_t place) {
      for (const auto& coordinate : points.coordinates) *to++ = static_cast<Stored>(coordinate[place]);
      numbers_[slot] = shared[std::min<std::uint32_t>(crossed_[slot].edge, chunk.shared)] = next++;
      if (with_attributes_) note_vertex(chunk, slot, points.weights[place]);
    });
    const ForeignEdge* foreign = chunks_.foreign.data() + chunk.first_foreign;
    for (std::size_t i = 0; i < foreign_count_; ++i) {
      const ForeignEdge& edge = foreign[crossed_[foreign_[i]].edge - chunk.owned];
      numbers_[foreign_[i]] = shared_numbers_[first_number_[edge.chunk] + edge.edge];
    }
  }

  // Calls use(i, entry) for each cut simplex, with the table's entry for its pieces.
  template <class Use>
  void for_each_cut_simplex(const Sides& sides, const Use& use) {
    const Chunk& chunk = chunks_.chunks[sides.chunk];
    const std::uint16_t* even = chunks_.even.data() + chunk.first_block;
    const bool turns = plane_.positive() == (K == D);
    for (std::size_t i = 0; i < cut_count_; ++i) {
      const std::uint16_t simplex = cut_simplices_[i];
      const bool is_even = even[simplex / block_size] >> simplex % block_size & 1;
      const auto& entry = table_.entries[is_even == turns][patterns_[i]];
      use(simplex_slots_[i], entry);
      if (with_attributes_)
        for (std::uint32_t piece = 0; piece < entry.pieces; ++piece)
          sources.push_back(chunks_.order[chunk.first_simplex + simplex]);
    }
  }

  void write_welded(const Sides& sides) {
    const std::size_t before = cut_.simplices.size();
    cut_.simplices.resize(before + cut_count_ * most_corners);
    auto* const begin = static_cast<std::uint32_t*>(cut_.simplices.data());
    std::uint32_t* to = begin + before;
    for_each_cut_simplex(sides, [&](const auto& slots, const auto& entry) {
      for (std::size_t corner = 0; corner < most_corners; ++corner)
        to[corner] = numbers_[slots[entry.corners[corner]]];
      to += entry.pieces * K;
    });
    cut_.simplices.resize(static_cast<std::size_t>(to - begin));
  }

  void write_unwelded(const Sides& sides) {
    const Chunk& chunk = chunks_.chunks[sides.chunk];
    place_points(sides, [&](std::size_t slot, const auto& points, std::size_t place) {
      for (std::size_t k = 0; k < D - 1; ++k)
        points_[slot][k] = static_cast<Stored>(points.coordinates[k][place]);
      weights_[slot] = points.weights[place];
    });
    const std::size_t before = cut_.positions.size();
    cut_.positions.resize(before + cut_count_ * most_corners * (D - 1) + 1);
    auto* const begin = static_cast<Stored*>(cut_.positions.data());
    Stored* to = begin + before;
    for_each_cut_simplex(sides, [&](const auto& slots, const auto& entry) {
      // With the number that follows it: a point of three is four, which is one instruction.
      for (std::size_t corner = 0; corner < most_corners; ++corner)
        std::memcpy(to + corner * (D - 1), &points_[slots[entry.corners[corner]]], D * sizeof(Stored));
      to += entry.pieces * K * (D - 1);
      if (!with_attributes_) return;
      for (std::size_t corner = 0; corner < entry.pieces * K; ++corner)
        note_vertex(chunk, slots[entry.corners[corner]], weights_[slots[entry.corners[corner]]]);
    });
    cut_.positions.resize(static_cast<std::size_t>(to - begin));
  }

  void note_vertex(const Chunk& chunk, std::size_t slot, double weight) {
    const std::uint64_t* numbers = chunks_.vertex_numbers.data() + chunk.first_vertex;
    vertices.push_back({numbers[crossed_[slot].lower], numbers[crossed_[slot].upper]});
    weights.push_back(weight);
  }

  const Chunks& chunks_;
  const CutPlane<D>& plane_;
  const PieceTable<K>& table_;
  const bool welded_, with_attributes_;
  SimplexMesh<D - 1, K - 1>& cut_;
  const Real* positions_;

  // Of the chunk at hand, and of the next.
  std::array<Sides, 2> sides_;
  std::array<std::uint16_t, most_simplices + 1> cut_simplices_;
  std::array<std::uint8_t, most_simplices + 1> patterns_;
  std::array<std::uint16_t, most_edges> slots_; // of each edge
  std::array<std::array<std::uint16_t, crossed_of_simplex>, most_simplices> simplex_slots_;
  std::array<std::uint16_t, most_crossed + 1> own_, foreign_; // slots
  // By slot:
  std::array<std::uint16_t, most_crossed + 1> found_; // edge of a cut simplex
  std::array<CrossedEdge, most_crossed> crossed_;
  std::array<std::uint32_t, most_crossed> numbers_;        // of vertices of the cut
  std::array<std::array<Stored, D>, most_crossed> points_; // and a number that means nothing
  std::array<double, most_crossed> weights_;
  EdgeBatch<D, Real> batch_{};
  std::size_t cut_count_ = 0, own_count_ = 0, foreign_count_ = 0;

  // Of the vertices on shared edges, from each chunk's first on. Of the heap, not fresh memory for each
  // slice.
  std::unique_ptr<std::uint32_t[]> shared_numbers_;
  std::vector<std::uint64_t> first_number_;
};

} // namespace hyperiso
