#pragma once
/// \file
/// One HTML file that shows a surface: plays it through time, cuts it by any hyperplane.

#include "hyperiso/mesh.hpp"
#include "hyperiso/progress.hpp"
#include "hyperiso/track.hpp"

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace hyperiso {

/// What the page says about the surface, besides the surface itself.
struct PageOptions {
  std::string title;      ///< empty: "Isosurface"
  std::vector<Axis> axes; ///< of the mesh's coordinates: names, units, ranges, steps of time; empty: unnamed,
                          ///< as long as the mesh
  bool has_time = false;  ///< the last axis is time
  std::string field_name; ///< empty if unknown
  std::optional<double> isovalue; ///< none: not shown
  std::string colour_by; ///< what the page colours by at first: "solid", "time", "component", "track" or the
                         ///< name of an attribute; empty: the page decides
  std::vector<std::string> notes; ///< what a reader has to know, for example that samples were left out
  /// Tracks and events to show under the scene, and to colour by; of the field that the mesh is the surface
  /// of.
  const TrackingGraph* tracking = nullptr;
  std::uint64_t size_limit = UINT64_MAX; ///< bytes that the page may have
  Progress progress = {};
};

/// Whether this library was built with the viewer; `write_page` works only then.
bool has_viewer();

/// Writes one self-contained HTML file: the viewer and the mesh, no reference to anything outside. It opens
/// in any browser with WebGL 2 (all current ones), also from a disk without a network.
///
/// Meshes: tetrahedra in R^4 and triangles in R^3. Coordinates are stored with 16 bits along each axis; the
/// samples of an evenly spaced axis fall on exact levels, so that a slice at a step is that step's surface.
/// Attributes of one component are kept with 16 bits: real ones between their minimum and maximum, integers
/// as labels. An attribute of simplices becomes one of their first vertices.
///
/// About 5 bytes per tetrahedron in the file, 19 on the graphics card.
///
/// Errors: file_unsupported for other meshes or without the viewer; invalid_argument where the page would
/// pass `size_limit`; out_of_memory where the mesh passes what graphics cards hold (16.7 million
/// vertices, 33.5 million simplices); file_unwritable; cancelled.
Status write_page(const Mesh& mesh, const PageOptions& options, const std::filesystem::path& path);

} // namespace hyperiso
