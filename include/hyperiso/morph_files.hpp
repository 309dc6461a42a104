#pragma once
/// \file
/// Moving pieces as files.

#include "hyperiso/io.hpp"
#include "hyperiso/morph.hpp"

#include <filesystem>

namespace hyperiso {

/// Writes moving pieces, whole or not at all. By the suffix of the path:
///
/// | format | what it holds |
/// | .npz | arrays of NumPy, uncompressed, with a row for each piece |
/// | any of write_mesh | `morph_mesh`: the starts, with the ends as point data; vtu and vtp keep all of it |
///
/// The arrays: start and end (pieces x corners x coordinates, f32 or f64), start_time and end_time (f64),
/// simplex (u64).
///
/// Errors: those of write_mesh; file_unsupported for other suffixes.
template <int D>
Status write_morph(const MorphPieces<D>& pieces, const std::filesystem::path& path,
                   FileGroup* group = nullptr);

/// Whether `write_morph` has a format for pieces of a surface in R^dimension at that path: to be told before
/// the work. Error: file_unsupported.
Status check_morph_format(int dimension, const std::filesystem::path& path);

} // namespace hyperiso
