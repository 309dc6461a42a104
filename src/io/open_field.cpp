// Which format a file is, by its suffix.

#include "core/text.hpp"
#include "io/formats.hpp"
#include "io/parse.hpp"
#include "io/stored_field.hpp"

namespace hyperiso {
namespace {

using Open = Result<std::unique_ptr<FieldReader>> (*)(const std::filesystem::path&, const ReadOptions&);

struct Format {
  std::string_view suffix;
  Open open;
};
constexpr Format formats[] = {
    {".nrrd", open_nrrd},
    {".nhdr", open_nrrd},
    {".raw", open_raw},
    {".bin", open_raw},
};

Result<std::unique_ptr<FieldReader>> open_one(const std::filesystem::path& path, const ReadOptions& options) {
  const std::string suffix = lower_case(path.extension().string());
  for (const Format& format : formats)
    if (suffix == format.suffix) return format.open(path, options);
  // Any file can be raw samples, if the caller says what they are.
  if (!options.dims.empty()) return open_raw(path, options);
  std::string names;
  for (const Format& format : formats) names += text(names.empty() ? "" : ", ", format.suffix);
  return Error{Code::file_unsupported, text(path.string(), ": fields are not read from ",
                                            suffix.empty() ? "files without a suffix" : suffix + " files",
                                            "; they are from ", names)};
}

} // namespace

Result<std::unique_ptr<FieldReader>> open_field(const std::vector<std::filesystem::path>& paths,
                                                const ReadOptions& options) {
  if (paths.empty()) return Error{Code::invalid_argument, "no file to read a field from"};
  return without_bad_alloc(paths[0], [&] { return open_one(paths[0], options); });
}

} // namespace hyperiso
