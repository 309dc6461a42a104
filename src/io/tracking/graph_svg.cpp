// The graph as ribbons along time.

#include "io/tracking/drawing.hpp"
#include "track/lanes.hpp"

#include <cmath>
#include <map>
#include <set>
#include <span>

namespace hyperiso {

using namespace tracking_files;

namespace {

constexpr double left_margin = 48, right_margin = 28, top_margin = 64, width = 1280;
constexpr std::size_t many = 100; // tracks; from there on what joins them is drawn fainter, and marks smaller

// A mark of about radius 1 around the origin, drawn with the colours of its group.
const char* glyph_shape(EventType type) {
  switch (type) {
  case EventType::birth:
    return "<circle r=\"0.9\"/>";
  case EventType::death:
    return "<path d=\"M-.8-.8L.8.8M-.8.8L.8-.8\" fill=\"none\"/>";
  case EventType::merge:
    return "<path d=\"M-.8-1L.9 0L-.8 1Z\"/>";
  case EventType::split:
    return "<path d=\"M.8-1L-.9 0L.8 1Z\"/>";
  case EventType::compound:
    return "<path d=\"M0-1.2L1.2 0L0 1.2L-1.2 0Z\"/>";
  case EventType::genus:
    return "<circle r=\"1\"/><circle r=\".4\"/>";
  case EventType::enter:
    return "<path d=\"M-1-1.1V1.1M-.6-.8L.9 0L-.6.8Z\"/>";
  case EventType::exit:
    return "<path d=\"M1-1.1V1.1M-.9-.8L.6 0L-.9.8Z\"/>";
  case EventType::touch:
    return "<path d=\"M0-1.1V1.1\" fill=\"none\"/>";
  default:
    return ""; // what is there at the first or last step just begins or ends there
  }
}

// Where the curve of a connection from (x1, y1) to (x2, y2) is at x: of the cubic with both handles half way.
double height_of_curve(double x1, double y1, double x2, double y2, double x) {
  double low = 0, high = 1;
  for (int halving = 0; halving < 20; ++halving) {
    const double s = (low + high) / 2, at = x1 + (x2 - x1) * s * (1.5 - 1.5 * s + s * s);
    (at < x ? low : high) = s;
  }
  return y1 + (y2 - y1) * low * low * (3 - 2 * low);
}

class GraphPicture {
 public:
  explicit GraphPicture(const TrackingGraph& graph)
      : graph_(graph), time_(graph, left_margin, width - right_margin),
        lanes_(track_detail::assign_lanes(graph, time_.duration(shown_tracks() > many ? 20 : 34))),
        rows_(graph.tracks.size()) {
    const auto lanes = static_cast<double>(std::max<std::int64_t>(lanes_.count, 1));
    pitch_ = std::clamp(640 / lanes, 8.0, 56.0);
    bottom_ = top_margin + pitch_ * lanes;
    for (const Feature& row : graph.features) rows_[index(row.track)].push_back(&row);
    for (const Track& track : graph.tracks)
      if (!track.simplified) largest_ = std::max(largest_, track.max_volume);
    glyph_ = std::clamp(pitch_ * 0.2, shown_tracks() > many ? 2.0 : 3.2, 5.5);
  }

  std::string svg() {
    std::string title = text(shown_tracks(), " tracks, isovalue ", graph_.isovalue);
    if (shown_tracks() < graph_.tracks.size())
      title += text(" (", graph_.tracks.size() - shown_tracks(), " more simplified",
                    shown_tracks() == most_drawn ? " or smaller)" : ")");
    std::string body = time_.grid(top_margin, bottom_);
    body += weak_links();
    body += text("<g opacity=\"", shown_tracks() > many ? 0.45 : 1.0, "\">\n");
    for (std::size_t track = 0; track < graph_.tracks.size(); ++track)
      if (is_shown(static_cast<std::int64_t>(track))) body += connections(track);
    body += "</g>\n";
    for (std::size_t track = 0; track < graph_.tracks.size(); ++track)
      if (is_shown(static_cast<std::int64_t>(track))) body += ribbon(track);
    for (std::size_t track = 0; track < graph_.tracks.size(); ++track)
      if (is_shown(static_cast<std::int64_t>(track))) body += label(track);
    body += glyphs();
    return svg_start(width, bottom_ + 84, title) + body + legend() + "</svg>\n";
  }

