#pragma once
// A step, where two slabs meet: what its connected pieces are, and what happens at them.

#include "track/link_test.hpp"
#include "track/sweep.hpp"

namespace hyperiso::track_detail {

// The components of the closed level set of a step: all that M has at that time, from the slab that ends
// there (`lower`) and the one that begins there (`upper`); one of them is missing at the first and last step.
template <int C>
class Level {
 public:
  // `pieces`: of the surface at the step, if it is known.
  Level(Sweep<C>* lower, Sweep<C>* upper, std::shared_ptr<const StepPieces> pieces = {})
      : lower_(lower), upper_(upper) {
    const bool plain = (!lower_ || lower_->plain_above()) && (!upper_ || upper_->plain_below());
    if (plain && pieces) {
      pieces_ = std::move(pieces);
      follow_pieces();
    } else if (plain && upper_) {
      follow_strands();
    } else {
      find_components();
    }
    if (lower_) lower_vertices_ = vertices_of_special(lower_->slab, lower_places_);
    if (upper_) upper_vertices_ = vertices_of_special(upper_->slab, upper_places_);
  }

  bool has_genus() const { return (upper_ ? upper_ : lower_)->slab.has_genus(); }

  // What a component became: an arc that passes, or an event; neither where no track is.
  struct Outcome {
    std::int64_t arc = -1, event = -1;
    std::vector<double> middle = {}; // the mean of its vertices, where it is not the surface at the step
  };

  // Decides every component and gives the strands of the upper slab their arcs.
  void resolve(double time, GraphBuilder& graph) {
    for (std::size_t component = 0; component < outcomes_.size(); ++component)
      outcomes_[component] = resolve(component, time, graph);
  }

  const std::vector<Outcome>& outcomes() const { return outcomes_; }

  // The arcs that end at a component, or pass, as they were before it was decided; and those that leave it.
  std::vector<std::int64_t> arcs_in(std::size_t component) const {
    std::vector<std::int64_t> arcs;
    if (lower_)
      for (const std::uint64_t strand : strands_in_[component]) arcs.push_back(lower_->arc_of(strand));
    std::ranges::sort(arcs);
    return arcs;
  }
  std::vector<std::int64_t> arcs_out(std::size_t component) const {
    std::vector<std::int64_t> arcs;
    if (upper_)
      for (const std::uint64_t strand : strands_out_[component]) arcs.push_back(upper_->arc_of(strand));
    return arcs;
  }

  // Whether the components are the pieces of the surface at this step, numbered alike.
  bool components_are_pieces() const { return pieces_ != nullptr; }
  // The component of a vertex of the surface at this step, if M has it.
  std::optional<std::size_t> component_of(const StepPieces& pieces, std::size_t vertex) const {
    if (pieces_) return pieces.piece(vertex);
    return component_in_slabs(pieces.edge(vertex));
  }

 private:
  static constexpr std::uint32_t none = UINT32_MAX;

  std::optional<std::size_t> component_in_slabs(GridEdge edge) const {
    if (upper_) {
      if (const auto found = upper_->slab.find(edge)) return component_[upper_places_[*found]];
    }
    if (lower_) {
      const auto found = lower_->slab.find(edge + lower_->slab.step_offset);
      if (found && !lower_places_.empty()) return component_[lower_places_[*found]];
    }
    return std::nullopt;
  }

