#pragma once
// From one step to the next: the components between them and what happens to them on the way.

#include "core/union_find.hpp"
#include "track/graph_builder.hpp"
#include "track/link_test.hpp"
#include "track/slice_search.hpp"
#include "track/step_pieces.hpp"

#include <map>
#include <optional>
#include <set>
#include <unordered_map>

namespace hyperiso::track_detail {

// A strand is a component of the slices, followed through the slab. Merging strands unites them; of a strand
// that splits, all pieces but the largest get new ones. Only the simplices around events are labelled with
// their strands, from the moment of the event on: others are on the strand of what they come from, found by
// going down along the surface to such a label or to the lower step.
template <int C>
class Sweep {
 public:
  using Candidates = std::vector<GridEdge>; // of the vertices strictly inside at which something may happen

  // A slab that was handed over whole. `candidates`: if they are known.
  Sweep(Slab<C> slab_, double lower_time, double upper_time, std::optional<Candidates> candidates = {})
      : slab(std::move(slab_)), lower_time_(lower_time), upper_time_(upper_time),
        candidates_(std::move(candidates)), strands_(slab.vertex_count()) {
    if (!plain_below()) part_ways_at_lower_step();
    unite_at_lower_step();
  }
  // One that unfolds. `pieces`: of the surface at the lower step, each a strand.
  Sweep(Slab<C> slab_, double lower_time, double upper_time, std::shared_ptr<const StepPieces> pieces,
        Candidates candidates)
      : slab(std::move(slab_)), lower_time_(lower_time), upper_time_(upper_time), pieces_(std::move(pieces)),
        candidates_(std::move(candidates)), strands_(pieces_->count()) {}

  Slab<C> slab;

  // Whether the slices at the lower (upper) step and next to it are alike: then each vertex there has one
  // strand.
  bool plain_below() const { return !slab.has_missing && !slab.ties_below; }
  bool plain_above() const { return !slab.has_missing && !slab.ties_above; }

  // Requires plain_below() and a vertex on an edge within the lower step.
  std::uint64_t strand_at_lower_step(Vertex vertex) {
    return strands_.find(pieces_ ? pieces_->piece_at(slab.edge(vertex)) : vertex);
  }
  std::uint64_t strand_count() const { return strands_.size(); }
  std::int64_t arc_of(std::uint64_t strand) const { return arcs_.at(strand); }
  void set_arc(std::uint64_t strand, std::int64_t arc) { arcs_[strand] = arc; }

  // Of what a simplex has just before `moment`. Requires that it has something there and that all is passed
  // that comes before.
  std::uint64_t strand_of(SimplexNumber simplex, double moment) {
    way_.clear();
    std::uint64_t strand = 0;
    for (;;) {
      if (const auto label = label_before(simplex, moment)) {
        strand = *label;
        break;
      }
      const Vertex lowest = lowest_corner(simplex);
      if (slab.time(lowest) == 0) {
        strand = strand_at_bottom(simplex, lowest);
        break;
      }
      if (below_.size() <= lowest) below_.resize(2 * slab.vertex_count(), no_strand);
      if (below_[lowest] != no_strand) {
        strand = below_[lowest];
        break;
      }
      way_.push_back(lowest);
      moment = slab.time(lowest);
      simplex = simplex_before(lowest);
    }
    for (const Vertex vertex : way_) below_[vertex] = static_cast<std::uint32_t>(strand);
    return strands_.find(strand);
  }
  // At the upper step.
  std::uint64_t strand_below(Vertex vertex) { return strand_of(simplex_before(vertex), slab.time(vertex)); }

  // The number of boundary curves of the slice just before or just after a moment that pass a triangle of one
  // of the simplices, all of which meet it, with a corner that `is_wanted`.
  template <class IsWanted>
  std::int64_t count_rims(std::span<const SimplexNumber> simplices, double moment, Direction direction,
                          IsWanted&& is_wanted) requires(C == 4) {
    const PartsOfRims rims{{slab, moment, direction}};
    std::vector<std::vector<std::uint32_t>> seeds;
    for (const SimplexNumber simplex : simplices)
      rims.for_each_part(simplex, [&](std::uint32_t part) {
        if (std::ranges::any_of(rims.triangle(part), is_wanted)) seeds.push_back({part});
      });
    return seeds.empty() ? 0 : std::ssize(rim_search_.find(rims, seeds));
  }

