#include "io/tracking/common.hpp"

#include <nlohmann/json.hpp>

namespace hyperiso {

using namespace tracking_files;
using Json = nlohmann::ordered_json;

namespace {

Json summary_of(const TrackingEvent& event) {
  return Json{{"time", event.time},
              {"type", name_of(event.type)},
              {"position", event.position},
              {"in", event.tracks_in},
              {"out", event.tracks_out},
              {"delta_euler", event.delta_euler},
              {"simplified", event.simplified}};
}

Json values(const std::vector<GraphValue>& list) {
  Json object = Json::object();
  for (const GraphValue& value : list) {
    const bool is_text = value.type == std::string_view("string");
    object[value.name] = is_text ? Json(value.value) : Json::parse(value.value);
  }
  return object;
}

} // namespace

std::string events_json(const TrackingGraph& graph) {
  Json list = Json::array();
  for (std::size_t id = 0; id < graph.events.size(); ++id) {
    Json event = summary_of(graph.events[id]);
    event["id"] = id;
    event["overlaps"] = Json::array();
    for (const TrackOverlap& overlap : graph.events[id].overlaps)
      event["overlaps"].push_back(
          {{"in", overlap.track_in}, {"out", overlap.track_out}, {"ratio", overlap.ratio}});
    list.push_back(std::move(event));
  }
  return Json{{"events", std::move(list)}}.dump(1) + "\n";
}

std::string tracking_summary_json(const TrackingGraph& graph) {
  Json tracks = Json::array(), events = Json::array();
  std::int64_t simplified = 0;
  for (std::size_t id = 0; id < graph.tracks.size(); ++id) {
    const Track& track = graph.tracks[id];
    simplified += track.simplified;
    tracks.push_back({{"id", id},
                      {"start_time", track.start_time},
                      {"end_time", track.end_time},
                      {"start_type", track.start_type},
                      {"end_type", track.end_type},
                      {"parents", track.parents},
                      {"children", track.children},
                      {"max_volume", track.max_volume},
                      {"steps", track.steps},
                      {"family", track.family},
                      {"clipped", track.clipped},
                      {"simplified", track.simplified}});
  }
  for (const TrackingEvent& event : graph.events) events.push_back(summary_of(event));
  return Json{{"steps", graph.steps},
              {"isovalue", graph.isovalue},
              {"simplified_tracks", simplified},
              {"tracks", std::move(tracks)},
              {"events", std::move(events)}}
      .dump();
}

// Node-link form: networkx.node_link_graph and d3 read it.
std::string graph_json(const TrackingGraph& graph) {
  Json nodes = Json::array(), links = Json::array();
  for (std::size_t id = 0; id < graph.events.size(); ++id) {
    Json node{{"id", id}};
    node.update(values(values_of(graph, graph.events[id])));
    nodes.push_back(std::move(node));
  }
  for (std::size_t id = 0; id < graph.arcs.size(); ++id) {
    Json link{{"source", graph.arcs[id].start_event}, {"target", graph.arcs[id].end_event}, {"key", id}};
    link.update(values(values_of(graph, graph.arcs[id])));
    links.push_back(std::move(link));
  }
  return Json{{"directed", true},
              {"multigraph", true},
              {"graph", Json::object()},
              {"nodes", std::move(nodes)},
              {"links", std::move(links)}}
             .dump(1) +
         "\n";
}

} // namespace hyperiso
