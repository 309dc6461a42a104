// Isolines as a picture (SVG) and for maps (GeoJSON). Both hold whole lines, not segments.

#include "core/text.hpp"
#include "hyperiso/polylines.hpp"
#include "io/encoding.hpp"
#include "io/mesh_formats.hpp"
#include "io/tracking/drawing.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <nlohmann/json.hpp>

namespace hyperiso {
namespace {

using tracking_files::pixel;

Status check_finite(const Mesh& mesh) {
  for (std::size_t i = 0; i < mesh.positions.size(); ++i)
    if (!std::isfinite(mesh.positions[i]))
      return Error{Code::invalid_argument, text("vertex ", i / 2, " is at ", mesh.positions[i],
                                                "; only finite numbers can be written as svg or geojson")};
  return {};
}

// The lines of a mesh that has finite coordinates.
Result<std::vector<Polyline>> finite_lines(const Mesh& mesh) {
  if (const Status finite = check_finite(mesh); !finite) return finite.error();
  return polylines(mesh);
}

std::string of_axis(const std::vector<std::string>& words, std::size_t axis) {
  return axis < words.size() ? words[axis] : std::string();
}

// The range of an axis of the picture and where it is drawn.
struct Scale {
  double low = 0, high = 1, start = 0, pixels = 1; // `pixels` is negative upwards
  double operator()(double value) const { return start + (value - low) / (high - low) * pixels; }
};

// The extent of the grid where it is known, else of the lines.
Scale range_of(const Mesh& mesh, std::size_t axis) {
  Scale scale{HUGE_VAL, -HUGE_VAL};
  const auto include = [&](double value) {
    scale.low = std::min(scale.low, value);
    scale.high = std::max(scale.high, value);
  };
  for (std::size_t i = axis; i < mesh.positions.size(); i += 2) include(mesh.positions[i]);
  if (mesh.grid_axes.size() == 2 && std::isfinite(mesh.grid_axes[axis].coordinate(0))) {
    include(mesh.grid_axes[axis].coordinate(0));
    include(mesh.grid_axes[axis].coordinate(mesh.grid_axes[axis].count - 1));
  }
  if (scale.low > scale.high) return {0, 1};
  if (scale.low == scale.high) return {scale.low - 0.5, scale.high + 0.5};
  return scale;
}

constexpr double left = 72, top = 56, width = 640, height = 480;

// Lengths are alike on both axes if their units are and neither would be a sliver.
std::array<Scale, 2> scales_of(const Mesh& mesh, const WriteMeshOptions& options) {
  std::array<Scale, 2> scales{range_of(mesh, 0), range_of(mesh, 1)};
  double across = width, up = height;
  const double shape = (scales[1].high - scales[1].low) / (scales[0].high - scales[0].low);
  const bool alike = of_axis(options.axis_units, 0) == of_axis(options.axis_units, 1);
  if (alike && shape < 8 && shape > 1. / 8) {
    up = width * shape;
    if (up > width) up = width, across = width / shape;
  }
  scales[0].start = left;
  scales[0].pixels = across;
  scales[1].start = top + up;
  scales[1].pixels = -up;
  return scales;
}

std::string axis_title(const WriteMeshOptions& options, std::size_t axis) {
  std::string title = of_axis(options.axis_names, axis);
  if (title.empty()) title = axis == 0 ? "x" : "y";
  const std::string unit = of_axis(options.axis_units, axis);
  return unit.empty() ? title : title + " [" + unit + "]";
}

std::string label(double x, double y, const char* anchor, const std::string& words) {
  return text("<text x=\"", pixel(x), "\" y=\"", pixel(y), "\" text-anchor=\"", anchor, "\">",
              xml_escaped(words), "</text>\n");
}

// Without the digits that multiples of a step have from rounding.
std::string tick_label(double value) {
  char digits[32];
  return {digits, std::to_chars(digits, digits + sizeof digits, value, std::chars_format::general, 10).ptr};
}

std::string drawn_axes(const std::array<Scale, 2>& scales, const WriteMeshOptions& options) {
  const auto& [x, y] = scales;
  const double right = x.start + x.pixels, bottom = y.start;
  std::string lines, labels;
  const auto line = [&](double x1, double y1, double x2, double y2) {
    lines += text("<line x1=\"", pixel(x1), "\" y1=\"", pixel(y1), "\" x2=\"", pixel(x2), "\" y2=\"",
                  pixel(y2), "\"/>\n");
  };
  for (const double tick : tracking_files::ticks(x.low, x.high, 6)) {
    line(x(tick), top, x(tick), bottom);
    labels += label(x(tick), bottom + 16, "middle", tick_label(tick));
  }
  for (const double tick : tracking_files::ticks(y.low, y.high, 6)) {
    line(left, y(tick), right, y(tick));
    labels += label(left - 6, y(tick) + 4, "end", tick_label(tick));
  }
  labels += label((left + right) / 2, bottom + 36, "middle", axis_title(options, 0));
  labels += label(left - 6, top - 8, "end", axis_title(options, 1));
  return text("<g stroke=\"#e4e4e4\" stroke-width=\"1\">\n", lines, "</g>\n<rect x=\"", pixel(left),
              "\" y=\"", pixel(top), "\" width=\"", pixel(x.pixels), "\" height=\"", pixel(-y.pixels),
              "\" fill=\"none\" stroke=\"#999\"/>\n<g fill=\"#444\">\n", labels, "</g>\n");
}

} // namespace

Status write_svg(AtomicFile& file, const Mesh& mesh, const WriteMeshOptions& options) {
  const auto lines = finite_lines(mesh);
  if (!lines) return lines.error();
  const std::array<Scale, 2> scales = scales_of(mesh, options);
  const std::string title = text(lines->size(), lines->size() == 1 ? " isoline" : " isolines");
  file.write(tracking_files::svg_start(left + scales[0].pixels + 24, scales[1].start + 52, title));
  file.write(drawn_axes(scales, options));
  file.write("<g id=\"isolines\" fill=\"none\" stroke=\"#1b5e9e\" stroke-width=\"1.6\" "
             "stroke-linejoin=\"round\">\n");
  for (const Polyline& line : *lines) {
    std::string path = "<path d=\"M";
    for (const std::uint64_t vertex : line.vertices) {
      if (path.back() != 'M') path += 'L';
      path += pixel(scales[0](mesh.positions[2 * vertex])) + ' ' +
              pixel(scales[1](mesh.positions[2 * vertex + 1]));
    }
    file.write(path + (line.closed ? "Z\"/>\n" : "\"/>\n"));
    if (file.failed()) break;
  }
  file.write("</g>\n</svg>\n");
  return {};
}

Status write_geojson(AtomicFile& file, const Mesh& mesh, const WriteMeshOptions& options) {
  const auto lines = finite_lines(mesh);
  if (!lines) return lines.error();
  nlohmann::ordered_json axes = nlohmann::ordered_json::array();
  for (std::size_t axis = 0; axis < 2; ++axis)
    axes.push_back(
        {{"name", of_axis(options.axis_names, axis)}, {"unit", of_axis(options.axis_units, axis)}});
  const auto replace = nlohmann::ordered_json::error_handler_t::replace; // what is no UTF-8
  file.write("{\"type\":\"FeatureCollection\",\"axes\":" + axes.dump(-1, ' ', false, replace) +
             ",\"features\":[");
  const char* separator = "\n";
  for (const Polyline& line : *lines) {
    std::string feature =
        text(separator, R"({"type":"Feature","properties":{"closed":)", line.closed ? "true" : "false",
             R"(},"geometry":{"type":"LineString","coordinates":[)");
    const auto append_point = [&](std::uint64_t vertex) {
      feature += feature.back() == '[' ? "[" : ",[";
      mesh.positions.visit([&](auto positions) {
        append_number(feature, positions[2 * vertex]);
        feature += ',';
        append_number(feature, positions[2 * vertex + 1]);
      });
      feature += ']';
    };
    for (const std::uint64_t vertex : line.vertices) append_point(vertex);
    if (line.closed) append_point(line.vertices.front());
    file.write(feature + "]}}");
    separator = ",\n";
    if (file.failed()) break;
  }
  file.write("\n]}\n");
  return {};
}

} // namespace hyperiso
