#include "cli/surface.hpp"

#include "cli/failure.hpp"
#include "core/text.hpp"
#include "hyperiso/statistics.hpp"

#include <algorithm>
#include <filesystem>
#include <fmt/format.h>
#include <fmt/ranges.h>

namespace hyperiso::cli {

std::string size_and_type(const FieldInfo& info) {
  std::string size;
  for (const Axis& axis : info.axes) size += (size.empty() ? "" : " x ") + std::to_string(axis.count);
  return size + ' ' + name_of(info.type);
}

Json dims_of(const FieldInfo& info) {
  Json dims = Json::array();
  for (const Axis& axis : info.axes) dims.push_back(axis.count);
  return dims;
}

std::string name_of_axis(const std::vector<Axis>& axes, std::size_t axis) {
  return axes[axis].name.empty() ? std::to_string(axis) : axes[axis].name;
}

std::vector<Axis> axes_of(const Mesh& mesh) {
  const auto dimension = static_cast<std::ptrdiff_t>(mesh.dimension);
  if (std::ssize(mesh.grid_axes) >= dimension) // that of levels follows
    return {mesh.grid_axes.begin(), mesh.grid_axes.begin() + dimension};
  std::vector<Axis> axes(static_cast<std::size_t>(mesh.dimension));
  constexpr const char* names[] = {"x", "y", "z", "t"};
  for (std::size_t axis = 0; axis < std::min<std::size_t>(axes.size(), 4); ++axis)
    axes[axis].name = names[axis];
  return axes;
}

Mesh mesh_in(const std::string& path, bool quiet) {
  const ProgressBar bar("read", quiet);
  return take(read_mesh(path));
}

Measure measure_of(const Mesh& mesh, bool quiet, int threads) {
  const ProgressBar bar("measure", quiet);
  return take(measure(mesh, threads));
}

void check_memory_to_measure(const Mesh& mesh, std::uint64_t limit) {
  const std::uint64_t needed = mesh.simplices.size() * 8 + mesh.vertex_count() * 16; // as measure.hpp says
  if (bytes_of(mesh) + needed <= limit) return;
  throw Failure{{Code::out_of_memory, text("the surface takes ", byte_size(bytes_of(mesh)),
                                           " and --measure of its ", mesh.simplex_count(), " simplices ",
                                           byte_size(needed), ", more than ", byte_size(limit))}};
}

std::uint64_t bytes_of(const Mesh& mesh) {
  return mesh.positions.bytes() + mesh.simplices.bytes() + mesh.edges.size() * sizeof(GridEdge);
}

bool is_mesh_file(const std::string& path) {
  const std::string suffix = std::filesystem::path(path).extension().string();
  for (const char* known : {".vtu", ".vtp", ".ply", ".stl", ".obj", ".off"})
    if (suffix == known) return true;
  return false;
}

const char* simplex_noun(int k) {
  constexpr const char* nouns[] = {"points", "segments", "triangles", "tetrahedra", "4-simplices"};
  return k >= 0 && k <= 4 ? nouns[k] : "simplices";
}

const char* content_noun(int k) {
  constexpr const char* nouns[] = {"points", "length", "area", "volume"};
  return k >= 0 && k <= 3 ? nouns[k] : "content";
}

Json json_of(const Measure& measure) {
  Json object{{"components", measure.components},
              {"euler_characteristic", measure.euler_characteristic},
              {"boundary_facets", measure.boundary_facets},
              {"bad_facets", measure.bad_facets},
              {"closed", measure.closed},
              {"content", measure.content}};
  if (measure.vector_area.empty())
    object["inverted_simplices"] = measure.inverted_simplices; // a volume
  else
    object["vector_area"] = measure.vector_area;
  object["zero_content_simplices"] = measure.zero_content_simplices;
  return object;
}

void add_measure(Report& report, const Measure& measure, int simplex_dimension) {
  report.add("components", grouped(measure.components));
  report.add("Euler char.", std::to_string(measure.euler_characteristic));
  report.add("boundary", measure.closed ? "none: closed"
                                        : fmt::format("{} {}", grouped(measure.boundary_facets),
                                                      simplex_noun(simplex_dimension - 1)));
  report.add("bad facets", grouped(measure.bad_facets));
  add_contents(report, measure, simplex_dimension);
}

void add_contents(Report& report, const Contents& contents, int simplex_dimension) {
  const char* simplices = simplex_noun(simplex_dimension);
  report.add(content_noun(simplex_dimension), fmt::format("{:.10g}", contents.content));
  if (contents.vector_area.empty())
    report.add("inverted", fmt::format("{} {}", grouped(contents.inverted_simplices), simplices));
  else
    report.add("vector area", fmt::format("{:.6g}", fmt::join(contents.vector_area, ", ")));
  report.add("zero content", fmt::format("{} {}", grouped(contents.zero_content_simplices), simplices));
}

void add_self_intersections_option(CLI::App& app, bool& option) {
  app.add_flag(
         "--self-intersections", option,
         "also look for simplices that pass through each other, exactly (slower). There are none in the "
         "surfaces of up to 4D fields by any method, nor in any dimension by simplicial")
      ->group("Output");
}

SelfIntersections self_intersections_of(const Mesh& mesh, bool quiet) {
  ProgressBar bar("self-intersections", quiet);
  return take(find_self_intersections(mesh, bar.callback()));
}

Json json_of(const SelfIntersections& found) {
  return {{"pairs", found.pairs}, {"examples", found.examples}};
}

void add_self_intersections(Report& report, const SelfIntersections& found) {
  std::string value =
      grouped(found.pairs) + (found.pairs == 1 ? " pair of simplices" : " pairs of simplices");
  if (!found.examples.empty())
    value += fmt::format(", the first: {} and {}", found.examples[0][0], found.examples[0][1]);
  report.add("self-intersections", value);
}

Affine at_coordinate(const Affine& map, int axis, double value) {
  const auto D = static_cast<std::size_t>(map.offset.size()), removed = static_cast<std::size_t>(axis);
  Affine rest;
  for (std::size_t row = 0; row < D; ++row) {
    if (row == removed) continue;
    rest.offset.push_back(map.offset[row] + map.linear[row * D + removed] * value);
    for (std::size_t column = 0; column < D; ++column)
      if (column != removed) rest.linear.push_back(map.linear[row * D + column]);
  }
  return rest;
}

FieldInfo without_flat_axes(FieldInfo info) {
  if (info.dimension() < 2) check_axes(info);
  for (int axis = info.dimension() - 1; axis >= 0; --axis) {
    const Axis& flat = info.axes[static_cast<std::size_t>(axis)];
    if (flat.count != 1) continue;
    if (info.dimension() == 2) check_axes(info);
    if (info.world) info.world = at_coordinate(*info.world, axis, flat.coordinate(0));
    info.has_time &= axis != info.dimension() - 1;
    info.axes.erase(info.axes.begin() + axis);
  }
  return info;
}

Field without_flat_axes(Field field) {
  FieldInfo info = without_flat_axes(field.info);
  std::size_t kept = 0;
  for (std::size_t axis = 0; axis < field.strides.size(); ++axis)
    if (field.info.axes[axis].count != 1) field.strides[kept++] = field.strides[axis];
  field.strides.resize(kept);
  field.info = std::move(info);
  return field;
}

void check_axes(const FieldInfo& info) {
  for (std::size_t axis = 0; axis < info.axes.size(); ++axis)
    if (info.axes[axis].count < 2)
      fail_usage(text("the field is ", size_and_type(info), ": axis ", name_of_axis(info.axes, axis),
                      " has one sample, and a surface needs two or more along two axes at least"));
}

std::string with_suffix(const std::string& path, const std::string& suffix) {
  std::filesystem::path result = path;
  const std::string extension = result.extension().string();
  result.replace_filename(result.stem().string() + '_' + suffix + extension);
  return result.string();
}

bool has_number_pattern(const std::string& path) { return path.find('%') != std::string::npos; }

std::string with_number(const std::string& option, const std::string& path, std::size_t number) {
  std::string result;
  int places = 0;
  for (std::size_t i = 0; i < path.size(); ++i) {
    if (path[i] != '%' || path.compare(i, 2, "%%") == 0) {
      i += path[i] == '%';
      result += path[i];
      continue;
    }
    const std::size_t end = path.find_first_not_of("0123456789", i + 1);
    const std::string width = path.substr(i + 1, end == std::string::npos ? end : end - i - 1);
    if (end == std::string::npos || path[end] != 'd' || width.size() > 2)
      fail_usage(text(option, ": '", path.substr(i),
                      "' does not begin with the place of a number, such as "
                      "%04d; a percent sign itself is %%"));
    std::string digits = std::to_string(number);
    const std::size_t wanted = width.empty() ? 0 : std::stoul(width);
    if (digits.size() < wanted) digits.insert(0, wanted - digits.size(), width.front() == '0' ? '0' : ' ');
    result += digits;
    ++places;
    i = end;
  }
  if (places != 1)
    fail_usage(text(option, ": '", path, "' has ", places, " places for a number; one is needed"));
  return result;
}

namespace {

std::string why_empty(const Statistics& statistics, double isovalue) {
  if (statistics.finite() == 0) return text("no surface: the field has no finite sample");
  return text("no surface at isovalue ", isovalue, ": the values go from ", statistics.minimum, " to ",
              statistics.maximum);
}

} // namespace

std::string why_empty(const Field& field, double isovalue) {
  StatisticsCollector collector;
  collector.add(field);
  return why_empty(std::move(collector).finish(), isovalue);
}

std::string why_empty(StepSource& steps, double isovalue) {
  StatisticsCollector collector;
  for (std::int64_t step = 0; step < steps.info().axes.back().count; ++step)
    collector.add(take(steps.read(step, step + 1)));
  return why_empty(std::move(collector).finish(), isovalue);
}

} // namespace hyperiso::cli
