// Many cuts of one mesh. The simplices lie in chunks, in the order of their places; a chunk has its vertices
// and edges in lists of its own, small enough for the first cache, numbered in a byte and in two. A cut of a
// chunk is a few loops without branches: on which side of the plane the vertices are, which edges are
// crossed, which simplices are cut, and their pieces by table.
//
// An edge that several chunks share belongs to the first of them, where it comes before the edges that belong
// to others. Chunks are cut in their order; so where a chunk finds such an edge crossed, its vertex has been
// numbered already.

#include "core/text.hpp"
#include "slice/check_plane.hpp"
#include "slice/cut.hpp"
#include "slice/trace.hpp"

#include <algorithm>
#include <cmath>
#include <memory>
#include <new>
#include <numeric>

namespace hyperiso {
namespace {

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

template <int D>
std::array<double, D> position_of(const Mesh& mesh, std::uint64_t vertex) {
  std::array<double, D> position;
  for (std::size_t k = 0; k < D; ++k) position[k] = mesh.positions[vertex * D + k];
  return position;
}

// Where simplices stand in the order of an index: by slab of the last axis, within it along a Morton curve.
template <int D>
class PlaceInOrder {
 public:
  PlaceInOrder(const Mesh& mesh, const Box<D>& whole) : whole_(whole) {
    if (mesh.grid_axes.size() < D || !std::isfinite(mesh.grid_axes[D - 1].coordinate(0))) return;
    const Axis& last = mesh.grid_axes[D - 1];
    for (std::int64_t i = 0; i < last.count; ++i) steps_.push_back(last.coordinate(i));
    std::ranges::sort(steps_);
  }
  std::uint64_t of(const std::array<double, D>& point) const {
    std::array<std::uint64_t, D> cell;
    for (int k = 0; k < D; ++k) {
      const double cells = k == D - 1 ? slabs_without_steps : 65536;
      const double share = (point[k] - whole_.low[k]) / (whole_.high[k] - whole_.low[k]); // NaN in a flat box
      cell[k] = share > 0 ? static_cast<std::uint64_t>(std::min(share * cells, cells - 1)) : 0;
    }
    if (!steps_.empty())
      cell[D - 1] =
          static_cast<std::uint64_t>(std::ranges::upper_bound(steps_, point[D - 1]) - steps_.begin());
    std::uint64_t place = cell[D - 1];
    for (int bit = 15; bit >= 0; --bit)
      for (int axis = D - 2; axis >= 0; --axis) place = place << 1 | (cell[axis] >> bit & 1);
    return place;
  }

 private:
  static constexpr double slabs_without_steps = 64;
  const Box<D>& whole_;
  std::vector<double> steps_; // of the last axis
};

// The simplices of a mesh in that order.
template <int D, int K>
std::vector<std::uint64_t> simplices_in_order(const SimplexMesh<D, K>& mesh) {
  Box<D> whole;
  for (std::uint64_t vertex = 0; vertex < mesh.vertex_count(); ++vertex)
    whole.add(position_of<D>(mesh, vertex));
  const PlaceInOrder<D> place(mesh, whole);
  std::vector<std::pair<std::uint64_t, std::uint64_t>> places(mesh.simplex_count());
  for (std::uint64_t simplex = 0; simplex < places.size(); ++simplex) {
    std::array<double, D> centre{};
    for (std::size_t corner = 0; corner <= K; ++corner) {
      const auto position = position_of<D>(mesh, mesh.simplices[simplex * (K + 1) + corner]);
      for (int k = 0; k < D; ++k) centre[k] += position[k] / (K + 1);
    }
    places[simplex] = {place.of(centre), simplex};
  }
  std::ranges::sort(places);
  std::vector<std::uint64_t> order(places.size());
  std::ranges::transform(places, order.begin(), [](const auto& entry) { return entry.second; });
  return order;
}

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

// The pieces of a cut simplex by its pattern of corners beyond the plane, each corner the number of the
// simplex's edge it lies on; `turned`: with the other orientation.
template <int K>
struct PieceTable {
  static constexpr std::size_t most_pieces = K - 1; // for K = 2, 3, 4
  struct Entry {
    std::uint32_t pieces = 0;
    std::array<std::uint8_t, most_pieces * K> edges{};
  };
  std::array<std::array<Entry, SimplexCut<K>::patterns>, 2> entries;

