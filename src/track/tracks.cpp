#include "track/tracks.hpp"

#include "core/union_find.hpp"
#include "hyperiso/slice.hpp"

#include <algorithm>
#include <map>
#include <set>
#include <tuple>

namespace hyperiso::track_detail {
namespace {

class TrackAssignment {
 public:
  explicit TrackAssignment(TrackingGraph& graph) : graph_(graph), arcs_(graph.arcs.size()) {
    for (std::size_t feature = 0; feature < graph.features.size(); ++feature) {
      const Feature& row = graph.features[feature];
      if (row.arc >= 0) arcs_[index(row.arc)].rows.push_back(feature);
      if (row.event >= 0) row_of_event_[row.event] = feature;
    }
    for (const FeatureLink& link : graph.links)
      if (link.weak) weak_.insert({link.from, link.to});
    find_volumes();
  }

  void run() {
    for (std::size_t event = 0; event < graph_.events.size(); ++event) pass(event);
    for (Feature& row : graph_.features)
      if (row.event >= 0) row.track = track_at(row.event);
    summarize();
    find_cells();
    add_overlaps();
  }

 private:
  struct Arc {
    std::vector<std::size_t> rows;
    double volume_before_end = 0, volume_after_start = 0;
    std::int64_t last_track = -1; // at its end
  };

  static std::size_t index(std::int64_t number) { return static_cast<std::size_t>(number); }
  Track& track(std::int64_t number) { return graph_.tracks[index(number)]; }

  // An arc without a row has the volumes that flow into it, or out of it.
  void find_volumes() {
    for (std::size_t i = 0; i < arcs_.size(); ++i) { // arcs are in order of their starts
      Arc& arc = arcs_[i];
      const std::int64_t start = graph_.arcs[i].start_event;
      if (!arc.rows.empty()) {
        arc.volume_before_end = graph_.features[arc.rows.back()].volume;
      } else if (const auto row = row_of_event_.find(start); row != row_of_event_.end()) {
        arc.volume_before_end = graph_.features[row->second].volume;
      } else {
        for (const std::int64_t in : graph_.events[index(start)].arcs_in)
          arc.volume_before_end += arcs_[index(in)].volume_before_end;
      }
    }
    for (std::size_t i = arcs_.size(); i-- > 0;) {
      Arc& arc = arcs_[i];
      const std::int64_t end = graph_.arcs[i].end_event;
      if (!arc.rows.empty()) {
        arc.volume_after_start = graph_.features[arc.rows.front()].volume;
      } else if (const auto row = row_of_event_.find(end); row != row_of_event_.end()) {
        arc.volume_after_start = graph_.features[row->second].volume;
      } else {
        for (const std::int64_t out : graph_.events[index(end)].arcs_out)
          arc.volume_after_start += arcs_[index(out)].volume_after_start;
      }
    }
  }

  std::int64_t new_track(double time, const std::string& type) {
    Track& made = graph_.tracks.emplace_back();
    made.start_time = made.end_time = time;
    made.start_type = type;
    return static_cast<std::int64_t>(graph_.tracks.size()) - 1;
  }
  void end_track(std::int64_t number, double time, const std::string& type) {
    track(number).end_time = time;
    track(number).end_type = type;
  }

  void pass(std::size_t number) {
    TrackingEvent& event = graph_.events[number];
    const std::string type = name_of(event.type);
    for (const std::int64_t arc : event.arcs_in) event.tracks_in.push_back(arcs_[index(arc)].last_track);
    const auto [in, out] = continuation(event);

    std::int64_t heir = -1;
    for (const std::int64_t arc : event.arcs_out) {
      const std::int64_t made = arc == out ? arcs_[index(in)].last_track : new_track(event.time, type);
      if (arc == out) heir = made;
      event.tracks_out.push_back(made);
      follow(arc, made);
    }
    for (const std::int64_t arc : event.arcs_in)
      if (arc != in) end_track(arcs_[index(arc)].last_track, event.time, type);
    relate(event, heir);
  }

  // The arc that goes on, as which; -1, -1 if none does.
  std::pair<std::int64_t, std::int64_t> continuation(const TrackingEvent& event) {
    if (event.arcs_in.empty() || event.arcs_out.empty()) return {-1, -1};
    const auto before = [&](std::int64_t arc) {
      const std::int64_t number = arcs_[index(arc)].last_track;
      return std::tuple(-arcs_[index(arc)].volume_before_end, track(number).start_time, number);
    };
    const auto after = [&](std::int64_t arc) {
      return std::pair(-arcs_[index(arc)].volume_after_start, arc);
    };
    const std::int64_t in = *std::ranges::min_element(event.arcs_in, {}, before);
    const std::int64_t out = *std::ranges::min_element(event.arcs_out, {}, after);
    if (is_weak(event, in, out)) return {-1, -1};
    return {in, out};
  }