  // Where the slices below, at and above the step are alike: the components are the pieces of the surface,
  // which are the strands that begin here.
  void follow_pieces() {
    outcomes_.resize(pieces_->count());
    plain_.assign(pieces_->count(), lower_ && upper_);
    for (std::size_t piece = 0; piece < pieces_->count(); ++piece) {
      const GridEdge edge = pieces_->first_edge(piece);
      if (upper_) strands_out_.push_back({upper_->strand_at_lower_step(*upper_->slab.find(edge))});
      if (lower_) strands_in_.push_back({strand_below(edge)});
    }
    if (!lower_) upper_places_ = places_of_pieces(upper_->slab, 0);
    if (!upper_) lower_places_ = places_of_pieces(lower_->slab, lower_->slab.step_offset);
  }
  std::vector<std::uint32_t> places_of_pieces(Slab<C>& slab, GridEdge offset) {
    std::vector<std::uint32_t> places;
    for (std::size_t vertex = 0; vertex < pieces_->vertex_count(); ++vertex) {
      const Vertex in_slab = *slab.find(pieces_->edge(vertex) + offset);
      if (in_slab >= places.size()) places.resize(in_slab + 1, none);
      places[in_slab] = static_cast<std::uint32_t>(component_.size());
      component_.push_back(pieces_->piece(vertex));
    }
    return places;
  }
  void follow_strands() {
    Slab<C>& slab = upper_->slab;
    upper_places_.assign(slab.vertex_count(), none);
    std::vector<std::uint32_t> number(slab.vertex_count(), none); // of components by strand
    for (Vertex vertex = 0; vertex < slab.vertex_count() && slab.time(vertex) == 0; ++vertex) {
      const std::uint64_t strand = upper_->strand_at_lower_step(vertex);
      if (number[strand] == none) {
        number[strand] = static_cast<std::uint32_t>(outcomes_.size());
        outcomes_.emplace_back();
        plain_.push_back(lower_ != nullptr);
        strands_out_.push_back({strand});
        if (lower_) strands_in_.push_back({strand_below(slab.edge(vertex))});
      }
      upper_places_[vertex] = vertex;
      component_.push_back(number[strand]);
    }
  }
  std::uint64_t strand_below(GridEdge edge) {
    return lower_->strand_below(*lower_->slab.find(edge + lower_->slab.step_offset));
  }

  void find_components() {
    if (lower_) lower_->slab.unfold_all();
    if (upper_) upper_->slab.unfold_all();
    vertex_count_ = number_vertices();
    UnionFind united(vertex_count_);
    unite_across_slabs(united);
    if (lower_) unite_in(*lower_, 1.0, lower_places_, united);
    if (upper_) unite_in(*upper_, 0.0, upper_places_, united);
    number_components(united);
    find_plain();
    if (std::ranges::find(plain_, false) != plain_.end()) find_uneven();
    if (lower_) strands_in_ = strands_of(*lower_, 1.0, lower_places_);
    if (upper_) strands_out_ = strands_of(*upper_, 0.0, upper_places_);
  }

  // Gives the vertices at this step places 0, 1, ... and says how many.
  std::size_t number_vertices() {
    std::uint32_t count = 0;
    const auto number = [&](const Sweep<C>& sweep, double time, std::vector<std::uint32_t>& places) {
      std::vector<Vertex> at_step;
      for (Vertex vertex = 0; vertex < sweep.slab.vertex_count(); ++vertex)
        if (sweep.slab.time(vertex) == time) at_step.push_back(vertex);
      std::ranges::sort(at_step, {}, [&](Vertex vertex) { return sweep.slab.edge(vertex); });
      places.assign(sweep.slab.vertex_count(), none);
      for (const Vertex vertex : at_step) places[vertex] = count++;
    };
    if (upper_) number(*upper_, 0.0, upper_places_);
    if (lower_) number(*lower_, 1.0, lower_places_);
    return count;
  }

  // A vertex within the step is in both slabs, unless cells without data are on one side of it.
  void unite_across_slabs(UnionFind& united) {
    twin_.assign(vertex_count_, none);
    if (!lower_ || !upper_) return;
    Slab<C>& below = lower_->slab;
    for (Vertex vertex = 0; vertex < lower_places_.size(); ++vertex) {
      if (lower_places_[vertex] == none || !below.in_step(vertex)) continue;
      const auto other = upper_->slab.find(below.edge(vertex) - below.step_offset);
      if (!other) continue;
      united.unite(lower_places_[vertex], upper_places_[*other]);
      twin_[lower_places_[vertex]] = upper_places_[*other];
      twin_[upper_places_[*other]] = lower_places_[vertex];
    }
  }

  // Between simplices whose corners at the step are all in both slabs, none of them next to one that is not,
  // M passes straight through the step: what it has there before and after is alike, piece by piece.
  void find_uneven() {
    uneven_.assign(vertex_count_, has_missing());
    if (!may_pass_straight()) return;
    mark_next_to_unpaired(lower_->slab, 1.0, lower_places_);
    mark_next_to_unpaired(upper_->slab, 0.0, upper_places_);
    for (std::size_t place = 0; place < vertex_count_; ++place)
      if (twin_[place] != none && uneven_[place]) uneven_[twin_[place]] = true;
  }
  void mark_next_to_unpaired(const Slab<C>& slab, double time, const std::vector<std::uint32_t>& places) {
    for (SimplexNumber number = 0; number < slab.simplex_count(); ++number) {
      const auto corners = slab.simplex(number);
      const auto at_step = [&](Vertex vertex) { return slab.time(vertex) == time; };
      if (std::none_of(corners.begin(), corners.end(),
                       [&](Vertex vertex) { return at_step(vertex) && twin_[places[vertex]] == none; }))
        continue;
      for (const Vertex vertex : corners)
        if (at_step(vertex)) uneven_[places[vertex]] = true;
    }
  }
  bool has_missing() const {
    return (lower_ && lower_->slab.has_missing) || (upper_ && upper_->slab.has_missing);
  }

