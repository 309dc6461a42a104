#include "hyperiso/view.hpp"

#include "core/text.hpp"
#include "hyperiso/track_files.hpp"
#include "io/atomic_file.hpp"
#include "io/encoding.hpp"
#include "view/payload.hpp"
#include "view/shell.hpp"
#include "view/track_labels.hpp"

#include <nlohmann/json.hpp>
#include <zlib.h>

#include <algorithm>
#include <limits>
#include <new>
#include <utility>

namespace hyperiso {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::size_t most_vertices = std::size_t{1} << 24;  // the payload's vertex codes have 24 bits
constexpr std::size_t most_simplices = std::size_t{1} << 25; // a texture of 2048 x 16384

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

// The axes of the mesh, with ranges for those that have none.
struct Ranges {
  std::vector<Axis> axes;
  std::vector<double> minimum, maximum;
};

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
  return ranges;
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

// The summary that files hold too, and of each track its volume at the steps.
Json tracking_json(const TrackingGraph& graph) {
  Json json = Json::parse(tracking_summary_json(graph));
  for (Json& track : json["tracks"]) track["volumes"] = Json::array();
  for (const Feature& feature : graph.features)
    if (feature.track >= 0)
      json["tracks"][static_cast<std::size_t>(feature.track)]["volumes"].push_back(
          {feature.time, feature.volume});
  return json;
}

Json metadata(const Mesh& mesh, const PageOptions& options, const Ranges& ranges, const Payload& payload,
              const std::vector<EncodedAttribute>& attributes) {
  Json blocks = Json::array();
  for (const Payload::Block& block : payload.blocks())
    blocks.push_back({{"vertices", block.vertices}, {"simplices", block.simplices}});
  Json json = {{"format", 1},
               {"title", options.title},
               {"field", options.field_name},
               {"dimension", mesh.dimension},
               {"simplexDimension", mesh.simplex_dimension},
               {"time", options.has_time},
               {"axes", axes_json(ranges, payload.quantisers())},
               {"vertices", payload.vertex_count()},
               {"simplices", mesh.simplex_count()},
               {"attributes", attributes_json(attributes)},
               {"colourBy", options.colour_by},
               {"notes", options.notes},
               {"blocks", std::move(blocks)}};
  if (options.isovalue) json["isovalue"] = *options.isovalue;
  if (options.tracking) json["tracking"] = tracking_json(*options.tracking);
  return json;
}

// Writes to a file, but not past a size.
class LimitedFile {
 public:
  LimitedFile(AtomicFile& file, std::uint64_t limit) : file_(file), left_(limit) {}
  bool write(std::string_view text) {
    if (text.size() > left_) return false;
    left_ -= text.size();
    file_.write(text);
    return true;
  }

 private:
  AtomicFile& file_;
  std::uint64_t left_;
};

Error too_large(const Mesh& mesh, const PageOptions& options) {
  return {Code::invalid_argument,
          text("a page of ", mesh.simplex_count(), " simplices would be larger than ",
               byte_size(options.size_limit), "; fewer samples, fewer steps or a higher limit would do")};
}

// The data of the page: the metadata and then the blocks, each an element of its own, so that the page can
// say how far it has been read.
Status write_data(const Mesh& mesh, const PageOptions& options, LimitedFile& file) {
  const Ranges ranges = ranges_of(mesh, options);
  std::vector<Quantiser> quantisers;
  for (std::size_t k = 0; k < ranges.axes.size(); ++k)
    quantisers.push_back(quantiser_of(ranges.axes[k], ranges.minimum[k], ranges.maximum[k]));
  const bool time_slabs = options.has_time && mesh.dimension == 4;
  const Payload payload(mesh, std::move(quantisers), time_slabs);
  std::vector<EncodedAttribute> attributes = encode_attributes(mesh);
  if (options.tracking)
    attributes.push_back(encode_labels("track", tracks_of_vertices(mesh, *options.tracking)));

  const std::string json = script_text(metadata(mesh, options, ranges, payload, attributes));
  bool fits = file.write("<script type=\"application/json\" id=\"hyperiso-metadata\">") && file.write(json) &&
              file.write("</script>\n");
  std::size_t done = 0;
  for (const Payload::Block& block : payload.blocks()) {
    if (!fits) return too_large(mesh, options);
    if (options.progress &&
        !options.progress(static_cast<double>(done++) / static_cast<double>(payload.blocks().size())))
      return Error{Code::cancelled, "cancelled while the page was written"};
    Base64Encoder encoder;
    std::string digits;
    encoder.append(payload.encode(block, attributes), digits);
    encoder.finish(digits);
    fits = file.write("<script type=\"text/plain\" class=\"hyperiso-block\">") && file.write(digits) &&
           file.write("</script>\n");
  }
  return fits ? Status{} : too_large(mesh, options);
}

Status write_page_to(const Mesh& mesh, const PageOptions& options, const std::filesystem::path& path) {
  const std::string shell = inflated_shell();
  constexpr std::string_view title_marker = "<!--hyperiso:title-->", data_marker = "<!--hyperiso:data-->";
  const std::size_t title = shell.find(title_marker), data = shell.find(data_marker);
  if (title == std::string::npos || data == std::string::npos)
    return Error{Code::internal, "the viewer in this build of hyperiso has no place for data"};

  Result<AtomicFile> file = AtomicFile::create(path);
  if (!file) return file.error();
  LimitedFile limited(*file, options.size_limit);
  const std::string_view view = shell;
  const std::size_t after_title = title + title_marker.size();
  const bool fits = limited.write(view.substr(0, title)) &&
                    limited.write(html_text(options.title.empty() ? "Isosurface" : options.title)) &&
                    limited.write(view.substr(after_title, data - after_title));
  if (!fits) return too_large(mesh, options);
  if (Status status = write_data(mesh, options, limited); !status) return status;
  if (!limited.write(view.substr(data + data_marker.size()))) return too_large(mesh, options);
  return file->commit();
}

} // namespace

bool has_viewer() { return !compressed_shell().empty(); }

Status write_page(const Mesh& mesh, const PageOptions& options, const std::filesystem::path& path) {
  if (!has_viewer())
    return Error{Code::file_unsupported,
                 "this build of hyperiso has no viewer; configure it with -D HYPERISO_WITH_VIEWER=ON"};
  const bool shown =
      mesh.simplex_dimension == mesh.dimension - 1 && (mesh.dimension == 3 || mesh.dimension == 4);
  if (!shown)
    return Error{Code::file_unsupported,
                 text("a page shows triangles in R^3 or tetrahedra in R^4, not simplices of dimension ",
                      mesh.simplex_dimension, " in R^", mesh.dimension)};
  if (mesh.simplex_count() > most_simplices || mesh.vertex_count() > most_vertices)
    return Error{Code::out_of_memory,
                 text("a page holds up to ", most_simplices, " simplices and ", most_vertices,
                      " vertices, not ", mesh.simplex_count(), " and ", mesh.vertex_count())};
  try {
    return write_page_to(mesh, options, path);
  } catch (const std::bad_alloc&) {
    return Error{Code::out_of_memory, "not enough memory to write the page"};
  }
}

} // namespace hyperiso