  PieceTable() {
    for (unsigned pattern = 0; pattern < SimplexCut<K>::patterns; ++pattern) {
      Entry entry;
      for (const auto& piece : simplex_cut<K>().simplices(pattern)) {
        for (std::size_t corner = 0; corner < K; ++corner)
          entry.edges[entry.pieces * K + corner] = static_cast<std::uint8_t>(
              std::ranges::find(SimplexEdges<K>::pairs, piece[corner]) - SimplexEdges<K>::pairs.begin());
        ++entry.pieces;
      }
      entries[0][pattern] = entry;
      for (std::size_t piece = 0; piece < entry.pieces; ++piece)
        std::swap(entry.edges[piece * K], entry.edges[piece * K + 1]);
      entries[1][pattern] = entry;
    }
  }
};

template <int K>
const PieceTable<K>& piece_table() {
  static const PieceTable<K> table;
  return table;
}

constexpr std::size_t most_vertices = 256, most_simplices = 1024; // of a chunk

// An edge of a chunk that belongs to another.
struct ForeignEdge {
  std::uint32_t chunk;
  std::uint32_t edge;
};

template <int D>
struct Chunk {
  Box<D> box;
  std::uint64_t first_simplex, first_vertex, first_edge, first_foreign;
  std::uint32_t simplices, vertices, edges, owned; // the edges that belong to it come first
};

} // namespace

template <int D, int K>
struct SliceIndex<D, K>::Chunks {
  std::vector<Chunk<D>> chunks;
  std::vector<std::uint64_t> order; // of each simplex: its number in the mesh

  // Of the simplices: the corners, ascending, as vertices of the chunk; whether their order in the mesh is an
  // even permutation of that; the edges of the chunk.
  std::vector<std::array<std::uint8_t, K + 1>> corners;
  std::vector<std::uint8_t> even;
  std::vector<std::array<std::uint16_t, SimplexEdges<K>::count>> simplex_edges;

  std::vector<std::uint64_t> vertex_numbers; // of the vertices of the chunks, in the mesh; ascending in each
  PositionArray positions;                   // theirs, chunk by chunk, axis by axis
  std::vector<std::array<std::uint8_t, 2>> edges;
  std::vector<ForeignEdge> foreign;

  explicit Chunks(const SimplexMesh<D, K>& mesh) : order(simplices_in_order(mesh)) {
    mesh.simplices.visit([&](auto simplices) {
      part(mesh, simplices);
      for (std::size_t number = 0; number < chunks.size(); ++number) fill(simplices, number);
    });
    positions.reset(vertex_numbers.size() * D, mesh.positions.wide());
    for (const Chunk<D>& chunk : chunks)
      for (std::size_t vertex = 0; vertex < chunk.vertices; ++vertex)
        for (std::size_t k = 0; k < D; ++k)
          positions.set(chunk.first_vertex * D + k * chunk.vertices + vertex,
                        mesh.positions[vertex_numbers[chunk.first_vertex + vertex] * D + k]);
    known_ = {};
    shared_ = {};
    shared_edges_ = {};
  }

  template <class Use>
  void for_each_met(const CutPlane<D>& plane, Use&& use) const {
    for (const Chunk<D>& chunk : chunks)
      if (plane.meets(chunk.box.low, chunk.box.high)) use(chunk);
  }

 private:
  // While it is made: the chunk that knew a vertex last, and which vertices several know; the edges between
  // those.
  std::vector<std::uint32_t> known_;
  std::vector<bool> shared_;
  struct SharedEdges {
    Array<MeshEdge<std::uint64_t>> edges;
    EdgeNumbers<std::uint64_t> numbers{edges};
    std::vector<ForeignEdge> owners;
  };
  std::unique_ptr<SharedEdges> shared_edges_ = std::make_unique<SharedEdges>();

