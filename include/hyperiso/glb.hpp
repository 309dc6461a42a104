#pragma once
/// \file
/// A surface through time as one binary glTF 2.0 file, for viewers, browsers and presentations.

#include "hyperiso/io.hpp"

#include <filesystem>
#include <memory>
#include <string>

namespace hyperiso {

struct GlbOptions {
  double frames_per_second = 10; ///< how long the last frame is shown
  bool quantised = false; ///< positions in 65536 steps over the largest extent of the series, 32768 if frames
                          ///< move, normals in 255: half the size (KHR_mesh_quantization)
  std::string name = {};  ///< of the surface
  std::string space_unit = {}; ///< noted; glTF's own unit is the metre, whatever the coordinates mean
  std::string time_unit = {};  ///< noted with the time of each frame
};

/// Frames of a surface, one after the other, in memory until they are written.
///
/// Baked frames: each is a node of its own, "frame 0", "frame 1", ..., with the extra `time`; an animation
/// with STEP interpolation scales one of them to 1 at every moment and the others to 0. Where the topology
/// changes nothing pops but what changes, and every viewer that plays glTF plays it. A frame that knows where
/// its vertices go has one morph target, there; the animation moves it evenly from its own positions to these
/// while it is shown.
///
/// glTF's y axis points up: the node "surface" above all frames turns (x, y, z) into (x, z, -y). Coordinates
/// keep their numbers, rounded to f32, whatever their unit is. Points in R^2 get z = 0.
///
/// A frame is a mesh of triangles in R^3 or of segments in R^2 or R^3. Triangles have normals: the vertex
/// attribute `normal`, or the mean of the triangles around a vertex. Vertex attributes `red`, `green`, `blue`
/// become vertex colours, which stay as the frame moves. By a simplex attribute `track_id` a frame is divided
/// into a child node for each track, "track 3", in the colour label_colour(3).
class GlbMovie {
 public:
  explicit GlbMovie(GlbOptions options = {});
  GlbMovie(GlbMovie&&) noexcept;
  ~GlbMovie();

  /// The frame of the moment `time`, shown from `seconds` on: 0 for the first frame, then ascending. `end`:
  /// the same mesh with its vertices, and their attribute `normal`, as they are to be when the next frame is
  /// shown (of moving_slice); null for a frame that stands still. Errors: invalid_argument for a mesh of
  /// other simplices, for an end with other vertices and for seconds that do not ascend; out_of_memory.
  Status add(const Mesh& frame, double time, double seconds, const Mesh* end = nullptr);

  /// Writes the file, whole or not at all. Errors: file_unwritable; file_unsupported where it would pass the
  /// 4 GiB that a .glb can hold; invalid_argument if there are no frames; out_of_memory.
  Status write(const std::filesystem::path& path, FileGroup* group = nullptr) const;

 private:
  struct Frame;
  GlbOptions options_;
  std::vector<Frame> frames_;
  double before_ = 0; // seconds of the last frame
  friend class GlbWriter;
};

} // namespace hyperiso
