#include "cli/tracked_folder.hpp"

#include "cli/failure.hpp"
#include "cli/surface.hpp"
#include "core/text.hpp"
#include "hyperiso/track_files.hpp"
#include "io/atomic_file.hpp"

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <optional>

namespace hyperiso::cli {
namespace {

namespace fs = std::filesystem;

constexpr const char* file_name = "source.json";
constexpr int version = 1;

// The options that decide the tracks, by their names on the command line of `track`.
std::vector<std::pair<const char*, std::string*>> options_of(TrackedFolder& folder) {
  FieldOptions& input = folder.input;
  SurfaceOptions& surface = folder.surface;
  TrackingOptions& tracking = folder.tracking;
  return {{"--variable", &input.variable},
          {"--time-axis", &input.time_axis},
          {"--crop", &input.crop},
          {"--steps", &input.steps},
          {"--dims", &input.dims},
          {"--type", &input.type},
          {"--skip", &input.skip},
          {"--iso", &tracking.iso},
          {"--range", &tracking.range},
          {"--track", &tracking.tracked},
          {"--method", &surface.method},
          {"--inside", &surface.inside},
          {"--overlap", &tracking.overlap},
          {"--overlap-volumes", &tracking.overlap_volumes},
          {"--min-volume", &tracking.minimum_volume},
          {"--min-duration", &tracking.minimum_duration}};
}
constexpr const char* big_endian = "--big-endian";

Json json_of_field(const FieldInfo& info) {
  Json axes = Json::array();
  for (const Axis& axis : info.axes)
    axes.push_back({{"first", axis.coordinate(0)}, {"last", axis.coordinate(axis.count - 1)}});
  return {{"size", size_and_type(info)}, {"axes", std::move(axes)}};
}

std::vector<std::string> names_of(const FileGroup& files) {
  std::vector<std::string> names;
  for (const fs::path& file : files.files()) names.push_back(file.filename().string());
  return names;
}

// The way from a folder to a file, so that both can be moved together.
std::string path_from(const fs::path& folder, const std::string& file) {
  std::error_code failure;
  const fs::path way = fs::relative(file, folder, failure);
  return (way.empty() ? fs::absolute(file) : way).generic_string();
}

std::string source_file(const std::string& folder) { return (fs::path(folder) / file_name).string(); }

[[noreturn]] void fail_source(const TrackedFolder& folder, const std::string& what) {
  fail_usage(text(source_file(folder.path), ": ", what, "; run 'hyperiso track' again"));
}

Json read_source(const TrackedFolder& folder) {
  const std::string path = source_file(folder.path);
  std::ifstream file(path);
  if (std::error_code failure; !file && fs::exists(path, failure))
    throw Failure{{Code::file_unreadable, text(path, ": cannot be read")}};
  if (!file)
    fail_usage(text(folder.path, ": this folder has no ", file_name,
                    ", so it is none that 'hyperiso track -o' wrote"));
  Json source = Json::parse(file, nullptr, false);
  if (!source.is_object() || !source.contains("version") || !source["version"].is_number_integer())
    fail_source(folder, "this is not what was written there");
  if (source["version"] != version)
    fail_usage(text(path, ": it has version ", source["version"].dump(), ", and this hyperiso knows version ",
                    version));
  return source;
}

std::vector<std::string> texts_of(const TrackedFolder& folder, const Json& source, const char* member) {
  const Json list = source.value(member, Json());
  std::vector<std::string> texts;
  if (!list.is_array()) fail_source(folder, text("'", member, "' is no list"));
  for (const Json& entry : list) {
    if (!entry.is_string()) fail_source(folder, text("'", member, "' holds something else than texts"));
    texts.push_back(entry.get<std::string>());
  }
  return texts;
}

void read_options(TrackedFolder& folder, const Json& options) {
  if (!options.is_object()) fail_source(folder, "'options' is no object");
  const auto known = options_of(folder);
  for (const auto& [name, value] : options.items()) {
    const auto option =
        std::ranges::find(known, name, [](const auto& entry) { return std::string(entry.first); });
    if (name == big_endian && value.is_boolean())
      folder.input.big_endian = value.get<bool>();
    else if (option != known.end() && value.is_string())
      *option->second = value.get<std::string>();
    else
      fail_source(folder, text("'options' has ", name, " with ", value.dump(), ", which means nothing"));
  }
}

// Fails where an option says something else than what the tracks were made with.
void check_given(TrackedFolder& folder, const CLI::App& verb) {
  for (const auto& [name, value] : options_of(folder)) {
    const CLI::Option* option = verb.get_option_no_throw(name);
    if (!option || option->count() == 0 || option->get_items_expected_max() == 0)
      continue; // not here, or a flag
    if (option->as<std::string>() == *value) continue;
    const std::string was = value->empty() ? text("without ", name) : text("with ", name, " ", *value);
    fail_usage(
        text(name, ": ", folder.path, " was tracked ", was, "; leave it out, or run 'hyperiso track' again"));
  }
  if (const CLI::Option* option = verb.get_option_no_throw(big_endian);
      option && option->count() > 0 && !folder.input.big_endian)
    fail_usage(text(big_endian, ": ", folder.path, " was tracked without ", big_endian, "; leave it out"));
}

void check_field_is_there(const TrackedFolder& folder, const CLI::App& verb) {
  for (const std::string& file : folder.input.paths)
    if (std::error_code failure; !fs::exists(file, failure))
      throw Failure{{Code::file_not_found, text(folder.path, ": the field that was tracked is no longer at ",
                                                file, "; say where it is, as in 'hyperiso ", verb.get_name(),
                                                " ", folder.path, " FIELD'")}};
}

void check_kind(const TrackedFolder& folder) {
  if (!folder.seeds.empty())
    fail_usage(text(folder.path,
                    ": it holds only the tracks of --seed or --select; run 'hyperiso track' without "
                    "these to see all"));
  if (!folder.tracking.range.empty())
    fail_usage(text(folder.path, ": it holds tracks of what lies between the isovalues ",
                    folder.tracking.range,
                    ", which two surfaces bound, and one is shown; run 'hyperiso track' with --iso, or open ",
                    (fs::path(folder.path) / "tracks.pvd").string(), " in ParaView"));
}

void add_source(TrackedFolder folder, const FieldInfo& selected, FileGroup& files) {
  if (!selected.has_time && folder.input.time_axis.empty()) // the last, which only `track` takes for time
    folder.input.time_axis = std::to_string(selected.axes.size() - 1);
  Json options = Json::object();
  for (const auto& [name, value] : options_of(folder))
    if (!value->empty()) options[name] = *value;
  if (folder.input.big_endian) options[big_endian] = true;
  Json fields = Json::array();
  for (const std::string& file : folder.input.paths) fields.push_back(path_from(folder.path, file));
  const Json source{
      {"version", version},    {"fields", std::move(fields)},      {"options", std::move(options)},
      {"seeds", folder.seeds}, {"field", json_of_field(selected)}, {"files", names_of(files)}};
  auto file = take(AtomicFile::create(source_file(folder.path)));
  // A name that is not UTF-8 has no place in JSON: that field is to be named after the folder.
  file.write(source.dump(1, ' ', false, Json::error_handler_t::replace) + "\n");
  take(file.commit(&files));
}

} // namespace

std::string TrackedFolder::name() const {
  const fs::path whole = fs::absolute(path).lexically_normal();
  return (whole.has_filename() ? whole : whole.parent_path()).filename().string();
}

void TrackedFolder::choose(FieldOptions& to_read, TrackingOptions& to_track,
                           SurfaceOptions& to_extract) const {
  to_read = input;
  to_track = tracking;
  to_extract.method = surface.method;
  to_extract.inside = surface.inside; // the rest does not decide the tracks
}

void TrackedFolder::check_field(const FieldInfo& info) const {
  const Json now = json_of_field(info);
  if (now == field) return;
  const bool same_size = now["size"] == field["size"];
  fail_usage(text(input.paths[0], ": this is not the field that ", path, " was made of: it is ",
                  size_and_type(info),
                  same_size ? " with other axes" : " instead of " + field["size"].get<std::string>(),
                  "; run 'hyperiso track' again"));
}

void TrackedFolder::check_tracks(const TrackingGraph& graph) const {
  const std::string table = (fs::path(path) / "tracks.csv").string();
  std::ifstream file(table, std::ios::binary);
  if (!file)
    throw Failure{{Code::file_not_found, text(table, ": there is no such file; run 'hyperiso track' again")}};
  const std::string stored{std::istreambuf_iterator<char>(file), {}};
  if (stored == tracks_csv(graph)) return;
  fail_usage(text(table,
                  ": these are not the tracks that the field has now: the field, this table or hyperiso "
                  "changed; run 'hyperiso track' again"));
}

std::optional<std::vector<std::string>> files_of_tracked_folder(const std::string& folder) {
  std::ifstream file(source_file(folder));
  const Json source = Json::parse(file, nullptr, false);
  if (!source.is_object() || !source.contains("version") || !source.contains("fields")) return std::nullopt;
  std::vector<std::string> files;
  const Json names = source.value("files", Json::array());
  for (const Json& name : names)
    if (name.is_string() && fs::path(name.get<std::string>()).filename() == name.get<std::string>())
      files.push_back(name.get<std::string>());
  return files;
}

void finish_folder(const TrackedFolder& folder, const FieldInfo& selected, FileGroup& files) {
  const auto earlier = files_of_tracked_folder(folder.path).value_or(std::vector<std::string>());
  const std::vector<std::string> now = names_of(files);
  const auto is_earlier = [&](const std::string& name) {
    return std::ranges::find(earlier, name) != earlier.end();
  };
  if (is_earlier("tracks.csv")) // else nothing tells what is of that run
    for (const std::string& name : now)
      if (const fs::path path = fs::path(folder.path) / name; !is_earlier(name) && fs::exists(path))
        fail_usage(text("-o: ", path.string(),
                        " is not of the run that the folder holds, and would be replaced; "
                        "move it, or name another folder"));
  add_source(folder, selected, files);
  take(files.commit());
  for (const std::string& name : earlier)
    if (std::error_code failure; std::ranges::find(now, name) == now.end())
      fs::remove(fs::path(folder.path) / name, failure);
}

bool names_folder(const FieldOptions& input) {
  std::error_code failure;
  return fs::is_directory(input.paths[0], failure);
}

TrackedFolder open_tracked_folder(const FieldOptions& input, const CLI::App& verb) {
  TrackedFolder folder;
  folder.path = input.paths[0];
  const Json source = read_source(folder);
  const std::vector<std::string> fields = texts_of(folder, source, "fields");
  if (fields.empty()) fail_source(folder, "'fields' is empty");
  folder.seeds = texts_of(folder, source, "seeds");
  read_options(folder, source.value("options", Json()));
  folder.field = source.value("field", Json());
  if (!folder.field.is_object() || !folder.field.value("size", Json()).is_string())
    fail_source(folder, "'field' does not say what the field was");
  check_given(folder, verb);
  check_kind(folder);
  if (input.paths.size() > 1) {
    folder.input.paths = {input.paths.begin() + 1, input.paths.end()};
  } else {
    for (const std::string& field : fields)
      folder.input.paths.push_back(fs::proximate(fs::canonical(folder.path) / field).string());
    check_field_is_there(folder, verb);
  }
  return folder;
}

} // namespace hyperiso::cli
