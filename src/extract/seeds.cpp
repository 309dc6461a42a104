// From vertex to vertex: each vertex of the surface leads to the cells around its grid edge, each of these to
// the piece of surface in it that has the vertex, and that to its other vertices. A cell may hold pieces of
// several components; only those that are reached are taken.

#include "hyperiso/seeds.hpp"

#include "core/cell.hpp"
#include "core/orientation.hpp"
#include "core/sign.hpp"
#include "core/text.hpp"
#include "core/union_find.hpp"
#include "extract/cell_corners.hpp"
#include "extract/check_options.hpp"

#include <algorithm>
#include <map>
#include <new>
#include <unordered_map>

namespace hyperiso {
namespace {

template <int D>
using Index = std::array<std::int64_t, D>;

// A grid edge: its upper sample and the axes it runs along.
template <int D>
struct LatticeEdge {
  Index<D> upper;
  unsigned direction;

  friend bool operator==(const LatticeEdge&, const LatticeEdge&) = default;
  Index<D> lower() const {
    Index<D> index = upper;
    for (int axis = 0; axis < D; ++axis) index[axis] -= direction >> axis & 1;
    return index;
  }
  // The order of grid edge numbers.
  friend bool operator<(const LatticeEdge& a, const LatticeEdge& b) {
    for (int axis = D - 1; axis > 0; --axis)
      if (a.upper[axis] != b.upper[axis]) return a.upper[axis] < b.upper[axis];
    return std::pair(a.direction, a.upper[0]) < std::pair(b.direction, b.upper[0]);
  }
};

struct Hash {
  template <std::size_t N>
  std::size_t operator()(const std::array<std::int64_t, N>& index) const {
    std::uint64_t mixed = 0;
    for (const std::int64_t number : index) {
      mixed = (mixed ^ static_cast<std::uint64_t>(number)) * 0x9e3779b97f4a7c15u;
      mixed ^= mixed >> 29;
    }
    return static_cast<std::size_t>(mixed);
  }
  template <int D>
  std::size_t operator()(const LatticeEdge<D>& edge) const {
    return (*this)(edge.upper) * 31 + edge.direction;
  }
};

// The simplices of a labelling, and which of them hang together.
struct Pieces {
  struct Corner {
    unsigned lower, upper; // cube vertices
    auto operator<=>(const Corner&) const = default;
  };
  std::vector<Corner> corners;    // D for each simplex
  std::vector<unsigned> piece_of; // each simplex: numbered from 0
};

template <int D>
Pieces make_pieces(Method method, CubeLabels labels) {
  Pieces pieces;
  for_each_cell_corner<D>(method, labels, [&](unsigned lower, unsigned upper) {
    pieces.corners.push_back({lower, upper});
  });
  const std::size_t simplices = pieces.corners.size() / D;
  UnionFind joined(simplices);
  std::map<Pieces::Corner, std::size_t> first_with; // simplex
  for (std::size_t corner = 0; corner < pieces.corners.size(); ++corner)
    joined.unite(first_with.try_emplace(pieces.corners[corner], corner / D).first->second, corner / D);
  std::map<std::uint64_t, unsigned> numbers;
  for (std::size_t simplex = 0; simplex < simplices; ++simplex)
    pieces.piece_of.push_back(
        numbers.try_emplace(joined.find(simplex), static_cast<unsigned>(numbers.size())).first->second);
  return pieces;
}

template <int D>
std::string text_of(const Index<D>& index) {
  std::string list;
  for (const std::int64_t number : index) list += (list.empty() ? "" : ", ") + std::to_string(number);
  return "(" + list + ")";
}

template <int D, bool Above>
class Tracer {
 public:
  Tracer(const LazyField<D>& field, double isovalue, const ExtractOptions& options)
      : field_(field), isovalue_(isovalue), options_(options), rule_(isovalue) {
    for (int axis = 0; axis < D; ++axis) dims_[axis] = field.grid.axes[axis].count;
  }

