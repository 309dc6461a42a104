#pragma once
// Where frames go: films, glTF, series and numbered files.

#include "cli/point_data.hpp"
#include "cli/surface.hpp"
#include "hyperiso/colours.hpp"

#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace hyperiso::cli {

struct MovieOptions;

// What the frames of a movie have in common.
struct Series {
  std::vector<Axis> axes; // time last
  std::vector<double> times;
  std::optional<double> isovalue;
  int threads = 0;
  // Of all frames looked at: where they are, and the values that they are coloured by.
  std::vector<double> low, high;
  std::optional<ColourRange> range;

  void look_at(Mesh frame, const MovieOptions& options);
};

class Movie {
 public:
  virtual ~Movie() = default;
  // `end`: where the frame moves until the next one, if it does.
  virtual void add(Mesh frame, std::optional<Mesh> end, std::size_t number) = 0;
  virtual void finish() = 0; // the files take their places
};

// -o and what belongs to some of its suffixes
struct MovieOptions {
  std::string path, fps, size, view;
  bool quantised = false, morphs = false;

  void add_to(CLI::App& app, const PointDataOptions& data);
  // Fails for what cannot be, before anything is read.
  void check() const;
  void check_frames(int dimension) const; // of the space of the frames
  bool is_drawn() const;                  // films and pictures
  bool is_shaded() const;                 // by normals: what is drawn, and .glb
  bool needs_survey() const;              // all frames have to be looked at first
  // The attribute that frames are coloured by; empty: none.
  const std::string& colour_by() const { return data_->colour_by; }
  bool has_colour_range() const;
  std::unique_ptr<Movie> open(Series& series) const; // `series` must outlive it

 private:
  enum class Kind { series, numbered, pictures, glb, film };
  Kind kind() const;
  double frames_per_second() const;
  std::pair<int, int> pixels() const;
  std::pair<double, double> direction() const; // azimuth, elevation

  const PointDataOptions* data_ = nullptr;
};

// Colours the vertices of a frame by an attribute or, where that is the name of an axis, a coordinate.
void colour(Mesh& frame, const std::string& name, const std::vector<Axis>& axes,
            const std::optional<ColourRange>& range);

} // namespace hyperiso::cli