 private:
  bool is_shown(std::int64_t track) const { return lanes_.lane_of_track[index(track)] >= 0; }
  std::size_t shown_tracks() const {
    return static_cast<std::size_t>(std::ranges::count(graph_.tracks, false, &Track::simplified));
  }
  double y(std::int64_t track) const {
    return top_margin + pitch_ * (static_cast<double>(lanes_.lane_of_track[index(track)]) + 0.5);
  }
  double half_width(double volume) const {
    return std::max(0.7, 0.36 * pitch_ * (largest_ > 0 ? std::sqrt(volume / largest_) : 0));
  }

  // Where a track is drawn, also where it leaves its lane to meet a relative's.
  double y_at(std::int64_t id, double x) const {
    const Track& track = graph_.tracks[index(id)];
    const double start = time_.x(track.start_time), end = time_.x(track.end_time), turn = bend(track);
    if (const auto from = parent(track); from && x < start + turn)
      return height_of_curve(start, y(*from), start + turn, y(id), x);
    if (const auto into = heir(track); into && x > end - turn)
      return height_of_curve(end - turn, y(id), end, y(*into), x);
    return y(id);
  }

  // How far a ribbon leaves its lane to meet a relative's.
  double bend(const Track& track) const {
    return std::min(16.0, 0.45 * time_.pixels(track.end_time - track.start_time));
  }
  static bool comes_from_parent(const Track& track) {
    return !track.parents.empty() && (track.start_type == "split" || track.start_type == "compound");
  }
  std::optional<std::int64_t> heir(const Track& track) const {
    if (track.end_type != "merge" && track.end_type != "compound") return std::nullopt;
    for (const std::int64_t child : track.children) {
      const Track& other = graph_.tracks[index(child)];
      if (is_shown(child) && other.start_time <= track.end_time && other.end_time >= track.end_time)
        return child;
    }
    return std::nullopt;
  }
  std::optional<std::int64_t> parent(const Track& track) const {
    if (!comes_from_parent(track)) return std::nullopt;
    for (const std::int64_t other : track.parents)
      if (is_shown(other) && graph_.tracks[index(other)].start_time <= track.start_time) return other;
    return std::nullopt;
  }

  std::string curve(double x1, double y1, double x2, double y2, std::int64_t track, double stroke) const {
    const double middle = (x1 + x2) / 2;
    return text("<path d=\"M", pixel(x1), " ", pixel(y1), "C", pixel(middle), " ", pixel(y1), " ",
                pixel(middle), " ", pixel(y2), " ", pixel(x2), " ", pixel(y2), "\" fill=\"none\" stroke=\"",
                colour_of(track), "\" stroke-width=\"", pixel(stroke), "\"/>\n");
  }

  std::string connections(std::size_t number) const {
    const Track& track = graph_.tracks[number];
    const auto id = static_cast<std::int64_t>(number);
    std::string svg;
    const auto stroke = [&](bool first) {
      const auto& rows = rows_[number];
      return rows.empty() ? 1.2 : std::min(4.0, 2 * half_width((first ? rows.front() : rows.back())->volume));
    };
    if (const auto from = parent(track)) {
      const double x = time_.x(track.start_time);
      svg += curve(x, y(*from), x + bend(track), y(id), id, stroke(true));
    }
    if (const auto into = heir(track)) {
      const double x = time_.x(track.end_time);
      svg += curve(x - bend(track), y(id), x, y(*into), id, stroke(false));
    }
    return svg;
  }