  Status add_cell(const Index<D>& cell) {
    for (int axis = 0; axis < D; ++axis)
      if (cell[axis] < 0 || cell[axis] > dims_[axis] - 2)
        return Error{Code::outside_domain, text("there is no cell ", text_of<D>(cell), ": along axis ", axis,
                                                " cells run from 0 to ", dims_[axis] - 2)};
    const Pieces* pieces = visit(cell).pieces;
    if (!pieces || pieces->corners.empty())
      return Error{Code::outside_domain,
                   text("the surface does not pass cell ", text_of<D>(cell),
                        "; name one that it passes, or two samples on both sides of it")};
    for (const auto& corner : pieces->corners) number_of(edge_of(cell, corner));
    return {};
  }

  Status add_pair(const Index<D>& from, const Index<D>& to) {
    for (const auto& sample : {from, to})
      for (int axis = 0; axis < D; ++axis)
        if (sample[axis] < 0 || sample[axis] >= dims_[axis])
          return Error{Code::outside_domain, text("there is no sample ", text_of<D>(sample), ": along axis ",
                                                  axis, " they run from 0 to ", dims_[axis] - 1)};
    if (is_inside(from) == is_inside(to))
      return Error{Code::invalid_argument,
                   text("samples ", text_of<D>(from), " and ", text_of<D>(to), " are both ",
                        is_inside(from) ? "inside" : "outside", ": no crossing is sure to lie between them")};
    const LatticeEdge<D> edge = crossing_between(from, to);
    bool has_cell = false;
    for_each_cell_around(edge, [&](const Index<D>& cell) { has_cell |= visit(cell).pieces != nullptr; });
    if (!has_cell)
      return Error{Code::outside_domain, text("between samples ", text_of<D>(from), " and ", text_of<D>(to),
                                              " lies missing data where a crossing was looked for")};
    number_of(edge);
    return {};
  }

  // Follows the surface from the vertices there are.
  Status follow() {
    for (std::size_t next = 0; next < edges_.size(); ++next) {
      const LatticeEdge<D> edge = edges_[next];
      for_each_cell_around(edge, [&](const Index<D>& cell) { take_piece_at(cell, edge); });
      if (next % 4096 != 0) continue;
      if (bytes() > options_.memory_limit)
        return Error{Code::out_of_memory,
                     text("the surface traced so far, ", simplices_.size(), " simplices, takes ",
                          byte_size(bytes()), ", the limit is ", byte_size(options_.memory_limit))};
      const double share = static_cast<double>(next) / static_cast<double>(edges_.size());
      if (options_.progress && !options_.progress(share))
        return Error{Code::cancelled, "the tracing was cancelled"};
    }
    return {};
  }

  TracedSurface<D> result() {
    TracedSurface<D> traced{{}, samples_.size(), cells_.size()};
    std::vector<std::uint64_t> order(edges_.size()), number(edges_.size());
    std::iota(order.begin(), order.end(), std::uint64_t{0});
    std::ranges::sort(order, [&](auto a, auto b) { return edges_[a] < edges_[b]; });
    for (std::size_t vertex = 0; vertex < order.size(); ++vertex) number[order[vertex]] = vertex;

    SimplexMesh<D>& mesh = traced.mesh;
    mesh.positions.reset(edges_.size() * D, options_.precision == Precision::f64);
    for (std::size_t vertex = 0; vertex < order.size(); ++vertex) {
      const auto position = position_on(edges_[order[vertex]]);
      for (std::size_t axis = 0; axis < D; ++axis) mesh.positions.set(vertex * D + axis, position[axis]);
    }

    std::ranges::sort(simplices_);
    const bool mirrored = mirror_space(field_.grid.axes);
    mesh.simplices.reset(simplices_.size() * D, edges_.size() > UINT32_MAX);
    std::size_t corner = 0;
    for (const Simplex& simplex : simplices_) {
      auto corners = simplex.corners;
      if (mirrored) std::swap(corners[0], corners[1]);
      for (const std::uint64_t vertex : corners) mesh.simplices.set(corner++, number[vertex]);
    }
    for (const auto& [cell, state] : cells_) mesh.active_cells += state.taken != 0;
    if (options_.keep_edges && numbers_fit()) {
      for (const std::uint64_t edge : order)
        mesh.edges.push_back(grid_edge<D>(dims_, edges_[edge].upper, edges_[edge].direction));
      mesh.grid_axes.assign(field_.grid.axes.begin(), field_.grid.axes.end());
    }
    return traced;
  }

