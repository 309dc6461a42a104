#include "hyperiso/track.hpp"

#include <algorithm>

namespace hyperiso {
namespace {

class GraphMesh {
 public:
  explicit GraphMesh(const TrackingGraph& graph) : graph_(graph), rows_(graph.arcs.size()) {
    for (std::size_t row = 0; row < graph.features.size(); ++row) {
      const Feature& feature = graph.features[row];
      if (feature.arc >= 0) rows_[static_cast<std::size_t>(feature.arc)].push_back(row);
      add_point(feature.centroid, feature.step, feature.time, feature.volume, feature.track, -1);
    }
    for (const TrackingEvent& event : graph.events) {
      const auto& tracks = event.tracks_out.empty() ? event.tracks_in : event.tracks_out;
      add_point(event.position, -1, event.time, 0, tracks[0], static_cast<std::int32_t>(event.type));
    }
    for (std::size_t arc = 0; arc < graph.arcs.size(); ++arc) add_lines(arc);
  }

  Mesh mesh() && {
    const auto dimension = graph_.axes.size() - 1;
    Mesh mesh(static_cast<int>(dimension), 1);
    mesh.positions.reset(positions_.size(), true);
    for (std::size_t i = 0; i < positions_.size(); ++i) mesh.positions.set(i, positions_[i]);
    mesh.simplices.reset(lines_.size(), false);
    for (std::size_t i = 0; i < lines_.size(); ++i) mesh.simplices.set(i, lines_[i]);
    const auto add = [&](const char* name, Attribute::Location location, auto& values) {
      mesh.attributes.push_back({name, location, 1, std::move(values)});
    };
    add("SequenceIndex", Attribute::Location::vertex, sequence_);
    add("Time", Attribute::Location::vertex, times_);
    add("Size", Attribute::Location::vertex, sizes_);
    add("BranchId", Attribute::Location::vertex, branches_);
    add("Type", Attribute::Location::vertex, types_);
    add("BranchId", Attribute::Location::simplex, line_branches_);
    add("Overlap", Attribute::Location::simplex, overlaps_);
    return mesh;
  }

 private:
  void add_point(const std::vector<double>& position, std::int64_t step, double time, double size,
                 std::int64_t track, std::int32_t type) {
    positions_.insert(positions_.end(), position.begin(), position.end());
    sequence_.push_back(static_cast<std::int32_t>(step));
    times_.push_back(time);
    sizes_.push_back(size);
    branches_.push_back(static_cast<std::int32_t>(track));
    types_.push_back(type);
  }

  // From the event it starts in, through its features, to the event it ends in.
  void add_lines(std::size_t number) {
    const TrackingArc& arc = graph_.arcs[number];
    const std::size_t features = graph_.features.size();
    std::vector<std::size_t> points{features + static_cast<std::size_t>(arc.start_event)};
    points.insert(points.end(), rows_[number].begin(), rows_[number].end());
    points.push_back(features + static_cast<std::size_t>(arc.end_event));
    for (std::size_t i = 1; i < points.size(); ++i) {
      lines_.insert(lines_.end(), {points[i - 1], points[i]});
      const bool between_steps = points[i - 1] < features && points[i] < features;
      overlaps_.push_back(between_steps ? overlap(points[i - 1], points[i]) : 1);
      line_branches_.push_back(static_cast<std::int32_t>(points[i] < features
                                                             ? graph_.features[points[i]].track
                                                         : i > 1 ? graph_.features[points[i - 1]].track
                                                                 : arc.track));
    }
  }
  double overlap(std::size_t from, std::size_t to) const {
    const auto key = [](const FeatureLink& link) { return std::pair(link.to, link.from); };
    const auto wanted = std::pair(static_cast<std::int64_t>(to), static_cast<std::int64_t>(from));
    const auto found = std::ranges::lower_bound(graph_.links, wanted, {}, key);
    return found != graph_.links.end() && key(*found) == wanted ? found->overlap : 1;
  }

  const TrackingGraph& graph_;
  std::vector<std::vector<std::size_t>> rows_; // features of each arc
  std::vector<double> positions_, times_, sizes_, overlaps_;
  std::vector<std::int32_t> sequence_, branches_, types_, line_branches_;
  std::vector<std::uint64_t> lines_;
};

} // namespace

Mesh graph_mesh(const TrackingGraph& graph) { return GraphMesh(graph).mesh(); }

} // namespace hyperiso
