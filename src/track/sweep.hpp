#pragma once
// From one step to the next: the components between them and what happens to them on the way.

#include "core/union_find.hpp"
#include "track/graph_builder.hpp"
#include "track/link_test.hpp"
#include "track/slice_search.hpp"

#include <map>
#include <optional>
#include <set>

namespace hyperiso::track_detail {

// A strand is a component of the slices, followed through the slab; every simplex that the current slice
// meets is labelled with the strand it belongs to. Merging strands unites their labels; a strand that splits
// has all pieces but the largest relabelled.
template <int C>
class Sweep {
 public:
  Sweep(Slab<C> slab_, double lower_time, double upper_time)
      : slab(std::move(slab_)), lower_time_(lower_time), upper_time_(upper_time), strands_(slab.times.size()),
        labels_(slab.simplex_count()), link_(slab.times.size()) {
    if (!plain_below()) part_ways_at_lower_step();
    unite_at_lower_step();
  }

  Slab<C> slab;

  // Whether the slices at the lower (upper) step and next to it are alike: then each vertex there has one
  // strand.
  bool plain_below() const { return !slab.has_missing && !slab.ties_below; }
  bool plain_above() const { return !slab.has_missing && !slab.ties_above; }

  // Requires plain_below() and a vertex at the lower step.
  std::uint64_t strand_at_lower_step(Vertex vertex) { return strands_.find(vertex); }
  std::uint64_t strand_count() const { return strands_.size(); }
  std::uint64_t strand_of(SimplexNumber simplex) { return strands_.find(labels_[simplex]); }
  std::int64_t arc_of(std::uint64_t strand) const { return arcs_.at(strand); }
  void set_arc(std::uint64_t strand, std::int64_t arc) { arcs_[strand] = arc; }

  // Goes through the inside of the slab. Requires an arc for each strand at the lower step.
  void run(GraphBuilder& graph) {
    std::vector<std::pair<double, Vertex>> by_time;
    for (Vertex vertex = 0; vertex < slab.times.size(); ++vertex)
      if (slab.times[vertex] > 0 && slab.times[vertex] < 1) by_time.emplace_back(slab.times[vertex], vertex);
    std::ranges::sort(by_time);
    std::vector<Vertex> inner;
    for (const auto& [time, vertex] : by_time) inner.push_back(vertex);
    for (std::size_t begin = 0; begin < inner.size();) {
      std::size_t end = begin + 1;
      while (end < inner.size() && slab.times[inner[end]] == slab.times[inner[begin]]) ++end;
      pass_moment(std::span(inner).subspan(begin, end - begin), graph);
      begin = end;
    }
  }

 private:
  // Vertices with equal time joined by edges, and the slices around them.
  struct Cluster {
    std::vector<Vertex> vertices;
    std::vector<SimplexNumber> star; // all simplices with a corner in it, ascending
    Side before, after;

    bool regular() const {
      return before.components.size() == 1 && after.components.size() == 1 && before.euler == after.euler;
    }
  };

  // Just after the lower step, simplices belong together that share an edge from a vertex there to one above.
  // The strand of a vertex has its number; where its edges fall into several pieces, the others get new ones.
  void part_ways_at_lower_step() {
    for (Vertex vertex = 0; vertex < slab.times.size(); ++vertex) {
      if (slab.times[vertex] != 0) continue;
      const Side after = sides_.find(slab, slab.stars.of(vertex), 0, Direction::after,
                                     [&](Vertex other) { return other == vertex; });
      for (std::size_t piece = 1; piece < after.components.size(); ++piece) {
        const std::uint64_t strand = strands_.add();
        for (const SimplexNumber simplex : after.components[piece]) parted_[{vertex, simplex}] = strand;
      }
    }
  }

