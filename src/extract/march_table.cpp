#include "extract/march_table.hpp"

#include "extract/cell_corners.hpp"

#include <utility>

namespace hyperiso {
namespace {

template <int D, Method M>
MarchTable<D> make_march_table(bool mirrored) {
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
    for_each_cell_corner<D>(M, labels_of_code<D>(code), [&](unsigned lower, unsigned upper) {
      table.corners.push_back(slot[lower][upper]);
    });
    if (mirrored)
      for (std::size_t simplex = first; simplex < table.corners.size(); simplex += D)
        std::swap(table.corners[simplex], table.corners[simplex + 1]);
    table.count.push_back(static_cast<std::uint8_t>((table.corners.size() - first) / D));
  }
  table.first.push_back(static_cast<std::uint32_t>(table.corners.size()));
  table.corners.resize(table.corners.size() + table.padding);
  return table;
}

} // namespace

template <int D, Method M>
const MarchTable<D>& march_table(bool mirrored) {
  if (mirrored) {
    static const MarchTable<D> table = make_march_table<D, M>(true);
    return table;
  }
  static const MarchTable<D> table = make_march_table<D, M>(false);
  return table;
}

template const MarchTable<2>& march_table<2, Method::hull>(bool);
template const MarchTable<3>& march_table<3, Method::hull>(bool);
template const MarchTable<4>& march_table<4, Method::hull>(bool);
template const MarchTable<2>& march_table<2, Method::simplicial>(bool);
template const MarchTable<3>& march_table<3, Method::simplicial>(bool);
template const MarchTable<4>& march_table<4, Method::simplicial>(bool);

} // namespace hyperiso
