// The graph that `track` builds by local decisions against one built by taking every distinct vertex time of
// the whole mesh as a possible event and finding the components of all slices and levels afresh.

#include "core/union_find.hpp"
#include "hyperiso/interval.hpp"
#include "track_fields.hpp"

namespace hyperiso {
namespace {

using check::time_field;
using check::track_field;

// All faces of a mesh by dimension, found by their sorted corners.
struct Complex {
  using Corners = std::vector<std::uint64_t>;

  Complex(const Mesh& mesh, const std::vector<double>& vertex_times)
      : times(vertex_times), region(mesh.simplex_dimension == mesh.dimension) {
    const auto corners = static_cast<std::size_t>(mesh.simplex_dimension + 1);
    faces.resize(corners);
    tops.resize(corners);
    for (std::size_t simplex = 0; simplex < mesh.simplex_count(); ++simplex)
      for (unsigned subset = 1; subset < 1u << corners; ++subset) {
        Corners face;
        for (std::size_t corner = 0; corner < corners; ++corner)
          if (subset >> corner & 1) face.push_back(mesh.simplices[simplex * corners + corner]);
        std::ranges::sort(face);
        ++tops[face.size() - 1][face];
      }
    for (std::size_t dimension = 0; dimension < corners; ++dimension)
      for (const auto& [face, count] : tops[dimension]) faces[dimension].push_back(face);
  }
  std::pair<double, double> range(const Corners& face) const {
    double first = times[face[0]], last = first;
    for (const auto vertex : face)
      first = std::min(first, times[vertex]), last = std::max(last, times[vertex]);
    return {first, last};
  }

  std::vector<double> times;
  bool region;
  std::vector<std::vector<Corners>> faces;
  std::vector<std::map<Corners, int>> tops; // how many simplices have it
};

struct Piece {
  std::int64_t euler = 0, rims = 0;
};

// The components of the slices between two consecutive vertex times, as a number for each edge that meets
// them.
struct Slices {
  Slices(const Complex& complex, double from, double to, const std::function<bool(std::uint64_t)>& on_layer) {
    const auto meets = [&](const Complex::Corners& face) {
      const auto [first, last] = complex.range(face);
      return first <= from && last >= to;
    };
    std::map<Complex::Corners, std::uint64_t> number;
    for (const auto& edge : complex.faces[1])
      if (meets(edge)) number.emplace(edge, number.size());
    UnionFind united(number.size()), rims(number.size());
    std::vector<bool> on_rim(number.size());
    const auto edges_of = [&](const Complex::Corners& face) {
      std::vector<std::uint64_t> edges;
      for (std::size_t i = 0; i < face.size(); ++i)
        for (std::size_t j = i + 1; j < face.size(); ++j)
          if (const auto found = number.find({face[i], face[j]}); found != number.end())
            edges.push_back(found->second);
      return edges;
    };
    const bool surface = complex.faces.size() == 4 && !complex.region;
    for (const auto& triangle : complex.faces[2]) {
      if (!meets(triangle)) continue;
      const auto edges = edges_of(triangle);
      for (const auto edge : edges) united.unite(edges[0], edge);
      if (surface && complex.tops[2].at(triangle) == 1 && !std::ranges::all_of(triangle, on_layer))
        for (const auto edge : edges) rims.unite(edges[0], edge), on_rim[edge] = true;
    }
    for (const auto& [edge, i] : number) {
      component[edge] = united.find(i);
      pieces[united.find(i)].rims += on_rim[i] && rims.find(i) == i;
    }
    for (std::size_t dimension = 1; dimension < complex.faces.size(); ++dimension)
      for (const auto& face : complex.faces[dimension])
        if (meets(face)) pieces[united.find(edges_of(face)[0])].euler += dimension % 2 == 1 ? 1 : -1;
  }
  std::map<Complex::Corners, std::uint64_t> component;
  std::map<std::uint64_t, Piece> pieces;
};

// What happens to the slices of a mesh whose last axis is time, in steps.
template <int D>
class History {
 public:
  History(const Mesh& mesh, const std::array<std::int64_t, D>& dims)
      : mesh_(mesh), dims_(dims), times_(times_of(mesh)), complex_(mesh, times_),
        last_step_(static_cast<double>(dims[D - 1] - 1)) {
    for (const auto& edge : complex_.faces[1]) number_.emplace(edge, times_.size() + number_.size());
  }

