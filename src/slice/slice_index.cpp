// Many cuts of one mesh: its simplices put in order and parted into chunks.

#include "core/text.hpp"
#include "slice/check_plane.hpp"
#include "slice/chunk_cutter.hpp"
#include "slice/trace.hpp"

#include <algorithm>
#include <cmath>
#include <memory>
#include <new>
#include <numeric>

namespace hyperiso {
namespace {

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

} // namespace

template <int D, int K>
struct SliceIndex<D, K>::Chunks {
  std::vector<Chunk> chunks;
  std::vector<Box<D>> boxes;        // of the chunks
  std::vector<std::uint64_t> order; // of each simplex: its number in the mesh

  std::vector<Block<K>> blocks;
  std::vector<VertexSet> block_vertices; // of each block
  std::vector<std::uint16_t> even; // of each block, by bits: the simplices whose corners in ascending order
                                   // are an even permutation of their order in the mesh

  std::vector<std::uint64_t> vertex_numbers; // of the vertices of the chunks, in the mesh; ascending in each
  PositionArray positions;                   // theirs, chunk by chunk, axis by axis
  std::vector<ForeignEdge> foreign;

  explicit Chunks(const SimplexMesh<D, K>& mesh) : order(simplices_in_order(mesh)) {
    mesh.simplices.visit([&](auto simplices) {
      part(mesh, simplices);
      for (std::size_t number = 0; number < chunks.size(); ++number) fill(simplices, number);
    });
    positions.reset(vertex_numbers.size() * D, mesh.positions.wide());
    for (const Chunk& chunk : chunks)
      for (std::size_t vertex = 0; vertex < chunk.vertices; ++vertex)
        for (std::size_t k = 0; k < D; ++k)
          positions.set(chunk.first_vertex * D + k * chunk.vertices + vertex,
                        mesh.positions[vertex_numbers[chunk.first_vertex + vertex] * D + k]);
    known_ = {};
    shared_ = {};
    shared_edges_ = {};
  }

  std::vector<std::uint32_t> met_by(const CutPlane<D>& plane) const {
    std::vector<std::uint32_t> met(boxes.size() + 1);
    std::size_t count = 0;
    for (std::uint32_t chunk = 0; chunk < boxes.size(); ++chunk) {
      met[count] = chunk;
      count += plane.meets(boxes[chunk].low, boxes[chunk].high);
    }
    met.resize(count);
    return met;
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
        chunks.push_back({place, vertex_numbers.size(), 0, 0, 0, 0, 0, 0});
        boxes.emplace_back();
      }
      ++chunks.back().simplices;
      const auto chunk = static_cast<std::uint32_t>(chunks.size() - 1);
      for (std::size_t corner = 0; corner <= K; ++corner) {
        const std::size_t vertex = corners_of[corner];
        if (known_[vertex] == chunk) continue;
        if (known_[vertex] != UINT32_MAX) shared_[vertex] = true;
        known_[vertex] = chunk;
        vertex_numbers.push_back(vertex);
        boxes.back().add(position_of<D>(mesh, vertex));
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
    Chunk& chunk = chunks[number];
    chunk.first_foreign = foreign.size();
    chunk.first_block = blocks.size();
    const std::uint64_t* vertices = &vertex_numbers[chunk.first_vertex];
    for (std::uint32_t vertex = 0; vertex < chunk.vertices; ++vertex) known_[vertices[vertex]] = vertex;

    std::vector<std::array<std::uint8_t, 2>> found;                                  // the edges as they come
    std::vector<std::uint16_t> number_of(most_vertices * most_vertices, UINT16_MAX); // of pairs of vertices
    std::array<std::uint8_t, most_vertices> of_block;
    for (std::uint32_t place = 0; place < chunk.simplices; ++place) {
      const std::uint32_t in_block = place % block_size;
      if (in_block == 0) {
        blocks.emplace_back();
        even.push_back(0);
        of_block.fill(0);
      }
      const SortedSimplex<std::uint64_t, K + 1> sorted(
          &simplices[order[chunk.first_simplex + place] * (K + 1)]);
      even.back() |= static_cast<std::uint16_t>(sorted.even << in_block);
      auto& local = blocks.back().corners[in_block];
      for (std::size_t corner = 0; corner <= K; ++corner) {
        local[corner] = static_cast<std::uint8_t>(known_[sorted.corners[corner]]);
        of_block[local[corner]] = 1;
      }
      auto& of_simplex = blocks.back().edges[in_block];
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
      if (in_block + 1 == block_size || place + 1 == chunk.simplices) block_vertices.emplace_back(of_block);
    }
    renumber(found, number);
  }

  // Those of the chunk's own edges first that others may know, those of others last.
  void renumber(const std::vector<std::array<std::uint8_t, 2>>& found, std::size_t number) {
    Chunk& chunk = chunks[number];
    std::vector<std::uint16_t> renumbered(found.size()), private_edges, of_others;
    for (std::uint16_t edge = 0; edge < found.size(); ++edge) {
      const std::uint64_t lower = vertex_numbers[chunk.first_vertex + found[edge][0]],
                          upper = vertex_numbers[chunk.first_vertex + found[edge][1]];
      if (!shared_[lower] || !shared_[upper]) {
        private_edges.push_back(edge);
        continue;
      }
      const std::uint64_t known = shared_edges_->numbers.number({lower, upper});
      if (known < shared_edges_->owners.size()) {
        of_others.push_back(edge);
        foreign.push_back(shared_edges_->owners[known]);
        continue;
      }
      shared_edges_->owners.push_back({static_cast<std::uint32_t>(number), chunk.shared});
      renumbered[edge] = static_cast<std::uint16_t>(chunk.shared++);
    }
    std::uint32_t next = chunk.shared;
    for (const std::uint16_t edge : private_edges) renumbered[edge] = static_cast<std::uint16_t>(next++);
    chunk.owned = next;
    for (const std::uint16_t edge : of_others) renumbered[edge] = static_cast<std::uint16_t>(next++);
    for (std::size_t block = chunk.first_block; block < blocks.size(); ++block)
      for (auto& edges : blocks[block].edges)
        for (std::uint16_t& edge : edges) edge = renumbered[edge];
  }
};

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
        for (const std::uint32_t number : chunks_->met_by(plane)) {
          const Chunk& chunk = chunks_->chunks[number];
          for (std::uint32_t simplex = 0; simplex < chunk.simplices; ++simplex)
            use(chunks_->order[chunk.first_simplex + simplex]);
        }
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