  // Goes through the inside of the slab. Requires an arc for each strand at the lower step.
  void run(GraphBuilder& graph) {
    std::vector<Vertex> vertices = inner_vertices();
    std::size_t looked_at = 0;
    std::erase_if(vertices, [&](Vertex vertex) {
      if (++looked_at % 4096 == 0) graph.tell_progress(lower_time_);
      return link_.is_regular(slab, vertex);
    });
    std::ranges::sort(vertices, [&](Vertex a, Vertex b) { return slab.is_earlier(a, b); });
    for (std::size_t begin = 0; begin < vertices.size();) {
      std::size_t end = begin + 1;
      while (end < vertices.size() && slab.time(vertices[end]) == slab.time(vertices[begin])) ++end;
      pass_moment(std::span(vertices).subspan(begin, end - begin), graph);
      begin = end;
    }
  }

 private:
  // Vertices with equal time joined by edges, and the slices around them.
  struct Cluster {
    std::vector<Vertex> vertices;
    std::vector<SimplexNumber> star; // all simplices with a corner in it, in the order of their cells
    Side before, after;

    bool regular() const {
      return before.components.size() == 1 && after.components.size() == 1 && before.euler == after.euler;
    }
  };

  // Just after the lower step, simplices belong together that share an edge from a vertex there to one above.
  // The strand of a vertex has its number; where its edges fall into several pieces, the others get new ones.
  void part_ways_at_lower_step() {
    has_parted_.resize(slab.vertex_count());
    const std::vector<bool> may_part = vertices_next_to_ties_below();
    for (Vertex vertex = 0; vertex < slab.vertex_count(); ++vertex) {
      if (!may_part[vertex] || link_.is_in_one_piece_after(slab, vertex)) continue;
      has_parted_[vertex] = true;
      const Side after = sides_.find(slab, slab.star(vertex), 0, Direction::after,
                                     [&](Vertex other) { return other == vertex; });
      for (std::size_t piece = 1; piece < after.components.size(); ++piece) {
        const std::uint64_t strand = strands_.add();
        for (const SimplexNumber simplex : after.components[piece]) parted_[{vertex, simplex}] = strand;
      }
    }
  }

  // Those at the lower step that share a simplex with one there on no edge within it; elsewhere the step has
  // nothing of M but its own surface. With missing samples all that are at the step.
  std::vector<bool> vertices_next_to_ties_below() const {
    std::vector<bool> result(slab.vertex_count());
    const auto is_at_step = [&](Vertex vertex) { return slab.time(vertex) == 0; };
    for (SimplexNumber simplex = 0; simplex < slab.simplex_count(); ++simplex) {
      const auto corners = slab.simplex(simplex);
      if (slab.has_missing || std::any_of(corners.begin(), corners.end(), [&](Vertex vertex) {
            return is_at_step(vertex) && !slab.in_step(vertex);
          }))
        for (const Vertex vertex : corners) result[vertex] = result[vertex] || is_at_step(vertex);
    }
    return result;
  }

  void unite_at_lower_step() {
    for (SimplexNumber simplex = 0; simplex < slab.simplex_count(); ++simplex) {
      const auto corners = slab.simplex(simplex);
      if (std::all_of(corners.begin(), corners.end(), [&](Vertex v) { return slab.time(v) == 0; })) continue;
      std::optional<std::uint64_t> first;
      for (const Vertex vertex : corners) {
        if (slab.time(vertex) != 0) continue;
        const std::uint64_t strand = strand_at_bottom(simplex, vertex);
        if (first)
          strands_.unite(*first, strand);
        else
          first = strand;
      }
    }
  }

  // Of a simplex with a vertex at the lower step and one above.
  std::uint64_t strand_at_bottom(SimplexNumber simplex, Vertex vertex) const {
    if (pieces_) return pieces_->piece_at(slab.edge(vertex));
    if (!has_parted_.empty() && has_parted_[vertex])
      if (const auto parted = parted_.find({vertex, simplex}); parted != parted_.end()) return parted->second;
    return vertex;
  }

