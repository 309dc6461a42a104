#pragma once
/// \file
/// Files: bytes <-> Field, Mesh. Computes nothing.

#include "hyperiso/field.hpp"
#include "hyperiso/mesh.hpp"
#include "hyperiso/step_source.hpp"

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

namespace hyperiso {

/// How to read a field.
struct ReadOptions {
  std::vector<std::int64_t> dims; ///< raw files: samples per axis, axis 0 fastest
  std::optional<SampleType> type; ///< raw files
  bool big_endian = false;        ///< raw files
  std::int64_t skip_bytes = 0;    ///< raw files: header to leave out
  std::string variable;  ///< the array to read where a file has several; empty: the only or first one
  std::string time_axis; ///< name or number of the axis that is time; empty: as the file says
  std::uint64_t memory_limit = UINT64_MAX; ///< bytes of samples that may be held
};

/// A field in one or several files, open but not yet read: its description is known, its samples are read on
/// request, step by step where the format allows.
class FieldReader : public StepSource {
 public:
  const FieldInfo& info() const override { return info_; }

  /// The samples [begin, end) along the last axis (steps, if it is time). Raw samples in a plain file come
  /// memory-mapped, others are read; only the files and parts needed for those steps are touched where the
  /// format allows it.
  /// Errors: file_unreadable, file_malformed (truncated, bad compression), out_of_memory.
  Result<Field> read(std::int64_t begin, std::int64_t end) override = 0;
  Result<Field> read() { return read(0, info_.axes.back().count); }

 protected:
  FieldInfo info_;
};

/// Opens a field. One path: .nrrd, .nhdr, .vti, .npy, .raw/.bin (with `dims` and `type`), .pvd, .series.
/// Several paths: one step each, in the order given, stacked along a new last axis t (with the times of the
/// files where they have them, else 0, 1, 2, ...). Errors: file_not_found, file_unreadable, file_malformed,
/// file_unsupported, out_of_memory; invalid_argument for options that do not fit the format.
Result<std::unique_ptr<FieldReader>> open_field(const std::vector<std::filesystem::path>& paths,
                                                const ReadOptions& options = {});

/// Writes a field: .nrrd (raw, or gzip where `compress`), .npy, .raw, .vti (3 axes; with time, a series: a
/// .pvd and one .vti per step beside it).
Status write_field(const Field& field, const std::filesystem::path& path, bool compress = false);

/// How to write a mesh.
struct WriteMeshOptions {
  std::string format; ///< "vtu", "vtp", "ply", "stl", "obj", "off"; empty: by the suffix of the path
  std::vector<std::string> axis_names; ///< of the mesh's coordinates, for the names of 4D point data
  bool keep_edges = true; ///< VTU: store Mesh::edges and the grid axes, so that slices at steps stay exact
};

/// Writes a mesh of dimension 2, 3 or 4, whole or not at all (written beside the target and renamed).
///
/// | format | meshes |
/// | vtu | any; in R^4 the points are x, y, z with point data `t` and `xyzt` |
/// | vtp | segments in R^2, triangles in R^3 |
/// | ply, obj, off | segments in R^2 (obj) or triangles in R^3 |
/// | stl | triangles in R^3 (unshared, by the format) |
///
/// Inline base64 with zlib for vtu and vtp. Errors: file_unwritable; file_unsupported where the format cannot
/// hold the mesh, saying which can.
Status write_mesh(const Mesh& mesh, const std::filesystem::path& path, const WriteMeshOptions& options = {});

/// Reads a mesh that write_mesh wrote as .vtu or .vtp, with its attributes and edges; also .ply, .obj, .off
/// and .stl of triangles (an .stl is not welded), and .vtu and .vtp by others where they hold one kind of
/// simplex.
Result<Mesh> read_mesh(const std::filesystem::path& path);

/// One step of a series of files.
struct SeriesEntry {
  double time;
  std::filesystem::path file; ///< relative to the series file
};
/// Writes a ParaView .pvd that names the files and their times.
Status write_series(const std::vector<SeriesEntry>& entries, const std::filesystem::path& path);

/// Removes the temporary files of writes under way in this process. For a program's handler of the signals
/// that end it (async-signal-safe); the writes themselves fail if they go on.
void remove_unfinished_files() noexcept;

} // namespace hyperiso
