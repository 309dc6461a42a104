#include "cli/movie.hpp"

#include "cli/failure.hpp"
#include "cli/parse.hpp"
#include "core/text.hpp"
#include "hyperiso/glb.hpp"
#include "hyperiso/render.hpp"
#include "mesh/attributes.hpp"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fmt/format.h>

namespace hyperiso::cli {
namespace {

constexpr const char* group = "Output";

std::string suffix_of(const std::string& path) { return std::filesystem::path(path).extension().string(); }

// Makes the coordinate along the axis of space called `name` an attribute, unless there is one of that name;
// fails if there is neither.
void add_coordinate(Mesh& frame, const std::string& name, const std::vector<Axis>& axes) {
  if (vertex_attribute(frame, name)) return;
  const auto D = static_cast<std::size_t>(frame.dimension);
  for (std::size_t axis = 0; axis < D; ++axis) {
    if (axes[axis].name != name) continue;
    std::vector<double> values;
    for (std::size_t vertex = 0; vertex < frame.vertex_count(); ++vertex)
      values.push_back(frame.positions[vertex * D + axis]);
    frame.attributes.push_back({name, Attribute::Location::vertex, 1, std::move(values)});
    return;
  }
  if (name_of_axis(axes, D) == name) fail_usage(text("--colour-by: ", name, " is the same all over a frame"));
  std::string names;
  for (const Attribute& attribute : frame.attributes)
    if (attribute.location == Attribute::Location::vertex) names += attribute.name + ", ";
  for (std::size_t axis = 0; axis < D; ++axis) names += (axis == 0 ? "" : ", ") + name_of_axis(axes, axis);
  fail_usage(text("--colour-by: the vertices have no data '", name, "'; there are ", names));
}

std::string with_unit(const std::string& name, const std::string& unit) {
  return unit.empty() ? name : name + " [" + unit + "]";
}

// As few decimals, for all frames, as leave each time within a twentieth of the shortest step.
int decimals_of(const std::vector<double>& times) {
  constexpr int most = 9;
  double tolerance = 1e-6 * std::max(std::abs(times.front()), std::abs(times.back()));
  for (std::size_t i = 1; i < times.size(); ++i)
    tolerance = i == 1 ? (times[1] - times[0]) / 20 : std::min(tolerance, (times[i] - times[i - 1]) / 20);
  for (int decimals = 0; decimals < most; ++decimals) {
    const double unit = std::pow(10, decimals);
    if (std::ranges::all_of(
            times, [&](double time) { return std::abs(std::round(time * unit) / unit - time) <= tolerance; }))
      return decimals;
  }
  return most;
}

// "t = 0.25 s" for each frame.
std::vector<std::string> labels_of(const Series& series) {
  const int decimals = decimals_of(series.times);
  const Axis& time = series.axes.back();
  std::vector<std::string> labels;
  for (const double moment : series.times)
    labels.push_back(fmt::format("{} = {:.{}f}{}", time.name.empty() ? "t" : time.name, moment, decimals,
                                 time.unit.empty() ? "" : " " + time.unit));
  return labels;
}

// A .pvd and a .vtp for each frame, or numbered files.
class FileMovie final : public Movie {
 public:
  FileMovie(const MovieOptions& options, const Series& series, bool has_index)
      : options_(options), series_(series), has_index_(has_index) {}

  void add(Mesh frame, std::optional<Mesh> /*end*/, std::size_t number) override {
    const std::string path =
        has_index_ ? with_suffix(std::filesystem::path(options_.path).replace_extension("vtp").string(),
                                 fmt::format("{:04}", number))
                   : with_number("-o", options_.path, number);
    if (!options_.colour_by().empty()) colour(frame, options_.colour_by(), series_.axes, series_.range);
    WriteMeshOptions writing;
    for (std::size_t axis = 0; axis + 1 < series_.axes.size(); ++axis)
      writing.axis_names.push_back(name_of_axis(series_.axes, axis));
    writing.group = &files_;
    take(write_mesh(frame, path, writing));
    entries_.push_back({series_.times[number], std::filesystem::path(path).filename()});
  }
  void finish() override {
    if (has_index_) take(write_series(entries_, options_.path, &files_));
    take(files_.commit());
  }

 private:
  const MovieOptions& options_;
  const Series& series_;
  bool has_index_;
  FileGroup files_;
  std::vector<SeriesEntry> entries_;
};

class GltfMovie final : public Movie {
 public:
  GltfMovie(const MovieOptions& options, const Series& series, const GlbOptions& how)
      : options_(options), series_(series), movie_(how), frames_per_second_(how.frames_per_second) {}

  void add(Mesh frame, std::optional<Mesh> end, std::size_t number) override {
    if (!options_.colour_by().empty()) colour(frame, options_.colour_by(), series_.axes, series_.range);
    take(movie_.add(frame, series_.times[number], seconds_at(number), end ? &*end : nullptr));
  }
  void finish() override { take(movie_.write(options_.path)); }