  std::string ribbon(std::size_t number) const {
    const Track& track = graph_.tracks[number];
    const auto id = static_cast<std::int64_t>(number);
    const double start = time_.x(track.start_time) + (parent(track) ? bend(track) : 0);
    const double end = time_.x(track.end_time) - (heir(track) ? bend(track) : 0);
    std::vector<std::pair<double, double>> outline; // x, half width
    const auto& rows = rows_[number];
    // What is left between two bends is no wider than long.
    const double widest = parent(track) || heir(track) ? std::max(2.0, (end - start) / 2) : pitch_;
    const auto half_width = [&](double volume) { return std::min(widest, this->half_width(volume)); };
    const auto tapers = [](const std::string& type) {
      return type == "birth" || type == "death" || type == "enter" || type == "exit";
    };
    const double thin = 0.5;
    outline.emplace_back(start,
                         tapers(track.start_type) || rows.empty() ? thin : half_width(rows.front()->volume));
    for (const Feature* row : rows)
      if (const double x = time_.x(row->time); x > start && x < end)
        outline.emplace_back(x, half_width(row->volume));
    outline.emplace_back(end,
                         tapers(track.end_type) || rows.empty() ? thin : half_width(rows.back()->volume));

    std::string path;
    for (const auto& [x, half] : outline)
      path += text(path.empty() ? "M" : "L", pixel(x), " ", pixel(y(id) - half));
    for (auto point = outline.rbegin(); point != outline.rend(); ++point)
      path += text("L", pixel(point->first), " ", pixel(y(id) + point->second));
    return text("<path d=\"", path, "Z\" fill=\"", colour_of(id), "\">",
                tooltip(text("track ", id, ": ", track.start_type, " at ", track.start_time, ", ",
                             track.end_type, " at ", track.end_time, ", largest volume ", track.max_volume)),
                "</path>\n");
  }

  // On a white edge, so that it can be read where a line passes behind it.
  std::string label(std::size_t number) const {
    const Track& track = graph_.tracks[number];
    const auto id = static_cast<std::int64_t>(number);
    const double size = std::clamp(pitch_ * 0.62, 7.0, 12.0);
    const double start = time_.x(track.start_time);
    const double before = parent(track) ? start + bend(track) - 6 : start - glyph_ - 3;
    return text("<text x=\"", pixel(before), "\" y=\"", pixel(y(id) + size * 0.35), "\" font-size=\"",
                pixel(size), "\" text-anchor=\"end\" fill=\"#555\" stroke=\"#fff\" stroke-width=\"2.5\" ",
                "stroke-linejoin=\"round\" paint-order=\"stroke\">", id, "</text>\n");
  }

  // Cut links, dashed.
  std::string weak_links() const {
    std::string svg;
    for (const FeatureLink& link : graph_.links) {
      const Feature &from = graph_.features[index(link.from)], &to = graph_.features[index(link.to)];
      if (!link.weak || !is_shown(from.track) || !is_shown(to.track)) continue;
      svg += text("<line x1=\"", pixel(time_.x(from.time)), "\" y1=\"", pixel(y(from.track)), "\" x2=\"",
                  pixel(time_.x(to.time)), "\" y2=\"", pixel(y(to.track)),
                  "\" stroke=\"#999\" stroke-dasharray=\"3 3\">",
                  tooltip(text("weak: overlap ", link.overlap)), "</line>\n");
    }
    return svg;
  }

  std::string mark(EventType type, double x, double at, double size, const std::string& words) const {
    return text("<g transform=\"translate(", pixel(x), " ", pixel(at), ") scale(", pixel(size),
                ")\" fill=\"#fff\" stroke=\"#222\" stroke-width=\"", pixel(1.4 / size), "\">",
                glyph_shape(type), words.empty() ? "" : tooltip(words), "</g>\n");
  }

  // Something that happens to one track as it goes on.
  static bool is_passed(EventType type) { return type == EventType::genus || type == EventType::touch; }

  struct Mark {
    EventType type;
    double x, y;
    std::string words;
    int more = 0;
  };

  // In rows of a lane, if it is high enough: where tracks begin, end, meet and part stands in the middle,
  // what would cover it above or below. Marks of one kind that still cover each other are drawn as one.
  class MarksOnLane {
   public:
    MarksOnLane(double glyph, double pitch) : glyph_(glyph), has_rows_(pitch > 3 * row_height()) {}

