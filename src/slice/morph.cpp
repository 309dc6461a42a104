#include "hyperiso/morph.hpp"

#include "core/text.hpp"
#include "slice/simplex_corners.hpp"
#include "table/simplex_cut.hpp"

#include <algorithm>
#include <new>
#include <span>
#include <tuple>

namespace hyperiso {
namespace {

// A simplex between two consecutive times of its corners.
struct Interval {
  double start, end;
  std::uint64_t simplex;
};

template <int D, class Real, class Index>
class PieceMaker {
 public:
  PieceMaker(std::span<const Real> positions, std::span<const Index> simplices, int axis)
      : positions_(positions), simplices_(simplices), axis_(static_cast<std::size_t>(axis)) {}

  // All intervals of all simplices, in order of time.
  std::vector<Interval> intervals() const {
    std::vector<Interval> found;
    for (std::uint64_t simplex = 0; simplex < simplices_.size() / D; ++simplex) {
      std::array<double, D> times;
      for (std::size_t corner = 0; corner < D; ++corner)
        times[corner] = time(simplices_[simplex * D + corner]);
      std::ranges::sort(times);
      for (std::size_t corner = 1; corner < D; ++corner)
        if (times[corner - 1] < times[corner]) found.push_back({times[corner - 1], times[corner], simplex});
    }
    std::ranges::sort(found, [](const auto& a, const auto& b) {
      return std::tie(a.start, a.simplex) < std::tie(b.start, b.simplex);
    });
    return found;
  }

  std::size_t piece_count(const Interval& interval) const {
    const SortedSimplex<Index, D> sorted(&simplices_[interval.simplex * D]);
    return simplex_cut<D - 1>().simplices(pattern(sorted, interval)).size();
  }

  // Writes the pieces of an interval from `piece` on and gives the number of the next one.
  std::size_t fill(const Interval& interval, std::size_t piece, MorphPieces<D>& pieces) const {
    const SortedSimplex<Index, D> sorted(&simplices_[interval.simplex * D]);
    const bool turned = sorted.even != (axis_ % 2 == 0); // as in a slice across this axis
    for (const auto& cut : simplex_cut<D - 1>().simplices(pattern(sorted, interval))) {
      for (std::size_t corner = 0; corner < D - 1; ++corner) {
        const std::size_t from = turned && corner < 2 ? 1 - corner : corner;
        const Index lower = sorted.corners[cut[from].lower], upper = sorted.corners[cut[from].upper];
        const std::size_t place = piece * MorphPieces<D>::numbers + corner * (D - 1);
        place_on_edge(lower, upper, interval.start, pieces.starts, place);
        place_on_edge(lower, upper, interval.end, pieces.ends, place);
      }
      pieces.start_times[piece] = interval.start;
      pieces.end_times[piece] = interval.end;
      pieces.simplices[piece] = interval.simplex;
      ++piece;
    }
    return piece;
  }

 private:
  double time(Index vertex) const { return static_cast<double>(positions_[std::size_t{vertex} * D + axis_]); }

  // The corners that are later: a corner at the time of the cut counts as beyond it.
  unsigned pattern(const SortedSimplex<Index, D>& sorted, const Interval& interval) const {
    unsigned beyond = 0;
    for (unsigned corner = 0; corner < D; ++corner)
      beyond |= (time(sorted.corners[corner]) >= interval.end ? 1u : 0u) << corner;
    return beyond;
  }

  // The point of the edge at `when`, a time between those of its ends; at those of its ends exactly there.
  void place_on_edge(Index lower, Index upper, double when, PositionArray& points, std::size_t place) const {
    const double before = time(lower), after = time(upper);
    for (std::size_t k = 0, to = place; k < D; ++k) {
      if (k == axis_) continue;
      const auto a = static_cast<double>(positions_[std::size_t{lower} * D + k]);
      const auto b = static_cast<double>(positions_[std::size_t{upper} * D + k]);
      points.set(to++, when == after ? b : a + (when - before) / (after - before) * (b - a));
    }
  }

