// Plain samples, described by the options.

#include "core/text.hpp"
#include "io/formats.hpp"
#include "io/stored_field.hpp"

#include <bit>

namespace hyperiso {

OpenedField open_raw(const std::filesystem::path& path, const ReadOptions& options) {
  if (options.dims.empty() || !options.type)
    return Error{Code::invalid_argument,
                 text(path.string(), ": a raw file needs its dims (axis 0 fastest) and its sample type")};
  StoredField stored;
  stored.type = *options.type;
  stored.axes.resize(options.dims.size());
  for (std::size_t axis = 0; axis < stored.axes.size(); ++axis) stored.axes[axis].count = options.dims[axis];
  stored.time_axis = usual_time_axis(stored.axes.size());

  auto file = InputFile::open(path);
  if (!file) return file.error();
  const auto bytes = bytes_of(stored.axes, stored.type, path);
  if (!bytes) return Error{Code::invalid_argument, bytes.error().message};
  if (options.skip_bytes < 0)
    return Error{Code::invalid_argument, text(path.string(), ": cannot skip ", options.skip_bytes, " bytes")};
  const auto skip = static_cast<std::uint64_t>(options.skip_bytes);
  if (skip > (*file)->size() || (*file)->size() - skip != *bytes)
    return Error{Code::file_malformed,
                 text(path.string(), ": ", dims_text(stored.axes), " samples of type ", name_of(stored.type),
                      skip > 0 ? text(" after ", skip, " skipped bytes") : "", " need ", *bytes,
                      " bytes, but the file has ", (*file)->size())};
  const bool swap = options.big_endian != (std::endian::native == std::endian::big);
  return read_stored(std::move(stored), plain_source(std::move(*file), skip), swap, path, options);
}

} // namespace hyperiso
