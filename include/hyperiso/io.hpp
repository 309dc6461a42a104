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

class AtomicFile; // a file on its way to its place; internal
struct UnfinishedFile;

/// How to read a field.
struct ReadOptions {
  std::vector<std::int64_t> dims; ///< raw files: samples per axis, axis 0 fastest
  std::optional<SampleType> type; ///< raw files
  bool big_endian = false;        ///< raw files
  std::int64_t skip_bytes = 0;    ///< raw files: header to leave out
  std::string variable;  ///< the array to read where a file has several; empty: the only or first one
  std::string time_axis; ///< name or number (in the file) of the axis that is time; empty: as the file says
  std::uint64_t memory_limit = UINT64_MAX; ///< bytes of samples that may be held (mapped ones are not)
};

/// A field in one or several files, open but not yet read: its description is known, its samples are read on
/// request, step by step where the format allows. Not thread-safe: one thread at a time.
class FieldReader : public StepSource {
 public:
  const FieldInfo& info() const override { return info_; }

  /// The samples [begin, end) along the last axis (steps, if it is time). Raw samples in a plain file come
  /// memory-mapped (the file must not be made shorter while they are in use), others are read; only the files
  /// and parts needed for those steps are touched where the format allows it. Of compressed samples all
  /// before `end` are decoded, but going on from where the last call ended, or one step before, costs no more
  /// than the new steps.
  ///
  /// Errors: file_unreadable, file_malformed (truncated, bad compression), out_of_memory; invalid_argument
  /// unless 0 <= begin <= end <= the number of steps.
  Result<Field> read(std::int64_t begin, std::int64_t end) override = 0;
  Result<Field> read() { return read(0, info_.axes.back().count); }

  /// The files with the samples, where the file that was opened names others: data files of an NRRD header,
  /// the steps of a series.
  const std::vector<std::filesystem::path>& files() const { return files_; }

 protected:
  FieldInfo info_;
  std::vector<std::filesystem::path> files_;
};

/// Opens a field. One path, by its suffix:
///
/// | suffix | what is read |
/// | .nrrd .nhdr | one data file or several; raw, gzip, bzip2, text, hex; either byte order |
/// | .vti | inline or appended, zlib or uncompressed, one piece or several |
/// | .npy | versions 1 to 3, C or Fortran order, either byte order; booleans as u8 |
/// | .raw .bin, and others with `dims` | samples alone, as `dims` and `type` say; the size must match |
/// | .pvd .series | ParaView's series: one file of the above for each step, with its time |
///
/// Several paths: one step each, in the order given, stacked along a new last axis t (with the times of the
/// files where they have them, else 0, 1, 2, ...). All steps must be of the same type and on the same grid.
///
/// Axes without a name are called t (time) and x, y, z, or x0, x1, ... where there are more than three. Time
/// is moved to the end by its stride, whatever its place in the file. Where a file does not say which axis is
/// time, the last of four or more is.
///
/// NRRD: time is the axis of kind `time`, else of kind `list` (3D Slicer's sequences), else the one labelled
/// t or time. Axis mins are the position of sample 0, unless `centerings` says cell. Space directions along
/// an axis of the space of their own become origins and spacings, others FieldInfo::world, unless the space
/// has more dimensions than the field has axes in it: then only the spacings are kept.
///
/// VTI: the array `variable`, else the active scalars, else the first with one component; of points, else of
/// cells, whose centres are the samples then. Axes of one sample are left out: a flat image has two axes.
///
/// A file can ask for no more memory than its size accounts for. Errors: file_not_found, file_unreadable,
/// file_malformed, file_unsupported (among others 64-bit integers and vectors), out_of_memory;
/// invalid_argument for options that do not fit the format.
Result<std::unique_ptr<FieldReader>> open_field(const std::vector<std::filesystem::path>& paths,
                                                const ReadOptions& options = {});

/// How to write a field.
struct WriteFieldOptions {
  std::string format;    ///< "nrrd", "npy", "raw", "vti", "pvd"; empty: by the suffix of the path
  bool compress = false; ///< nrrd: gzip; vti always is; npy and raw cannot be
};

