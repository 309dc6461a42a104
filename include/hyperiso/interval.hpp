#pragma once
/// \file
/// Interval volumes: where a field lies between two levels, or between several (paper 000 section 6, paper
/// 003 section 4).

#include "hyperiso/extract.hpp"

#include <span>

namespace hyperiso {

/// Where the axis of levels stands in the order of the table (Method::hull). It decides how cells are cut:
/// `last` folds less, `first` is paper 000's order of its example.
enum class LevelAxis { last, first };

struct IntervalOptions : ExtractOptions {
  LevelAxis level_axis = LevelAxis::last;
};

/// Fills the volume between the levels with D-simplices in R^D: samples with levels.front() <= value <
/// levels.back() are in it; with Inside::below, levels.front() < value <= levels.back(). That matters where
/// the field is flat at a level.
///
/// The field is lifted by one axis, along which the levels are taken off it; the isosurface at 0 of the
/// lifted field, projected along that axis, is the volume. Nothing of the lifted field is stored. Within each
/// level the mesh holds the isosurface of the field at that level as `extract` makes it (with
/// LevelAxis::last), so volumes of adjoining ranges, and the levels of one call, fit together without a seam.
///
/// Vertex attributes: `level`, the number of the level, fractions between two; `isovalue`, the same in the
/// field's values: linear in between. Mesh::edges number the edges of the lifted grid, whose axes are
/// Mesh::grid_axes with the levels as the last.
///
/// Guarantees: every (D-1)-face lies in one or two simplices, in two with opposite orientation; simplices are
/// oriented positively, but for those that fold: with the hull method a few may project with the wrong sign
/// (Measure::inverted_simplices): on random 3D values 0.7 %, with LevelAxis::first 1 %; hardly any on
/// smooth fields. With Method::simplicial none can: prefer it where simplices are integrated over, at about
/// five times the number. `inside` decides which side an ambiguous cell keeps together, not which volume is
/// filled.
///
/// A volume of a 4D field, whose last axis is time, is one through time (paper 003 section 4): `slice` of it
/// at a stored time is the volume of that step, vertex for vertex and simplex for simplex.
///
/// Types: all of SampleType; D = 2, 3, 4. Cost: that of an extraction of the lifted field; `memory_limit` is
/// for its surface, of which the volume is made in place, and the attributes. Errors: those of `extract`;
/// invalid_isovalue if there are fewer than two levels or they do not increase.
template <class T, int D>
Result<VolumeMesh<D>> interval(const FieldView<const T, D>& field, std::span<const double> levels,
                               const IntervalOptions& options = {});

template <class T, int D>
Result<VolumeMesh<D>> interval(const FieldView<const T, D>& field, double low, double high,
                               const IntervalOptions& options = {}) {
  const double levels[] = {low, high};
  return interval(field, std::span<const double>(levels), options);
}

} // namespace hyperiso