    void add(Mark mark) {
      const double middle = mark.y;
      const double offsets[] = {0, -row_height(), row_height()};
      for (const double offset : std::span(offsets, has_rows_ && is_passed(mark.type) ? 3 : 1)) {
        mark.y = middle + offset;
        if (find_near(mark, 2 * glyph_, row_height() / 2, [](const Mark&) { return true; })) continue;
        marks_.emplace(mark.x, std::move(mark));
        return;
      }
      mark.y = middle;
      const auto is_same = [&](const Mark& other) { return other.type == mark.type; };
      if (Mark* same = find_near(mark, 1.6 * glyph_, 1.5 * row_height(), is_same))
        ++same->more;
      else
        marks_.emplace(mark.x, std::move(mark));
    }
    const std::multimap<double, Mark>& marks() const { return marks_; }

   private:
    double row_height() const { return 2.3 * glyph_; }
    template <class Condition>
    Mark* find_near(const Mark& mark, double along, double across, Condition&& condition) {
      for (auto other = marks_.upper_bound(mark.x - along);
           other != marks_.end() && other->first < mark.x + along; ++other)
        if (std::abs(other->second.y - mark.y) < across && condition(other->second)) return &other->second;
      return nullptr;
    }

    double glyph_;
    bool has_rows_;
    std::multimap<double, Mark> marks_; // by x
  };

  std::optional<std::int64_t> track_of(const TrackingEvent& event) const {
    if (event.simplified || *glyph_shape(event.type) == 0) return std::nullopt;
    const auto& tracks =
        event.type == EventType::split || event.tracks_out.empty() ? event.tracks_in : event.tracks_out;
    const auto shown = std::ranges::find_if(tracks, [&](std::int64_t track) { return is_shown(track); });
    if (shown == tracks.end()) return std::nullopt;
    return *shown;
  }

  Mark mark_of(const TrackingEvent& event, std::int64_t track) const {
    const double x = time_.x(event.time);
    return {event.type, x, is_passed(event.type) ? y_at(track, x) : y(track),
            text(name_of(event.type), " at ", event.time, ", position ", joined(event.position, ", "),
                 "; in ", joined(event.tracks_in, " "), "; out ", joined(event.tracks_out, " "))};
  }

  std::string glyphs() {
    std::map<std::int64_t, MarksOnLane> lanes;
    for (const bool passed : {false, true})
      for (const TrackingEvent& event : graph_.events) {
        const auto track = track_of(event);
        if (!track || is_passed(event.type) != passed) continue;
        types_.insert(event.type);
        MarksOnLane& lane =
            lanes.try_emplace(lanes_.lane_of_track[index(*track)], glyph_, pitch_).first->second;
        lane.add(mark_of(event, *track));
      }
    std::string svg;
    for (const auto& [number, lane] : lanes)
      for (const auto& [x, drawn] : lane.marks())
        svg += mark(drawn.type, drawn.x, drawn.y, glyph_,
                    drawn.more == 0 ? drawn.words : text(drawn.words, "; and ", drawn.more, " more"));
    return svg;
  }

  std::string legend() const {
    double x = left_margin;
    const double at = bottom_ + 62;
    std::string svg;
    for (const EventType type : types_) {
      svg += mark(type, x, at, 5.5, "");
      svg += text("<text x=\"", pixel(x + 10), "\" y=\"", pixel(at + 4), "\">", name_of(type), "</text>\n");
      x += 34 + 7.0 * static_cast<double>(std::string_view(name_of(type)).size());
    }
    return svg + text("<text x=\"", pixel(width - right_margin), "\" y=\"", pixel(at + 4),
                      "\" text-anchor=\"end\" fill=\"#666\">width: square root of volume</text>\n");
  }

  const TrackingGraph& graph_;
  TimeScale time_;
  track_detail::Lanes lanes_;
  std::vector<std::vector<const Feature*>> rows_; // of each track
  std::set<EventType> types_;                     // that were drawn
  double pitch_ = 0, bottom_ = 0, glyph_ = 0, largest_ = 0;
};

} // namespace

std::string graph_svg(const TrackingGraph& graph) {
  const auto largest = with_largest_alone(graph);
  return GraphPicture(largest ? *largest : graph).svg();
}

} // namespace hyperiso
