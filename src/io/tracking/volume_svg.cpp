// Volume against time (paper 003 figure 8).

#include "io/tracking/drawing.hpp"

#include <cmath>

namespace hyperiso {

using namespace tracking_files;

namespace {

constexpr double left = 76, right = 1200, top = 64, bottom = 600;

class VolumePicture {
 public:
  explicit VolumePicture(const TrackingGraph& graph)
      : graph_(graph), time_(graph, left, right), rows_(graph.tracks.size()) {
    std::vector<double> volumes;
    for (const Feature& row : graph.features)
      if (!graph.tracks[index(row.track)].simplified) {
        rows_[index(row.track)].push_back(&row);
        if (row.volume > 0) volumes.push_back(row.volume);
      }
    if (volumes.empty()) volumes.push_back(1);
    std::ranges::sort(volumes);
    // Tracks of very different size show on a logarithmic scale only.
    std::vector<double> largest;
    for (const Track& track : graph.tracks)
      if (!track.simplified && track.steps > 0) largest.push_back(track.max_volume);
    std::ranges::sort(largest);
    logarithmic_ = !largest.empty() && largest.back() > 50 * largest[largest.size() / 2];
    high_ = volumes.back() * (logarithmic_ ? 1.5 : 1.05);
    // What is a millionth of the largest and less lies on the floor.
    low_ = logarithmic_ ? std::pow(10, std::floor(std::log10(std::max(volumes.front(), 1e-6 * high_)))) : 0;
  }

  std::string svg() const {
    std::string body = time_.grid(top, bottom) + scale();
    for (std::size_t track = 0; track < rows_.size(); ++track)
      if (!rows_[track].empty()) body += curve(track);
    std::vector<std::pair<double, double>> labels;
    for (const std::size_t track : largest_tracks(20)) body += label(track, labels);
    return svg_start(1280, bottom + 56, text("Volume of each track, isovalue ", graph_.isovalue)) + body +
           "</svg>\n";
  }

 private:
  double y(double volume) const {
    const double share = logarithmic_ ? std::log(std::max(volume, low_) / low_) / std::log(high_ / low_)
                                      : (volume - low_) / (high_ - low_);
    return bottom - share * (bottom - top);
  }

  std::string scale() const {
    std::vector<double> values;
    if (logarithmic_)
      for (double power = std::round(std::log10(low_)); std::pow(10, power) <= high_; ++power)
        values.push_back(std::pow(10, power));
    else
      values = ticks(low_, high_, 8);
    std::string svg;
    for (const double value : values)
      svg +=
          text("<line x1=\"", pixel(left), "\" x2=\"", pixel(right), "\" y1=\"", pixel(y(value)), "\" y2=\"",
               pixel(y(value)), "\" stroke=\"#e4e4e4\"/>\n<text x=\"", pixel(left - 8), "\" y=\"",
               pixel(y(value) + 4), "\" text-anchor=\"end\" fill=\"#666\">", value, "</text>\n");
    return svg + text("<text transform=\"translate(18 ", pixel((top + bottom) / 2),
                      ") rotate(-90)\" text-anchor=\"middle\">volume", logarithmic_ ? " (logarithmic)" : "",
                      "</text>\n");
  }

  std::string curve(std::size_t number) const {
    const Track& track = graph_.tracks[number];
    const auto id = static_cast<std::int64_t>(number);
    std::string path;
    const auto add = [&](double time, double volume) {
      path += text(path.empty() ? "M" : "L", pixel(time_.x(time)), " ", pixel(y(volume)));
    };
    if (track.start_type == "birth") add(track.start_time, low_);
    for (const Feature* row : rows_[number]) add(row->time, row->volume);
    if (track.end_type == "death") add(track.end_time, low_);
    const bool is_dot = rows_[number].size() == 1;
    if (is_dot) path += "h0";
    return text("<path d=\"", path, "\" fill=\"none\" stroke=\"", colour_of(id), "\" stroke-width=\"",
                is_dot ? 4 : 2, "\" stroke-linejoin=\"round\" stroke-linecap=\"round\">",
                tooltip(text("track ", id)), "</path>\n");
  }

  std::vector<std::size_t> largest_tracks(std::size_t count) const {
    std::vector<std::size_t> tracks;
    for (std::size_t track = 0; track < rows_.size(); ++track)
      if (!rows_[track].empty()) tracks.push_back(track);
    std::ranges::stable_sort(tracks, std::greater(),
                             [&](std::size_t t) { return graph_.tracks[t].max_volume; });
    tracks.resize(std::min(tracks.size(), count));
    return tracks;
  }

  // At the track's largest volume, unless others that are there already leave no room.
  std::string label(std::size_t number, std::vector<std::pair<double, double>>& labels) const {
    const auto peak = *std::ranges::max_element(rows_[number], {}, &Feature::volume);
    const double x = time_.x(peak->time), at = y(peak->volume) - 6;
    for (const auto& [other_x, other_y] : labels)
      if (std::abs(other_x - x) < 24 && std::abs(other_y - at) < 11) return "";
    labels.emplace_back(x, at);
    return text("<text x=\"", pixel(x), "\" y=\"", pixel(at),
                "\" text-anchor=\"middle\" font-size=\"11\" fill=\"",
                colour_of(static_cast<std::int64_t>(number)),
                "\" stroke=\"#fff\" stroke-width=\"3\" paint-order=\"stroke\">", number, "</text>\n");
  }

  const TrackingGraph& graph_;
  TimeScale time_;
  std::vector<std::vector<const Feature*>> rows_; // of each track that is shown
  bool logarithmic_ = false;
  double low_ = 0, high_ = 1;
};

} // namespace

std::string volume_svg(const TrackingGraph& graph) {
  const auto largest = with_largest_alone(graph);
  return VolumePicture(largest ? *largest : graph).svg();
}

} // namespace hyperiso