  bool is_weak(const TrackingEvent& event, std::int64_t in, std::int64_t out) const {
    const auto number = static_cast<std::size_t>(&event - graph_.events.data());
    return weak_.contains({last_row(in), first_row_after(number, out)});
  }
  // The row of the event itself, if it is at a step, else the first of the arc that leaves it.
  std::int64_t first_row_after(std::size_t event, std::int64_t out) const {
    const auto at_step = row_of_event_.find(static_cast<std::int64_t>(event));
    return at_step != row_of_event_.end() ? static_cast<std::int64_t>(at_step->second) : first_row(out);
  }
  std::int64_t first_row(std::int64_t arc) const {
    if (!arcs_[index(arc)].rows.empty()) return static_cast<std::int64_t>(arcs_[index(arc)].rows.front());
    const auto at_end = row_of_event_.find(graph_.arcs[index(arc)].end_event);
    return at_end == row_of_event_.end() ? -1 : static_cast<std::int64_t>(at_end->second);
  }
  std::int64_t last_row(std::int64_t arc) const {
    if (!arcs_[index(arc)].rows.empty()) return static_cast<std::int64_t>(arcs_[index(arc)].rows.back());
    const auto at_start = row_of_event_.find(graph_.arcs[index(arc)].start_event);
    return at_start == row_of_event_.end() ? -1 : static_cast<std::int64_t>(at_start->second);
  }

  // Gives the rows of an arc their track, a new one after each weak link.
  void follow(std::int64_t number, std::int64_t current) {
    Arc& arc = arcs_[index(number)];
    graph_.arcs[index(number)].track = current;
    const auto start = row_of_event_.find(graph_.arcs[index(number)].start_event);
    std::int64_t before = start == row_of_event_.end() ? -1 : static_cast<std::int64_t>(start->second);
    const auto pass_row = [&](std::size_t row) {
      if (weak_.contains({before, static_cast<std::int64_t>(row)})) {
        end_track(current, graph_.features[index(before)].time, "weak");
        current = new_track(graph_.features[row].time, "weak");
      }
      before = static_cast<std::int64_t>(row);
    };
    for (const std::size_t row : arc.rows) {
      pass_row(row);
      graph_.features[row].track = current;
    }
    const std::int64_t end = graph_.arcs[index(number)].end_event;
    const auto row_at_end = row_of_event_.find(end);
    if (row_at_end != row_of_event_.end() && graph_.events[index(end)].arcs_out.empty())
      pass_row(row_at_end->second);
    arc.last_track = current;
  }

  // Tracks that begin here come from those before; tracks that end here went into the heir.
  void relate(const TrackingEvent& event, std::int64_t heir) {
    const auto link = [&](std::int64_t parent, std::int64_t child) {
      track(parent).children.push_back(child);
      track(child).parents.push_back(parent);
    };
    for (const std::int64_t child : event.tracks_out)
      if (child != heir)
        for (const std::int64_t parent : event.tracks_in) link(parent, child);
    if (heir < 0) return;
    for (const std::int64_t parent : event.tracks_in)
      if (parent != heir) link(parent, heir);
  }

  // The track that goes on at an event, or is born or dies there.
  std::int64_t track_at(std::int64_t number) const {
    const TrackingEvent& event = graph_.events[index(number)];
    for (const std::int64_t track : event.tracks_in)
      if (std::ranges::count(event.tracks_out, track) > 0) return track;
    const auto largest = [&](const std::vector<std::int64_t>& arcs, const std::vector<std::int64_t>& tracks,
                             double Arc::*volume) {
      std::size_t best = 0;
      for (std::size_t i = 1; i < arcs.size(); ++i)
        if (arcs_[index(arcs[i])].*volume > arcs_[index(arcs[best])].*volume) best = i;
      return tracks[best];
    };
    if (event.tracks_out.empty()) return largest(event.arcs_in, event.tracks_in, &Arc::volume_before_end);
    return largest(event.arcs_out, event.tracks_out, &Arc::volume_after_start);
  }

