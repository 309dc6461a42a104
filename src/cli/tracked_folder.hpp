#pragma once
// A folder that `track -o` wrote as the input of other verbs. Its file source.json says which field was
// tracked and how, so that they find the same tracks by the same numbers.

#include "cli/console.hpp"
#include "cli/tracking_options.hpp"
#include "hyperiso/io.hpp"

#include <optional>

namespace hyperiso::cli {

// What source.json holds.
struct TrackedFolder {
  std::string path;   // of the folder
  FieldOptions input; // the field, by paths that hold from here
  SurfaceOptions surface;
  TrackingOptions tracking;
  std::vector<std::string> seeds; // where only the tracks through these points are there
  Json field;                     // type and axes of what was selected

  // The field and how it was tracked, as if they had been given.
  void choose(FieldOptions& to_read, TrackingOptions& to_track, SurfaceOptions& to_extract) const;
  // Fails if this is not the field that was tracked, as far as its description tells.
  void check_field(const FieldInfo& info) const;
  // Fails unless the tracks are those of the folder's tracks.csv.
  void check_tracks(const TrackingGraph& graph) const;
  // The name of the folder.
  std::string name() const;
};

// Gives the files their places in the folder, with a source.json beside them, and removes what an earlier run
// left there that is not among them. `selected`: the field as it was tracked.
void finish_folder(const TrackedFolder& folder, const FieldInfo& selected, FileGroup& files);

// The files that `track` wrote into a folder, by their names in it; nothing if it wrote none there.
std::optional<std::vector<std::string>> files_of_tracked_folder(const std::string& folder);

// Whether INPUT... begins with a folder.
bool names_folder(const FieldOptions& input);

// The folder that INPUT... begins with; more of it is the field, for where that is no longer in its place.
// Fails if it holds no tracks of all surfaces, or if an option that was given to `verb` says otherwise.
TrackedFolder open_tracked_folder(const FieldOptions& input, const CLI::App& verb);

} // namespace hyperiso::cli
