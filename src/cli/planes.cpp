#include "cli/planes.hpp"

#include "cli/dispatch.hpp"
#include "cli/failure.hpp"
#include "cli/parse.hpp"
#include "cli/surface.hpp"
#include "core/text.hpp"

#include <algorithm>

namespace hyperiso::cli {
namespace {

constexpr const char* cut_group = "Cut";

std::string axis_list(const std::vector<Axis>& axes) {
  std::string list;
  for (std::size_t axis = 0; axis < axes.size(); ++axis)
    list += (axis == 0 ? "" : ", ") + name_of_axis(axes, axis);
  return list;
}

Plane across(const std::vector<Axis>& space, int axis, double value) {
  Plane plane{std::vector<double>(space.size()), value, name_of_axis(space, static_cast<std::size_t>(axis)),
              value, axis};
  plane.normal[static_cast<std::size_t>(axis)] = 1;
  return plane;
}

void add_across(const std::string& given, const std::vector<Axis>& space, std::vector<Plane>& planes) {
  const auto equals = given.find('=');
  if (equals == std::string::npos) fail_usage(text("--axis: '", given, "' is not NAME=VALUE"));
  FieldInfo info;
  info.axes = space;
  const auto axis = info.axis_named(given.substr(0, equals));
  if (!axis)
    fail_usage(
        text("--axis: there is no axis '", given.substr(0, equals), "'; there are ", axis_list(space)));
  for (const double value : parse_series("--axis", given.substr(equals + 1)))
    planes.push_back(across(space, *axis, value));
}

void add_plane(const std::string& given, const std::vector<Axis>& space, std::vector<Plane>& planes) {
  const auto numbers = split(given, ',');
  if (numbers.size() != space.size() + 1)
    fail_usage(text("--plane: '", given, "' has ", numbers.size(), " numbers; in ", space.size(),
                    " dimensions it takes ", space.size() + 1, ": those of the normal and the offset"));
  std::vector<double> normal;
  for (std::size_t k = 0; k < space.size(); ++k) normal.push_back(parse_number("--plane", numbers[k]));
  const auto nonzero = std::ranges::count_if(normal, [](double n) { return n != 0; });
  if (nonzero == 0) fail_usage(text("--plane: the normal of '", given, "' is 0"));
  for (const double offset : parse_series("--plane", numbers.back())) {
    if (nonzero > 1) {
      planes.push_back({normal, offset, "plane", offset, -1});
      continue;
    }
    const auto axis = std::ranges::find_if(normal, [](double n) { return n != 0; }) - normal.begin();
    planes.push_back(across(space, static_cast<int>(axis), offset / normal[static_cast<std::size_t>(axis)]));
  }
}

} // namespace

void PlaneOptions::add_to(CLI::App& app) {
  const auto add = [&](const char* name, std::vector<std::string>& values, const char* type,
                       const char* meaning) {
    app.add_option(name, values, meaning)->type_name(type)->allow_extra_args(false)->group(cut_group);
  };
  add("--time,--times", times, "T[,T...]",
      "where to cut the last axis, in its coordinates (times, not step numbers): a time, several with commas "
      "between them, or a series FROM:TO:STEP. This and the next two may be given again and again");
  add("--axis", axes, "NAME=V[,V...]",
      "where to cut another axis, by its name or number: y=0.5 or 1=0.5; several and series as for --time");
  add("--plane", planes, "N,...,C",
      "cut by the plane N . x = C, one number for each axis and the offset: 1,0,0,2,0.5 is x + 2 t = 0.5. "
      "The offset may be a series");
  app.add_option(
         "--frame", frame,
         "coordinates on an oblique plane: orthonormal (default; shapes are true) or axes (those of the "
         "axes without the one most aligned with the normal; places are true). A plane across an axis "
         "keeps the other axes in either")
      ->type_name("FRAME")
      ->group(cut_group);
}

SliceFrame PlaneOptions::slice_frame() const {
  if (frame != "orthonormal" && frame != "axes")
    fail_usage(text("--frame: '", frame, "' is neither orthonormal nor axes"));
  return frame == "axes" ? SliceFrame::axes : SliceFrame::orthonormal;
}

std::vector<Plane> PlaneOptions::parse(const std::vector<Axis>& space) const {
  std::vector<Plane> result;
  for (const std::string& given : times)
    for (const double time : parse_series("--time", given))
      result.push_back(across(space, static_cast<int>(space.size()) - 1, time));
  for (const std::string& given : axes) add_across(given, space, result);
  for (const std::string& given : planes) add_plane(given, space, result);
  return result;
}

MappedPlane in_axis_coordinates(const Plane& plane, const std::optional<Affine>& world, SliceFrame frame) {
  if (!world) return {plane, std::nullopt};
  return with_dimension<3>(static_cast<int>(plane.normal.size()), "the field", [&](auto dimension) {
    constexpr int D = decltype(dimension)::value;
    const auto in_world = plane.hyperplane<D>();
    // normal . (linear x + offset) = plane.offset
    Plane of_axes = plane;
    of_axes.axis = -1;
    int nonzero = 0;
    for (std::size_t column = 0; column < D; ++column) {
      of_axes.normal[column] = 0;
      for (std::size_t row = 0; row < D; ++row)
        of_axes.normal[column] += plane.normal[row] * world->linear[row * D + column];
      of_axes.offset -= plane.normal[column] * world->offset[column];
      if (of_axes.normal[column] != 0) of_axes.axis = static_cast<int>(column), ++nonzero;
    }
    if (nonzero > 1) of_axes.axis = -1;

    // From the cut to the axes, on to the world, and into the plane there.
    const auto of_cut = plane_coordinates(of_axes.hyperplane<D>(), SliceFrame::axes),
               of_result = plane_coordinates(in_world, frame);
    const auto to_world = [&](const std::vector<double>& x, bool point) {
      std::vector<double> image(D);
      for (std::size_t row = 0; row < D; ++row) {
        image[row] = point ? world->offset[row] : 0;
        for (std::size_t k = 0; k < D; ++k) image[row] += world->linear[row * D + k] * x[k];
      }
      return image;
    };
    Affine map{std::vector<double>((D - 1) * (D - 1)), std::vector<double>(D - 1)};
    const auto origin = to_world(of_cut.foot, true);
    for (std::size_t row = 0; row < D - 1; ++row)
      for (std::size_t k = 0; k < D; ++k) {
        map.offset[row] += of_result.rows[row][k] * origin[k];
        for (std::size_t column = 0; column < D - 1; ++column)
          map.linear[row * (D - 1) + column] +=
              of_result.rows[row][k] * to_world(of_cut.directions[column], false)[k];
      }
    return MappedPlane{of_axes, map};
  });
}

} // namespace hyperiso::cli
