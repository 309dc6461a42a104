#pragma once
/// \file
/// Tracking graphs as files and texts.

#include "hyperiso/io.hpp"
#include "hyperiso/track.hpp"

#include <filesystem>

namespace hyperiso {

/// Writes what is known of a graph into `directory`, which is made if it does not exist. Simplified tracks
/// stay in the tables, marked; pictures leave them out, and all but the 2000 largest others.
///
/// | tracks.csv | a row per track: its ends, parents, children, steps, largest volume, family |
/// | features.csv | a row per track and step: sizes, places, topology |
/// | events.csv, events.json | a row per event: when, where, what goes in and out |
/// | graph.graphml, graph.gexf, graph.dot, graph.json | events as nodes, components between them as edges |
/// | graph.vtu | the graph in space, as `graph_mesh` makes it |
/// | graph.svg | time to the right, one lane per track, width by volume |
/// | volume.svg | volume against time, one line per track (paper 003 figure 8) |
/// | napari_tracks.csv, napari_graph.json | for napari's tracks layer |
///
/// All of them or none; with a `group` they take their places when it is committed. Errors: file_unwritable,
/// out_of_memory.
Status write_tracking(const TrackingGraph& graph, const std::filesystem::path& directory,
                      FileGroup* group = nullptr);

/// The contents of these files. Axis names stand in the names of columns.
std::string tracks_csv(const TrackingGraph& graph);
std::string features_csv(const TrackingGraph& graph);
std::string events_csv(const TrackingGraph& graph);
std::string events_json(const TrackingGraph& graph);
std::string graph_graphml(const TrackingGraph& graph);
std::string graph_gexf(const TrackingGraph& graph);
std::string graph_dot(const TrackingGraph& graph);
std::string graph_json(const TrackingGraph& graph);
std::string graph_svg(const TrackingGraph& graph);
std::string volume_svg(const TrackingGraph& graph);
std::string napari_tracks_csv(const TrackingGraph& graph);
std::string napari_graph_json(const TrackingGraph& graph);

/// {"steps", "simplified_tracks", "tracks": [...], "events": [...]} as `hyperiso track --json` prints it.
std::string tracking_summary_json(const TrackingGraph& graph);

} // namespace hyperiso
