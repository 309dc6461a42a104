#pragma once
/// \file
/// Cuts of isosurfaces by hyperplanes: the surface at a moment, or on any plane.

#include "hyperiso/extract.hpp"
#include "hyperiso/step_source.hpp"

#include <array>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

namespace hyperiso {

/// The points x with normal . x = offset.
template <int D>
struct Hyperplane {
  std::array<double, D> normal{}; ///< not 0; need not be a unit vector
  double offset = 0;

  /// x[axis] = value; `axis` D-1 is usually time.
  static Hyperplane at(int axis, double value) {
    Hyperplane plane;
    plane.normal[static_cast<std::size_t>(axis)] = 1;
    plane.offset = value;
    return plane;
  }
};

/// Coordinates on a plane. They differ for oblique planes only: on a plane across one axis both are those of
/// the other axes in their order.
enum class SliceFrame {
  orthonormal, ///< along an orthonormal basis: lengths and angles are true
  axes,        ///< those of the axes without the one most aligned with the normal: places are true
};

/// How coordinates on a plane belong to points in space. `rows` take a point on the plane to its coordinates;
/// the point with coordinates u is foot + sum of u[k] * directions[k]. With `orthonormal` both are a basis of
/// the plane, and `foot` is its point nearest to the origin.
struct PlaneCoordinates {
  std::vector<std::vector<double>> rows, directions; ///< D - 1 rows of D
  std::vector<double> foot;                          ///< D
};
template <int D>
PlaneCoordinates plane_coordinates(const Hyperplane<D>& plane, SliceFrame frame);

/// The coordinate along an axis of space (the time, say) of each vertex of a cut in the plane's `frame`, as
/// a vertex attribute of its own; on an oblique plane the coordinates of the cut do not tell.
template <int D>
Attribute axis_on_slice(const Mesh& cut, const Hyperplane<D>& plane, SliceFrame frame, int axis,
                        std::string name);

struct SliceOptions {
  Precision precision = Precision::f32; ///< of the positions; they are computed in double in any case
  bool welded = true; ///< false: pieces of different simplices of the mesh share no vertices; of SliceIndex,
                      ///< no two pieces do
  SliceFrame frame = SliceFrame::orthonormal;
};

/// Cuts a mesh of K-simplices in R^D (K = D-1: a surface, K = D: a volume) by a hyperplane into a mesh of
/// (K-1)-simplices in R^(D-1), welded and oriented as `mesh` is.
///
/// Coordinates: for a plane across one axis, those of the other axes in their order; for an oblique plane, by
/// SliceFrame; the orthonormal basis is that of the axes without the one most aligned with the normal, made
/// orthonormal in their order. Normals of a surface point from + to -; simplices of a volume whose simplices
/// are oriented positively are oriented positively.
///
/// A cut vertex lies on one edge of the mesh; a vertex exactly on the plane counts as beyond it (normal . x
/// >= offset). So a plane through vertices or along whole simplices needs no special treatment: the cut stays
/// a manifold wherever the mesh is one; it may hold simplices without content.
/// A plane that holds samples (across an axis, at a coordinate of `mesh.grid_axes`) gives the trace of the
/// mesh there instead: the mesh that `extract` makes of these samples alone, vertex for vertex and simplex
/// for simplex, with its own grid edges, wherever a cell without NaN touches them. That needs `mesh.edges`;
/// without them such a plane is cut like any other. Of an interval volume it is the volume that `interval`
/// makes of these samples.
///
/// Attributes come along: those of vertices interpolated along the edges, those of simplices copied. Of the
/// attribute `normal` the part in the plane is left, in the coordinates of the cut and of length 1: it is the
/// normal of the cut.
///
/// D = 3, 4 for surfaces and for volumes. As a set the cut depends on the order of the vertices, not of the
/// simplices, and is the same for a mesh and for any slab of it that holds the plane. A plane that misses the
/// mesh gives an empty mesh.
/// Cost: one pass over the mesh; 0.1 s for a few million simplices cut. Errors: invalid_argument if the
/// normal is 0 or not finite; out_of_memory.
template <int D, int K>
Result<SimplexMesh<D - 1, K - 1>> slice(const SimplexMesh<D, K>& mesh, const Hyperplane<D>& plane,
                                        const SliceOptions& options = {});

/// A slice that moves for a while: its vertices where they are first, and where they are last. Positions and
/// attributes of vertices differ; the simplices and their attributes are the same in both.
template <int D>
struct MovingSlice {
  SimplexMesh<D - 1> start, end;
};

/// The slice of a surface across `axis` at `start`, moving until `end`, which may come before it. Each vertex
/// lies on one edge of the mesh and slides along it: to where the edge is at `end`, or to the end of the edge
/// where that comes first. Welded and oriented as `slice`, with its attributes.
///
/// The simplices are those of the surface as it is just after `start` (on the side of `end`). Seen as points,
/// `start` is `slice(mesh, Hyperplane<D>::at(axis, start))` without what ends there; where vertices of the
/// mesh have just that time, as at a stored step, several vertices start from one point, and simplices
/// without extent. Until the next time of any vertex of the mesh the points at the share w of the way are the
/// slice at that share of the time, to rounding; from then on they are an approximation that keeps the
/// topology of the start.
///
/// For renderers that blend: as morph targets of glTF.
/// Cost: one pass over the mesh. Types: D = 3, 4. Errors: invalid_argument if `axis` is none or if `start`
/// and `end` are equal or not finite; out_of_memory.
template <int D>
Result<MovingSlice<D>> moving_slice(const SimplexMesh<D>& mesh, double start, double end,
                                    Precision precision = Precision::f32, int axis = D - 1);

/// A mesh prepared for many cuts: its simplices in chunks that lie together, each with a box around it, the
/// positions of its vertices and its edges, by which the chunks that a plane meets are cut without looking
/// anywhere else.
template <int D, int K = D - 1>
class SliceIndex {
 public:
  /// Cost: sorts the simplices by place, slabs of the last axis (time) first, then along a Morton curve:
  /// about a microsecond and 40 bytes per simplex. Throws std::bad_alloc.
  explicit SliceIndex(const SimplexMesh<D, K>& mesh);

