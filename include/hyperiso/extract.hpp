#pragma once
/// \file
/// The isosurface of a field.

#include "hyperiso/field.hpp"
#include "hyperiso/mesh.hpp"
#include "hyperiso/progress.hpp"

#include <memory>
#include <span>
#include <vector>

namespace hyperiso {

/// Which samples are `+`: the side that the surface's table keeps together where a cell is ambiguous
/// (paper 000 section 2.1), and from which normals point away.
enum class Inside {
  above, ///< value >= isovalue
  below, ///< value <= isovalue
};

/// How a cell is filled with simplices.
enum class Method {
  hull, ///< facets of the convex hull of W+ (paper 000): fewest simplices, vertices on the edges of the grid
  component, ///< hulls of the components of the + side (paper 002): as many simplices and vertices, but where
             ///< a cell is ambiguous the - side is kept together; the surface of `hull` by the other sign
             ///< rule
  simplicial,  ///< cuts of the D! Kuhn simplices of a cell (paper 004): about five times as many, vertices
               ///< also on diagonals; the level set of the piecewise linear interpolant, so embedded in every
               ///< dimension
  barycentric, ///< cuts of the 2^(D-1) D! simplices of a cell's barycentric subdivision, whose centres have
               ///< the mean of their face's samples: what the papers compare with, for comparison only. Slow;
               ///< two dozen times the simplices
};

/// How `barycentric` cuts a simplex.
enum class Cut {
  midpoints, ///< recursive contour meshing (Weigle and Banks): a point in the middle of each piece that is no
             ///< simplex; 4 triangles in a tetrahedron, 14 tetrahedra in a 4-simplex
  staircase, ///< as `simplicial` does: 2 and 3
};

enum class Precision { f32, f64 };

/// Memory that an extraction takes besides its mesh, kept for the next one: that saves the system clearing it
/// again. Some bytes per row of samples and per active cell, until it is destroyed. For one call at a time.
class Workspace {
 public:
  Workspace();
  Workspace(Workspace&&) noexcept;
  Workspace& operator=(Workspace&&) noexcept;
  ~Workspace();

  struct State; ///< the library's own
  State& state() { return *state_; }

 private:
  std::unique_ptr<State> state_;
};

/// The least and the greatest of every 64 samples along axis 0 of a field, for one isovalue after another:
/// the first extraction notes them down as it reads, the next ones read only where their surfaces may be, and
/// give the same bytes. Two samples for every 64 (3 % of the field). Belongs to one field: another one (other
/// memory, shape or type) is noted down anew; after a change of the samples, call `clear`. Fields whose
/// samples along axis 0 do not lie one after the other are read whole every time, and so are those of more
/// than five dimensions. For one call at a time.
class FieldRanges {
 public:
  FieldRanges();
  FieldRanges(FieldRanges&&) noexcept;
  FieldRanges& operator=(FieldRanges&&) noexcept;
  ~FieldRanges();

  void clear(); ///< forgets the field

  struct State; ///< the library's own
  State& state() { return *state_; }

 private:
  std::unique_ptr<State> state_;
};

struct ExtractOptions {
  Method method = Method::hull;
  Cut cut = Cut::midpoints; ///< of Method::barycentric
  Inside inside = Inside::above;
  Precision precision = Precision::f32; ///< of the positions; they are computed in double in any case
  bool keep_edges = true; ///< fill Mesh::edges and Mesh::grid_axes (8 bytes per vertex; not barycentric)
  /// Bytes the surface may take; with barycentric, and in six and more dimensions, together with all that is
  /// held to make it. Checked before they are taken. Tables, made once for the process, are not counted:
  /// up to 20 MB, and up to 140 MB of entries that are kept in five dimensions.
  std::uint64_t memory_limit = UINT64_MAX;
  int threads = 0; ///< 0: one per processor; the result is the same for any number
  Progress progress = {};
  Workspace* workspace = nullptr; ///< for who extracts again and again
  FieldRanges* ranges = nullptr;  ///< for who extracts the same field again and again
};

/// Builds the isosurface of `field` as a welded, oriented mesh of (D-1)-simplices.
///
/// A sample is inside (`+`) iff `value >= isovalue` (or <=, see Inside), compared exactly. Every grid edge
/// (with `simplicial` every edge of the Kuhn grid) between a `+` and a `-` sample that belongs to a cell
/// without NaN carries one vertex, at t = (isovalue - a) / (b - a) from its lower end; where one end is
/// infinite it lies on the other, where both are, in the middle. Vertices ascend by the number of their grid
/// edge, simplices by their cell.
///
/// Guarantees: every (D-2)-face lies in one or two simplices, in two with opposite orientation; in one only
/// on the boundary of the grid or of the data (NaN). det[n; v1-v0; ...] > 0 for the normal n from `+` to `-`,
/// whatever the direction of the axes. A sample equal to the isovalue may put several vertices on one point:
/// nothing is merged by distance. A grid with fewer than two samples along an axis has no cell and no
/// surface.
///
/// Coordinates are those of the field's axes. Types: all of SampleType. Dimensions: hull and component 2 to 6
/// (tables are made as they are used from 5 on), simplicial 2 to 8, barycentric 2 to 5; from 6 on, and by
/// barycentric, by a plain loop on one thread. The vertices of `barycentric` come in no order and have no
/// grid edges. Errors: invalid_isovalue if it is not finite; unsupported_dimension; out_of_memory; cancelled.
template <class T, int D>
Result<SimplexMesh<D>> extract(const FieldView<const T, D>& field, double isovalue,
                               const ExtractOptions& options = {});

/// The same into `mesh`, replacing what it holds but keeping its memory: to extract again and again costs no
/// fresh pages, which on large surfaces cost more than the extraction. After an error the mesh holds nothing
/// of use.
template <class T, int D>
Status extract_into(const FieldView<const T, D>& field, double isovalue, const ExtractOptions& options,
                    SimplexMesh<D>& mesh);

/// The surfaces at several isovalues, in their order. The field is read whole once, and once more where the
/// surfaces are. `memory_limit` is for all of them. Errors: the same.
template <class T, int D>
Result<std::vector<SimplexMesh<D>>> extract(const FieldView<const T, D>& field,
                                            std::span<const double> isovalues,
                                            const ExtractOptions& options = {});

} // namespace hyperiso