  // Parts the simplices into chunks and gives these their boxes and vertices.
  template <class Index>
  void part(const SimplexMesh<D, K>& mesh, std::span<const Index> simplices) {
    known_.assign(mesh.vertex_count(), UINT32_MAX);
    shared_.assign(mesh.vertex_count(), false);
    for (std::uint64_t place = 0; place < order.size(); ++place) {
      const Index* corners_of = &simplices[order[place] * (K + 1)];
      if (chunks.empty() || chunks.back().simplices == most_simplices ||
          vertex_numbers.size() - chunks.back().first_vertex + K + 1 > most_vertices) {
        end_vertices();
        chunks.push_back({{}, place, vertex_numbers.size(), 0, 0, 0, 0, 0, 0});
      }
      ++chunks.back().simplices;
      const auto chunk = static_cast<std::uint32_t>(chunks.size() - 1);
      for (std::size_t corner = 0; corner <= K; ++corner) {
        const std::size_t vertex = corners_of[corner];
        if (known_[vertex] == chunk) continue;
        if (known_[vertex] != UINT32_MAX) shared_[vertex] = true;
        known_[vertex] = chunk;
        vertex_numbers.push_back(vertex);
        chunks.back().box.add(position_of<D>(mesh, vertex));
      }
    }
    end_vertices();
  }
  void end_vertices() {
    if (chunks.empty()) return;
    const auto first = vertex_numbers.begin() + static_cast<std::ptrdiff_t>(chunks.back().first_vertex);
    std::sort(first, vertex_numbers.end());
    chunks.back().vertices = static_cast<std::uint32_t>(vertex_numbers.end() - first);
  }

  // Makes the lists of a chunk.
  template <class Index>
  void fill(std::span<const Index> simplices, std::size_t number) {
    Chunk<D>& chunk = chunks[number];
    chunk.first_edge = edges.size();
    chunk.first_foreign = foreign.size();
    const std::uint64_t* vertices = &vertex_numbers[chunk.first_vertex];
    for (std::uint32_t vertex = 0; vertex < chunk.vertices; ++vertex) known_[vertices[vertex]] = vertex;

    std::vector<std::array<std::uint8_t, 2>> found;                                  // the edges as they come
    std::vector<std::uint16_t> number_of(most_vertices * most_vertices, UINT16_MAX); // of pairs of vertices
    for (std::uint64_t place = chunk.first_simplex; place < chunk.first_simplex + chunk.simplices; ++place) {
      const SortedSimplex<std::uint64_t, K + 1> sorted(&simplices[order[place] * (K + 1)]);
      even.push_back(sorted.even);
      auto& local = corners.emplace_back();
      for (std::size_t corner = 0; corner <= K; ++corner)
        local[corner] = static_cast<std::uint8_t>(known_[sorted.corners[corner]]);
      auto& of_simplex = simplex_edges.emplace_back();
      for (std::size_t edge = 0; edge < SimplexEdges<K>::count; ++edge) {
        const CornerPair pair = SimplexEdges<K>::pairs[edge];
        const std::array<std::uint8_t, 2> ends{local[pair.lower], local[pair.upper]};
        std::uint16_t& known = number_of[ends[0] * most_vertices + ends[1]];
        if (known == UINT16_MAX) {
          known = static_cast<std::uint16_t>(found.size());
          found.push_back(ends);
        }
        of_simplex[edge] = known;
      }
    }
    renumber(found, number);
  }

  // Those of the chunk's own edges first.
  void renumber(const std::vector<std::array<std::uint8_t, 2>>& found, std::size_t number) {
    Chunk<D>& chunk = chunks[number];
    std::vector<std::uint16_t> renumbered(found.size());
    std::vector<std::uint16_t> of_others;
    std::vector<std::pair<std::uint64_t, std::uint16_t>> newly_shared;
    for (std::size_t edge = 0; edge < found.size(); ++edge) {
      const std::uint64_t lower = vertex_numbers[chunk.first_vertex + found[edge][0]],
                          upper = vertex_numbers[chunk.first_vertex + found[edge][1]];
      if (shared_[lower] && shared_[upper]) {
        const std::uint64_t shared = shared_edges_->numbers.number({lower, upper});
        if (shared < shared_edges_->owners.size()) {
          of_others.push_back(static_cast<std::uint16_t>(edge));
          foreign.push_back(shared_edges_->owners[shared]);
          continue;
        }
        shared_edges_->owners.push_back({static_cast<std::uint32_t>(number), chunk.owned});
      }
      renumbered[edge] = static_cast<std::uint16_t>(chunk.owned++);
      edges.push_back(found[edge]);
    }
    for (const std::uint16_t edge : of_others) {
      renumbered[edge] = static_cast<std::uint16_t>(edges.size() - chunk.first_edge);
      edges.push_back(found[edge]);
    }
    chunk.edges = static_cast<std::uint32_t>(found.size());
    for (std::uint64_t place = chunk.first_simplex; place < chunk.first_simplex + chunk.simplices; ++place)
      for (std::uint16_t& edge : simplex_edges[place]) edge = renumbered[edge];
  }
};

namespace {

// A cut of the chunks that a plane meets. `Stored`: positions of the cut.
template <int D, int K, class Chunks, class Real, class Stored>
class ChunkCutter {
 public:
  ChunkCutter(const Chunks& chunks, const CutPlane<D>& plane, bool welded, bool with_attributes,
              SimplexMesh<D - 1, K - 1>& cut)
      : chunks_(chunks), plane_(plane), table_(piece_table<K>()), welded_(welded),
        with_attributes_(with_attributes), cut_(cut),
        positions_(static_cast<const Real*>(chunks.positions.data())) {
    first_number_.resize(chunks.chunks.size());
  }

