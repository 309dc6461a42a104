// Which format a field is written in, and whether it fits.

#include "core/text.hpp"
#include "io/formats.hpp"
#include "io/parse.hpp"
#include "io/stored_field.hpp"

#include <algorithm>
#include <new>

namespace hyperiso {
namespace {

enum class FieldFormat { nrrd, npy, raw, vti };

constexpr std::pair<std::string_view, FieldFormat> formats[] = {
    {"nrrd", FieldFormat::nrrd}, {"npy", FieldFormat::npy}, {"raw", FieldFormat::raw},
    {"bin", FieldFormat::raw},   {"vti", FieldFormat::vti}, {"pvd", FieldFormat::vti}};

Result<FieldFormat> format_of(const std::filesystem::path& path, const std::string& asked) {
  std::string name = lower_case(asked.empty() ? path.extension().string() : asked);
  if (asked.empty() && !name.empty()) name.erase(0, 1);
  std::string names;
  for (const auto& [known, format] : formats) {
    if (name == known) return format;
    names += text(names.empty() ? "" : ", ", known);
  }
  if (!asked.empty())
    return Error{Code::file_unsupported,
                 text("fields are not written as ", in_quotes(asked), "; they are as ", names)};
  return Error{Code::file_unsupported, text(path.string(), ": fields are not written to ",
                                            name.empty() ? "files without a suffix" : "." + name + " files",
                                            "; the suffixes are ", names)};
}

bool has_samples(const Field& field) {
  return field.samples && field.strides.size() == field.info.axes.size() && !field.strides.empty() &&
         std::ranges::all_of(field.info.axes, [](const Axis& axis) { return axis.count > 0; });
}

// Axes are written with the names that a reader would give them.
FieldInfo with_names(FieldInfo info) {
  name_axes(info.axes, info.has_time ? std::optional(info.dimension() - 1) : std::nullopt);
  return info;
}

Result<FieldFormat> fitting_format(const FieldInfo& info, const std::filesystem::path& path,
                                   const WriteFieldOptions& options) {
  const auto format = format_of(path, options.format);
  if (!format) return format.error();
  if (options.compress && (*format == FieldFormat::npy || *format == FieldFormat::raw))
    return Error{Code::invalid_argument,
                 text(path.string(), ": .npy and .raw files are not compressed; .nrrd can be")};
  if (*format == FieldFormat::nrrd)
    if (const Status status = check_fits_nrrd(info, path); !status) return status.error();
  if (*format == FieldFormat::vti)
    if (const Status status = check_fits_vti(info, path); !status) return status.error();
  return *format;
}

Status write_as(FieldFormat format, const Field& field, const std::filesystem::path& path, bool compress) {
  if (format == FieldFormat::vti && field.info.has_time) return write_vti_series(field, path);
  auto file = AtomicFile::create(path);
  if (!file) return file.error();
  switch (format) {
  case FieldFormat::nrrd:
    write_nrrd(*file, field, compress);
    break;
  case FieldFormat::npy:
    write_npy(*file, field);
    break;
  case FieldFormat::raw:
    write_raw(*file, field);
    break;
  case FieldFormat::vti:
    write_vti(*file, field);
    break;
  }
  return file->commit();
}

} // namespace

Status write_field(const Field& field, const std::filesystem::path& path, const WriteFieldOptions& options) {
  try {
    Field named = field; // shares the samples
    named.info = with_names(field.info);
    const auto format = fitting_format(named.info, path, options);
    if (!format) return format.error();
    if (!has_samples(field))
      return Error{Code::invalid_argument, text(path.string(), ": there are no samples to write")};
    return write_as(*format, named, path, options.compress);
  } catch (const std::bad_alloc&) {
    return no_memory_to_write(path);
  }
}

Status check_field_format(const FieldInfo& info, const std::filesystem::path& path,
                          const WriteFieldOptions& options) {
  if (const auto format = fitting_format(with_names(info), path, options); !format) return format.error();
  return {};
}

} // namespace hyperiso
