#include "extract/march_table.hpp"

#include "extract/cell_corners.hpp"
#include "table/entry_cache.hpp"

#include <utility>

namespace hyperiso {

template <>
struct MarchTable<5> {
  // Room for some hundred thousand entries of the hull table; a field seldom has more than thousands.
  static constexpr std::size_t cached_bytes = 64 << 20;

  explicit MarchTable(void (*append_)(std::uint32_t code, std::vector<std::uint8_t>& corners))
      : append(append_) {}

  void (*append)(std::uint32_t code, std::vector<std::uint8_t>& corners);
  mutable EntryCache<std::uint32_t> cache{cached_bytes};
};

namespace {

// Cube vertices, or labels, with the last axis moved to the front, and back.
template <int D>
unsigned last_axis_to_front(unsigned vertex) {
  return (vertex << 1 & ((1u << D) - 1)) | vertex >> (D - 1);
}
template <int D>
unsigned first_axis_to_back(unsigned vertex) {
  return vertex >> 1 | (vertex & 1) << (D - 1);
}

// Calls use(lower, upper) for the corners of an entry, as TableForm says.
template <int D, class Use>
void for_each_corner(Method method, TableForm form, CubeLabels labels, Use&& use) {
  if (!form.last_axis_first) return for_each_cell_corner<D>(method, labels, use);
  CubeLabels turned = 0;
  for (unsigned vertex = 0; vertex < 1u << D; ++vertex)
    turned |= (labels >> vertex & 1) << last_axis_to_front<D>(vertex);
  for_each_cell_corner<D>(method, turned, [&](unsigned lower, unsigned upper) {
    use(first_axis_to_back<D>(lower), first_axis_to_back<D>(upper));
  });
}

// The slot of each edge, by the cube vertices at its ends.
template <int D>
using Slots = std::array<std::array<std::uint8_t, 1 << D>, 1 << D>;

template <int D, Method M>
Slots<D> make_slots() {
  using Edges = CellEdges<D, M == Method::simplicial ? M : Method::hull>;
  Slots<D> slot{};
  for (unsigned upper = 0; upper < 1u << D; ++upper)
    for (unsigned lower = 0; lower < upper; ++lower)
      if ((lower & ~upper) == 0) slot[lower][upper] = static_cast<std::uint8_t>(Edges::slot(lower, upper));
  return slot;
}

// Appends the slots of an entry's corners.
template <int D, Method M, bool Mirrored, bool LastAxisFirst>
void append_entry(std::uint32_t code, std::vector<std::uint8_t>& corners) {
  static const Slots<D> slot = make_slots<D, M>();
  const std::size_t first = corners.size();
  for_each_corner<D>(M, {Mirrored, LastAxisFirst}, labels_of_code<D>(code),
                     [&](unsigned lower, unsigned upper) { corners.push_back(slot[lower][upper]); });
  // Moving an axis past an odd number of others reflects space.
  if (Mirrored != (LastAxisFirst && D % 2 == 0))
    for (std::size_t simplex = first; simplex < corners.size(); simplex += D)
      std::swap(corners[simplex], corners[simplex + 1]);
}

template <int D>
MarchTable<D> make_march_table(void (*append)(std::uint32_t code, std::vector<std::uint8_t>& corners)) {
  MarchTable<D> table;
  table.first.reserve(table.codes + 1);
  table.count.reserve(table.codes);
  for (std::uint32_t code = 0; code < table.codes; ++code) {
    const std::size_t first = table.corners.size();
    table.first.push_back(static_cast<std::uint32_t>(first));
    append(code, table.corners);
    table.count.push_back(static_cast<std::uint8_t>((table.corners.size() - first) / D));
  }
  table.first.push_back(static_cast<std::uint32_t>(table.corners.size()));
  table.corners.resize(table.corners.size() + table.padding);
  return table;
}

template <int D, Method M, bool Mirrored, bool LastAxisFirst>
const MarchTable<D>& cached_march_table() {
  constexpr auto append = append_entry<D, M, Mirrored, LastAxisFirst>;
  if constexpr (D <= 4) {
    static const MarchTable<D> table = make_march_table<D>(append);
    return table;
  } else {
    static const MarchTable<D> table(append);
    return table;
  }
}

template <int D, Method M>
const MarchTable<D>& march_table_of(TableForm form) {
  if (form.last_axis_first)
    return form.mirrored ? cached_march_table<D, M, true, true>() : cached_march_table<D, M, false, true>();
  return form.mirrored ? cached_march_table<D, M, true, false>() : cached_march_table<D, M, false, false>();
}

} // namespace

template <int D>
const MarchTable<D>& march_table(Method method, TableForm form) {
  if (method == Method::simplicial) return march_table_of<D, Method::simplicial>(form);
  if (method == Method::component) return march_table_of<D, Method::component>(form);
  return march_table_of<D, Method::hull>(form);
}

template const MarchTable<2>& march_table(Method, TableForm);
template const MarchTable<3>& march_table(Method, TableForm);
template const MarchTable<4>& march_table(Method, TableForm);
template const MarchTable<5>& march_table(Method, TableForm);

struct MarchTableReader<5>::State {
  explicit State(const MarchTable<5>& table) : append(table.append), reader(table.cache) {}

  void (*append)(std::uint32_t code, std::vector<std::uint8_t>& corners);
  EntryCache<std::uint32_t>::Reader reader;
  std::vector<std::uint8_t> made;
};

MarchTableReader<5>::MarchTableReader(const MarchTable<5>& table) : state_(std::make_unique<State>(table)) {}
MarchTableReader<5>::~MarchTableReader() = default;

std::span<const std::uint8_t> MarchTableReader<5>::corners(std::uint32_t code) {
  return state_->reader.entry(code, [&]() -> std::span<const std::uint8_t> {
    state_->made.clear();
    state_->append(code, state_->made);
    return state_->made;
  });
}

std::size_t MarchTableReader<5>::simplex_count(std::uint32_t code) { return corners(code).size() / 5; }

} // namespace hyperiso