  // Not at the first and last step, nor beside missing samples.
  bool may_pass_straight() const { return lower_ && upper_ && !has_missing(); }

  static void unite_in(const Sweep<C>& sweep, double time, const std::vector<std::uint32_t>& places,
                       UnionFind& united) {
    for (SimplexNumber number = 0; number < sweep.slab.simplex_count(); ++number) {
      std::uint32_t first = none;
      for (const Vertex vertex : sweep.slab.simplex(number)) {
        if (sweep.slab.time(vertex) != time) continue;
        if (first == none)
          first = places[vertex];
        else
          united.unite(first, places[vertex]);
      }
    }
  }

  void number_components(UnionFind& united) {
    component_.resize(vertex_count_);
    for (std::size_t place = 0; place < component_.size(); ++place) {
      const std::uint64_t root = united.find(place);
      if (root == place) {
        component_[place] = outcomes_.size();
        outcomes_.emplace_back();
        plain_.push_back(may_pass_straight());
      } else {
        component_[place] = component_[root];
      }
    }
  }

  // The vertices that only one slab has, passed one after the other in the order of time, those of the
  // surface at the step in between: a component where nothing happens at any of them is plain.
  void find_plain() {
    if (!may_pass_straight()) return;
    const auto check = [&](Slab<C>& slab, const std::vector<std::uint32_t>& places) {
      LinkTest<C> link;
      for (Vertex vertex = 0; vertex < places.size(); ++vertex) {
        const std::uint32_t place = places[vertex];
        if (place == none || twin_[place] != none || !plain_[component_[place]]) continue;
        plain_[component_[place]] = link.is_regular(slab, vertex);
      }
    };
    check(lower_->slab, lower_places_);
    check(upper_->slab, upper_places_);
  }

  std::vector<std::vector<Vertex>> vertices_of_special(const Slab<C>& slab,
                                                       const std::vector<std::uint32_t>& places) const {
    std::vector<std::vector<Vertex>> vertices(outcomes_.size());
    for (Vertex vertex = 0; vertex < places.size(); ++vertex)
      if (places[vertex] != none && !plain_[component_[places[vertex]]])
        vertices[component_[places[vertex]]].push_back(vertex);
    for (auto& list : vertices) std::ranges::sort(list, {}, [&](Vertex vertex) { return slab.edge(vertex); });
    return vertices;
  }

  // The strands that reach each component, ascending: of one where nothing happens there is one.
  std::vector<std::vector<std::uint64_t>> strands_of(Sweep<C>& sweep, double time,
                                                     const std::vector<std::uint32_t>& places) {
    std::vector<std::vector<std::uint64_t>> strands(outcomes_.size());
    std::vector<bool> seen(sweep.strand_count());
    for (SimplexNumber number = 0; number < sweep.slab.simplex_count(); ++number) {
      const auto [first, last] = sweep.slab.time_range(number);
      if (first == last || (time == 0 ? first : last) != time) continue;
      const auto corners = sweep.slab.simplex(number);
      const auto time_of = [&](Vertex vertex) { return sweep.slab.time(vertex); };
      const Vertex at_step = time == 0 ? *std::ranges::min_element(corners, {}, time_of)
                                       : *std::ranges::max_element(corners, {}, time_of);
      const std::size_t component = component_[places[at_step]];
      if (plain_[component] && !strands[component].empty()) continue;
      const std::uint64_t strand = sweep.strand_of(number, time == 0 ? last : time);
      if (seen[strand]) continue;
      seen[strand] = true;
      strands[component].push_back(strand);
    }
    for (auto& list : strands) std::ranges::sort(list);
    return strands;
  }

