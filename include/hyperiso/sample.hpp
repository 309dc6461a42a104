#pragma once
/// \file
/// Built-in fields, for trying things out, for tests and for benchmarks: known shapes in any dimension.

#include "hyperiso/field.hpp"
#include "hyperiso/progress.hpp"

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace hyperiso {

/// A built-in field. Axes of space run from -1 to 1; time, where there is one, from 0 to `end_of_time`.
struct SampleField {
  const char* name;
  const char* description; ///< one line: the surface, and what it does through time
  double isovalue;         ///< one that shows the shape
  double end_of_time;      ///< 1, torus-morph 2
  double still;            ///< the moment that is shown where no axis is time
};

/// | name | value at x, c = where its centre is at that time |
/// | gaussians | sum over the blobs of exp(-|x-c|^2 / 0.08); at 0.5, blobs that approach and merge |
/// | gyroid | sum over the axes of sin(2 pi x_i) cos(2 pi x_(i+1)), shifted once through by time |
/// | ball | 1 - |x-c|: at 0.5, a ball of radius 1/2; it moves from x = -0.4 to 0.4, and is at 0 when still |
/// | torus-morph | sphere (t = 0) -> torus (1; also still) -> two spheres (2), after paper 000 figure 7 |
/// | marschner-lobb | the signal of Marschner and Lobb (IEEE Visualization 1994), its rings moving out |
/// | noise | independent uniform numbers in [0, 1): every case of every table, no shape at all |
std::span<const SampleField> sample_fields();

struct SampleOptions {
  std::vector<std::int64_t> dims = {}; ///< samples per axis, 2 to 8 axes, axis 0 fastest
  SampleType type = SampleType::f32;
  std::optional<bool> time = {};           ///< whether the last axis is time; left out: yes from 4 axes on
  int blobs = 2;                           ///< gaussians: how many, at least 1
  std::uint64_t seed = 1;                  ///< noise, and where more than two blobs start
  std::uint64_t memory_limit = UINT64_MAX; ///< bytes of samples
  Progress progress = {};
};

/// Makes a built-in field. The same options give the same samples, on every machine with IEEE doubles and the
/// same libm. Axes are named x, y, z, u, v, w, p, q, time t.
///
/// Values are computed in double and rounded to `type`. Integer types hold them scaled: the field's range
/// (0 to 1; gaussians 0 to 2; the gyroid as far as it goes) covers the range of the type, the nearest integer
/// is taken and what lies outside is clamped. `sample_isovalue` goes the same way, unrounded.
///
/// Errors: invalid_argument for an unknown name (the message lists them), fewer than 2 or more than 8 axes,
/// an axis without samples or no blobs; out_of_memory; cancelled.
Result<Field> make_sample(const std::string& name, const SampleOptions& options);

/// What `make_sample` would make. Errors: invalid_argument, as there.
Result<FieldInfo> describe_sample(const std::string& name, const SampleOptions& options);

/// The isovalue for a field made by `make_sample` with these options. Requires that the name is known.
double sample_isovalue(const std::string& name, const SampleOptions& options);

} // namespace hyperiso
