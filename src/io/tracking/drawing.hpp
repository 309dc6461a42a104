#pragma once
// Axes and shapes for the pictures.

#include "io/tracking/common.hpp"

namespace hyperiso::tracking_files {

// Round numbers between two ends, about `wanted` of them.
std::vector<double> ticks(double low, double high, int wanted);

// More tracks than anybody can tell apart are not drawn.
constexpr std::size_t most_drawn = 2000;

// The graph with all but its largest tracks marked as simplified; nothing if all of them can be drawn.
std::optional<TrackingGraph> with_largest_alone(const TrackingGraph& graph);

// A coordinate of a picture, to a hundredth.
std::string pixel(double value);

// The opening of a picture: white ground, the font, a title.
std::string svg_start(double width, double height, const std::string& title);

// Vertical lines at round times with their labels above and below, between `top` and `bottom`.
class TimeScale {
 public:
  TimeScale(const TrackingGraph& graph, double left, double right);
  double x(double time) const { return left_ + (time - start_) / (end_ - start_) * (right_ - left_); }
  double pixels(double duration) const { return duration / (end_ - start_) * (right_ - left_); }
  double duration(double pixels) const { return pixels / (right_ - left_) * (end_ - start_); }
  std::string grid(double top, double bottom) const;

 private:
  double left_, right_, start_, end_;
  std::string label_;
};

// What follows the pointer.
inline std::string tooltip(const std::string& words) { return "<title>" + xml_escaped(words) + "</title>"; }

} // namespace hyperiso::tracking_files