  Outcome resolve(std::size_t component, double time, GraphBuilder& graph) {
    std::vector<std::int64_t> in = arcs_in(component);
    const std::vector<std::uint64_t> out = upper_ ? strands_out_[component] : std::vector<std::uint64_t>{};

    const bool passes = plain_[component] && in.size() == 1 && out.size() == 1;
    if ((in.empty() && out.empty()) || passes) {
      for (const std::uint64_t strand : out) upper_->set_arc(strand, in[0]);
      return passes ? Outcome{in[0], -1} : Outcome{};
    }
    const Surroundings around(*this, component);
    std::optional<EventType> type = !lower_   ? EventType::open_start
                                    : !upper_ ? EventType::open_end
                                              : std::optional<EventType>();
    ChangeWithin change;
    if (!type) {
      change = around.change(in.size() == 1 && out.size() == 1);
      const bool on_wall = (in.empty() || out.empty()) && around.all_places().all_on_wall();
      type = type_of_node(in.size(), out.size(), on_wall, change, has_genus());
    }
    Outcome outcome;
    if (!around.has_surface_at_step()) outcome.middle = around.all_places().mean();
    if (!type) {
      upper_->set_arc(out[0], in[0]);
      outcome.arc = in[0];
      return outcome;
    }
    const bool whole = !lower_ || !upper_ || in.empty() || out.empty();
    TrackingEvent& event = graph.add_event(*type, time, std::move(in), out.size());
    event.position = whole ? around.all_places().mean() : around.critical_position();
    event.delta_euler = change.euler;
    for (std::size_t i = 0; i < out.size(); ++i) upper_->set_arc(out[i], event.arcs_out[i]);
    outcome.event = graph.last_event();
    return outcome;
  }

  // The simplices around one component, for those few where something may happen.
  class Surroundings {
   public:
    Surroundings(const Level& level, std::size_t component) : level_(level) {
      if (level.lower_) lower_vertices_ = level.lower_vertices_[component];
      if (level.upper_) upper_vertices_ = level.upper_vertices_[component];
    }

    PlaceSum all_places() const {
      PlaceSum places;
      for (const Vertex vertex : upper_vertices_) places.add(place_in_upper(vertex));
      for (const Vertex vertex : lower_vertices_)
        if (!upper_twin(vertex)) places.add(place_in_lower(vertex));
      return places;
    }
    bool has_surface_at_step() const {
      const auto in_step = [](Slab<C>& slab) {
        return [&slab](Vertex vertex) { return slab.in_step(vertex); };
      };
      return (level_.lower_ && std::ranges::any_of(lower_vertices_, in_step(level_.lower_->slab))) ||
             (level_.upper_ && std::ranges::any_of(upper_vertices_, in_step(level_.upper_->slab)));
    }

    // Requires both slabs. Faces of simplices of which all corners at the step lie where it is even add as
    // much before as after, and so do boundary curves that pass only there: they are left out.
    ChangeWithin change(bool count_rims) const {
      const auto is_uneven_below = [&](Vertex vertex) {
        return level_.uneven_[level_.lower_places_[vertex]];
      };
      const auto is_uneven_above = [&](Vertex vertex) {
        return level_.uneven_[level_.upper_places_[vertex]];
      };
      SideFinder<C> sides;
      const Side before =
          sides.find(level_.lower_->slab, star(level_.lower_->slab, lower_vertices_, is_uneven_below), 1,
                     Direction::before, is_uneven_below);
      const Side after =
          sides.find(level_.upper_->slab, star(level_.upper_->slab, upper_vertices_, is_uneven_above), 0,
                     Direction::after, is_uneven_above);
      ChangeWithin change{after.euler - before.euler, 0};
      if constexpr (C == 4)
        if (count_rims && level_.upper_->slab.has_rims())
          change.rims = rims(after, Direction::after, is_uneven_above) -
                        rims(before, Direction::before, is_uneven_below);
      return change;
    }

    // The mean of the vertices whose own links are critical, or of all if none is. Requires both slabs.
    std::vector<double> critical_position() const {
      PlaceSum critical;
      for (const Vertex vertex : upper_vertices_)
        if (level_.uneven_[level_.upper_places_[vertex]] && is_critical(lower_twin(vertex), vertex))
          critical.add(place_in_upper(vertex));
      for (const Vertex vertex : lower_vertices_)
        if (!upper_twin(vertex) && is_critical(vertex, std::nullopt)) critical.add(place_in_lower(vertex));
      return critical.empty() ? all_places().mean() : critical.mean();
    }