 private:
  // As long as all frames take, in proportion to the time between them.
  double seconds_at(std::size_t number) const {
    const auto last = static_cast<double>(series_.times.size() - 1);
    if (last == 0) return 0;
    const double first = series_.times.front(), whole = series_.times.back() - first;
    return (series_.times[number] - first) / whole * last / frames_per_second_;
  }

  const MovieOptions& options_;
  const Series& series_;
  GlbMovie movie_;
  double frames_per_second_;
};

// Pictures, numbered or in a film.
class DrawnMovie final : public Movie {
 public:
  DrawnMovie(const MovieOptions& options, const Series& series, RenderOptions drawing,
             std::optional<FilmWriter> film)
      : options_(options), series_(series), drawing_(std::move(drawing)), labels_(labels_of(series)),
        film_(std::move(film)) {}

  void add(Mesh frame, std::optional<Mesh> /*end*/, std::size_t number) override {
    if (!options_.colour_by().empty()) colour(frame, options_.colour_by(), series_.axes, series_.range);
    const Image image = take(render(frame, labels_[number], drawing_));
    if (film_)
      take(film_->add(image));
    else
      take(write_png(image, with_number("-o", options_.path, number), &files_));
  }
  void finish() override { film_ ? take(film_->finish()) : take(files_.commit()); }

