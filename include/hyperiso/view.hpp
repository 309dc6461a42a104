#pragma once
/// \file
/// One HTML file that shows a surface: plays it through time, cuts it by any hyperplane.

#include "hyperiso/extract.hpp"
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
  std::string part;       ///< which part of the field it is, such as "t = 0.5 s"; empty: all of it
  std::optional<double> isovalue; ///< none: not shown
  std::string colour_by; ///< what the page colours by at first: "solid", "time", "component", "track" or the
                         ///< name of an attribute; empty: the page decides
  std::vector<std::string> notes; ///< what a reader has to know, for example that samples were left out
  /// Tracks and events to show under the scene, and to colour by; of the field that the mesh is the surface
  /// of. A graph of regions after `use_boundary_pieces`.
  const TrackingGraph* tracking = nullptr;
  /// Grid to world coordinates, where the mesh has been moved so: `axes` are then those of the grid, and they
  /// and what `tracking` says of times and places are moved along. `write_field_page` takes that of its
  /// field.
  std::optional<Affine> world;
  std::uint64_t size_limit = UINT64_MAX; ///< bytes that the page may have
  Progress progress = {};
};

/// Whether this library was built with the viewer; `write_page` works only then.
bool has_viewer();
/// Whether it was also built with the extraction core for pages; `write_field_page` works only then.
bool has_field_pages();

/// Makes a graph of regions one that `PageOptions::tracking` takes: each vertex of the surface at a step goes
/// by the region that it bounds, the wall of a cavity by the region around it. `pieces` are then those of the
/// surface, with an entry for each of its vertices. A graph of surfaces stays as it is.
///
/// Requires that `graph` came from `source` with these options, and with features measured. Cost: each region
/// is meshed once more. Errors: those of `source` and of `tracked_surface`; invalid_argument for regions
/// between two isovalues, which two surfaces bound.
Status use_boundary_pieces(TrackingGraph& graph, StepSource& source, const TrackOptions& options = {});

/// Writes one self-contained HTML file: the viewer and the mesh, no reference to anything outside. It opens
/// in any browser with WebGL 2 (all current ones), also from a disk without a network.
///
/// Meshes: tetrahedra in R^4 and triangles in R^3; and interval volumes in R^2 and R^3 whose vertices have
/// the attribute `isovalue`, as `interval` makes them: the page slides between their isovalues. Coordinates
/// are stored with 16 bits along each axis; the samples of an evenly spaced axis fall on exact levels, so
/// that a slice at a step is that step's surface. Attributes of one component are kept with 16 bits: real
/// ones between their minimum and maximum, integers as labels. An attribute of simplices becomes one of their
/// first vertices.
///
/// About 5 bytes per tetrahedron in the file, 19 on the graphics card.
///
/// Errors: file_unsupported for other meshes or without the viewer; invalid_argument where the page would
/// pass `size_limit`; out_of_memory where the mesh passes what graphics cards hold (16.7 million
/// vertices, 33.5 million simplices); file_unwritable; cancelled.
Status write_page(const Mesh& mesh, const PageOptions& options, const std::filesystem::path& path);

/// What a page keeps of the samples of a field.
enum class PageSamples {
  band, ///< those that the surface at one isovalue needs: the smallest page, by far
  all,  ///< every one: the page has a slider for the isovalue
};

struct FieldPageOptions : PageOptions {
  PageSamples samples = PageSamples::all;
  Method method = Method::hull; ///< not barycentric
  Inside inside = Inside::above;
  int threads = 0;
  std::uint64_t memory_limit = UINT64_MAX; ///< bytes the surface may take while the page is written
};

/// What the page shows at first.
struct PageSurface {
  std::uint64_t vertices, simplices;
};

/// Writes a page that holds samples of the field and extracts its surface itself when it is opened, by this
/// library's code compiled to WebAssembly. `isovalue`, `axes`, `has_time`, `field_name` and `world` of the
/// options are taken from the arguments.
///
/// Samples are kept with up to 16 bits. Integers of 8 and 16 bits are exact. Others are rounded to 65533 even
/// steps over their range (65530 if there are NaN or infinities, which are kept), of a band over the range
/// of the samples kept, and never across the isovalue. So the page shows the surface of `write_page` simplex
/// for simplex, to the bit for exact samples; others may move a vertex by what half a step of its two samples
/// moves it. At other isovalues than the first, it is the surface of the rounded field.
///
/// `tracking`: of the same field at the same isovalue; the page says so where another is chosen.
///
/// Dimensions: 3 and 4. Bytes in the file, beside 0.8 MB for the viewer: for each tetrahedron of the surface
/// 0.2 to 0.3 of a band; for each sample up to 2.7 of all, 0.4 of smooth fields.
///
/// Errors: those of `write_page`; invalid_isovalue; invalid_argument for Method::barycentric;
/// unsupported_dimension.
Result<PageSurface> write_field_page(const Field& field, double isovalue, const FieldPageOptions& options,
                                     const std::filesystem::path& path);

} // namespace hyperiso