  std::span<const Real> positions_;
  std::span<const Index> simplices_;
  std::size_t axis_;
};

Error does_not_fit(std::size_t simplices) {
  return {Code::out_of_memory, text("not enough memory for the moving pieces of ", simplices, " simplices")};
}

template <int D, class Real, class Index>
Result<MorphPieces<D>> make_pieces(const PieceMaker<D, Real, Index>& maker, std::size_t simplices,
                                   std::uint64_t memory_limit) {
  using Pieces = MorphPieces<D>;
  const auto intervals = maker.intervals();
  std::size_t count = 0;
  for (const auto& interval : intervals) count += maker.piece_count(interval);
  const std::uint64_t held = intervals.size() * sizeof(intervals[0]);
  const std::uint64_t bytes_of_piece =
      2 * Pieces::numbers * sizeof(Real) + 2 * sizeof(double) + sizeof(std::uint64_t);
  if (held > memory_limit || count > (memory_limit - held) / bytes_of_piece) return does_not_fit(simplices);

  Pieces pieces;
  for (PositionArray* points : {&pieces.starts, &pieces.ends})
    points->reset(count * Pieces::numbers, sizeof(Real) == sizeof(double));
  for (std::vector<double>* times : {&pieces.start_times, &pieces.end_times}) times->resize(count);
  pieces.simplices.resize(count);
  std::size_t piece = 0;
  for (const auto& interval : intervals) piece = maker.fill(interval, piece, pieces);
  return pieces;
}

template <int D>
void number_corners(SimplexMesh<D>& mesh, std::size_t simplices) {
  mesh.simplices.reset(simplices * D, simplices * D > UINT32_MAX);
  for (std::size_t corner = 0; corner < mesh.simplices.size(); ++corner) mesh.simplices.set(corner, corner);
}

} // namespace

template <int D>
Result<MorphPieces<D>> morph_pieces(const SimplexMesh<D>& mesh, int axis, std::uint64_t memory_limit) {
  if (axis < 0 || axis >= D)
    return Error{Code::invalid_argument, text("axis ", axis, " is none of the ", D, " axes of the surface")};
  try {
    return mesh.positions.visit([&](auto positions) {
      return mesh.simplices.visit([&](auto simplices) {
        using Real = std::remove_const_t<typename decltype(positions)::element_type>;
        using Index = std::remove_const_t<typename decltype(simplices)::element_type>;
        return make_pieces<D, Real, Index>({positions, simplices, axis}, mesh.simplex_count(), memory_limit);
      });
    });
  } catch (const std::bad_alloc&) {
    return does_not_fit(mesh.simplex_count());
  }
}

template <int D>
SimplexMesh<D - 1> pieces_at(const MorphPieces<D>& pieces, double time) {
  constexpr std::size_t numbers = MorphPieces<D>::numbers;
  std::vector<std::size_t> there;
  for (std::size_t piece = 0; piece < pieces.count() && pieces.start_times[piece] < time; ++piece)
    if (time <= pieces.end_times[piece]) there.push_back(piece);
  SimplexMesh<D - 1> mesh;
  mesh.positions.reset(there.size() * numbers, pieces.starts.wide());
  for (std::size_t place = 0; place < there.size(); ++place) {
    const double start = pieces.start_times[there[place]], end = pieces.end_times[there[place]];
    const double share = (time - start) / (end - start);
    for (std::size_t k = 0; k < numbers; ++k) {
      const double from = pieces.starts[there[place] * numbers + k],
                   to = pieces.ends[there[place] * numbers + k];
      mesh.positions.set(place * numbers + k, time == end ? to : from + share * (to - from));
    }
  }
  number_corners(mesh, there.size());
  return mesh;
}

template <int D>
SimplexMesh<D - 1> morph_mesh(const MorphPieces<D>& pieces) {
  SimplexMesh<D - 1> mesh;
  mesh.positions = pieces.starts;
  number_corners(mesh, pieces.count());
  Attribute end{"end", Attribute::Location::vertex, D - 1, {}};
  pieces.ends.visit([&](auto ends) {
    using Real = std::remove_const_t<typename decltype(ends)::element_type>;
    end.values = std::vector<Real>(ends.begin(), ends.end());
  });
  mesh.attributes.push_back(std::move(end));
  const auto of_simplices = [&](const char* name, auto values) {
    mesh.attributes.push_back({name, Attribute::Location::simplex, 1, std::move(values)});
  };
  of_simplices("start_time", pieces.start_times);
  of_simplices("end_time", pieces.end_times);
  of_simplices("simplex", std::vector<std::int64_t>(pieces.simplices.begin(), pieces.simplices.end()));
  return mesh;
}

#define HYPERISO_INSTANTIATE_MORPH(D)                                                                        \
  template Result<MorphPieces<D>> morph_pieces(const SimplexMesh<D>&, int, std::uint64_t);                   \
  template SimplexMesh<D - 1> pieces_at(const MorphPieces<D>&, double);                                      \
  template SimplexMesh<D - 1> morph_mesh(const MorphPieces<D>&)
HYPERISO_INSTANTIATE_MORPH(3);
HYPERISO_INSTANTIATE_MORPH(4);

} // namespace hyperiso
