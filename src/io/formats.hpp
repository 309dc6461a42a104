#pragma once
// The formats of fields, one file each. Errors as open_field says.

#include "hyperiso/io.hpp"

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

} // namespace hyperiso
