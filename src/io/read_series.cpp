// Fields whose steps are files: lists of files, ParaView's .pvd and .series.

#include "core/text.hpp"
#include "io/formats.hpp"
#include "io/input_file.hpp"
#include "io/parse.hpp"
#include "io/sample_runs.hpp"
#include "io/stored_field.hpp"
#include "io/vtk_xml.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <nlohmann/json.hpp>

namespace hyperiso {
namespace {

namespace fs = std::filesystem;

struct Entry {
  fs::path file;
  std::optional<double> time;
};

// How the grid of a step differs from that of the first; empty if it does not.
std::string difference(const FieldInfo& step, const FieldInfo& first) {
  if (step.type != first.type)
    return text("its samples are ", name_of(step.type), ", not ", name_of(first.type));
  if (step.dimension() != first.dimension())
    return text("it has ", step.dimension(), " axes, not ", first.dimension());
  if (step.has_time != first.has_time) return text("it has ", step.has_time ? "a" : "no", " time axis");
  for (std::size_t k = 0; k < first.axes.size(); ++k) {
    const Axis &a = step.axes[k], &b = first.axes[k];
    if (a.count != b.count) return text("axis ", b.name, " has ", a.count, " samples, not ", b.count);
    if (a.first != b.first || a.origin != b.origin || a.spacing != b.spacing ||
        a.coordinates != b.coordinates)
      return text("axis ", b.name, " runs from ", a.coordinate(0), " to ", a.coordinate(a.count - 1),
                  ", not from ", b.coordinate(0), " to ", b.coordinate(b.count - 1));
  }
  const bool same_world = step.world.has_value() == first.world.has_value() &&
                          (!step.world || (step.world->linear == first.world->linear &&
                                           step.world->offset == first.world->offset));
  return same_world ? "" : "its axes have another orientation";
}

class SeriesReader final : public FieldReader {
 public:
  // Requires `times` of set_coordinates, and `first`, the description of the first file.
  SeriesReader(std::vector<Entry> entries, Axis times, FieldInfo first, ReadOptions options)
      : entries_(std::move(entries)), step_(std::move(first)), options_(std::move(options)) {
    info_ = step_;
    info_.axes.push_back(std::move(times));
    info_.has_time = true;
    if (info_.world) info_.world = with_time(*info_.world);
    for (const Entry& entry : entries_) files_.push_back(entry.file);
  }

  Result<Field> read(std::int64_t begin, std::int64_t end) override {
    if (Status status = check_range(info_, begin, end, path(begin)); !status) return status.error();
    return without_bad_alloc(path(begin),
                             [&] { return end == begin + 1 ? one(begin) : several(begin, end); });
  }

 private:
  const fs::path& path(std::int64_t step) const {
    return entries_[static_cast<std::size_t>(std::clamp<std::int64_t>(step, 0, info_.axes.back().count - 1))]
        .file;
  }

  static Affine with_time(const Affine& world) {
    const std::size_t D = world.offset.size();
    Affine result{std::vector<double>((D + 1) * (D + 1)), world.offset};
    for (std::size_t row = 0; row < D; ++row)
      for (std::size_t column = 0; column < D; ++column)
        result.linear[row * (D + 1) + column] = world.linear[row * D + column];
    result.linear.back() = 1;
    result.offset.push_back(0);
    return result;
  }

  FieldInfo info_of(std::int64_t begin, std::int64_t end) const {
    FieldInfo info = info_;
    info.axes.back() = info.axes.back().cropped(begin, end);
    return info;
  }

  Result<Field> read_step(std::int64_t step) const {
    auto opened = open_step(path(step), options_);
    if (!opened) return opened.error();
    const std::string differs = difference(opened->reader->info(), step_);
    if (!differs.empty())
      return Error{Code::file_malformed,
                   text(path(step).string(), ": not on the grid of ", path(0).string(), ": ", differs)};
    return opened->reader->read();
  }

  // Shares the samples of the step, which may be memory-mapped.
  Result<Field> one(std::int64_t step) const {
    auto field = read_step(step);
    if (!field) return field;
    field->info = info_of(step, step + 1);
    field->strides.push_back(step_.samples());
    return field;
  }

  Result<Field> several(std::int64_t begin, std::int64_t end) const {
    auto memory = allocate_to_read(info_of(begin, end), options_.memory_limit, path(begin));
    if (!memory) return memory.error();
    std::byte* out = memory->samples;
    for (std::int64_t step = begin; step < end; ++step) {
      const auto field = read_step(step);
      if (!field) return field.error();
      for_each_run(*field, [&](std::span<const std::byte> run) {
        std::memcpy(out, run.data(), run.size());
        out += run.size();
      });
    }
    return std::move(memory->field);
  }

