#include "extract/march_table.hpp"

#include "extract/cell_corners.hpp"

#include <utility>

namespace hyperiso {
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
template <int D, Method M, class Use>
void for_each_corner(TableForm form, CubeLabels labels, Use&& use) {
  if (!form.last_axis_first) return for_each_cell_corner<D>(M, labels, use);
  CubeLabels turned = 0;
  for (unsigned vertex = 0; vertex < 1u << D; ++vertex)
    turned |= (labels >> vertex & 1) << last_axis_to_front<D>(vertex);
  for_each_cell_corner<D>(M, turned, [&](unsigned lower, unsigned upper) {
    use(first_axis_to_back<D>(lower), first_axis_to_back<D>(upper));
  });
}

template <int D, Method M>
MarchTable<D> make_march_table(TableForm form) {
  using Edges = CellEdges<D, M>;
  std::array<std::array<std::uint8_t, 1 << D>, 1 << D> slot{};
  for (unsigned upper = 0; upper < 1u << D; ++upper)
    for (unsigned lower = 0; lower < upper; ++lower)
      if ((lower & ~upper) == 0) slot[lower][upper] = static_cast<std::uint8_t>(Edges::slot(lower, upper));

  MarchTable<D> table;
  table.first.reserve(table.codes + 1);
  table.count.reserve(table.codes);
  for (std::uint32_t code = 0; code < table.codes; ++code) {
    const std::size_t first = table.corners.size();
    table.first.push_back(static_cast<std::uint32_t>(first));
    for_each_corner<D, M>(form, labels_of_code<D>(code), [&](unsigned lower, unsigned upper) {
      table.corners.push_back(slot[lower][upper]);
    });
    // Moving an axis past an odd number of others reflects space.
    if (form.mirrored != (form.last_axis_first && D % 2 == 0))
      for (std::size_t simplex = first; simplex < table.corners.size(); simplex += D)
        std::swap(table.corners[simplex], table.corners[simplex + 1]);
    table.count.push_back(static_cast<std::uint8_t>((table.corners.size() - first) / D));
  }
  table.first.push_back(static_cast<std::uint32_t>(table.corners.size()));
  table.corners.resize(table.corners.size() + table.padding);
  return table;
}

template <int D, Method M, bool Mirrored, bool LastAxisFirst>
const MarchTable<D>& cached_march_table() {
  static const MarchTable<D> table = make_march_table<D, M>({Mirrored, LastAxisFirst});
  return table;
}

} // namespace

template <int D, Method M>
const MarchTable<D>& march_table(TableForm form) {
  if (form.last_axis_first)
    return form.mirrored ? cached_march_table<D, M, true, true>() : cached_march_table<D, M, false, true>();
  return form.mirrored ? cached_march_table<D, M, true, false>() : cached_march_table<D, M, false, false>();
}

template const MarchTable<2>& march_table<2, Method::hull>(TableForm);
template const MarchTable<3>& march_table<3, Method::hull>(TableForm);
template const MarchTable<4>& march_table<4, Method::hull>(TableForm);
template const MarchTable<2>& march_table<2, Method::simplicial>(TableForm);
template const MarchTable<3>& march_table<3, Method::simplicial>(TableForm);
template const MarchTable<4>& march_table<4, Method::simplicial>(TableForm);

} // namespace hyperiso