 private:
  struct Cell {
    const Pieces* pieces = nullptr; // none: the cell touches NaN
    std::uint64_t taken = 0;        // a bit for each piece
  };
  struct Simplex {
    Index<D> cell_reversed;                           // slowest axis first, as cells are ordered
    std::size_t place;                                // in its cell's entry
    std::array<std::uint64_t, D> corners;             // numbers of edges
    auto operator<=>(const Simplex&) const = default; // by cell, then place: no two agree in both
  };

  double sample(const Index<D>& index) {
    const auto [entry, is_new] = samples_.try_emplace(index);
    if (is_new) entry->second = field_.sample(index);
    return entry->second;
  }
  bool is_inside(const Index<D>& index) { return rule_.inside(sample(index)); }

  Cell& visit(const Index<D>& cell) {
    const auto [entry, is_new] = cells_.try_emplace(cell);
    if (!is_new) return entry->second;
    CubeLabels labels = 0;
    for (unsigned vertex = 0; vertex < 1u << D; ++vertex) {
      const double value = sample(corner_of(cell, vertex));
      if (is_missing(value)) return entry->second;
      if (rule_.inside(value)) labels |= CubeLabels{1} << vertex;
    }
    auto known = pieces_.find(labels);
    if (known == pieces_.end())
      known = pieces_.emplace(labels, make_pieces<D>(options_.method, labels)).first;
    entry->second.pieces = &known->second;
    return entry->second;
  }

  static LatticeEdge<D> edge_of(const Index<D>& cell, Pieces::Corner corner) {
    return {corner_of(cell, corner.upper), corner.lower ^ corner.upper};
  }

  std::uint64_t number_of(const LatticeEdge<D>& edge) {
    const auto [entry, is_new] = numbers_.try_emplace(edge, edges_.size());
    if (is_new) edges_.push_back(edge);
    return entry->second;
  }

  template <class Use>
  void for_each_cell_around(const LatticeEdge<D>& edge, Use&& use) {
    for (unsigned shift = 0; shift < 1u << D; ++shift) {
      if ((shift & edge.direction) != edge.direction) continue; // the edge ends where the cell does
      Index<D> cell = edge.upper;
      bool on_grid = true;
      for (int axis = 0; axis < D; ++axis) {
        cell[axis] -= shift >> axis & 1;
        on_grid &= cell[axis] >= 0 && cell[axis] <= dims_[axis] - 2;
      }
      if (on_grid) use(cell);
    }
  }

  // Takes the piece of the cell that has a vertex on the edge.
  void take_piece_at(const Index<D>& cell, const LatticeEdge<D>& edge) {
    Cell& state = visit(cell);
    if (!state.pieces) return;
    unsigned upper = 0;
    for (int axis = 0; axis < D; ++axis)
      upper |= static_cast<unsigned>(edge.upper[axis] - cell[axis]) << axis;
    const Pieces& pieces = *state.pieces;
    const auto found = std::ranges::find(pieces.corners, Pieces::Corner{upper ^ edge.direction, upper});
    const unsigned piece = pieces.piece_of[static_cast<std::size_t>(found - pieces.corners.begin()) / D];
    if (state.taken >> piece & 1) return;
    state.taken |= std::uint64_t{1} << piece;

    Simplex simplex;
    std::ranges::reverse_copy(cell, simplex.cell_reversed.begin());
    for (simplex.place = 0; simplex.place < pieces.piece_of.size(); ++simplex.place) {
      if (pieces.piece_of[simplex.place] != piece) continue;
      for (std::size_t corner = 0; corner < D; ++corner)
        simplex.corners[corner] = number_of(edge_of(cell, pieces.corners[simplex.place * D + corner]));
      simplices_.push_back(simplex);
    }
  }