 private:
  const MovieOptions& options_;
  const Series& series_;
  RenderOptions drawing_;
  std::vector<std::string> labels_;
  std::optional<FilmWriter> film_;
  FileGroup files_;
};

} // namespace

void colour(Mesh& frame, const std::string& name, const std::vector<Axis>& axes,
            const std::optional<ColourRange>& range) {
  add_coordinate(frame, name, axes);
  take(colour_vertices(frame, name, range));
}

void Series::look_at(Mesh frame, const MovieOptions& options) {
  const auto D = static_cast<std::size_t>(frame.dimension);
  low.resize(D, HUGE_VAL);
  high.resize(D, -HUGE_VAL);
  for (std::size_t place = 0; place < frame.positions.size(); ++place) {
    low[place % D] = std::min(low[place % D], frame.positions[place]);
    high[place % D] = std::max(high[place % D], frame.positions[place]);
  }
  if (options.colour_by().empty() || options.has_colour_range() || frame.vertex_count() == 0) return;
  add_coordinate(frame, options.colour_by(), axes);
  const ColourRange found = take(colour_vertices(frame, options.colour_by()));
  range = range ? ColourRange{std::min(range->low, found.low), std::max(range->high, found.high)} : found;
}

void MovieOptions::add_to(CLI::App& app, const PointDataOptions& data) {
  data_ = &data;
  app.add_option("-o,--output", path, "the film, the .glb, the .pvd, or the pattern of numbered files")
      ->type_name("PATH")
      ->required()
      ->group(group);
  app.add_option("--fps", fps, "films and .glb: frames per second")
      ->type_name("N")
      ->default_str("10")
      ->group(group);
  app.add_option("--size", size, "films and pictures: pixels; both even in .mp4")
      ->type_name("WxH")
      ->default_str("960x720")
      ->group(group);
  app.add_option(
         "--view", view,
         "films and pictures: where the camera is, in degrees: around the last axis of space from the "
         "first one on, and above the plane of the others. It stays, and all frames fit")
      ->type_name("AZIMUTH,ELEVATION")
      ->default_str("-60,25")
      ->group(group);
  app.add_flag("--quantise,--quantize", quantised,
               ".glb: positions in 65536 steps, 32768 with --morph: half the size (KHR_mesh_quantization)")
      ->group(group);
  app.add_flag(
         "--morph", morphs,
         ".glb: each frame moves on until the next one is shown, by a morph target: its vertices slide "
         "along the edges of the surface in space and time, to the end of the edge at most. At least twice "
         "the size")
      ->group(group);
}

MovieOptions::Kind MovieOptions::kind() const {
  const std::string suffix = suffix_of(path);
  if (has_number_pattern(path)) return suffix == ".png" ? Kind::pictures : Kind::numbered;
  if (suffix == ".pvd") return Kind::series;
  if (suffix == ".glb") return Kind::glb;
  if (suffix == ".mp4" || suffix == ".gif") return Kind::film;
  const bool single = suffix == ".png" || is_mesh_file(path);
  fail_usage(single ? text(path, ": one file for many frames; number them: ",
                           std::filesystem::path(path).stem().string(), "_%04d", suffix)
                    : text(path, ": an animation is .mp4, .gif, .glb, .pvd, or numbered files such as "
                                 "f_%04d.ply and f_%04d.png"));
}

bool MovieOptions::is_drawn() const { return kind() == Kind::film || kind() == Kind::pictures; }
bool MovieOptions::is_shaded() const { return is_drawn() || kind() == Kind::glb; }
bool MovieOptions::has_colour_range() const { return data_->range().has_value(); }
bool MovieOptions::needs_survey() const {
  return is_drawn() || (!colour_by().empty() && !has_colour_range());
}

double MovieOptions::frames_per_second() const {
  const double number = fps.empty() ? 10 : parse_number("--fps", fps);
  if (!(number > 0) || number > 1000) fail_usage(text("--fps: ", number, " is not above 0 and up to 1000"));
  return number;
}

std::pair<int, int> MovieOptions::pixels() const {
  if (size.empty()) return {960, 720};
  const auto parts = split(size, 'x');
  if (parts.size() != 2) fail_usage(text("--size: '", size, "' is not WIDTHxHEIGHT, such as 960x720"));
  const std::int64_t width = parse_integer("--size", parts[0]), height = parse_integer("--size", parts[1]);
  for (const std::int64_t number : {width, height})
    if (number < 64 || number > 8192) fail_usage(text("--size: ", number, " pixels are not from 64 to 8192"));
  if (suffix_of(path) == ".mp4" && (width % 2 != 0 || height % 2 != 0))
    fail_usage(text("--size: ", size, " has an odd number, and .mp4 takes even ones: ", width + width % 2,
                    "x", height + height % 2));
  return {static_cast<int>(width), static_cast<int>(height)};
}

std::pair<double, double> MovieOptions::direction() const {
  if (view.empty()) return {-60, 25};
  const std::vector<double> angles = parse_numbers("--view", view);
  if (angles.size() != 2) fail_usage(text("--view: '", view, "' is not AZIMUTH,ELEVATION, such as -60,25"));
  if (std::abs(angles[1]) > 90)
    fail_usage(text("--view: the elevation ", angles[1], " is not from -90 to 90"));
  return {angles[0], angles[1]};
}

void MovieOptions::check() const {
  const Kind to = kind();
  if (has_number_pattern(path)) (void)with_number("-o", path, 0);
  if (is_drawn()) take(check_rendering());
  (void)frames_per_second();
  (void)pixels();
  (void)direction();
  const auto only = [&](bool given, bool fits, const char* option, const char* where) {
    if (given && !fits) fail_usage(text(option, ": only for ", where, ", not for ", suffix_of(path)));
  };
  only(!fps.empty(), to == Kind::film || to == Kind::glb, "--fps", "films and .glb");
  only(!size.empty(), is_drawn(), "--size", "films and pictures");
  only(!view.empty(), is_drawn(), "--view", "films and pictures");
  only(quantised, to == Kind::glb, "--quantise", ".glb");
  only(morphs, to == Kind::glb, "--morph", ".glb");
  if (!data_->colour_range.empty() && colour_by().empty())
    fail_usage("--colour-range: there is no --colour-by");
  (void)data_->range();
  const bool coloured = is_drawn() || to == Kind::glb || suffix_of(path) == ".ply";
  only(!colour_by().empty(), coloured, "--colour-by", "films, pictures, .glb and .ply");
}

void MovieOptions::check_frames(int dimension) const {
  if (is_drawn()) {
    if (kind() == Kind::film) (void)take(FilmWriter::create(path, 64, 64, 10)); // whether it can be written
    return;
  }
  if (kind() == Kind::glb) return;
  take(check_mesh_format(dimension, dimension - 1, kind() == Kind::series ? "f.vtp" : path));
}

std::unique_ptr<Movie> MovieOptions::open(Series& series) const {
  if (has_colour_range()) series.range = data_->range();
  const Kind to = kind();
  const Axis& time = series.axes.back();
  if (to == Kind::glb) {
    GlbOptions how;
    how.frames_per_second = frames_per_second();
    how.quantised = quantised;
    how.space_unit = series.axes.front().unit;
    how.time_unit = time.unit;
    return std::make_unique<GltfMovie>(*this, series, how);
  }
  if (!is_drawn()) return std::make_unique<FileMovie>(*this, series, to == Kind::series);

  RenderOptions drawing;
  std::tie(drawing.width, drawing.height) = pixels();
  std::tie(drawing.azimuth, drawing.elevation) = direction();
  const bool empty = series.low.empty() || !(series.low[0] <= series.high[0]);
  drawing.low = empty ? std::vector<double>(series.axes.size() - 1, 0) : series.low;
  drawing.high = empty ? std::vector<double>(series.axes.size() - 1, 1) : series.high;
  for (std::size_t axis = 0; axis + 1 < series.axes.size(); ++axis)
    drawing.axis_names.push_back(with_unit(name_of_axis(series.axes, axis), series.axes[axis].unit));
  if (series.isovalue) drawing.title = fmt::format("isovalue {:.6g}", *series.isovalue);
  if (!colour_by().empty() && series.range) drawing.colour_bar = {colour_by(), *series.range};
  drawing.threads = series.threads;
  std::optional<FilmWriter> film;
  if (to == Kind::film)
    film.emplace(take(FilmWriter::create(path, drawing.width, drawing.height, frames_per_second())));
  return std::make_unique<DrawnMovie>(*this, series, std::move(drawing), std::move(film));
}

} // namespace hyperiso::cli