  void unite_at_lower_step() {
    for (SimplexNumber simplex = 0; simplex < labels_.size(); ++simplex) {
      const auto corners = slab.simplex(simplex);
      if (std::all_of(corners.begin(), corners.end(), [&](Vertex v) { return slab.times[v] == 0; })) continue;
      std::optional<std::uint64_t> first;
      for (const Vertex vertex : corners) {
        if (slab.times[vertex] != 0) continue;
        std::uint64_t strand = vertex;
        if (!parted_.empty())
          if (const auto parted = parted_.find({vertex, simplex}); parted != parted_.end())
            strand = parted->second;
        if (first)
          strands_.unite(*first, strand);
        else
          first = strand;
      }
      if (first) labels_[simplex] = static_cast<SimplexNumber>(*first);
    }
  }

  void pass_moment(std::span<const Vertex> vertices, GraphBuilder& graph) {
    const double moment = slab.times[vertices[0]];
    std::vector<Vertex> others;
    for (const Vertex vertex : vertices)
      if (link_.is_regular(slab, vertex))
        pass_regular(vertex);
      else
        others.push_back(vertex);
    if (others.empty()) return;
    std::vector<Cluster> critical;
    for (Cluster& cluster : clusters(others)) {
      describe(cluster, moment);
      if (cluster.regular())
        label(cluster.after.components[0], strand_of(cluster.before.components[0][0]));
      else
        critical.push_back(std::move(cluster));
    }
    for (const auto& level_component : level_components(critical))
      pass_node(level_component, critical, moment, graph);
  }

  // What begins at a regular vertex belongs to what ends there.
  void pass_regular(Vertex vertex) {
    std::optional<std::uint64_t> strand;
    const auto is_new = [&](SimplexNumber simplex) {
      const auto corners = slab.simplex(simplex);
      return std::none_of(corners.begin(), corners.end(),
                          [&](Vertex v) { return slab.times[v] < slab.times[vertex]; });
    };
    for (const SimplexNumber simplex : slab.stars.of(vertex))
      if (!is_new(simplex)) {
        strand = strand_of(simplex);
        break;
      }
    for (const SimplexNumber simplex : slab.stars.of(vertex))
      if (is_new(simplex)) labels_[simplex] = static_cast<SimplexNumber>(*strand);
  }

  std::vector<Cluster> clusters(std::span<const Vertex> vertices) const {
    std::vector<Cluster> result;
    std::set<Vertex> seen;
    for (const Vertex vertex : vertices) {
      if (!seen.insert(vertex).second) continue;
      std::vector<Vertex>& cluster = result.emplace_back().vertices;
      cluster.push_back(vertex);
      for (std::size_t next = 0; next < cluster.size(); ++next)
        for (const SimplexNumber simplex : slab.stars.of(cluster[next]))
          for (const Vertex other : slab.simplex(simplex))
            if (slab.times[other] == slab.times[vertex] && seen.insert(other).second)
              cluster.push_back(other);
    }
    return result;
  }

  void describe(Cluster& cluster, double moment) {
    for (const Vertex vertex : cluster.vertices) {
      const auto star = slab.stars.of(vertex);
      cluster.star.insert(cluster.star.end(), star.begin(), star.end());
    }
    if (cluster.vertices.size() > 1) {
      std::ranges::sort(cluster.star);
      cluster.star.erase(std::unique(cluster.star.begin(), cluster.star.end()), cluster.star.end());
    }
    const auto contains = [](Vertex) { return true; }; // what has this time next to the cluster is part of it
    cluster.before = sides_.find(slab, cluster.star, moment, Direction::before, contains);
    cluster.after = sides_.find(slab, cluster.star, moment, Direction::after, contains);
  }

  // Critical clusters that strands just before connect: numbers in `critical`.
  std::vector<std::vector<std::size_t>> level_components(const std::vector<Cluster>& critical) {
    UnionFind united(critical.size());
    std::map<std::uint64_t, std::size_t> cluster_of_strand;
    for (std::size_t cluster = 0; cluster < critical.size(); ++cluster)
      for (const auto& component : critical[cluster].before.components)
        united.unite(cluster, cluster_of_strand.try_emplace(strand_of(component[0]), cluster).first->second);
    std::map<std::uint64_t, std::vector<std::size_t>> components;
    for (std::size_t cluster = 0; cluster < critical.size(); ++cluster)
      components[united.find(cluster)].push_back(cluster);
    std::vector<std::vector<std::size_t>> result;
    for (auto& [root, component] : components) result.push_back(std::move(component));
    return result;
  }

