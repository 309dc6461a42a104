#include "hyperiso/track_files.hpp"
#include "io/atomic_file.hpp"

#include <new>

namespace hyperiso {
namespace {

Status write_text(const std::string& content, const std::filesystem::path& path, FileGroup& files) {
  auto file = AtomicFile::create(path);
  if (!file) return file.error();
  file->write(content);
  return file->commit(&files);
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
    FileGroup own;
    FileGroup& files = group ? *group : own;
    if (const Status made = files.make_folder(directory); !made) return made;
    for (const Output& output : outputs)
      if (const Status written = write_text(output.content(graph), directory / output.name, files); !written)
        return written.error();
    WriteMeshOptions options;
    options.group = &files;
    const Status written = write_mesh(graph_mesh(graph), directory / "graph.vtu", options);
    return !written || group ? written : own.commit();
  } catch (const std::bad_alloc&) {
    return no_memory_to_write(directory);
  }
}

} // namespace hyperiso
