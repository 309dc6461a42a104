#pragma once
// What hangs together inside, and its Euler characteristic, found from samples alone: no mesh, no events.

#include "core/union_find.hpp"
#include "track_fields.hpp"

namespace hyperiso::check {

struct Pieces {
  std::int64_t components = 0, euler = 0;
  bool operator==(const Pieces&) const = default;
};
inline std::ostream& operator<<(std::ostream& out, const Pieces& pieces) {
  return out << pieces.components << " pieces with Euler characteristic " << pieces.euler;
}

inline Pieces counted(UnionFind& united, const std::vector<bool>& present, std::int64_t euler) {
  Pieces pieces{0, euler};
  for (std::uint64_t i = 0; i < present.size(); ++i) pieces.components += present[i] && united.find(i) == i;
  return pieces;
}

template <int D>
using Samples = FieldView<const float, D>;

template <int D>
std::uint64_t number_of(const Samples<D>& field, const std::array<std::int64_t, D>& index) {
  std::uint64_t number = 0;
  for (int axis = D; axis-- > 0;)
    number =
        number * static_cast<std::uint64_t>(field.dims()[axis]) + static_cast<std::uint64_t>(index[axis]);
  return number;
}

template <int D>
std::uint64_t sample_count(const Samples<D>& field) {
  std::uint64_t count = 1;
  for (const std::int64_t n : field.dims()) count *= static_cast<std::uint64_t>(n);
  return count;
}

// The corner of a cell with this set of axes, or nothing if that is off the grid.
template <int D>
std::optional<std::array<std::int64_t, D>> corner_of(const Samples<D>& field,
                                                     std::array<std::int64_t, D> lowest, unsigned axes) {
  for (int axis = 0; axis < D; ++axis) {
    lowest[axis] += axes >> axis & 1;
    if (lowest[axis] >= field.dims()[axis]) return {};
  }
  return lowest;
}

// At a step with the method hull, which joins all that is inside of a cell: as if samples were boxes that
// meet at their corners.
template <int D>
Pieces pieces_of_boxes(const Samples<D>& field, double isovalue) {
  const auto inside = [&](const std::array<std::int64_t, D>& index) { return field.at(index) >= isovalue; };
  UnionFind united(sample_count<D>(field));
  std::vector<bool> present(sample_count<D>(field));
  std::int64_t euler = 0;
  // A face of boxes is where a box begins (even) or lies (odd) along each axis.
  std::array<std::int64_t, D> dims;
  for (int axis = 0; axis < D; ++axis) dims[axis] = 2 * field.dims()[axis] + 1;
  for_each_index<D>(dims, [&](const std::array<std::int64_t, D>& face) {
    std::optional<std::uint64_t> first;
    int dimension = 0;
    for (const std::int64_t place : face) dimension += place % 2;
    for (unsigned side = 0; side < 1u << D; ++side) {
      std::array<std::int64_t, D> box;
      bool there = true;
      for (int axis = 0; axis < D; ++axis) {
        const bool upper = side >> axis & 1;
        there &= face[axis] % 2 == 0 || !upper; // along it there is but one
        box[axis] = face[axis] / 2 - (face[axis] % 2 == 0 && !upper);
        there &= box[axis] >= 0 && box[axis] < field.dims()[axis];
      }
      if (!there || !inside(box)) continue;
      const std::uint64_t number = number_of<D>(field, box);
      present[number] = true;
      if (!first) euler += dimension % 2 == 0 ? 1 : -1;
      united.unite(first.value_or(number), number);
      first = first.value_or(number);
    }
  });
  return counted(united, present, euler);
}

// Calls use(path) for every path from the lowest corner of a cell upwards: the faces of its Kuhn simplices
// that have this corner, each as the sets of axes that its corners lie along.
template <int D, class Use>
void for_each_path(std::vector<unsigned>& path, Use&& use) {
  use(path);
  const unsigned last = path.back();
  for (unsigned next = last + 1; next < 1u << D; ++next)
    if ((next & last) == last) {
      path.push_back(next);
      for_each_path<D>(path, use);
      path.pop_back();
    }
}

// At a step with the method simplicial: the full subcomplex of what is inside of the Kuhn triangulation.
template <int D>
Pieces pieces_of_simplices(const Samples<D>& field, double isovalue) {
  UnionFind united(sample_count<D>(field));
  std::vector<bool> present(sample_count<D>(field));
  std::int64_t euler = 0;
  for_each_index<D>(field.dims(), [&](const std::array<std::int64_t, D>& lowest) {
    if (field.at(lowest) < isovalue) return;
    const std::uint64_t number = number_of<D>(field, lowest);
    present[number] = true;
    std::vector<unsigned> start{0};
    for_each_path<D>(start, [&](const std::vector<unsigned>& path) {
      for (const unsigned axes : path) {
        const auto corner = corner_of<D>(field, lowest, axes);
        if (!corner || field.at(*corner) < isovalue) return;
        united.unite(number, number_of<D>(field, *corner));
      }
      euler += path.size() % 2 == 1 ? 1 : -1;
    });
  });
  return counted(united, present, euler);
}

// Between two steps with the method simplicial, `share` of the way from `step` on: the time cuts each face of
// a Kuhn simplex that has corners at both steps in a convex piece, with a corner for each of its edges
// between them; what is inside of the pieces is as connected as those faces of them that are inside.
template <int D>
Pieces pieces_of_simplices_between(const Samples<D>& field, std::int64_t step, double share,
                                   double isovalue) {
  constexpr unsigned time = 1u << (D - 1);
  auto dims = field.dims();
  dims[D - 1] = 1;
  std::uint64_t edges = 1u << (D - 1); // of a sample, upwards in space and time
  for (const std::int64_t n : dims) edges *= static_cast<std::uint64_t>(n);
  UnionFind united(edges);
  std::vector<bool> present(edges);
  std::int64_t euler = 0;
  for_each_index<D>(dims, [&](std::array<std::int64_t, D> lowest) {
    lowest[D - 1] = step;
    std::vector<unsigned> start{0};
    for_each_path<D>(start, [&](const std::vector<unsigned>& path) {
      if (path.back() < time) return;
      double before = std::numeric_limits<double>::infinity(), after = before;
      for (const unsigned axes : path) {
        const auto corner = corner_of<D>(field, lowest, axes);
        if (!corner) return;
        double& least = axes < time ? before : after;
        least = std::min<double>(least, field.at(*corner));
      }
      if ((1 - share) * before + share * after < isovalue) return;
      euler += path.size() % 2 == 0 ? 1 : -1;
      std::optional<std::uint64_t> first;
      for (const unsigned from : path)
        for (const unsigned to : path)
          if (from < time && to >= time) {
            auto foot = *corner_of<D>(field, lowest, from);
            foot[D - 1] = 0;
            const auto edge = number_of<D>(field, foot) << (D - 1) | (to & ~from & (time - 1));
            present[edge] = true;
            first = first.value_or(edge);
            united.unite(*first, edge);
          }
    });
  });
  return counted(united, present, euler);
}

// What a graph of regions says about a moment at which nothing happens.
inline Pieces pieces_at(const TrackingGraph& graph, double time) {
  const auto time_of = [&](std::int64_t event) { return graph.events[static_cast<std::size_t>(event)].time; };
  const double first = graph.axes.back().coordinate(0), last = graph.axes.back().coordinate(graph.steps - 1);
  Pieces pieces;
  for (const TrackingArc& arc : graph.arcs) {
    const double start = time_of(arc.start_event), end = time_of(arc.end_event);
    pieces.components += (start < time || start == first) && (end > time || end == last);
  }
  for (const Feature& row : graph.features)
    if (row.step == 0) pieces.euler += row.euler_characteristic;
  for (const TrackingEvent& event : graph.events)
    if (event.time < time) pieces.euler += event.delta_euler;
  return pieces;
}

// The regions at every step, and with the method simplicial at a moment after each, are those of the samples.
// Times are numbers of steps, and no sample equals the isovalue.
template <int D>
void expect_regions_of_samples(const TrackingGraph& graph, const Samples<D>& field, double isovalue,
                               Method method, std::int64_t every = 1) {
  ASSERT_EQ(graph.tracked, Tracked::region);
  std::mt19937 random(3);
  for (std::int64_t step = 0; step < graph.steps; step += every) {
    const auto samples = field.at_index(D - 1, step);
    const Pieces found = method == Method::hull ? pieces_of_boxes<D - 1>(samples, isovalue)
                                                : pieces_of_simplices<D - 1>(samples, isovalue);
    EXPECT_EQ(pieces_at(graph, static_cast<double>(step)), found) << "step " << step;
    Pieces rows;
    for (const Feature& row : graph.features)
      if (row.step == step) ++rows.components, rows.euler += row.euler_characteristic;
    EXPECT_EQ(rows, found) << "step " << step;
    if (method == Method::hull || step + 1 == graph.steps) continue;
    const double share = std::uniform_real_distribution<double>(0.01, 0.99)(random);
    EXPECT_EQ(pieces_at(graph, static_cast<double>(step) + share),
              pieces_of_simplices_between<D>(field, step, share, isovalue))
        << "step " << step << " + " << share;
  }
}

} // namespace hyperiso::check
