#pragma once
// The formats of fields, one file each. Errors as open_field says.

#include "hyperiso/io.hpp"

namespace hyperiso {

Result<std::unique_ptr<FieldReader>> open_raw(const std::filesystem::path& path, const ReadOptions& options);
Result<std::unique_ptr<FieldReader>> open_nrrd(const std::filesystem::path& path, const ReadOptions& options);

} // namespace hyperiso