  Vertex lowest_corner(SimplexNumber simplex) const {
    const auto corners = slab.simplex(simplex);
    return *std::ranges::min_element(corners, {}, [&](Vertex vertex) { return slab.time(vertex); });
  }

  // A simplex that has something just before a vertex, or before others with the same time that edges join
  // it with. Requires that there is one.
  SimplexNumber simplex_before(Vertex vertex) {
    const double time = slab.time(vertex);
    std::vector<Vertex> cluster{vertex};
    for (std::size_t next = 0;; ++next) {
      for (const SimplexNumber simplex : slab.star(cluster[next]))
        if (slab.time_range(simplex).first < time) return simplex;
      for (const SimplexNumber simplex : slab.star(cluster[next]))
        for (const Vertex other : slab.simplex(simplex))
          if (slab.time(other) == time && std::ranges::find(cluster, other) == cluster.end())
            cluster.push_back(other);
    }
  }

  // The last label that a simplex got before a moment.
  std::optional<std::uint64_t> label_before(SimplexNumber simplex, double moment) const {
    const auto found = labels_.find(simplex);
    if (found == labels_.end()) return std::nullopt;
    for (auto label = found->second.rbegin(); label != found->second.rend(); ++label)
      if (label->first < moment) return label->second;
    return std::nullopt;
  }
  void label(const std::vector<SimplexNumber>& simplices, double moment, std::uint64_t strand) {
    for (const SimplexNumber simplex : simplices) labels_[simplex].emplace_back(moment, strand);
  }

  void pass_moment(std::span<const Vertex> vertices, GraphBuilder& graph) {
    const double moment = slab.time(vertices[0]);
    std::vector<Cluster> critical;
    for (Cluster& cluster : clusters(vertices)) {
      describe(cluster, moment);
      if (!cluster.regular()) critical.push_back(std::move(cluster));
    }
    for (const auto& level_component : level_components(critical, moment))
      pass_node(level_component, critical, moment, graph);
  }

  // Those strictly inside the slab, or the candidates among them.
  std::vector<Vertex> inner_vertices() {
    std::vector<Vertex> vertices;
    const auto add = [&](Vertex vertex) {
      if (slab.time(vertex) > 0 && slab.time(vertex) < 1) vertices.push_back(vertex);
    };
    if (candidates_)
      for (const GridEdge edge : *candidates_) add(*slab.find(edge));
    else
      for (Vertex vertex = 0; vertex < slab.vertex_count(); ++vertex) add(vertex);
    return vertices;
  }

  std::vector<Cluster> clusters(std::span<const Vertex> vertices) {
    std::vector<Cluster> result;
    std::set<Vertex> seen;
    for (const Vertex vertex : vertices) {
      if (!seen.insert(vertex).second) continue;
      std::vector<Vertex>& cluster = result.emplace_back().vertices;
      cluster.push_back(vertex);
      for (std::size_t next = 0; next < cluster.size(); ++next)
        for (const SimplexNumber simplex : slab.star(cluster[next]))
          for (const Vertex other : slab.simplex(simplex))
            if (slab.time(other) == slab.time(vertex) && seen.insert(other).second) cluster.push_back(other);
      std::ranges::sort(cluster, {}, [&](Vertex v) { return slab.edge(v); });
    }
    std::ranges::sort(result, {}, [&](const Cluster& cluster) { return slab.edge(cluster.vertices[0]); });
    return result;
  }

  void describe(Cluster& cluster, double moment) {
    for (const Vertex vertex : cluster.vertices) {
      const auto star = slab.star(vertex);
      cluster.star.insert(cluster.star.end(), star.begin(), star.end());
    }
    if (cluster.vertices.size() > 1) {
      std::ranges::sort(cluster.star, [&](auto a, auto b) { return slab.comes_before(a, b); });
      cluster.star.erase(std::unique(cluster.star.begin(), cluster.star.end()), cluster.star.end());
    }
    const auto contains = [](Vertex) { return true; }; // what has this time next to the cluster is part of it
    cluster.before = sides_.find(slab, cluster.star, moment, Direction::before, contains);
    cluster.after = sides_.find(slab, cluster.star, moment, Direction::after, contains);
  }