  std::vector<Entry> entries_;
  FieldInfo step_; // of every file
  ReadOptions options_;
};

// The times of the entries; 0, 1, 2, ... where none has one.
Result<Axis> time_axis_of(const std::vector<Entry>& entries, const std::string& whole) {
  Axis axis;
  axis.name = "t";
  axis.count = static_cast<std::int64_t>(entries.size());
  std::vector<double> times;
  for (const Entry& entry : entries)
    if (entry.time) times.push_back(*entry.time);
  // Writers that know no time may put the same one into every file.
  const bool told = times.size() > 1 ? times.front() != times.back() : !times.empty();
  if (!told) return axis;
  if (times.size() != entries.size())
    return Error{Code::file_malformed,
                 text(whole, ": only ", times.size(), " of ", entries.size(), " steps have a time")};
  for (std::size_t i = 1; i < entries.size(); ++i)
    if (!(times[i - 1] < times[i]))
      return Error{Code::file_malformed,
                   text(entries[i].file.string(), ": its time ", times[i], " does not follow ", times[i - 1],
                        " of ", entries[i - 1].file.string(),
                        ": name the steps in the order of their times, each once")};
  if (!set_coordinates(axis, std::move(times)))
    return Error{Code::file_malformed, text(whole, ": the times of its steps are not finite")};
  return axis;
}

ReadOptions options_of_steps(const ReadOptions& options) {
  ReadOptions result = options;
  result.time_axis.clear(); // the files are the steps
  return result;
}

// `whole` names the series in messages.
Result<std::unique_ptr<FieldReader>> open_entries(std::vector<Entry> entries, const std::string& whole,
                                                  const ReadOptions& options, const FieldInfo& first) {
  if (first.has_time)
    return Error{Code::file_unsupported,
                 text(entries[0].file.string(), ": has a time axis (", first.axes.back().name,
                      ") of its own, so that it cannot be one step of a series")};
  auto times = time_axis_of(entries, whole);
  if (!times) return times.error();
  auto reader =
      std::make_unique<SeriesReader>(std::move(entries), std::move(*times), first, options_of_steps(options));
  if (!options.time_axis.empty() &&
      reader->info().axis_named(options.time_axis) != reader->info().dimension() - 1)
    return Error{Code::invalid_argument, text(whole, ": the time axis of a series of files is t, not ",
                                              in_quotes(options.time_axis))};
  return std::unique_ptr<FieldReader>(std::move(reader));
}

// A .pvd or .series: the files are known by their names until a step is read, but for the first.
Result<std::unique_ptr<FieldReader>> open_collection(std::vector<Entry> entries, const fs::path& path,
                                                     const ReadOptions& options) {
  const ReadOptions step_options = options_of_steps(options);
  if (entries.empty()) return Error{Code::file_malformed, text(path.string(), ": it names no files")};
  for (Entry& entry : entries) {
    entry.file = path.parent_path() / entry.file;
    std::error_code error;
    if (!fs::exists(entry.file, error))
      return Error{Code::file_not_found,
                   text(path.string(), ": it names ", entry.file.string(), ", but there is no such file")};
  }
  const bool all_timed =
      std::ranges::all_of(entries, [](const Entry& entry) { return entry.time.has_value(); });
  if (all_timed) std::ranges::stable_sort(entries, {}, [](const Entry& entry) { return *entry.time; });
  const auto first = open_step(entries[0].file, step_options);
  if (!first) return first.error();
  return open_entries(std::move(entries), path.string(), options, first->reader->info());
}

} // namespace

OpenedField open_list(const std::vector<fs::path>& paths, const ReadOptions& options) {
  const ReadOptions step_options = options_of_steps(options);
  std::vector<Entry> entries;
  std::optional<FieldInfo> first;
  for (const fs::path& path : paths) {
    const auto step = open_step(path, step_options);
    if (!step) return step.error();
    if (!first) first = step->reader->info();
    if (const std::string differs = difference(step->reader->info(), *first); !differs.empty())
      return Error{Code::file_malformed,
                   text(path.string(), ": not on the grid of ", paths[0].string(), ": ", differs)};
    entries.push_back({path, step->time});
  }
  return open_entries(std::move(entries), paths[0].string(), options, *first);
}

OpenedField open_pvd(const fs::path& path, const ReadOptions& options) {
  const auto file = InputFile::open(path);
  if (!file) return file.error();
  const auto xml = VtkXml::parse((*file)->characters(), path.string());
  if (!xml) return xml.error();
  const auto collection = xml->root().child("Collection");
  if (!collection) return xml->malformed("there is no <Collection> of files in it");
  std::vector<Entry> entries;
  for (const auto node : collection.children("DataSet")) {
    const std::string_view name = node.attribute("file").as_string();
    if (name.empty()) return xml->malformed("a <DataSet> names no file");
    Entry entry{fs::path(name), std::nullopt};
    if (node.attribute("timestep")) {
      entry.time = number_from<double>(trimmed(node.attribute("timestep").as_string()));
      if (!entry.time || !std::isfinite(*entry.time))
        return xml->malformed(text("the timestep of ", in_quotes(name), " is not a number"));
    }
    if (node.attribute("part").as_int() != 0)
      return xml->unsupported("a time step consists of several parts; hyperiso reads one file for each step");
    entries.push_back(std::move(entry));
  }
  return open_collection(std::move(entries), path, options);
}

OpenedField open_series(const fs::path& path, const ReadOptions& options) {
  const auto file = InputFile::open(path);
  if (!file) return file.error();
  const Error malformed{Code::file_malformed,
                        text(path.string(),
                             ": not a ParaView series: a JSON object {\"files\": [{\"name\": ..., "
                             "\"time\": ...}, ...]} is expected")};
  const auto json = nlohmann::json::parse((*file)->characters(), nullptr, false);
  if (!json.is_object() || !json.contains("files") || !json["files"].is_array()) return malformed;
  std::vector<Entry> entries;
  for (const auto& item : json["files"]) {
    if (!item.is_object() || !item.contains("name") || !item["name"].is_string()) return malformed;
    Entry entry{fs::path(item["name"].get<std::string>()), std::nullopt};
    if (item.contains("time")) {
      if (!item["time"].is_number()) return malformed;
      entry.time = item["time"].get<double>();
    }
    entries.push_back(std::move(entry));
  }
  return open_collection(std::move(entries), path, options);
}

} // namespace hyperiso
