#pragma once
// The surface at one moment after the other, whatever it comes from.

#include "cli/point_data.hpp"
#include "cli/surface.hpp"
#include "cli/tracked_folder.hpp"

#include <memory>

namespace hyperiso::cli {

// A frame that moves: the same mesh with the vertices where they are first and last.
struct MovingFrame {
  Mesh start, end;
};

// What is shown: the surface of a field or of a mesh file through its last axis.
class Frames {
 public:
  virtual ~Frames() = default;
  virtual const std::vector<Axis>& axes() const = 0;   // of the field or of the space of the mesh; time last
  virtual std::pair<double, double> times() const = 0; // the first and the last there are
  virtual void check(double time) const = 0;           // fails for a moment that there is no surface of
  virtual Mesh at(double time) = 0;                    // cheapest in the order of time
  virtual MovingFrame moving(double time, double until) = 0; // until: later; see moving_slice
  virtual double read_seconds() const = 0;
  // The times at which components are born, die, merge, split or change otherwise. Fails for a mesh.
  virtual std::vector<double> events() = 0;
};

// Of a field, slab by slab.
std::unique_ptr<Frames> frames_of_field(const FieldOptions& input, double isovalue,
                                        const SurfaceOptions& surface, const PointDataOptions& data,
                                        bool normals, const MachineOptions& machine,
                                        const PrintOptions& printing);

// The same with the simplex attribute `track_id`: by the track that a piece was in at the step before. The
// whole surface is in memory. `folder`: whose tracks they have to be, or null.
std::unique_ptr<Frames> frames_with_tracks(const FieldOptions& input, const TrackingOptions& tracking,
                                           const TrackedFolder* folder, const SurfaceOptions& surface,
                                           const PointDataOptions& data, bool normals,
                                           const MachineOptions& machine, const PrintOptions& printing);

// Of a mesh file, indexed.
std::unique_ptr<Frames> frames_of_mesh(const std::string& path, const SurfaceOptions& surface,
                                       const MachineOptions& machine, const PrintOptions& printing);

} // namespace hyperiso::cli
