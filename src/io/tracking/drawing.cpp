#include "io/tracking/drawing.hpp"

#include "hyperiso/colours.hpp"

#include <cmath>
#include <cstdio>
#include <span>

namespace hyperiso::tracking_files {

std::string colour_of(std::int64_t track) {
  const Colour colour = label_colour(track);
  char digits[8];
  std::snprintf(digits, sizeof digits, "#%02x%02x%02x", unsigned{colour.red}, unsigned{colour.green},
                unsigned{colour.blue});
  return digits;
}

std::optional<TrackingGraph> with_largest_alone(const TrackingGraph& graph) {
  std::vector<std::size_t> shown;
  for (std::size_t track = 0; track < graph.tracks.size(); ++track)
    if (!graph.tracks[track].simplified) shown.push_back(track);
  if (shown.size() <= most_drawn) return std::nullopt;
  std::ranges::stable_sort(shown, std::ranges::greater{},
                           [&](std::size_t track) { return graph.tracks[track].max_volume; });
  TrackingGraph result = graph;
  for (const std::size_t track : std::span(shown).subspan(most_drawn)) result.tracks[track].simplified = true;
  return result;
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

// In a browser's narrower window it shrinks; other programs take the width as it is.
std::string svg_start(double width, double height, const std::string& title) {
  return text(
      "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"",
      pixel(width), "\" height=\"", pixel(height), "\" viewBox=\"0 0 ", pixel(width), " ", pixel(height),
      "\" style=\"max-width:100%;height:auto\" font-family=\"system-ui, 'Segoe UI', 'DejaVu Sans', "
      "sans-serif\" font-size=\"12\" fill=\"#333\">\n",
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