  // One line for each event: what it is, when, and what the components that end there began with.
  std::multiset<std::string> lines() const {
    const std::set<double> moments(times_.begin(), times_.end());
    std::multiset<std::string> lines;
    std::map<std::uint64_t, std::string> origin_before; // of each component just before the moment
    std::optional<Slices> before;
    for (auto moment = moments.begin(); moment != moments.end(); ++moment) {
      std::optional<Slices> after;
      if (std::next(moment) != moments.end())
        after.emplace(complex_, *moment, *std::next(moment), [&](auto vertex) { return on_layer(vertex); });
      std::map<std::uint64_t, std::string> origin_after;
      for (const auto& [root, node] : nodes_at(*moment, before, after)) {
        if (node.in.size() + node.out.size() == 0) continue;
        const Piece change = change_at(node, before, after);
        const std::string type = type_of(node, change, *moment);
        if (type.empty()) {
          origin_after[*node.out.begin()] = origin_before.at(*node.in.begin());
          continue;
        }
        char event[80];
        std::snprintf(event, sizeof event, "%s %.9f %+d", type.c_str(), *moment,
                      type.starts_with("open") ? 0 : static_cast<int>(change.euler));
        for (const auto component : node.out) origin_after[component] = event;
        std::multiset<std::string> origins;
        for (const auto component : node.in) origins.insert(origin_before.at(component));
        std::string line = event + (" out " + std::to_string(node.out.size())) + " in";
        for (const auto& origin : origins) line += " (" + origin + ")";
        lines.insert(line);
      }
      origin_before = std::move(origin_after);
      before = std::move(after);
    }
    return lines;
  }

 private:
  // A component of the closed level, and those of the slices before and after that it belongs to.
  struct Node {
    std::set<std::uint64_t> in, out;
    bool all_on_wall = true;
  };

  static std::vector<double> times_of(const Mesh& mesh) {
    std::vector<double> times;
    for (std::size_t vertex = 0; vertex < mesh.vertex_count(); ++vertex)
      times.push_back(mesh.positions[vertex * D + D - 1]);
    return times;
  }
  bool on_layer(std::uint64_t vertex) const { return times_[vertex] == 0 || times_[vertex] == last_step_; }
  bool on_wall(std::uint64_t vertex) const {
    for (std::size_t axis = 0; axis + 1 < D; ++axis)
      if (const double x = mesh_.positions[vertex * D + axis];
          x == 0 || x == static_cast<double>(dims_[axis] - 1))
        return true;
    return false;
  }

  // By their roots. Points of the level are vertices at the moment and pieces of edges that cross it.
  std::map<std::uint64_t, Node> nodes_at(double moment, const std::optional<Slices>& before,
                                         const std::optional<Slices>& after) const {
    UnionFind level(times_.size() + number_.size());
    std::vector<bool> present(times_.size());
    for (const auto& simplex : complex_.faces.back()) {
      std::vector<std::uint64_t> points;
      for (std::size_t i = 0; i < simplex.size(); ++i) {
        if (times_[simplex[i]] == moment) {
          points.push_back(simplex[i]);
          present[simplex[i]] = true;
        }
        for (std::size_t j = i + 1; j < simplex.size(); ++j)
          if (const auto [first, last] = complex_.range({simplex[i], simplex[j]});
              first < moment && last > moment)
            points.push_back(number_.at({simplex[i], simplex[j]}));
      }
      for (const auto point : points) level.unite(points[0], point);
    }

    std::map<std::uint64_t, Node> nodes;
    for (std::uint64_t vertex = 0; vertex < times_.size(); ++vertex)
      if (present[vertex]) nodes[level.find(vertex)].all_on_wall &= on_wall(vertex);
    const auto attach = [&](const std::optional<Slices>& slices, auto member) {
      if (!slices) return;
      for (const auto& [edge, component] : slices->component) {
        const auto point = times_[edge[0]] == moment   ? edge[0]
                           : times_[edge[1]] == moment ? edge[1]
                                                       : number_.at(edge);
        (nodes[level.find(point)].*member).insert(component);
      }
    };
    attach(before, &Node::in);
    attach(after, &Node::out);
    return nodes;
  }

  static Piece change_at(const Node& node, const std::optional<Slices>& before,
                         const std::optional<Slices>& after) {
    Piece change;
    for (const auto component : node.out)
      change.euler += after->pieces.at(component).euler, change.rims += after->pieces.at(component).rims;
    for (const auto component : node.in)
      change.euler -= before->pieces.at(component).euler, change.rims -= before->pieces.at(component).rims;
    return change;
  }

