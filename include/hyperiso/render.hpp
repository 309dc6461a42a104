#pragma once
/// \file
/// Pictures and films of a surface, drawn without a screen: ray casting with Intel Embree, text with cairo,
/// films by the program ffmpeg. Where hyperiso was built without Embree or cairo, everything here gives an
/// error that says so.

#include "hyperiso/colours.hpp"
#include "hyperiso/io.hpp"

#include <array>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

namespace hyperiso {

/// Rows from the top, pixels from the left, sRGB: width x height x 3 bytes.
struct Image {
  int width = 0, height = 0;
  std::vector<std::uint8_t> pixels;
};

/// What the pictures of a series have in common. The camera looks at the middle of the box and is as near as
/// it can be with all of the box in the picture; the last axis points up.
struct RenderOptions {
  int width = 960, height = 720;       ///< each 64 to 8192; even for .mp4
  double azimuth = -60;                ///< of the camera, in degrees from axis 0 towards axis 1
  double elevation = 25;               ///< in degrees above the plane of these; -90 to 90
  std::vector<double> low, high;       ///< the box: of all frames of a series, two or three numbers each
  std::vector<std::string> axis_names; ///< written at its edges, with units if they have one
  std::string title = {};              ///< below the label
  struct ColourBar {
    std::string name;
    ColourRange range;
  };
  std::optional<ColourBar> colour_bar = {};
  int threads = 0; ///< 0: one per processor; the pictures do not depend on it
};

/// Whether hyperiso was built with Embree and cairo: an error that says what is missing.
Status check_rendering();

/// A picture of triangles in R^3, with smooth shading, four samples a pixel, inside and outside told apart;
/// or of segments in R^2. `label` stands in the upper left corner. The surface has the colours of the vertex
/// attributes `red`, `green`, `blue` (see colour_vertices), else those of the simplex attribute `track_id`
/// (see label_colour), else one. Normals: the vertex attribute `normal`, else the mean of the triangles
/// around a vertex.
///
/// Cost: about 0.2 s for 960 x 720 on one core, and a search tree over the triangles, about 0.2 s for a
/// million. Errors: invalid_argument for other simplices and for options that contradict themselves;
/// out_of_memory.
Result<Image> render(const Mesh& frame, const std::string& label, const RenderOptions& options);

/// Writes a picture, whole or not at all. Errors: file_unwritable, out_of_memory.
Status write_png(const Image& image, const std::filesystem::path& path, FileGroup* group = nullptr);

/// A film on its way: the program ffmpeg, which must be on PATH, encodes while the next picture is drawn.
/// By the suffix: .mp4 (H.264, 4:2:0, plays everywhere), .gif (one palette for all frames; ffmpeg holds them
/// until the end).
class FilmWriter {
 public:
  /// Errors: file_unwritable, also where ffmpeg is missing; file_unsupported for other suffixes;
  /// invalid_argument for odd sizes of .mp4.
  static Result<FilmWriter> create(const std::filesystem::path& path, int width, int height,
                                   double frames_per_second);
  FilmWriter(FilmWriter&&) noexcept;
  /// Ends ffmpeg and leaves no file, unless it was finished.
  ~FilmWriter();

  /// Requires the width and height given to `create`. Error: file_unwritable, with what ffmpeg says.
  Status add(const Image& image);
  /// The film takes its place. Call once, last. Errors: the same.
  Status finish();

 private:
  struct State;
  explicit FilmWriter(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

} // namespace hyperiso
