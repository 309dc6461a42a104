#pragma once
// The formats of fields, a file for reading and one for writing each.
//
// Readers: errors as open_field says.

#include "hyperiso/io.hpp"
#include "io/atomic_file.hpp"

#include <optional>

namespace hyperiso {

using OpenedField = Result<std::unique_ptr<FieldReader>>;

OpenedField open_raw(const std::filesystem::path& path, const ReadOptions& options);
OpenedField open_nrrd(const std::filesystem::path& path, const ReadOptions& options);
OpenedField open_npy(const std::filesystem::path& path, const ReadOptions& options);

// Several files that are one field.
OpenedField open_pvd(const std::filesystem::path& path, const ReadOptions& options);
OpenedField open_series(const std::filesystem::path& path, const ReadOptions& options);
OpenedField open_list(const std::vector<std::filesystem::path>& paths, const ReadOptions& options);

// A field in one file that may be a step of a series, with its time if the file tells it.
struct OpenStep {
  std::unique_ptr<FieldReader> reader;
  std::optional<double> time;
};
Result<OpenStep> open_vti_step(const std::filesystem::path& path, const ReadOptions& options);
// Any format of a single file.
Result<OpenStep> open_step(const std::filesystem::path& path, const ReadOptions& options);

// Writers: what fails goes to the AtomicFile. Fields have samples and, where there is a check, have passed
// it: it says whether the format can hold such a field (file_unsupported).
Status check_fits_nrrd(const FieldInfo& info, const std::filesystem::path& path);
void write_nrrd(AtomicFile& file, const Field& field, bool compress);
void write_npy(AtomicFile& file, const Field& field);
void write_raw(AtomicFile& file, const Field& field);
Status check_fits_vti(const FieldInfo& info, const std::filesystem::path& path);
void write_vti(AtomicFile& file, const Field& field); // no time axis
// The steps as .vti beside `path`, then `path` with the suffix .pvd, which names them.
Status write_vti_series(const Field& field, const std::filesystem::path& path);

} // namespace hyperiso