  /// `slice(mesh, plane, options)`, its vertices and simplices in the order of the index. Requires the mesh
  /// of the constructor, unchanged. May be called from several threads at once.
  /// Cost: 10 nanoseconds for each chunk of several hundred simplices, and then 15 to 50 for each simplex of
  /// the cut. A plane that holds samples costs about a microsecond for each simplex of the cut.
  Result<SimplexMesh<D - 1, K - 1>> slice(const SimplexMesh<D, K>& mesh, const Hyperplane<D>& plane,
                                          const SliceOptions& options = {}) const;

  /// The same into `cut`, replacing what it holds but keeping its memory. After an error it holds nothing of
  /// use.
  Status slice_into(const SimplexMesh<D, K>& mesh, const Hyperplane<D>& plane, const SliceOptions& options,
                    SimplexMesh<D - 1, K - 1>& cut) const;

 private:
  struct Chunks;
  std::shared_ptr<const Chunks> chunks_; // never changes
};

/// How a field is cut.
struct FieldSliceOptions : ExtractOptions {
  SliceFrame frame = SliceFrame::orthonormal;
  bool with_normals = false; ///< the attribute `normal`, of the gradient (see interpolate.hpp)
  struct Other {
    std::string name;
    StepSource* source; ///< a field of the same grid; must outlive the slicer
  };
  std::vector<Other> others = {}; ///< further fields, interpolated at the surface: attributes of their names
};

/// Cuts of the isosurface of a field (K = D-1) or of an interval volume (K = D), without the D-mesh:
/// `slice(extract(field), plane)`, or of `interval(field, levels)`, as a set of vertices and simplices, with
/// the same attributes.
///
/// Of the last axis (steps, if it is time) it reads what the plane meets: of a plane across it, the samples
/// around it; of any other plane, slab after slab of two samples each; for normals one more on both sides;
/// the pieces of neighbouring slabs are welded by the identity of the mesh edges that their vertices lie on.
/// A plane that holds samples gives the extraction of these samples, also where NaN surrounds them. (With
/// Method::barycentric, whose meshes have no grid edges, other planes take the whole field.)
/// Cuts across the last axis between the same two samples share one surface, indexed: so a series of many
/// moments in their order extracts every slab once.
/// Memory: the samples of a slab, its part of the surface and the cut; nothing else stays.
template <int D, int K = D - 1>
class FieldSlicer {
 public:
  /// `source` has D axes and must outlive the slicer. `levels`: of a surface its isovalue alone, of a volume
  /// two or more. Volumes take no normals and no other fields.
  FieldSlicer(StepSource& source, std::vector<double> levels, FieldSliceOptions options = {});
  FieldSlicer(StepSource& source, double isovalue, FieldSliceOptions options = {}) requires(K == D - 1)
      : FieldSlicer(source, std::vector<double>{isovalue}, std::move(options)) {}
  ~FieldSlicer();
  FieldSlicer(FieldSlicer&&) noexcept;

  /// Errors: those of `extract` or `interval`, `add_point_data`, the source and the other `slice`;
  /// outside_domain if a plane across an axis misses the field. An oblique plane that misses it gives an
  /// empty mesh.
  Result<SimplexMesh<D - 1, K - 1>> slice(const Hyperplane<D>& plane);

  /// `moving_slice` of the surface across its last axis, from the samples around `start` alone: vertices stop
  /// at the next samples at the latest, where all edges of the mesh end. Errors: as above; outside_domain if
  /// the field is not there from `start` on.
  Result<MovingSlice<D>> moving_slice(double start, double end) requires(K == D - 1);

 private:
  class Work;
  std::unique_ptr<Work> work_;
};

/// The same for one cut of a field in memory. Types: all of SampleType; D = 3, 4.
template <class T, int D>
Result<SimplexMesh<D - 1>> slice(const FieldView<const T, D>& field, double isovalue,
                                 const Hyperplane<D>& plane, const ExtractOptions& options = {}) {
  FieldSteps steps(unowned_field(field));
  FieldSliceOptions how;
  static_cast<ExtractOptions&>(how) = options;
  return FieldSlicer<D>(steps, isovalue, std::move(how)).slice(plane);
}

struct SampleRange {
  std::int64_t begin, end;
};

/// The samples of an axis that a plane at `value` needs: one if it holds samples, else the two around it.
/// Error: outside_domain if `value` is not between the first and the last coordinate; names axis and range.
Result<SampleRange> samples_around(const Axis& axis, double value);

} // namespace hyperiso
