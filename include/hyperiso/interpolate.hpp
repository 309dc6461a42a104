#pragma once
/// \file
/// What else is known at the vertices of a surface: other fields of the same grid, and normals.

#include "hyperiso/extract.hpp"

#include <span>
#include <string>
#include <vector>

namespace hyperiso {

/// How far along its grid edge each vertex lies, from 0 at the lower end to 1 at the upper: (isovalue - a) /
/// (b - a) as `extract` computed it, in double, whatever the precision of the positions is.
///
/// `mesh` is a surface of `field` at `isovalue`, or of a crop of it (told by Axis::first), with its grid
/// edges; `field` may have been cropped too, as long as it holds the ends of all edges. Errors:
/// invalid_argument if the mesh has no grid edges (ExtractOptions::keep_edges; never by
/// Method::barycentric) or they are not edges of the field.
Result<std::vector<double>> vertex_weights(const Mesh& mesh, const Field& field, double isovalue);

/// Another field of the same grid at the vertices of a surface: linear between the two samples of the grid
/// edge of a vertex, by its weight: just where the surface is. NaN where one of them is, but for a vertex
/// that lies on the other. One component, float or double as the positions are. Cost: about 0.1 microsecond a
/// vertex. Errors: invalid_argument as above, also if there is not one weight for each vertex.
Result<Attribute> interpolate(const Mesh& mesh, std::span<const double> weights, const Field& field,
                              std::string name);

/// The unit normals of a surface at its vertices, pointing from + to -: D components, named
/// `normal_attribute`, which `slice` and `transform` turn along with the mesh. They come from the
/// gradient of the field that the surface is of: at each sample, differences with both neighbours along each
/// axis, in coordinates, weighed to be of second order on uneven axes too; with one neighbour at the end of
/// the grid and beside samples that are not finite; then linear along the grid edge. 0 where the gradient is.
/// Normals of a crop are those of the whole if `field` is the whole, or goes one sample further.
/// Errors: as above.
Result<Attribute> normals(const Mesh& mesh, std::span<const double> weights, const Field& field,
                          Inside inside = Inside::above);

/// A field and what it is called.
struct NamedField {
  std::string name;
  Field field;
};

/// Adds the values of `others` to the attributes of a surface of `field`, and its normals if `with_normals`.
/// Errors: as above; invalid_argument if a field is not on the grid of `field` or two attributes would have
/// one name.
Status add_point_data(Mesh& mesh, const Field& field, double isovalue, Inside inside,
                      std::span<const NamedField> others, bool with_normals);

} // namespace hyperiso
