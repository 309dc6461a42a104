#include "view/page_parts.hpp"

#include "core/affine.hpp"
#include "core/text.hpp"
#include "hyperiso/track_files.hpp"
#include "io/encoding.hpp"
#include "view/shell.hpp"
#include "view/world_axis.hpp"

#include <zlib.h>

#include <algorithm>
#include <new>
#include <utility>

namespace hyperiso {
namespace {

// Text inside an element: the page has no other place for names.
std::string html_text(const std::string& text) {
  std::string result;
  for (const char character : text) {
    if (character == '&')
      result += "&amp;";
    else if (character == '<')
      result += "&lt;";
    else
      result += character;
  }
  return result;
}

// JSON inside a <script>: no `<` that could end it. Names that are not UTF-8 are shown as far as they are.
std::string script_text(const Json& json) {
  const std::string text = json.dump(-1, ' ', false, Json::error_handler_t::replace);
  std::string result;
  for (const char character : text) {
    if (character == '<')
      result += "\\u003c";
    else
      result += character;
  }
  return result;
}

std::string inflated_shell() {
  const std::span<const unsigned char> compressed = compressed_shell();
  z_stream stream{};
  if (inflateInit(&stream) != Z_OK) throw std::bad_alloc();
  stream.next_in = const_cast<unsigned char*>(compressed.data());
  stream.avail_in = static_cast<uInt>(compressed.size());
  std::string shell;
  char piece[16384];
  int status = Z_OK;
  while (status == Z_OK) {
    stream.next_out = reinterpret_cast<unsigned char*>(piece);
    stream.avail_out = sizeof piece;
    status = inflate(&stream, Z_NO_FLUSH);
    shell.append(piece, sizeof piece - stream.avail_out);
  }
  inflateEnd(&stream);
  return shell;
}

Json axes_json(const Ranges& ranges, const std::vector<Quantiser>& quantisers) {
  Json axes = Json::array();
  for (std::size_t k = 0; k < quantisers.size(); ++k) {
    const Axis& axis = ranges.axes[k];
    Json json = {{"name", axis.name},
                 {"unit", axis.unit},
                 {"samples", axis.count},
                 {"minimum", ranges.minimum[k]},
                 {"maximum", ranges.maximum[k]},
                 {"origin", quantisers[k].origin},
                 {"scale", quantisers[k].scale}};
    if (!axis.coordinates.empty()) json["coordinates"] = axis.coordinates;
    axes.push_back(std::move(json));
  }
  return axes;
}

Json attributes_json(const std::vector<EncodedAttribute>& attributes) {
  Json result = Json::array();
  for (const EncodedAttribute& attribute : attributes) {
    Json json = {{"name", attribute.name}, {"kind", attribute.is_label ? "label" : "scalar"}};
    if (attribute.is_label)
      json["labels"] = attribute.labels;
    else
      json.update({{"minimum", attribute.minimum}, {"maximum", attribute.maximum}});
    result.push_back(std::move(json));
  }
  return result;
}

// A place in the space of a step.
std::vector<double> moved(const std::vector<double>& position, double time, const Affine& world) {
  std::vector<double> point = position;
  point.resize(world.offset.size(), time);
  std::vector<double> image(position.size());
  for (std::size_t row = 0; row < image.size(); ++row) {
    image[row] = world.offset[row];
    for (std::size_t column = 0; column < point.size(); ++column)
      image[row] += world.linear[row * point.size() + column] * point[column];
  }
  return image;
}

// Times and places from grid to world coordinates; times where they depend on nothing else.
void move_tracking(const Affine& world, Json& tracking) {
  const std::size_t time = world.offset.size() - 1;
  const bool alone = stands_alone(world, time);
  const double scale = world.linear.back(), offset = world.offset.back();
  const auto move_time = [&](Json& number) {
    if (alone) number = offset + scale * number.get<double>();
  };
  for (Json& event : tracking["events"]) {
    event["position"] =
        moved(event["position"].get<std::vector<double>>(), event["time"].get<double>(), world);
    move_time(event["time"]);
  }
  for (Json& track : tracking["tracks"]) {
    move_time(track["start_time"]);
    move_time(track["end_time"]);
    for (Json& volume : track["volumes"]) move_time(volume[0]);
  }
}

// The summary that files hold too, and of each track its volume at the steps.
Json tracking_json(const TrackingGraph& graph, const std::optional<Affine>& world) {
  Json json = Json::parse(tracking_summary_json(graph));
  json["regions"] = graph.tracked == Tracked::region;
  for (Json& track : json["tracks"]) track["volumes"] = Json::array();
  for (const Feature& feature : graph.features)
    if (feature.track >= 0)
      json["tracks"][static_cast<std::size_t>(feature.track)]["volumes"].push_back(
          {feature.time, feature.volume});
  if (world) move_tracking(*world, json);
  return json;
}

} // namespace

Status check_size(std::uint64_t simplices, std::uint64_t vertices) {
  if (simplices <= most_simplices && vertices <= most_vertices) return {};
  return Error{Code::out_of_memory, text("a page holds up to ", most_simplices, " simplices and ",
                                         most_vertices, " vertices, not ", simplices, " and ", vertices)};
}

std::vector<Quantiser> Ranges::quantisers() const {
  std::vector<Quantiser> result;
  for (std::size_t k = 0; k < axes.size(); ++k)
    result.push_back(quantiser_of(axes[k], minimum[k], maximum[k]));
  return result;
}

namespace {

Ranges in_world(Ranges grid, const Affine& world) {
  const std::size_t D = grid.axes.size();
  Ranges ranges = grid;
  for (std::size_t row = 0; row < D; ++row) {
    ranges.axes[row] = world_axis(grid.axes[row], world, row);
    ranges.minimum[row] = ranges.maximum[row] = world.offset[row];
    for (std::size_t column = 0; column < D; ++column) {
      const double low = world.linear[row * D + column] * grid.minimum[column],
                   high = world.linear[row * D + column] * grid.maximum[column];
      ranges.minimum[row] += std::min(low, high);
      ranges.maximum[row] += std::max(low, high);
    }
  }
  return ranges;
}

} // namespace

Ranges ranges_of(const Mesh& mesh, const PageOptions& options) {
  const auto dimension = static_cast<std::size_t>(mesh.dimension);
  Ranges ranges{options.axes, std::vector<double>(dimension, std::numeric_limits<double>::infinity()), {}};
  ranges.axes.resize(dimension);
  ranges.maximum.assign(dimension, -std::numeric_limits<double>::infinity());
  mesh.positions.visit([&](auto positions) {
    for (std::size_t i = 0; i < positions.size(); ++i) {
      ranges.minimum[i % dimension] = std::min<double>(ranges.minimum[i % dimension], positions[i]);
      ranges.maximum[i % dimension] = std::max<double>(ranges.maximum[i % dimension], positions[i]);
    }
  });
  const char* const names[] = {"x", "y", "z", "t"};
  for (std::size_t k = 0; k < dimension; ++k) {
    Axis& axis = ranges.axes[k];
    if (axis.name.empty()) axis.name = options.has_time && k + 1 == dimension ? "t" : names[k];
    if (axis.count >= 2) {
      ranges.minimum[k] = std::min(axis.coordinate(0), axis.coordinate(axis.count - 1));
      ranges.maximum[k] = std::max(axis.coordinate(0), axis.coordinate(axis.count - 1));
    } else if (mesh.vertex_count() == 0) {
      ranges.minimum[k] = 0;
      ranges.maximum[k] = 1;
    }
  }
  return options.world ? in_world(std::move(ranges), *options.world) : ranges;
}

Result<Json> metadata_of(int dimension, int simplex_dimension, const PageOptions& options,
                         const Ranges& ranges, const std::vector<Quantiser>& quantisers,
                         const std::vector<EncodedAttribute>& attributes) {
  std::vector<std::string> colourings{"solid", "component"};
  if (options.has_time) colourings.push_back("time");
  if (options.has_time && dimension == 4) colourings.push_back("speed");
  for (const EncodedAttribute& attribute : attributes) colourings.push_back(attribute.name);
  for (const Axis& axis : ranges.axes) colourings.push_back(axis.name);
  if (!options.colour_by.empty() && std::ranges::find(colourings, options.colour_by) == colourings.end()) {
    std::string known;
    for (const std::string& name : colourings) known += (known.empty() ? "" : ", ") + name;
    return Error{Code::invalid_argument,
                 text("the page has no '", options.colour_by, "' to colour by; there are ", known)};
  }
  Json json = {{"format", 1},
               {"title", options.title},
               {"field", options.field_name},
               {"part", options.part},
               {"dimension", dimension},
               {"simplexDimension", simplex_dimension},
               {"time", options.has_time},
               {"axes", axes_json(ranges, quantisers)},
               {"attributes", attributes_json(attributes)},
               {"colourBy", options.colour_by},
               {"notes", options.notes}};
  if (options.isovalue) json["isovalue"] = *options.isovalue;
  if (options.tracking) json["tracking"] = tracking_json(*options.tracking, options.world);
  return json;
}

Result<PageFile> PageFile::create(const PageOptions& options, const std::filesystem::path& path) {
  std::string shell = inflated_shell();
  constexpr std::string_view title_marker = "<!--hyperiso:title-->", data_marker = "<!--hyperiso:data-->";
  const std::size_t title = shell.find(title_marker), data = shell.find(data_marker);
  if (title == std::string::npos || data == std::string::npos)
    return Error{Code::internal, "the viewer in this build of hyperiso has no place for data"};
  Result<AtomicFile> file = AtomicFile::create(path);
  if (!file) return file.error();
  PageFile page(std::move(*file), std::move(shell), data + data_marker.size(), options.size_limit);
  const std::string_view view = page.shell_;
  const std::size_t after_title = title + title_marker.size();
  page.write(view.substr(0, title));
  page.write(html_text(options.title.empty() ? "Isosurface" : options.title));
  page.write(view.substr(after_title, data - after_title));
  return page;
}

bool PageFile::write(std::string_view piece) {
  if (piece.size() > left_) return left_ = 0, false;
  left_ -= piece.size();
  file_.write(piece);
  return true;
}

bool PageFile::write_metadata(const Json& metadata) {
  return write("<script type=\"application/json\" id=\"hyperiso-metadata\">") &&
         write(script_text(metadata)) && write("</script>\n");
}

bool PageFile::write_block(std::span<const unsigned char> compressed) {
  Base64Encoder encoder;
  std::string digits;
  encoder.append(compressed, digits);
  encoder.finish(digits);
  return write("<script type=\"text/plain\" class=\"hyperiso-block\">") && write(digits) &&
         write("</script>\n");
}

Status PageFile::finish() {
  if (!write(std::string_view(shell_).substr(data_end_))) return too_large("this surface");
  return file_.commit();
}

Error PageFile::too_large(std::string_view what) const {
  if (shell_.size() > limit_)
    return {Code::invalid_argument,
            text("the viewer alone takes ", byte_size(shell_.size()), ", the limit is ", byte_size(limit_))};
  return {Code::invalid_argument, text("a page of ", what, " would be larger than ", byte_size(limit_),
                                       "; fewer samples, fewer steps or a higher limit would do")};
}

} // namespace hyperiso