  // Empty where nothing happens.
  std::string type_of(const Node& node, const Piece& change, double moment) const {
    const auto m = node.in.size(), n = node.out.size();
    if (moment == 0) return "open_start";
    if (moment == last_step_) return "open_end";
    if (m == 0 && n == 1) return node.all_on_wall ? "enter" : "birth";
    if (m == 1 && n == 0) return node.all_on_wall ? "exit" : "death";
    if (m != 1 || n != 1) return n == 1 ? "merge" : m == 1 ? "split" : "compound";
    if ((D == 4 || complex_.region) && change.euler + change.rims != 0) return "genus";
    return change.euler != 0 || (D == 4 && change.rims != 0) ? "touch" : "";
  }

  const Mesh& mesh_;
  const std::array<std::int64_t, D> dims_;
  const std::vector<double> times_;
  const Complex complex_;
  const double last_step_;
  std::map<Complex::Corners, std::uint64_t> number_; // of each edge, behind those of the vertices
};

template <class T, int D>
std::multiset<std::string> brute_force_history(const FieldView<const T, D>& field,
                                               const ExtractOptions& extraction) {
  ExtractOptions options = extraction;
  options.precision = Precision::f64;
  return History<D>(*extract(field, 0, options), field.dims()).lines();
}

std::multiset<std::string> tracked_history(const TrackingGraph& graph) {
  std::vector<std::string> lines;
  for (const auto& event : graph.events) {
    char line[80];
    std::snprintf(line, sizeof line, "%s %.9f %+d", name_of(event.type), event.time,
                  static_cast<int>(event.delta_euler));
    lines.push_back(line);
  }
  std::multiset<std::string> history;
  for (std::size_t i = 0; i < lines.size(); ++i) {
    std::multiset<std::string> origins;
    for (const auto arc : graph.events[i].arcs_in)
      origins.insert(lines[static_cast<std::size_t>(graph.arcs[static_cast<std::size_t>(arc)].start_event)]);
    std::string text = lines[i] + " out " + std::to_string(graph.events[i].arcs_out.size()) + " in";
    for (const auto& origin : origins) text += " (" + origin + ")";
    history.insert(text);
  }
  return history;
}

template <int D>
void compare(const check::OwnedField<float, D>& field, const ExtractOptions& extraction) {
  TrackOptions options;
  options.extraction = extraction;
  EXPECT_EQ(tracked_history(track_field(time_field<float, D>(field), 0, options)),
            (brute_force_history<float, D>(field.view, extraction)));
}
template <int D>
void compare(const std::array<std::int64_t, D>& dims, int range, unsigned seed, Inside inside = Inside::above,
             Method method = Method::hull) {
  SCOPED_TRACE("seed " + std::to_string(seed) + ", samples up to " + std::to_string(range));
  ExtractOptions extraction;
  extraction.inside = inside;
  extraction.method = method;
  compare<D>(check::random_field<float, D>(dims, range, seed), extraction);
}
// Waves, rounded to whole numbers: components of many vertices at a step, with ties at a part of them.
template <int D>
check::OwnedField<float, D> waves(const std::array<std::int64_t, D>& dims, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> number(-1, 1);
  std::array<std::array<double, D + 1>, 6> waves;
  for (auto& wave : waves)
    for (double& entry : wave) entry = number(random);
  const double height = 1 + 4 * std::abs(number(random));
  return check::make_field<float, D>(unit_grid<D>(dims), [&](const auto& index) {
    double sum = 0;
    for (const auto& wave : waves) {
      double phase = 5 * wave[D];
      for (std::size_t axis = 0; axis < D; ++axis)
        phase += 1.6 * wave[axis] * static_cast<double>(index[axis]);
      sum += std::cos(phase);
    }
    return std::round(height * sum);
  });
}

TEST(TrackBruteForce, ties_everywhere_in_2d) {
  for (unsigned seed = 0; seed < 150; ++seed) compare<3>({4, 3, 4}, 1, seed);
}
TEST(TrackBruteForce, equal_times_in_2d) {
  for (unsigned seed = 0; seed < 150; ++seed) compare<3>({4, 4, 4}, 3, seed);
}
TEST(TrackBruteForce, single_events_in_2d) {
  for (unsigned seed = 0; seed < 100; ++seed) compare<3>({5, 4, 3}, 100000, seed, Inside::below);
}
TEST(TrackBruteForce, ties_everywhere_in_3d) {
  for (unsigned seed = 0; seed < 40; ++seed) compare<4>({3, 3, 3, 3}, 1, seed);
}
TEST(TrackBruteForce, equal_times_in_3d) {
  for (unsigned seed = 0; seed < 40; ++seed) compare<4>({3, 3, 3, 3}, 3, seed);
}
TEST(TrackBruteForce, single_events_in_3d) {
  for (unsigned seed = 0; seed < 12; ++seed) compare<4>({3, 4, 3, 3}, 100000, seed, Inside::below);
}

// Ties that change nothing beside some that do.
TEST(TrackBruteForce, smooth_fields_with_ties_in_2d) {
  for (const Method method : {Method::hull, Method::simplicial})
    for (unsigned seed = 0; seed < 40; ++seed) {
      SCOPED_TRACE(seed);
      ExtractOptions extraction;
      extraction.method = method;
      compare<3>(waves<3>({6, 5, 5}, seed), extraction);
    }
}
// In the last three curves on walls pass close to ties that are not theirs.
TEST(TrackBruteForce, smooth_fields_with_ties_in_3d) {
  for (const Method method : {Method::hull, Method::simplicial})
    for (const unsigned seed : {0u, 59u, 63u, 111u}) {
      SCOPED_TRACE(seed);
      ExtractOptions extraction;
      extraction.method = method;
      compare<4>(waves<4>({5, 5, 4, 3}, seed), extraction);
    }
}

TEST(TrackBruteForce, simplicial) {
  for (unsigned seed = 0; seed < 60; ++seed)
    compare<3>({4, 3, 3}, seed % 2 == 0 ? 1 : 5, seed, Inside::above, Method::simplicial);
  for (unsigned seed = 0; seed < 8; ++seed)
    compare<4>({3, 2, 3, 3}, seed % 2 == 0 ? 1 : 5, seed, Inside::above, Method::simplicial);
}
// The region is that of the interval volume up to a level that no sample reaches: with `simplicial` a mesh
// other than the one that is tracked, of the same set.
template <int D>
void compare_region(const std::array<std::int64_t, D>& dims, int range, unsigned seed, Method method,
                    std::optional<double> upper = {}, int missing = 0) {
  auto field = check::random_field<float, D>(dims, range, seed);
  std::mt19937 random(seed);
  for (int i = 0; i < missing; ++i) field.samples[random() % field.samples.size()] = std::nanf("");
  TrackOptions options;
  options.tracked = Tracked::region;
  options.extraction.method = method;
  options.upper_isovalue = upper;
  IntervalOptions volume;
  volume.method = method;
  volume.precision = Precision::f64;
  const auto mesh = interval(field.view, 0, upper.value_or(2 * range + 0.7), volume);
  EXPECT_EQ(tracked_history(track_field(time_field<float, D>(field), 0, options)),
            History<D>(*mesh, field.view.dims()).lines())
      << "seed " << seed << ", samples up to " << range;
}

TEST(TrackBruteForce, regions_in_2d) {
  for (const Method method : {Method::hull, Method::simplicial})
    for (const int range : {1, 3, 100000})
      for (unsigned seed = 0; seed < 12; ++seed) compare_region<3>({4, 3, 4}, range, seed, method);
}
TEST(TrackBruteForce, regions_between_two_isovalues_in_2d) {
  for (const Method method : {Method::hull, Method::simplicial})
    for (unsigned seed = 0; seed < 15; ++seed) {
      compare_region<3>({4, 3, 3}, 2, seed, method, 1);
      compare_region<3>({4, 3, 3}, 1000, seed, method, 300);
    }
}
TEST(TrackBruteForce, regions_in_3d) {
  for (unsigned seed = 0; seed < 6; ++seed)
    for (const int range : {1, 3, 1000}) {
      compare_region<4>({3, 2, 3, 3}, range, seed, Method::hull);
      if (seed < 2) compare_region<4>({2, 2, 3, 2}, range, seed, Method::simplicial);
    }
  compare_region<4>({3, 2, 2, 2}, 2, 1, Method::hull, 1);
}
TEST(TrackBruteForce, regions_with_missing_samples) {
  for (unsigned seed = 0; seed < 40; ++seed) compare_region<3>({5, 4, 4}, 4, seed, Method::hull, {}, 4);
}
// Holes in the data end components as walls do.
TEST(TrackBruteForce, with_missing_samples) {
  for (unsigned seed = 0; seed < 60; ++seed) {
    auto field = check::random_field<float, 3>({5, 5, 4}, 4, seed);
    std::mt19937 random(seed);
    for (int i = 0; i < 4; ++i) field.samples[random() % field.samples.size()] = std::nanf("");
    const auto graph = track_field(time_field<float, 3>(field), 0);
    const auto expected = brute_force_history<float, 3>(field.view, {});
    EXPECT_EQ(tracked_history(graph), expected) << "seed " << seed;
  }
}

} // namespace
} // namespace hyperiso