  void run() {
    chunks_.for_each_met(plane_, [&](const Chunk<D>& chunk) {
      if (find_sides(chunk)) cut_chunk(chunk);
    });
  }

  Array<MeshEdge<std::uint64_t>> vertices; // with attributes: the edge of the mesh that each vertex lies on,
  Array<double> weights;                   // how far from its lower end,
  Array<std::uint64_t> sources;            // and the simplex of the mesh that each simplex lies in

 private:
  // How far the vertices lie beyond the plane; whether they lie on both sides.
  bool find_sides(const Chunk<D>& chunk) {
    const Real* positions = positions_ + chunk.first_vertex * D;
    plane_.beyond_all(positions, chunk.vertices, beyond_.data());
    unsigned all = 1, any = 0;
    for (std::size_t vertex = 0; vertex < chunk.vertices; ++vertex) {
      side_[vertex] = beyond_[vertex] >= 0;
      all &= side_[vertex];
      any |= side_[vertex];
    }
    return any != all;
  }

  void cut_chunk(const Chunk<D>& chunk) {
    find_crossed_edges(chunk);
    find_cut_simplices(chunk);
    if (welded_) {
      number_vertices(chunk);
      write_welded(chunk);
    } else {
      write_unwelded(chunk);
    }
  }

  void find_crossed_edges(const Chunk<D>& chunk) {
    const std::array<std::uint8_t, 2>* edges = chunks_.edges.data() + chunk.first_edge;
    std::size_t crossed = 0;
    for (std::uint32_t edge = 0; edge < chunk.edges; ++edge) {
      crossed_[crossed] = static_cast<std::uint16_t>(edge);
      crossed += side_[edges[edge][0]] ^ side_[edges[edge][1]];
    }
    crossed_count_ = crossed;
  }
  void find_cut_simplices(const Chunk<D>& chunk) {
    constexpr unsigned all_beyond = SimplexCut<K>::patterns - 1;
    const auto* corners = chunks_.corners.data() + chunk.first_simplex;
    std::size_t cut = 0;
    for (std::uint32_t simplex = 0; simplex < chunk.simplices; ++simplex) {
      unsigned pattern = 0;
      for (unsigned corner = 0; corner <= K; ++corner)
        pattern |= static_cast<unsigned>(side_[corners[simplex][corner]]) << corner;
      cut_simplices_[cut] = static_cast<std::uint16_t>(simplex);
      patterns_[cut] = static_cast<std::uint8_t>(pattern);
      cut += (pattern != 0) & (pattern != all_beyond);
    }
    cut_count_ = cut;
  }

  PointOnEdge<D> point_on(const Chunk<D>& chunk, std::uint16_t edge) const {
    const Real* positions = positions_ + chunk.first_vertex * D;
    const auto [lower, upper] = chunks_.edges[chunk.first_edge + edge];
    std::array<double, D> from, to;
    for (std::size_t k = 0; k < D; ++k) {
      from[k] = static_cast<double>(positions[k * chunk.vertices + lower]);
      to[k] = static_cast<double>(positions[k * chunk.vertices + upper]);
    }
    return {plane_, from, beyond_[lower], to, beyond_[upper]};
  }

