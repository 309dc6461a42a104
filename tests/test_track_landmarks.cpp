// Landmarks spare searches of slices. These tests compare what they say with the components of the slices.

#include "check.hpp"
#include "track/slice_search.hpp"
#include "track/step_mask.hpp"

#include <gtest/gtest.h>
#include <map>
#include <random>

namespace hyperiso::track_detail {
namespace {

template <int D>
struct RandomSlab {
  RandomSlab(const std::array<std::int64_t, D>& dims, unsigned seed) {
    std::mt19937 random(seed);
    std::size_t count = 1;
    for (const auto n : dims) count *= static_cast<std::size_t>(n);
    std::uniform_real_distribution<double> value(-1, 1);
    // Often like the sample before it, so that sets of samples are of all sizes.
    samples.resize(count);
    for (std::size_t i = 0; i < count; ++i)
      samples[i] =
          i > 0 && random() % 3 != 0 ? samples[i - 1] * value(random) + 0.1 * value(random) : value(random);
    Grid<D> grid;
    for (int axis = 0; axis < D; ++axis) grid.axes[axis].count = dims[axis];
    view = contiguous_view<const double, D>(samples.data(), grid);
  }
  Slab<D> slab(Method method) const {
    const auto mask = [&](std::int64_t step) {
      return std::make_shared<const StepMask>(view.at_index(D - 1, step), 0.0, Inside::above);
    };
    Slab<D> slab(std::make_unique<MaskedCells<D>>(march_table<D>(method, {}),
                                                  Crossings<D>(view, 0.0, mask(0), mask(1))));
    slab.add_searched(SIZE_MAX, false);
    slab.add_searched(SIZE_MAX, true);
    describe(slab, SlabSamples<double, D>(view, 0.0));
    slab.unfold_all();
    return slab;
  }

  std::vector<double> samples;
  FieldView<const double, D> view;
};

// Checks that places of one name lie on one component; gives how many names have several places.
template <class Parts>
int expect_names_of_components(const Parts& parts, const std::vector<std::uint32_t>& all) {
  using Edge = std::pair<Vertex, Vertex>;
  std::map<Edge, std::size_t> number;
  for (const auto part : all)
    parts.for_each_edge(part, [&](Vertex before, Vertex after) {
      number.try_emplace({before, after}, number.size());
    });
  UnionFind united(number.size());
  for (const auto part : all) {
    std::vector<std::size_t> edges;
    parts.for_each_edge(part, [&](Vertex before, Vertex after) {
      edges.push_back(number.at({before, after}));
    });
    for (const auto edge : edges) united.unite(edges[0], edge);
  }
  const auto* const landmarks = parts.slab.landmarks(Parts::of_rim);
  std::map<std::uint64_t, std::pair<std::uint64_t, int>> component_of_name;
  for (const auto& [edge, place] : number) {
    if (parts.slab.edge(edge.second) != parts.slab.edge(edge.first) + parts.slab.step_offset) continue;
    if (const auto name = landmarks->name(parts.slab.edge(edge.first))) {
      const auto [found, is_new] = component_of_name.try_emplace(*name, united.find(place), 0);
      ++found->second.second;
      EXPECT_EQ(found->second.first, united.find(place));
    }
  }
  return static_cast<int>(
      std::ranges::count_if(component_of_name, [](const auto& entry) { return entry.second.second > 1; }));
}

// At random moments, and at those of crossings.
template <int D>
void expect_landmarks_to_hold(const std::array<std::int64_t, D>& dims, Method method, unsigned seeds) {
  int names = 0, names_of_rims = 0;
  for (unsigned seed = 0; seed < seeds; ++seed) {
    const RandomSlab<D> random(dims, seed);
    Slab<D> slab = random.slab(method);
    std::map<std::array<Vertex, 3>, std::vector<std::uint32_t>>
        triangles; // and the parts of rims they may be
    for (SimplexNumber simplex = 0; D == 4 && simplex < slab.simplex_count(); ++simplex)
      for (std::uint32_t left_out = 0; left_out < 4; ++left_out) {
        std::vector<Vertex> corners;
        for (std::uint32_t corner = 0; corner < 4; ++corner)
          if (corner != left_out) corners.push_back(slab.simplex(simplex)[corner % D]);
        std::ranges::sort(corners);
        triangles[{corners[0], corners[1], corners[2]}].push_back(4 * simplex + left_out);
      }
    std::mt19937 choose(seed);
    for (int i = 0; i < 4; ++i) {
      double moment = std::uniform_real_distribution<double>(0, 1)(choose);
      if (i % 2 == 0)
        for (int tries = 0; tries < 50; ++tries)
          if (const double time = slab.time(static_cast<Vertex>(choose() % slab.vertex_count()));
              time > 0 && time < 1)
            moment = time;
      for (const Direction direction : {Direction::before, Direction::after}) {
        const PartsOfSlice<D> parts{{slab, moment, direction}};
        const auto crosses = [&](const auto& corners) {
          const auto after =
              std::ranges::count_if(corners, [&](Vertex vertex) { return parts.is_after(vertex); });
          return after != 0 && after != std::ssize(corners);
        };
        std::vector<std::uint32_t> all;
        for (SimplexNumber simplex = 0; simplex < slab.simplex_count(); ++simplex)
          if (crosses(slab.simplex(simplex))) all.push_back(simplex);
        names += expect_names_of_components(parts, all);
        if constexpr (D == 4) {
          std::vector<std::uint32_t> rims;
          for (const auto& [corners, places] : triangles)
            if (places.size() == 1 && crosses(corners)) rims.push_back(places[0]);
          names_of_rims += expect_names_of_components(PartsOfRims{{slab, moment, direction}}, rims);
        }
      }
    }
  }
  EXPECT_GT(names, static_cast<int>(seeds));
  const bool has_named_rims = D == 4 && *std::min_element(dims.begin(), dims.end() - 1) > 2;
  EXPECT_GE(names_of_rims, has_named_rims ? static_cast<int>(seeds) : 0);
}

// A name that stands on two components would unite tracks that have parted, or hide a hole.
TEST(TrackLandmarks, are_on_one_component_of_curves) {
  for (const Method method : {Method::hull, Method::component}) {
    expect_landmarks_to_hold<3>({7, 6, 2}, method, 60);
    expect_landmarks_to_hold<3>({70, 3, 2}, method, 10);
    expect_landmarks_to_hold<3>({2, 9, 2}, method, 40);
  }
}
TEST(TrackLandmarks, are_on_one_component_of_surfaces_and_rims) {
  for (const Method method : {Method::hull, Method::component}) {
    expect_landmarks_to_hold<4>({5, 4, 3, 2}, method, 20);
    expect_landmarks_to_hold<4>({2, 4, 5, 2}, method, 10);
    expect_landmarks_to_hold<4>({66, 3, 3, 2}, method, 2);
  }
}

} // namespace
} // namespace hyperiso::track_detail