   private:
    // Of those vertices that are wanted.
    template <class IsWanted>
    static std::vector<SimplexNumber> star(Slab<C>& slab, std::span<const Vertex> vertices,
                                           IsWanted&& is_wanted) {
      std::vector<SimplexNumber> star;
      for (const Vertex vertex : vertices) {
        if (!is_wanted(vertex)) continue;
        const auto around = slab.star(vertex);
        star.insert(star.end(), around.begin(), around.end());
      }
      std::ranges::sort(star, [&](auto a, auto b) { return slab.comes_before(a, b); });
      star.erase(std::unique(star.begin(), star.end()), star.end());
      return star;
    }

    std::optional<Vertex> upper_twin(Vertex lower) const {
      Slab<C>& slab = level_.lower_->slab;
      if (!level_.upper_ || !slab.in_step(lower)) return std::nullopt;
      return level_.upper_->slab.find(slab.edge(lower) - slab.step_offset);
    }
    std::optional<Vertex> lower_twin(Vertex upper) const {
      Slab<C>& slab = level_.upper_->slab;
      if (!level_.lower_ || !slab.in_step(upper)) return std::nullopt;
      return level_.lower_->slab.find(slab.edge(upper) + level_.lower_->slab.step_offset);
    }

    Place place_in_upper(Vertex vertex) const {
      Slab<C>& slab = level_.upper_->slab;
      return slab.place(slab.edge(vertex));
    }
    // The samples of the step are those of the upper slab, if there is one that has any.
    Place place_in_lower(Vertex vertex) const {
      Slab<C>& slab = level_.lower_->slab;
      if (!slab.in_step(vertex)) return slab.place_of_upper_end(slab.edge(vertex));
      return level_.upper_ && level_.upper_->slab.place
                 ? level_.upper_->slab.place(slab.edge(vertex) - slab.step_offset)
                 : slab.place(slab.edge(vertex));
    }

    bool is_critical(std::optional<Vertex> lower, std::optional<Vertex> upper) const {
      SideFinder<C> sides;
      Side before, after;
      if (lower) {
        Slab<C>& slab = level_.lower_->slab;
        before = sides.find(slab, slab.star(*lower), 1, Direction::before,
                            [&](Vertex vertex) { return vertex == *lower; });
      }
      if (upper) {
        Slab<C>& slab = level_.upper_->slab;
        after = sides.find(slab, slab.star(*upper), 0, Direction::after,
                           [&](Vertex vertex) { return vertex == *upper; });
      }
      return before.components.size() != 1 || after.components.size() != 1 || before.euler != after.euler;
    }

    // Of curves that pass triangles with a corner that is wanted.
    template <class IsWanted>
    std::int64_t rims(const Side& side, Direction direction, IsWanted&& is_wanted) const requires(C == 4) {
      std::vector<SimplexNumber> simplices;
      for (const auto& component : side.components)
        simplices.insert(simplices.end(), component.begin(), component.end());
      const bool before = direction == Direction::before;
      Sweep<C>* const sweep = before ? level_.lower_ : level_.upper_;
      const double moment = before ? 1 : 0;
      return sweep->count_rims(simplices, moment, direction, [&](Vertex vertex) {
        return sweep->slab.time(vertex) == moment && is_wanted(vertex);
      });
    }

    const Level& level_;
    std::span<const Vertex> lower_vertices_, upper_vertices_;
  };

  Sweep<C>*lower_, *upper_;
  std::shared_ptr<const StepPieces> pieces_;               // if they are the components
  std::vector<std::uint32_t> lower_places_, upper_places_; // of each vertex of the slabs, or none
  std::size_t vertex_count_ = 0;                           // of both, = places
  std::vector<std::uint32_t> twin_;    // the place of the same vertex in the other slab, or none
  std::vector<bool> uneven_;           // places: what is before and after may differ there
  std::vector<std::size_t> component_; // of each place
  std::vector<bool> plain_;            // components: the same on both sides, so that nothing can happen there
  std::vector<std::vector<Vertex>> lower_vertices_, upper_vertices_; // of each component that is not plain
  std::vector<std::vector<std::uint64_t>> strands_in_, strands_out_; // of each component
  std::vector<Outcome> outcomes_;
};

} // namespace hyperiso::track_detail