/// Writes a field, whole or not at all.
///
/// | format | what is kept beside the samples |
/// | nrrd | all of FieldInfo; uneven axes by keys of our own (`hyperiso axis coordinates t:=...`) |
/// | vti, pvd | the name, evenly spaced axes and the times |
/// | npy, raw | dims and type; only the samples |
///
/// vti takes fields of up to three axes beside time. With time, it becomes a series: PATH_0000.vti, ... and a
/// .pvd beside them that names them, also if the path ends in .vti. Axes whose coordinates fall are written
/// backwards there. An affine map keeps the positions in the world, not the axis coordinates.
/// Errors: file_unwritable; file_unsupported where the format cannot hold the field; invalid_argument.
Status write_field(const Field& field, const std::filesystem::path& path,
                   const WriteFieldOptions& options = {});

/// Whether `write_field` can write such a field to that path: to be told before the work. The same errors.
Status check_field_format(const FieldInfo& info, const std::filesystem::path& path,
                          const WriteFieldOptions& options = {});

/// Files that take their places together. A write that is given a group completes its file under a temporary
/// name; `commit` renames all of them, in the order in which they were written. A group that is destroyed
/// without it, or after an error, removes what has not taken its place. Pipes and devices are written at
/// once.
class FileGroup {
 public:
  FileGroup();
  FileGroup(FileGroup&&) noexcept;
  ~FileGroup();

  /// Makes a folder for files of the group, and those around it, where there is none. Without `commit` they
  /// are removed again, if they are empty. Error: file_unwritable.
  Status make_folder(const std::filesystem::path& folder);
  /// The files that are complete, as they were named.
  std::vector<std::filesystem::path> files() const;

  /// Signals to this thread wait until all files have their places. Error: file_unwritable. Call once, last.
  Status commit();

 private:
  friend class AtomicFile;
  void remove_folders();
  std::vector<AtomicFile> files_;
  std::vector<UnfinishedFile*> folders_; // that were made, outer ones first
};

/// How to write a mesh.
struct WriteMeshOptions {
  std::string format =
      {}; ///< "vtu", "vtp", "ply", "stl", "obj", "off", "svg", "geojson"; empty: by the suffix of the path
  std::vector<std::string> axis_names = {}; ///< in R^4 the last one names the point data `t`
  std::vector<std::string> axis_units = {}; ///< svg, geojson: told beside the names
  bool keep_edges = true; ///< vtu, vtp: store Mesh::edges and grid_axes, so that slices at steps stay exact
  FileGroup* group = nullptr; ///< none: the file takes its place at once
};

/// Writes a mesh of dimension 2, 3 or 4, whole or not at all (written beside the target and renamed; a pipe
/// or device, such as /dev/stdout, is written as it is).
///
/// | format   | simplices                          | of the mesh it keeps                                 |
/// | vtu      | segments to 7-simplices            | all, to the bit                                      |
/// | vtp      | segments, triangles; not in R^4    | all, to the bit; but segments without attributes of  |
/// |          |                                    | their own are joined into lines (see polylines)      |
/// | ply      | triangles; not in R^4              | positions as they are; attributes, one property a    |
/// |          |                                    | component: NAME, or NAME_0, NAME_1, ...; 64-bit      |
/// |          |                                    | integers as 32-bit ones or, where too large, double; |
/// |          |                                    | integers red, green and blue from 0 to 255 as bytes: |
/// |          |                                    | the colours of the vertices; normals as nx, ny, nz   |
/// | stl      | triangles; not in R^4              | positions, f32, unshared; normals are computed, 0    |
/// |          |                                    | for a triangle without area                          |
/// | obj, off | triangles, obj also segments;      | positions, in as many digits as it takes             |
/// |          | not in R^4                         |                                                      |
/// | svg      | segments in R^2                    | a picture of the lines: axes, names and units; a     |
/// |          |                                    | path for each line, closed or open                   |
/// | geojson  | segments in R^2                    | a LineString for each line, in its own coordinates;  |
/// |          |                                    | inside on its left, closed ones end where they begin |
///
/// Of attributes svg, geojson, stl, obj and off keep nothing.
/// Points of a mesh in R^2 get z = 0. Of a mesh in R^4 they are x, y, z; point data `t` is the fourth
/// coordinate and `xyzt` has all four, so that a contour of `t` in ParaView is a slice in time. In higher
/// dimensions the points are the first three coordinates, `t` the last, and `coordinates` has all. VTK has no
/// cell for 4-simplices and larger ones: they are poly vertices, whole for `read_mesh`, points to others. vtu
/// and vtp hold their arrays inline, base64 of zlib, the only encoding that all of Debian's VTK programs
/// read.
///
/// Cost: a vtu of four million tetrahedra takes about a second on one core, the others less; memory: one
/// block of an array (in a pipe: one array). Errors: file_unwritable; file_unsupported where the format
/// cannot hold the mesh, saying which can; invalid_argument if the mesh contradicts itself or an attribute's
/// name is taken, or, as svg and geojson, has branching lines or coordinates that are not finite;
/// out_of_memory.
Status write_mesh(const Mesh& mesh, const std::filesystem::path& path, const WriteMeshOptions& options = {});

