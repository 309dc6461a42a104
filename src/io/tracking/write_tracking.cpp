#include "core/text.hpp"
#include "hyperiso/track_files.hpp"
#include "io/atomic_file.hpp"

#include <new>

namespace hyperiso {
namespace {

Status write_text(const std::string& content, const std::filesystem::path& path, FileGroup* group) {
  auto file = AtomicFile::create(path);
  if (!file) return file.error();
  file->write(content);
  return file->commit(group);
}

} // namespace

Status write_tracking(const TrackingGraph& graph, const std::filesystem::path& directory, FileGroup* group) {
  struct Output {
    const char* name;
    std::string (*content)(const TrackingGraph&);
  };
  static constexpr Output outputs[] = {{"tracks.csv", tracks_csv},
                                       {"features.csv", features_csv},
                                       {"events.csv", events_csv},
                                       {"events.json", events_json},
                                       {"graph.graphml", graph_graphml},
                                       {"graph.gexf", graph_gexf},
                                       {"graph.dot", graph_dot},
                                       {"graph.json", graph_json},
                                       {"graph.svg", graph_svg},
                                       {"volume.svg", volume_svg},
                                       {"napari_tracks.csv", napari_tracks_csv},
                                       {"napari_graph.json", napari_graph_json}};
  try {
    std::error_code failure;
    std::filesystem::create_directories(directory, failure);
    if (failure)
      return Error{Code::file_unwritable,
                   text(directory.string(), ": cannot make this folder: ", failure.message())};
    for (const Output& output : outputs)
      if (const Status written = write_text(output.content(graph), directory / output.name, group); !written)
        return written.error();
    WriteMeshOptions options;
    options.group = group;
    return write_mesh(graph_mesh(graph), directory / "graph.vtu", options);
  } catch (const std::bad_alloc&) {
    return Error{Code::out_of_memory, text("no memory to write ", directory.string())};
  }
}

} // namespace hyperiso