  // Critical clusters that strands just before connect: numbers in `critical`.
  std::vector<std::vector<std::size_t>> level_components(const std::vector<Cluster>& critical,
                                                         double moment) {
    UnionFind united(critical.size());
    std::map<std::uint64_t, std::size_t> cluster_of_strand;
    for (std::size_t cluster = 0; cluster < critical.size(); ++cluster)
      for (const auto& component : critical[cluster].before.components)
        united.unite(cluster,
                     cluster_of_strand.try_emplace(strand_of(component[0], moment), cluster).first->second);
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
      for (const auto& component : cluster.before.components) before.insert(strand_of(component[0], moment));
      seeds.insert(seeds.end(), cluster.after.components.begin(), cluster.after.components.end());
      change.euler += cluster.after.euler - cluster.before.euler;
      PlaceSum place;
      for (const Vertex vertex : cluster.vertices) place.add(slab.place(slab.edge(vertex)));
      place_of_clusters.add({place.mean(), place.all_on_wall()});
    }
    const auto pieces = search_.find(PartsOfSlice<C>{{slab, moment, Direction::after}}, seeds);
    if (before.size() == 1 && pieces.size() == 1 && slab.has_rims())
      change.rims = change_of_rims(level_component, critical, moment);

    std::vector<std::int64_t> arcs_before;
    for (const std::uint64_t strand : before) arcs_before.push_back(arc_of(strand));
    std::ranges::sort(arcs_before);
    const std::vector<std::uint64_t> after = relabel(pieces, before, moment);

    const auto type =
        type_of_node(before.size(), after.size(), place_of_clusters.all_on_wall(), change, slab.has_genus());
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

  // One strand for each piece. What was not searched to its end goes on with those before, united.
  std::vector<std::uint64_t> relabel(const std::vector<PieceSearch::Piece>& pieces,
                                     const std::set<std::uint64_t>& before, double moment) {
    std::vector<std::uint64_t> after;
    for (const auto& piece : pieces) {
      std::uint64_t strand = 0;
      if (piece.finished || before.empty()) {
        strand = strands_.add();
        label(piece.parts, moment, strand);
      } else { // what it comes from leads to the strand
        for (const std::uint64_t other : before) strands_.unite(*before.begin(), other);
        strand = strands_.find(*before.begin());
      }
      after.push_back(strand);
    }
    return after;
  }

  std::int64_t change_of_rims(const std::vector<std::size_t>& level_component,
                              const std::vector<Cluster>& critical, double moment) {
    if constexpr (C == 4) {
      std::vector<SimplexNumber> before, after;
      for (const std::size_t number : level_component) {
        for (const auto& component : critical[number].before.components)
          before.insert(before.end(), component.begin(), component.end());
        for (const auto& component : critical[number].after.components)
          after.insert(after.end(), component.begin(), component.end());
      }
      const auto any = [](Vertex) { return true; };
      return count_rims(after, moment, Direction::after, any) -
             count_rims(before, moment, Direction::before, any);
    } else {
      return 0;
    }
  }

  double lower_time_, upper_time_;
  std::shared_ptr<const StepPieces> pieces_; // at the lower step, of a slab that unfolds
  std::optional<Candidates> candidates_;     // if they are known
  UnionFind strands_;
  std::unordered_map<SimplexNumber, std::vector<std::pair<double, std::uint64_t>>> labels_; // from a time on
  static constexpr std::uint32_t no_strand = UINT32_MAX;
  std::vector<std::uint32_t> below_; // strand just before each vertex, where known
  std::vector<Vertex> way_;
  std::vector<bool> has_parted_;                                     // vertices at the lower step
  std::map<std::pair<Vertex, SimplexNumber>, std::uint64_t> parted_; // the strands of their other pieces
  std::map<std::uint64_t, std::int64_t> arcs_;
  SideFinder<C> sides_;
  PieceSearch search_, rim_search_;
  LinkTest<C> link_;
};

} // namespace hyperiso::track_detail
