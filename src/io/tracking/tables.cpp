// The tables: tracks, features, events; and what napari reads.

#include "io/tracking/common.hpp"

#include <cmath>
#include <nlohmann/json.hpp>
#include <numeric>

namespace hyperiso {

using namespace tracking_files;

namespace {

// The middle of the track's cell.
std::vector<double> seed_of(const TrackingGraph& graph, const Track& track) {
  std::vector<double> seed;
  for (std::size_t axis = 0; axis < track.cell.size(); ++axis)
    seed.push_back(std::midpoint(graph.axes[axis].coordinate(track.cell[axis]),
                                 graph.axes[axis].coordinate(track.cell[axis] + 1)));
  return seed;
}

// Of a field's samples; nothing where there are none.
std::string extreme(double value) { return std::isfinite(value) ? text(value) : std::string(); }

} // namespace

std::string tracks_csv(const TrackingGraph& graph) {
  std::string csv = "track_id,start_time,end_time,start_type,end_type,parents,children,steps,max_volume,"
                    "family_id,clipped,simplified,seed\n";
  for (std::size_t id = 0; id < graph.tracks.size(); ++id) {
    const Track& track = graph.tracks[id];
    csv += text(id, ",", track.start_time, ",", track.end_time, ",", track.start_type, ",", track.end_type,
                ",", joined(track.parents, " "), ",", joined(track.children, " "), ",", track.steps, ",",
                track.max_volume, ",", track.family, ",", track.clipped, ",", track.simplified, ",",
                joined(seed_of(graph, track), " "), "\n");
  }
  return csv;
}

std::string features_csv(const TrackingGraph& graph) {
  std::string csv = "step,time,track_id,volume,cell_volume,surface_area,mass,min,max";
  const auto names = space_axis_names(graph);
  for (const char* what : {"centroid_", "low_", "high_"})
    for (const std::string& name : names) csv += text(",", what, name);
  csv += ",euler_characteristic,wall_curves,genus,cells,on_wall";
  for (const std::string& name : graph.with)
    for (const char* what : {"_mass", "_min", "_max"}) csv += text(",", name, what);
  csv += "\n";
  const bool has_genus = names.size() == 3 && graph.tracked == Tracked::surface;
  for (const Feature& row : graph.features) {
    csv += text(row.step, ",", row.time, ",", row.track, ",", row.volume, ",", row.cell_volume, ",",
                row.surface_area, ",", row.mass, ",", extreme(row.minimum), ",", extreme(row.maximum));
    for (const auto* point : {&row.centroid, &row.low, &row.high}) csv += text(",", joined(*point, ","));
    csv += text(",", row.euler_characteristic, ",", row.wall_curves, ",",
                has_genus && row.cells > 0 ? text(row.genus()) : std::string(), ",", row.cells, ",",
                row.on_wall);
    for (const FieldSum& sum : row.with)
      csv += text(",", sum.mass, ",", extreme(sum.minimum), ",", extreme(sum.maximum));
    csv += "\n";
  }
  return csv;
}

std::string events_csv(const TrackingGraph& graph) {
  std::string csv = "id,time,type";
  for (const std::string& name : space_axis_names(graph)) csv += text(",", name);
  csv += ",tracks_in,tracks_out,delta_euler,overlaps,simplified\n";
  for (std::size_t id = 0; id < graph.events.size(); ++id) {
    const TrackingEvent& event = graph.events[id];
    std::string overlaps;
    for (const TrackOverlap& overlap : event.overlaps)
      overlaps +=
          text(overlaps.empty() ? "" : " ", overlap.track_in, ">", overlap.track_out, ":", overlap.ratio);
    csv += text(id, ",", event.time, ",", name_of(event.type), ",", joined(event.position, ","), ",",
                joined(event.tracks_in, " "), ",", joined(event.tracks_out, " "), ",", event.delta_euler, ",",
                overlaps, ",", event.simplified, "\n");
  }
  return csv;
}

// Columns as napari's tracks layer takes them: the id, then time and space with the slowest axis first.
std::string napari_tracks_csv(const TrackingGraph& graph) {
  std::vector<const Feature*> rows;
  for (const Feature& row : graph.features) rows.push_back(&row);
  std::ranges::stable_sort(rows, {}, &Feature::track);
  std::string csv = graph.axes.size() == 4 ? "track_id,t,z,y,x\n" : "track_id,t,y,x\n";
  for (const Feature* row : rows) {
    csv += text(row->track, ",", row->time);
    for (auto coordinate = row->centroid.rbegin(); coordinate != row->centroid.rend(); ++coordinate)
      csv += text(",", *coordinate);
    csv += "\n";
  }
  return csv;
}

std::string napari_graph_json(const TrackingGraph& graph) {
  nlohmann::ordered_json parents = nlohmann::ordered_json::object();
  for (std::size_t id = 0; id < graph.tracks.size(); ++id)
    if (!graph.tracks[id].parents.empty()) parents[std::to_string(id)] = graph.tracks[id].parents;
  return parents.dump(1) + "\n";
}

} // namespace hyperiso
