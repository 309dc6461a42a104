// Which format a file is, by its suffix.

#include "core/text.hpp"
#include "io/formats.hpp"
#include "io/parse.hpp"
#include "io/stored_field.hpp"

namespace hyperiso {
namespace {

OpenedField open_vti(const std::filesystem::path& path, const ReadOptions& options) {
  auto step = open_vti_step(path, options);
  if (!step) return step.error();
  return std::move(step->reader);
}

struct Format {
  std::string_view suffix;
  OpenedField (*open)(const std::filesystem::path&, const ReadOptions&);
  bool is_series;
};
constexpr Format formats[] = {
    {".nrrd", open_nrrd, false}, {".nhdr", open_nrrd, false},    {".vti", open_vti, false},
    {".npy", open_npy, false},   {".raw", open_raw, false},      {".bin", open_raw, false},
    {".pvd", open_pvd, true},    {".series", open_series, true},
};

Error unknown_format(const std::filesystem::path& path) {
  if (std::error_code failure; std::filesystem::is_directory(path, failure))
    return {Code::file_unsupported, text(path.string(), ": is a folder, not a field")};
  std::string names;
  for (const Format& format : formats) names += text(names.empty() ? "" : ", ", format.suffix);
  const std::string suffix = path.extension().string();
  return {Code::file_unsupported, text(path.string(), ": fields are not read from ",
                                       suffix.empty() ? "files without a suffix" : suffix, "; they are from ",
                                       names, ", and from any file whose dims and sample type are given")};
}

const Format* format_of(const std::filesystem::path& path, const ReadOptions& options) {
  const std::string suffix = lower_case(path.extension().string());
  // Any file can be raw samples, if the caller says what they are.
  static constexpr Format raw{"", open_raw, false};
  for (const Format& format : formats)
    if (suffix == format.suffix) return &format;
  return options.dims.empty() ? nullptr : &raw;
}

// An option that a file has no use for is refused: passing over it would look like doing what it says.
Status check_options(const Format& format, const std::filesystem::path& path, const ReadOptions& options) {
  if (format.is_series) return {}; // its files have their own formats
  const bool describe_raw =
      !options.dims.empty() || options.type || options.skip_bytes != 0 || options.big_endian;
  if (describe_raw && format.open != open_raw)
    return Error{Code::invalid_argument, text(path.string(), ": a ", format.suffix,
                                              " file says itself how its samples lie; dims, type, "
                                              "skipped bytes and byte order are for raw files")};
  if (!options.variable.empty() && format.open != open_vti)
    return Error{Code::invalid_argument,
                 text(path.string(), ": the file holds one array without a name to choose it by, so ",
                      in_quotes(options.variable), " cannot be asked for")};
  return {};
}

} // namespace

Result<OpenStep> open_step(const std::filesystem::path& path, const ReadOptions& options) {
  const Format* format = format_of(path, options);
  if (!format) return unknown_format(path);
  if (format->is_series)
    return Error{
        Code::file_unsupported,
        text(path.string(), ": is a series of files itself, so that it cannot be one step of another")};
  if (const Status status = check_options(*format, path, options); !status) return status.error();
  if (format->open == open_vti) return open_vti_step(path, options);
  auto reader = format->open(path, options);
  if (!reader) return reader.error();
  return OpenStep{std::move(*reader), std::nullopt};
}

Result<std::unique_ptr<FieldReader>> open_field(const std::vector<std::filesystem::path>& paths,
                                                const ReadOptions& options) {
  if (paths.empty()) return Error{Code::invalid_argument, "no file to read a field from"};
  return without_bad_alloc(paths[0], [&]() -> OpenedField {
    if (paths.size() > 1) return open_list(paths, options);
    const Format* format = format_of(paths[0], options);
    if (!format) return unknown_format(paths[0]);
    if (const Status status = check_options(*format, paths[0], options); !status) return status.error();
    return format->open(paths[0], options);
  });
}

} // namespace hyperiso