  // A crossed grid edge near the line between two samples with different labels.
  LatticeEdge<D> crossing_between(const Index<D>& from, const Index<D>& to) {
    std::int64_t steps = 0;
    for (int axis = 0; axis < D; ++axis) steps = std::max(steps, std::abs(to[axis] - from[axis]));
    const auto on_line = [&](std::int64_t step) {
      Index<D> sample;
      for (int axis = 0; axis < D; ++axis)
        sample[axis] =
            from[axis] +
            static_cast<std::int64_t>(std::llround(static_cast<double>(to[axis] - from[axis]) *
                                                   (static_cast<double>(step) / static_cast<double>(steps))));
      return sample;
    };
    std::int64_t low = 0, high = steps; // labels differ between them
    while (high - low > 1) {
      const std::int64_t middle = low + (high - low) / 2;
      (is_inside(on_line(middle)) == is_inside(from) ? low : high) = middle;
    }
    // Neighbours on the line differ by at most 1 along each axis: go there axis by axis.
    Index<D> sample = on_line(low);
    const Index<D> end = on_line(high);
    for (int axis = 0;; ++axis) {
      if (sample[axis] == end[axis]) continue;
      Index<D> next = sample;
      next[axis] = end[axis];
      if (is_inside(next) != is_inside(sample)) return {std::max(sample, next), 1u << axis};
      sample = next;
    }
  }

  std::array<double, D> position_on(const LatticeEdge<D>& edge) {
    const Index<D> start = edge.lower();
    const double weight = crossing(sample(start), sample(edge.upper), isovalue_);
    return point_between<D>(field_.grid, {start, edge.upper, edge.direction}, weight);
  }

  bool numbers_fit() const {
    std::uint64_t numbers = std::uint64_t{1} << D;
    for (const std::int64_t count : dims_)
      if (__builtin_mul_overflow(numbers, static_cast<std::uint64_t>(count), &numbers)) return false;
    return true;
  }

  // About what the tables take, with a hash table's own share.
  std::uint64_t bytes() const {
    constexpr std::uint64_t node = 32;
    return samples_.size() * (sizeof(Index<D>) + sizeof(double) + node) +
           edges_.size() * (2 * sizeof(LatticeEdge<D>) + sizeof(std::uint64_t) + node) +
           cells_.size() * (sizeof(Index<D>) + sizeof(Cell) + node) + simplices_.size() * sizeof(Simplex);
  }

  const LazyField<D>& field_;
  const double isovalue_;
  const ExtractOptions& options_;
  const SignRule<double, Above> rule_;
  Index<D> dims_;

  std::unordered_map<Index<D>, double, Hash> samples_;
  std::unordered_map<Index<D>, Cell, Hash> cells_;
  std::unordered_map<CubeLabels, Pieces> pieces_;
  std::unordered_map<LatticeEdge<D>, std::uint64_t, Hash> numbers_;
  std::vector<LatticeEdge<D>> edges_; // the vertices, as they were found
  std::vector<Simplex> simplices_;
};

template <int D, bool Above>
Result<TracedSurface<D>> trace(const LazyField<D>& field, double isovalue, const Seeds<D>& seeds,
                               const ExtractOptions& options) {
  Tracer<D, Above> tracer(field, isovalue, options);
  for (const auto& cell : seeds.cells)
    if (const Status added = tracer.add_cell(cell); !added) return added.error();
  for (const auto& [from, to] : seeds.pairs)
    if (const Status added = tracer.add_pair(from, to); !added) return added.error();
  if (const Status followed = tracer.follow(); !followed) return followed.error();
  return tracer.result();
}

} // namespace

template <int D>
Result<TracedSurface<D>> extract_from_seeds(const LazyField<D>& field, double isovalue, const Seeds<D>& seeds,
                                            const ExtractOptions& options) {
  if (Status status = check_arguments(isovalue, options.threads); !status) return status.error();
  if (options.method == Method::barycentric)
    return Error{Code::invalid_argument,
                 "surfaces are traced by the methods hull, component and simplicial, not by barycentric"};
  try {
    return options.inside == Inside::above ? trace<D, true>(field, isovalue, seeds, options)
                                           : trace<D, false>(field, isovalue, seeds, options);
  } catch (const std::bad_alloc&) {
    return Error{Code::out_of_memory, "not enough memory for the surface"};
  }
}

template Result<TracedSurface<2>> extract_from_seeds(const LazyField<2>&, double, const Seeds<2>&,
                                                     const ExtractOptions&);
template Result<TracedSurface<3>> extract_from_seeds(const LazyField<3>&, double, const Seeds<3>&,
                                                     const ExtractOptions&);
template Result<TracedSurface<4>> extract_from_seeds(const LazyField<4>&, double, const Seeds<4>&,
                                                     const ExtractOptions&);

} // namespace hyperiso
