#include "cli/point_data.hpp"

#include "cli/console.hpp"
#include "cli/failure.hpp"
#include "cli/parse.hpp"
#include "cli/surface.hpp"
#include "core/text.hpp"
#include "hyperiso/colours.hpp"

#include <filesystem>
#include <numeric>

namespace hyperiso::cli {
namespace {

constexpr const char* data_group = "Data at the vertices";

NamedSteps open_one(const std::string& given, const FieldOptions& input, const MachineOptions& machine) {
  const auto equals = given.find('=');
  const std::string what = equals == std::string::npos ? given : given.substr(equals + 1);
  FieldOptions other = input;
  other.variable.clear();
  std::string name = equals == std::string::npos ? what : given.substr(0, equals);
  if (std::error_code ignored; std::filesystem::exists(what, ignored)) {
    other.paths = {what};
    if (equals == std::string::npos) name = std::filesystem::path(what).stem().string();
  } else {
    other.variable = what;
    const std::string suffix = std::filesystem::path(input.paths[0]).extension().string();
    if (suffix != ".vti" && suffix != ".pvd" && suffix != ".series")
      fail_usage(text("--with: there is no file '", what, "', and no variables in ", suffix, " files"));
  }
  if (name.empty()) fail_usage(text("--with: '", given, "' has no name before the ="));
  auto steps = std::make_unique<SelectedSteps>(other.open(machine), other);
  return {std::move(name), std::move(steps)};
}

std::optional<ColourRange> parse_colour_range(const std::string& range) {
  if (range.empty()) return std::nullopt;
  const auto ends = split(range, ':');
  if (ends.size() != 2) fail_usage(text("--colour-range: '", range, "' is not LOW:HIGH"));
  const ColourRange result{parse_number("--colour-range", ends[0]), parse_number("--colour-range", ends[1])};
  if (!(result.low < result.high))
    fail_usage(text("--colour-range: ", result.low, " is not less than ", result.high));
  return result;
}

} // namespace

SelectedSteps::SelectedSteps(std::unique_ptr<FieldReader> reader, const FieldOptions& input)
    : reader_(std::move(reader)), selection_(input.selection(reader_->info())),
      info_(selected(reader_->info(), selection_)), axes_(info_.axes.size()) {
  std::iota(axes_.begin(), axes_.end(), std::size_t{0});
}

void SelectedSteps::leave_out_flat_axes(int lowest) {
  held_.reset();
  for (std::size_t axis = info_.axes.size() - 1; axis-- > 0;) {
    if (info_.axes[axis].count != 1) continue;
    if (info_.dimension() <= lowest) check_axes(info_);
    if (info_.world)
      info_.world = at_coordinate(*info_.world, static_cast<int>(axis), info_.axes[axis].coordinate(0));
    info_.axes.erase(info_.axes.begin() + static_cast<std::ptrdiff_t>(axis));
    axes_.erase(axes_.begin() + static_cast<std::ptrdiff_t>(axis));
  }
}

Result<Field> SelectedSteps::read(std::int64_t begin, std::int64_t end) {
  if (held_ && begin == held_begin_ && end == held_end_) return *held_;
  held_.reset();
  const Stopwatch reading;
  Selection wanted = selection_;
  const std::int64_t first = selection_.ranges.back().first;
  wanted.ranges.back() = {first + begin, first + end};
  try {
    held_ = read_selection(*reader_, wanted);
  } catch (const Failure& failure) {
    return failure.error;
  }
  std::vector<std::int64_t> strides;
  for (const std::size_t axis : axes_) strides.push_back(held_->strides[axis]);
  held_->strides = std::move(strides);
  held_->info = info_;
  held_->info.axes.back() = info_.axes.back().cropped(begin, end);
  held_begin_ = begin;
  held_end_ = end;
  read_seconds_ += reading.seconds();
  return *held_;
}

std::optional<ColourRange> PointDataOptions::range() const { return parse_colour_range(colour_range); }

void PointDataOptions::add_to(CLI::App& app, const std::string& coloured, const std::string& whole) {
  app.add_option("--with", with,
                 "further fields of the same grid, interpolated at the surface: files, or variables of INPUT "
                 "(.vti, .pvd); they are called as the file or the variable is, or NAME")
      ->type_name("[NAME=]FIELD[,...]")
      ->delimiter(',')
      ->allow_extra_args(false)
      ->group(data_group);
  app.add_flag("--normals", normals,
               "unit normals from the gradient of the field: smoother than those of the simplices")
      ->group(data_group);
  app.add_option("--colour-by", colour_by,
                 coloured + ": colour the vertices by this data of theirs, one of --with for example")
      ->type_name("NAME")
      ->group(data_group);
  app.add_option("--colour-range", colour_range,
                 "the values of the first and the last colour; left out: the smallest and the largest " +
                     whole)
      ->type_name("LOW:HIGH")
      ->group(data_group);
}

void PointDataOptions::check(const MeshOutputOptions& output, const std::string& path) const {
  (void)range();
  if (!colour_range.empty() && colour_by.empty()) fail_usage("--colour-range: there is no --colour-by");
  if (path.empty()) return;
  const std::string format = output.format_of(path);
  if (from_field() && format != "vtu" && format != "vtp" && format != "ply")
    fail_usage(text(with.empty() ? "--normals" : "--with", ": ", format,
                    " files hold no data of vertices; vtu, vtp and ply do"));
  if (!colour_by.empty() && format != "ply")
    fail_usage(
        "--colour-by: colours are written to .ply; ParaView colours .vtu and .vtp by any data they hold");
}

std::vector<NamedSteps> PointDataOptions::open(const FieldOptions& input,
                                               const MachineOptions& machine) const {
  std::vector<NamedSteps> fields;
  for (const std::string& given : with) fields.push_back(open_one(given, input, machine));
  return fields;
}

void PointDataOptions::colour(Mesh& mesh) const {
  if (!colour_by.empty()) take(colour_vertices(mesh, colour_by, range()));
}

} // namespace hyperiso::cli