/// Whether `write_mesh` has a format for simplices of dimension `simplex_dimension` in R^dimension at that
/// path: to be told before the work. Error: file_unsupported, as `write_mesh` would give it.
Status check_mesh_format(int dimension, int simplex_dimension, const std::filesystem::path& path,
                         const WriteMeshOptions& options = {});

/// Writes a mesh that comes in pieces, slab by slab (stream.hpp), and need never be in memory as a whole: the
/// file that `write_mesh` would write, in every format. Until `finish` the arrays of the mesh lie in
/// temporary files beside the target (beside a pipe or device: in the system's temporary folder), which are
/// removed in any case; then they are joined. Memory: a few hundred kilobytes. Room on the disk: that of the
/// arrays, beside the file.
class MeshFileWriter {
 public:
  /// Opens the temporary files. Errors: file_unwritable; file_unsupported, as `check_mesh_format` gives it.
  static Result<MeshFileWriter> create(int dimension, int simplex_dimension,
                                       const std::filesystem::path& path,
                                       const WriteMeshOptions& options = {});
  MeshFileWriter(MeshFileWriter&&) noexcept;
  MeshFileWriter& operator=(MeshFileWriter&&) noexcept;
  ~MeshFileWriter();

  /// Adds vertices and simplices, whose corners are vertices of any piece so far, numbered on from piece to
  /// piece. Positions are f32 in all pieces or f64 in all. `edges` and `grid_axes` are written if the first
  /// piece has them; active cells add up. Errors: file_unwritable (the disk is full); invalid_argument if the
  /// piece contradicts the others or itself, or has attributes; out_of_memory.
  Status append(const Mesh& piece);
  /// Writes the file. Errors: those of `write_mesh`. Call once, last.
  Status finish();

 private:
  struct Parts;
  explicit MeshFileWriter(std::unique_ptr<Parts> parts);
  std::unique_ptr<Parts> parts_;
};

/// Reads a mesh, by the suffix of its name. vtu and vtp that write_mesh wrote come back as they were, with
/// attributes and, if they were kept, grid edges and axes; where another program has changed the mesh so that
/// the edges fit no grid any more, they are left out. vtu and vtp by others may be ascii, inline or appended,
/// with or without zlib, and hold one piece with one kind of simplex; ply, stl (also text; not welded), obj
/// and off hold triangles, or obj segments. Positions are f32 or f64 as the file has them, f64 from text.
/// A mesh is in R^4 if it has point data `xyzt`, in a higher dimension or in R^2 if write_mesh noted so or,
/// from vtu and vtp by others, if it holds segments with z = 0 only, else in R^3. Errors: file_not_found,
/// file_unreadable, file_malformed, file_unsupported, out_of_memory.
Result<Mesh> read_mesh(const std::filesystem::path& path);

/// One step of a series of files.
struct SeriesEntry {
  double time;
  std::filesystem::path file; ///< relative to the series file
};
/// Writes a ParaView .pvd that names the files and their times. Errors: file_unwritable, out_of_memory.
Status write_series(const std::vector<SeriesEntry>& entries, const std::filesystem::path& path,
                    FileGroup* group = nullptr);

/// Removes the temporary files and new folders of writes under way in this process. For a program's handler
/// of the signals that end it (async-signal-safe); the writes themselves fail if they go on.
void remove_unfinished_files() noexcept;

} // namespace hyperiso