  void pass_node(const std::vector<std::size_t>& level_component, const std::vector<Cluster>& critical,
                 double moment, GraphBuilder& graph) {
    std::set<std::uint64_t> before;
    std::vector<std::vector<SimplexNumber>> seeds;
    ChangeWithin change;
    PlaceSum place_of_clusters, place_of_vertices;
    for (const std::size_t number : level_component) {
      const Cluster& cluster = critical[number];
      for (const auto& component : cluster.before.components) before.insert(strand_of(component[0]));
      seeds.insert(seeds.end(), cluster.after.components.begin(), cluster.after.components.end());
      change.euler += cluster.after.euler - cluster.before.euler;
      PlaceSum place;
      for (const Vertex vertex : cluster.vertices) place.add(slab.place(slab.edges[vertex]));
      place_of_clusters.add({place.mean(), place.all_on_wall()});
    }
    const auto pieces = search_.find({slab, moment, Direction::after}, seeds);
    if (before.size() == 1 && pieces.size() == 1)
      change.rims = change_of_rims(level_component, critical, moment);

    std::vector<std::int64_t> arcs_before;
    for (const std::uint64_t strand : before) arcs_before.push_back(arc_of(strand));
    std::ranges::sort(arcs_before);
    const std::vector<std::uint64_t> after = relabel(pieces, before);

    const auto type =
        type_of_node(before.size(), after.size(), place_of_clusters.all_on_wall(), change, C == 4);
    if (!type) {
      for (const std::uint64_t strand : after) set_arc(strand, arcs_before[0]);
      return;
    }
    TrackingEvent& event = graph.add_event(*type, lower_time_ + moment * (upper_time_ - lower_time_),
                                           std::move(arcs_before), after.size());
    event.position = place_of_clusters.mean();
    event.delta_euler = change.euler;
    for (std::size_t piece = 0; piece < after.size(); ++piece) set_arc(after[piece], event.arcs_out[piece]);
  }

  // One strand for each piece. What was not searched to its end keeps the labels it has, united.
  std::vector<std::uint64_t> relabel(const std::vector<typename PieceSearch<C>::Piece>& pieces,
                                     const std::set<std::uint64_t>& before) {
    std::vector<std::uint64_t> after;
    for (const auto& piece : pieces) {
      std::uint64_t strand = 0;
      if (piece.finished || before.empty()) {
        strand = strands_.add();
      } else {
        for (const std::uint64_t other : before) strands_.unite(*before.begin(), other);
        strand = strands_.find(*before.begin());
      }
      label(piece.simplices, strand);
      after.push_back(strand);
    }
    return after;
  }

  void label(const std::vector<SimplexNumber>& simplices, std::uint64_t strand) {
    for (const SimplexNumber simplex : simplices) labels_[simplex] = static_cast<SimplexNumber>(strand);
  }

  std::int64_t change_of_rims(const std::vector<std::size_t>& level_component,
                              const std::vector<Cluster>& critical, double moment) const {
    if constexpr (C == 4) {
      std::vector<SimplexNumber> before, after;
      for (const std::size_t number : level_component) {
        for (const auto& component : critical[number].before.components)
          before.insert(before.end(), component.begin(), component.end());
        for (const auto& component : critical[number].after.components)
          after.insert(after.end(), component.begin(), component.end());
      }
      return RimCounter::count({slab, moment, Direction::after}, after) -
             RimCounter::count({slab, moment, Direction::before}, before);
    } else {
      return 0;
    }
  }

  double lower_time_, upper_time_;
  UnionFind strands_;
  std::vector<SimplexNumber> labels_;
  std::map<std::pair<Vertex, SimplexNumber>, std::uint64_t> parted_; // at the lower step
  std::map<std::uint64_t, std::int64_t> arcs_;
  SideFinder<C> sides_;
  PieceSearch<C> search_;
  LinkTest<C> link_;
};

} // namespace hyperiso::track_detail
