#include "table/hull_entry.hpp"

#include "table/cube_facet.hpp"
#include "table/hull_facet.hpp"

#include <algorithm>
#include <cassert>
#include <numeric>
#include <utility>

namespace hyperiso {

// Faces of a growing surface -------------------------------------------------------------------------------

template <int D>
void RidgeFront<D>::clear() {
  entries_.clear();
  next_ = 0;
  if (slots_.empty()) make_slots(1024);
  std::fill(slots_.begin(), slots_.end(), 0);
}

template <int D>
void RidgeFront<D>::add(std::array<std::uint8_t, D - 1> edges, bool positive) {
  for (std::size_t i = 1; i < edges.size(); ++i)
    for (std::size_t j = i; j > 0 && edges[j] < edges[j - 1]; --j) {
      std::swap(edges[j], edges[j - 1]);
      positive = !positive;
    }
  if (2 * entries_.size() >= slots_.size()) make_slots(2 * slots_.size());
  const Ridge wanted{edges, !positive}; // neighbours orient their common ridge in opposite ways
  std::uint32_t& slot = slot_of(wanted);
  if (slot == 0) {
    entries_.push_back({wanted, true});
    slot = static_cast<std::uint32_t>(entries_.size());
  } else {
    Entry& entry = entries_[slot - 1];
    assert(entry.open && entry.ridge.positive == positive);
    entry.open = false;
  }
}

template <int D>
const typename RidgeFront<D>::Ridge* RidgeFront<D>::next() {
  while (next_ < entries_.size() && !entries_[next_].open) ++next_;
  return next_ < entries_.size() ? &entries_[next_].ridge : nullptr;
}

template <int D>
std::uint32_t& RidgeFront<D>::slot_of(const Ridge& ridge) {
  std::uint64_t hash = 0;
  for (const std::uint8_t edge : ridge.edges) hash = hash << 8 | edge;
  hash *= 0x9e3779b97f4a7c15; // 2^64 over the golden ratio: the upper bits mix all edges
  std::size_t slot = (hash >> 32) & (slots_.size() - 1);
  while (slots_[slot] != 0 && entries_[slots_[slot] - 1].ridge.edges != ridge.edges)
    slot = (slot + 1) & (slots_.size() - 1);
  return slots_[slot];
}

template <int D>
void RidgeFront<D>::make_slots(std::size_t count) {
  slots_.assign(count, 0);
  for (std::size_t i = 0; i < entries_.size(); ++i)
    slot_of(entries_[i].ridge) = static_cast<std::uint32_t>(i + 1);
}

// Entries --------------------------------------------------------------------------------------------------

namespace {

template <int D>
struct PlacedEdge {
  std::uint8_t edge;
  int lower, upper; // vertices
  IntegerVector<D> midpoint;
};

// All edges of the cube in placing order.
template <int D>
const std::array<PlacedEdge<D>, cube_edge_count<D>>& placed_edges() {
  static const auto edges = [] {
    std::array<PlacedEdge<D>, cube_edge_count<D>> placed;
    std::ranges::transform(edges_in_placing_order<D>(), placed.begin(), [](std::uint8_t edge) {
      const CubeEdge ends = cube_edge_ends<D>(edge);
      return PlacedEdge<D>{edge, ends.lower, ends.lower | 1 << ends.axis, edge_midpoint<D>(edge)};
    });
    return placed;
  }();
  return edges;
}

// Calls `use` with the simplices of the table of one dimension less.
template <int D, class Use>
void with_lower_entry(LabelSet<D> labels, Use&& use) {
  if constexpr (D <= 4) {
    use(hull_table<D>().simplices(labels));
  } else {
    HullEntryMaker<D> maker;
    use(maker.make(labels));
  }
}

template <int D>
void make_coprime(IntegerVector<D>& vector) {
  std::int64_t divisor = 0;
  for (const std::int64_t x : vector) divisor = std::gcd(divisor, x);
  for (std::int64_t& x : vector) x /= divisor;
}

} // namespace

template <int D>
std::span<const std::uint8_t> HullEntryMaker<D>::make(LabelSet<D> labels) {
  simplices_.clear();
  facets_.clear();
  front_.clear();
  find_crossed_edges(labels);
  start_at_boundary(labels);
  while (const Ridge* ridge = front_.next()) add_facet_at(*ridge);
  return sort_facets();
}

template <int D>
void HullEntryMaker<D>::find_crossed_edges(LabelSet<D> labels) {
  crossed_.clear();
  for (const PlacedEdge<D>& edge : placed_edges<D>())
    if ((labels >> edge.lower & 1) != (labels >> edge.upper & 1))
      crossed_.push_back({edge.edge, edge.midpoint});
}

template <int D>
void HullEntryMaker<D>::start_at_boundary(LabelSet<D> labels) {
  for (const CubeFacet<D>& facet : cube_facets<D>)
    with_lower_entry<D - 1>(facet.labels_within(labels), [&](std::span<const std::uint8_t> edges) {
      for (std::size_t first = 0; first < edges.size(); first += D - 1) {
        std::array<std::uint8_t, D - 1> ridge;
        for (std::size_t i = 0; i < D - 1; ++i) ridge[i] = facet.edge_of_cube(edges[first + i]);
        front_.add(ridge, !facet.trace_keeps_orientation()); // as a simplex beyond the facet would
      }
    });
}

template <int D>
void HullEntryMaker<D>::add_facet_at(const Ridge& ridge) {
  std::array<IntegerVector<D>, D - 1> corners;
  for (std::size_t i = 0; i < D - 1; ++i) corners[i] = edge_midpoint<D>(ridge.edges[i]);

  // Seen from the ridge, W+ lies within an angle of less than two right angles: the hyperplane on whose
  // outside no point lies is the one through the last of the points in the order of their angles.
  IntegerVector<D> outward{};
  std::int64_t offset = 0;
  for (const Point& point : crossed_) {
    if (dot(outward, point.midpoint) <= offset && outward != IntegerVector<D>{}) continue;
    std::array<IntegerVector<D>, D - 1> sides;
    for (std::size_t i = 0; i < D - 1; ++i) sides[i] = difference(corners[i], point.midpoint);
    outward = cross_product<D>(sides);
    if (!ridge.positive) outward = difference({}, outward);
    offset = dot(outward, point.midpoint);
  }

  touched_.clear();
  for (const Point& point : crossed_)
    if (dot(outward, point.midpoint) == offset) touched_.push_back(point.edge);
  make_coprime<D>(outward);
  const std::size_t first = simplices_.size();
  for (const EdgeSimplex<D>& simplex : triangulate_facet<D>(outward, touched_)) {
    simplices_.insert(simplices_.end(), simplex.begin(), simplex.end());
    for (std::size_t left_out = 0; left_out < D; ++left_out) {
      std::array<std::uint8_t, D - 1> face;
      std::copy_n(simplex.begin(), left_out, face.begin());
      std::copy(simplex.begin() + left_out + 1, simplex.end(), face.begin() + left_out);
      front_.add(face, left_out % 2 == 0);
    }
  }
  facets_.push_back({outward, first, simplices_.size()});
}

template <int D>
std::span<const std::uint8_t> HullEntryMaker<D>::sort_facets() {
  std::ranges::sort(facets_, {}, &Facet::outward);
  sorted_.clear();
  for (const Facet& facet : facets_)
    sorted_.insert(sorted_.end(), simplices_.begin() + static_cast<std::ptrdiff_t>(facet.first),
                   simplices_.begin() + static_cast<std::ptrdiff_t>(facet.end));
  return sorted_;
}

template class RidgeFront<3>;
template class RidgeFront<4>;
template class RidgeFront<5>;
template class RidgeFront<6>;
template class HullEntryMaker<3>;
template class HullEntryMaker<4>;
template class HullEntryMaker<5>;
template class HullEntryMaker<6>;

} // namespace hyperiso