  void summarize() {
    UnionFind families(graph_.tracks.size());
    for (const TrackingEvent& event : graph_.events) {
      std::vector<std::int64_t> all = event.tracks_in;
      all.insert(all.end(), event.tracks_out.begin(), event.tracks_out.end());
      const bool open = event.type == EventType::open_start || event.type == EventType::open_end;
      const bool wall =
          event.type == EventType::touch || event.type == EventType::enter || event.type == EventType::exit;
      for (const std::int64_t number : all) {
        if (!open) families.unite(index(all[0]), index(number));
        if (wall) track(number).clipped = true;
      }
    }
    for (const Feature& row : graph_.features) {
      Track& owner = track(row.track);
      ++owner.steps;
      owner.max_volume = std::max(owner.max_volume, row.volume);
      owner.clipped |= row.on_wall;
    }
    for (std::size_t number = 0; number < graph_.tracks.size(); ++number) {
      Track& one = graph_.tracks[number];
      one.family = static_cast<std::int64_t>(families.find(number));
      for (auto* list : {&one.parents, &one.children}) {
        std::ranges::sort(*list);
        list->erase(std::unique(list->begin(), list->end()), list->end());
      }
    }
  }

  // Of a piece at the first step that has one, else where the track begins.
  void find_cells() {
    if (graph_.tracked == Tracked::region) return;
    for (std::size_t step = 0; step < graph_.pieces.size(); ++step)
      for (const TrackingGraph::Piece& piece : graph_.pieces[step]) {
        Track& owner = track(graph_.features[index(piece.feature)].track);
        if (owner.cell.empty()) owner.cell = cell_beside(piece.edge, static_cast<std::int64_t>(step));
      }
    for (const TrackingEvent& event : graph_.events)
      for (const std::int64_t number : event.tracks_out)
        if (track(number).cell.empty()) track(number).cell = cell_around(event);
  }
  std::vector<std::int64_t> in_grid(std::vector<std::int64_t> sample) const {
    for (std::size_t axis = 0; axis < sample.size(); ++axis)
      sample[axis] = std::min(sample[axis], graph_.axes[axis].count - 2);
    return sample;
  }
  std::vector<std::int64_t> cell_beside(GridEdge edge, std::int64_t step) const {
    const auto of_dimension = [&]<int D>() {
      std::array<std::int64_t, D> dims;
      for (std::size_t axis = 0; axis < D; ++axis) dims[axis] = graph_.axes[axis].count;
      const auto lower = grid_edge_ends<D>(dims, edge).lower;
      std::vector<std::int64_t> sample(lower.begin(), lower.end());
      sample.push_back(step);
      return in_grid(std::move(sample));
    };
    return graph_.axes.size() == 3 ? of_dimension.template operator()<2>()
                                   : of_dimension.template operator()<3>();
  }
  std::vector<std::int64_t> cell_around(const TrackingEvent& event) const {
    std::vector<std::int64_t> sample;
    for (std::size_t axis = 0; axis < graph_.axes.size(); ++axis) {
      const double coordinate = axis < event.position.size() ? event.position[axis] : event.time;
      const auto around = samples_around(graph_.axes[axis], coordinate);
      if (!around) return {};
      sample.push_back(around->begin);
    }
    return in_grid(std::move(sample));
  }

  void add_overlaps() {
    std::map<std::pair<std::int64_t, std::int64_t>, double> overlap;
    for (const FeatureLink& link : graph_.links) overlap[{link.from, link.to}] = link.overlap;
    for (std::size_t number = 0; number < graph_.events.size(); ++number) {
      TrackingEvent& event = graph_.events[number];
      for (std::size_t in = 0; in < event.arcs_in.size(); ++in)
        for (std::size_t out = 0; out < event.arcs_out.size(); ++out) {
          const auto found =
              overlap.find({last_row(event.arcs_in[in]), first_row_after(number, event.arcs_out[out])});
          if (found != overlap.end())
            event.overlaps.push_back({event.tracks_in[in], event.tracks_out[out], found->second});
        }
    }
    for (std::size_t number = 0; number < arcs_.size(); ++number) {
      TrackingArc& arc = graph_.arcs[number];
      const auto& rows = arcs_[number].rows;
      for (std::size_t i = 0; i < rows.size(); ++i) {
        arc.max_volume = std::max(arc.max_volume, graph_.features[rows[i]].volume);
        if (i == 0) continue;
        const auto found = overlap.find({rows[i - 1], rows[i]});
        if (found != overlap.end()) arc.least_overlap = std::min(arc.least_overlap, found->second);
      }
    }
  }

  TrackingGraph& graph_;
  std::vector<Arc> arcs_;
  std::map<std::int64_t, std::size_t> row_of_event_;
  std::set<std::pair<std::int64_t, std::int64_t>> weak_; // links
};

} // namespace

void assign_tracks(TrackingGraph& graph) { TrackAssignment(graph).run(); }

} // namespace hyperiso::track_detail
