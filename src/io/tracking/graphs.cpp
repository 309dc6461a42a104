// The graph for the programs that draw and analyse graphs: GraphML, GEXF, DOT.

#include "io/tracking/common.hpp"

namespace hyperiso {

using namespace tracking_files;

namespace {

constexpr const char* xml_header = "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n";

// The attributes' names and types, from the first thing that has them.
template <class Things>
std::vector<GraphValue> names_and_types(const TrackingGraph& graph, const Things& things) {
  return things.empty() ? std::vector<GraphValue>{} : values_of(graph, things.front());
}

std::string graphml_keys(const char* of, const std::vector<GraphValue>& values) {
  std::string keys;
  for (const GraphValue& value : values)
    keys += text("<key id=\"", of, "_", value.name, "\" for=\"", of, "\" attr.name=\"", value.name,
                 "\" attr.type=\"", value.type, "\"/>\n");
  return keys;
}
std::string graphml_data(const char* of, const std::vector<GraphValue>& values) {
  std::string data;
  for (const GraphValue& value : values)
    data += text("<data key=\"", of, "_", value.name, "\">", xml_escaped(value.value), "</data>");
  return data;
}

std::string gexf_attributes(const char* of, const std::vector<GraphValue>& values) {
  std::string attributes = text("<attributes class=\"", of, "\">\n");
  for (const GraphValue& value : values)
    attributes +=
        text("<attribute id=\"", value.name, "\" title=\"", value.name, "\" type=\"", value.type, "\"/>\n");
  return attributes + "</attributes>\n";
}
std::string gexf_values(const std::vector<GraphValue>& values) {
  std::string result = "<attvalues>";
  for (const GraphValue& value : values)
    result += text("<attvalue for=\"", value.name, "\" value=\"", xml_escaped(value.value), "\"/>");
  return result + "</attvalues>";
}

} // namespace

std::string graph_graphml(const TrackingGraph& graph) {
  std::string xml = text(xml_header, "<graphml xmlns=\"http://graphml.graphdrawing.org/xmlns\">\n",
                         graphml_keys("node", names_and_types(graph, graph.events)),
                         graphml_keys("edge", names_and_types(graph, graph.arcs)),
                         "<graph id=\"tracks\" edgedefault=\"directed\">\n");
  for (std::size_t id = 0; id < graph.events.size(); ++id)
    xml += text("<node id=\"e", id, "\">", graphml_data("node", values_of(graph, graph.events[id])),
                "</node>\n");
  for (std::size_t id = 0; id < graph.arcs.size(); ++id) {
    const TrackingArc& arc = graph.arcs[id];
    xml += text("<edge id=\"a", id, "\" source=\"e", arc.start_event, "\" target=\"e", arc.end_event, "\">",
                graphml_data("edge", values_of(graph, arc)), "</edge>\n");
  }
  return xml + "</graph>\n</graphml>\n";
}

std::string graph_gexf(const TrackingGraph& graph) {
  std::string xml = text(xml_header, "<gexf xmlns=\"http://www.gexf.net/1.2draft\" version=\"1.2\">\n",
                         "<graph mode=\"dynamic\" defaultedgetype=\"directed\" timeformat=\"double\">\n",
                         gexf_attributes("node", names_and_types(graph, graph.events)),
                         gexf_attributes("edge", names_and_types(graph, graph.arcs)), "<nodes>\n");
  for (std::size_t id = 0; id < graph.events.size(); ++id) {
    const TrackingEvent& event = graph.events[id];
    xml += text("<node id=\"", id, "\" label=\"", name_of(event.type), "\" start=\"", event.time, "\" end=\"",
                event.time, "\">", gexf_values(values_of(graph, event)), "</node>\n");
  }
  xml += "</nodes>\n<edges>\n";
  for (std::size_t id = 0; id < graph.arcs.size(); ++id) {
    const TrackingArc& arc = graph.arcs[id];
    xml +=
        text("<edge id=\"", id, "\" source=\"", arc.start_event, "\" target=\"", arc.end_event, "\" start=\"",
             graph.events[index(arc.start_event)].time, "\" end=\"", graph.events[index(arc.end_event)].time,
             "\">", gexf_values(values_of(graph, arc)), "</edge>\n");
  }
  return xml + "</edges>\n</graph>\n</gexf>\n";
}

std::string graph_dot(const TrackingGraph& graph) {
  std::string dot = "digraph tracks {\n  rankdir=LR;\n  node [shape=box, style=rounded, fontsize=10];\n";
  const auto quoted = [](const std::vector<GraphValue>& values) {
    std::string list;
    for (const GraphValue& value : values)
      if (value.name != std::string_view("type")) list += text(", ", value.name, "=\"", value.value, "\"");
    return list;
  };
  for (std::size_t id = 0; id < graph.events.size(); ++id) {
    const TrackingEvent& event = graph.events[id];
    dot += text("  e", id, " [label=\"", name_of(event.type), "\\n", event.time, "\", type=\"",
                name_of(event.type), "\"", quoted(values_of(graph, event)), "];\n");
  }
  for (std::size_t id = 0; id < graph.arcs.size(); ++id) {
    const TrackingArc& arc = graph.arcs[id];
    dot += text("  e", arc.start_event, " -> e", arc.end_event, " [label=\"", arc.track, "\", color=\"",
                colour_of(arc.track), "\"", quoted(values_of(graph, arc)), "];\n");
  }
  return dot + "}\n";
}

} // namespace hyperiso