  // Appends the vertices on the chunk's own edges and gives all crossed edges their numbers.
  void number_vertices(const Chunk<D>& chunk) {
    const auto number = static_cast<std::size_t>(&chunk - chunks_.chunks.data());
    first_number_[number] = numbers_.size();
    numbers_.resize(numbers_.size() + chunk.edges);
    std::uint32_t* numbers = numbers_.data() + first_number_[number];

    const auto owned_end = std::lower_bound(crossed_.begin(), crossed_.begin() + crossed_count_, chunk.owned);
    const auto owned = static_cast<std::size_t>(owned_end - crossed_.begin());
    const std::size_t first = cut_.positions.size() / (D - 1);
    if (first + owned > UINT32_MAX) throw std::bad_alloc();
    cut_.positions.resize((first + owned) * (D - 1));
    auto* to = static_cast<Stored*>(cut_.positions.data()) + first * (D - 1);
    for (std::size_t i = 0; i < owned; ++i) {
      const PointOnEdge<D> point = point_on(chunk, crossed_[i]);
      for (const double coordinate : point.coordinates) *to++ = static_cast<Stored>(coordinate);
      numbers[crossed_[i]] = static_cast<std::uint32_t>(first + i);
      if (with_attributes_) note_vertex(chunk, crossed_[i], point.weight);
    }
    const ForeignEdge* foreign = chunks_.foreign.data() + chunk.first_foreign;
    for (std::size_t i = owned; i < crossed_count_; ++i) {
      const ForeignEdge& edge = foreign[crossed_[i] - chunk.owned];
      numbers[crossed_[i]] = numbers_[first_number_[edge.chunk] + edge.edge];
    }
    numbers_.resize(first_number_[number] + chunk.owned); // those of others are needed no more
  }

  // Calls use(corners) for each cut simplex, with the numbers of the edges that the corners of its pieces lie
  // on and how many pieces there are.
  template <class Use>
  void for_each_cut_simplex(const Chunk<D>& chunk, const Use& use) {
    const auto* simplex_edges = chunks_.simplex_edges.data() + chunk.first_simplex;
    const std::uint8_t* even = chunks_.even.data() + chunk.first_simplex;
    const bool turns = plane_.positive() == (K == D);
    for (std::size_t i = 0; i < cut_count_; ++i) {
      const std::uint16_t simplex = cut_simplices_[i];
      const auto& entry = table_.entries[(even[simplex] != 0) == turns][patterns_[i]];
      use(simplex_edges[simplex], entry);
      if (with_attributes_)
        for (std::uint32_t piece = 0; piece < entry.pieces; ++piece)
          sources.push_back(chunks_.order[chunk.first_simplex + simplex]);
    }
  }

  static constexpr std::size_t most_corners = PieceTable<K>::most_pieces * K;

  void write_welded(const Chunk<D>& chunk) {
    const std::uint32_t* numbers =
        numbers_.data() + first_number_[static_cast<std::size_t>(&chunk - chunks_.chunks.data())];
    const std::size_t before = cut_.simplices.size();
    cut_.simplices.resize(before + cut_count_ * most_corners);
    auto* const begin = static_cast<std::uint32_t*>(cut_.simplices.data());
    std::uint32_t* to = begin + before;
    for_each_cut_simplex(chunk, [&](const auto& edges, const auto& entry) {
      for (std::size_t corner = 0; corner < most_corners; ++corner)
        to[corner] = numbers[edges[entry.edges[corner]]];
      to += entry.pieces * K;
    });
    cut_.simplices.resize(static_cast<std::size_t>(to - begin));
  }

  void write_unwelded(const Chunk<D>& chunk) {
    for (std::size_t i = 0; i < crossed_count_; ++i) {
      const PointOnEdge<D> point = point_on(chunk, crossed_[i]);
      for (std::size_t k = 0; k < D - 1; ++k)
        points_[crossed_[i]][k] = static_cast<Stored>(point.coordinates[k]);
      weights_[crossed_[i]] = point.weight;
    }
    const std::size_t before = cut_.positions.size();
    cut_.positions.resize(before + cut_count_ * most_corners * (D - 1));
    auto* const begin = static_cast<Stored*>(cut_.positions.data());
    Stored* to = begin + before;
    for_each_cut_simplex(chunk, [&](const auto& edges, const auto& entry) {
      for (std::size_t corner = 0; corner < most_corners; ++corner)
        for (std::size_t k = 0; k < D - 1; ++k)
          to[corner * (D - 1) + k] = points_[edges[entry.edges[corner]]][k];
      to += entry.pieces * K * (D - 1);
      if (!with_attributes_) return;
      for (std::size_t corner = 0; corner < entry.pieces * K; ++corner)
        note_vertex(chunk, edges[entry.edges[corner]], weights_[edges[entry.edges[corner]]]);
    });
    cut_.positions.resize(static_cast<std::size_t>(to - begin));
  }

