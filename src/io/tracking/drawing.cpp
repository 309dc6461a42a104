#include "io/tracking/drawing.hpp"

#include <array>
#include <cmath>
#include <numbers>

namespace hyperiso::tracking_files {
namespace {

// Of the OKLab colour space (Ottosson 2020), where equal steps look equal, to sRGB.
std::array<double, 3> srgb_of_oklch(double lightness, double chroma, double hue) {
  const double a = chroma * std::cos(hue), b = chroma * std::sin(hue);
  const double l = std::pow(lightness + 0.3963377774 * a + 0.2158037573 * b, 3);
  const double m = std::pow(lightness - 0.1055613458 * a - 0.0638541728 * b, 3);
  const double s = std::pow(lightness - 0.0894841775 * a - 1.2914855480 * b, 3);
  std::array<double, 3> rgb{4.0767416621 * l - 3.3077115913 * m + 0.2309699292 * s,
                            -1.2684380046 * l + 2.6097574011 * m - 0.3413193965 * s,
                            -0.0041960863 * l - 0.7034186147 * m + 1.7076147010 * s};
  for (double& channel : rgb) {
    channel = std::clamp(channel, 0.0, 1.0);
    channel = channel <= 0.0031308 ? 12.92 * channel : 1.055 * std::pow(channel, 1 / 2.4) - 0.055;
  }
  return rgb;
}

} // namespace

std::string colour_of(std::int64_t track) {
  const double golden_angle = std::numbers::pi * (3 - std::sqrt(5.0));
  const double lightness = track % 3 == 0 ? 0.6 : track % 3 == 1 ? 0.68 : 0.52;
  const auto rgb = srgb_of_oklch(lightness, 0.14, 4.3 + golden_angle * static_cast<double>(track));
  char colour[8];
  std::snprintf(colour, sizeof colour, "#%02x%02x%02x", static_cast<unsigned>(std::lround(rgb[0] * 255)),
                static_cast<unsigned>(std::lround(rgb[1] * 255)),
                static_cast<unsigned>(std::lround(rgb[2] * 255)));
  return colour;
}

std::vector<double> ticks(double low, double high, int wanted) {
  if (!(high > low)) return {low};
  const double raw = (high - low) / wanted;
  const double power = std::pow(10, std::floor(std::log10(raw)));
  double step = 10 * power;
  for (const double factor : {5.0, 2.0, 1.0})
    if (factor * power >= raw * 0.99) step = factor * power;
  std::vector<double> result;
  for (double i = std::ceil(low / step - 1e-9) + 0.0; i * step <= high + 1e-9 * step; ++i)
    result.push_back(i * step + 0.0); // no negative zero
  return result;
}

std::string pixel(double value) { return text(std::round(value * 100) / 100); }

std::string svg_start(double width, double height, const std::string& title) {
  return text(
      "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"",
      pixel(width), "\" height=\"", pixel(height), "\" viewBox=\"0 0 ", pixel(width), " ", pixel(height),
      "\" font-family=\"system-ui, 'Segoe UI', 'DejaVu Sans', sans-serif\" font-size=\"12\" fill=\"#333\">\n",
      "<title>", xml_escaped(title), "</title>\n<rect width=\"100%\" height=\"100%\" fill=\"#fff\"/>\n",
      "<text x=\"16\" y=\"24\" font-size=\"15\" font-weight=\"600\" fill=\"#111\">", xml_escaped(title),
      "</text>\n");
}

TimeScale::TimeScale(const TrackingGraph& graph, double left, double right) : left_(left), right_(right) {
  const Axis& axis = graph.axes.back();
  start_ = axis.coordinate(0);
  end_ = axis.coordinate(axis.count - 1);
  label_ = axis.name.empty() ? "time" : axis.name;
  if (!axis.unit.empty()) label_ += " [" + axis.unit + "]";
}

std::string TimeScale::grid(double top, double bottom) const {
  std::string svg = "<g stroke=\"#e4e4e4\" stroke-width=\"1\">\n";
  const std::vector<double> times = ticks(start_, end_, 12);
  for (const double time : times)
    svg += text("<line x1=\"", pixel(x(time)), "\" y1=\"", pixel(top), "\" x2=\"", pixel(x(time)), "\" y2=\"",
                pixel(bottom), "\"/>\n");
  svg += "</g>\n<g fill=\"#666\" text-anchor=\"middle\">\n";
  for (const double time : times)
    for (const double y : {top - 6, bottom + 16})
      svg += text("<text x=\"", pixel(x(time)), "\" y=\"", pixel(y), "\">",
                  text(std::round(time * 1e9) / 1e9), "</text>\n");
  return svg + text("<text x=\"", pixel((left_ + right_) / 2), "\" y=\"", pixel(bottom + 34),
                    "\" fill=\"#333\">", xml_escaped(label_), "</text>\n</g>\n");
}

} // namespace hyperiso::tracking_files