  void note_vertex(const Chunk<D>& chunk, std::uint16_t edge, double weight) {
    const auto [lower, upper] = chunks_.edges[chunk.first_edge + edge];
    const std::uint64_t* numbers = chunks_.vertex_numbers.data() + chunk.first_vertex;
    vertices.push_back({numbers[lower], numbers[upper]});
    weights.push_back(weight);
  }

  static constexpr std::size_t most_edges = most_simplices * SimplexEdges<K>::count;

  const Chunks& chunks_;
  const CutPlane<D>& plane_;
  const PieceTable<K>& table_;
  const bool welded_, with_attributes_;
  SimplexMesh<D - 1, K - 1>& cut_;
  const Real* positions_;

  // Of the chunk at hand.
  std::array<double, most_vertices> beyond_;
  std::array<std::uint8_t, most_vertices> side_;
  std::array<std::uint16_t, most_edges + 1> crossed_;
  std::array<std::uint16_t, most_simplices + 1> cut_simplices_;
  std::array<std::uint8_t, most_simplices + 1> patterns_;
  std::array<std::array<Stored, D - 1>, most_edges> points_;
  std::array<double, most_edges> weights_;
  std::size_t crossed_count_ = 0, cut_count_ = 0;

  Array<std::uint32_t> numbers_;            // of the vertices on the own edges of the chunks so far
  std::vector<std::uint64_t> first_number_; // of each of these chunks
};

} // namespace

template <int D, int K>
SliceIndex<D, K>::SliceIndex(const SimplexMesh<D, K>& mesh) : chunks_(std::make_shared<const Chunks>(mesh)) {}

template <int D, int K>
Status SliceIndex<D, K>::slice_into(const SimplexMesh<D, K>& mesh, const Hyperplane<D>& hyperplane,
                                    const SliceOptions& options, SimplexMesh<D - 1, K - 1>& cut) const {
  if (const Status valid = check_plane(hyperplane); !valid) return valid;
  try {
    const CutPlane<D> plane(mesh, hyperplane, options.frame);
    if (const auto layer = layer_in(mesh, hyperplane)) {
      const auto met = [&](auto&& use) {
        chunks_->for_each_met(plane, [&](const Chunk<D>& chunk) {
          for (std::uint32_t simplex = 0; simplex < chunk.simplices; ++simplex)
            use(chunks_->order[chunk.first_simplex + simplex]);
        });
      };
      cut = Trace<D, K>(mesh, *layer, met).mesh(options);
      return {};
    }
    cut.positions.reset(0, options.precision == Precision::f64);
    cut.simplices.reset(0, false);
    cut.edges.clear();
    cut.grid_axes.clear();
    cut.attributes.clear();
    cut.active_cells = 0;
    mesh.positions.visit([&]<class Real>(std::span<Real>) {
      cut.positions.visit([&]<class Stored>(std::span<Stored>) {
        using Cutter = ChunkCutter<D, K, Chunks, std::remove_const_t<Real>, Stored>;
        const auto cutter =
            std::make_unique<Cutter>(*chunks_, plane, options.welded, !mesh.attributes.empty(), cut);
        cutter->run();
        if (mesh.attributes.empty()) return;
        carry_attributes<std::uint64_t>(mesh, cutter->vertices, cutter->weights, cutter->sources, cut);
        turn_normals<D>(cut, plane.directions());
      });
    });
    if (!options.welded) {
      const std::size_t corners = cut.vertex_count();
      if (corners > UINT32_MAX) throw std::bad_alloc();
      cut.simplices.reset(corners, false);
      auto* to = static_cast<std::uint32_t*>(cut.simplices.data());
      std::iota(to, to + corners, 0u);
    }
    return {};
  } catch (const std::bad_alloc&) {
    return Error{Code::out_of_memory,
                 text("not enough memory to slice ", mesh.simplex_count(), " simplices")};
  }
}

template <int D, int K>
Result<SimplexMesh<D - 1, K - 1>> SliceIndex<D, K>::slice(const SimplexMesh<D, K>& mesh,
                                                          const Hyperplane<D>& plane,
                                                          const SliceOptions& options) const {
  SimplexMesh<D - 1, K - 1> cut;
  if (const Status done = slice_into(mesh, plane, options, cut); !done) return done.error();
  return cut;
}

template class SliceIndex<3, 2>;
template class SliceIndex<4, 3>;
template class SliceIndex<3, 3>;
template class SliceIndex<4, 4>;

} // namespace hyperiso
