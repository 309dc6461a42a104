// glTF 2.0, Khronos Group, in its binary form: a header, a chunk of JSON that describes, a chunk of numbers.

#include "hyperiso/glb.hpp"

#include "core/text.hpp"
#include "hyperiso/colours.hpp"
#include "io/atomic_file.hpp"
#include "mesh/attributes.hpp"
#include "mesh/normals.hpp"

#include <algorithm>
#include <array>
#include <climits>
#include <cmath>
#include <cstring>
#include <functional>
#include <map>
#include <new>
#include <nlohmann/json.hpp>
#include <optional>

namespace hyperiso {

using Json = nlohmann::ordered_json;

struct GlbMovie::Frame {
  struct Part { // the triangles or segments of one material
    std::int64_t track = -1;
    std::vector<std::uint32_t> corners;
  };
  double time = 0;
  float seconds = 0;
  int corners_per_simplex = 3;
  std::vector<float> positions, normals;         // three numbers for each vertex, or none
  std::vector<float> end_positions, end_normals; // where it moves; none: it does not
  std::vector<std::uint16_t> colours;            // four, of linear light
  std::vector<Part> parts;
};

namespace {

constexpr int mode_lines = 1, mode_triangles = 4;
constexpr int type_byte = 5120, type_i16 = 5122, type_u16 = 5123, type_u32 = 5125, type_float = 5126;
constexpr int target_vertices = 34962, target_corners = 34963;

// Positions in R^2 get z = 0.
std::vector<float> in_space(const Mesh& mesh) {
  const auto D = static_cast<std::size_t>(mesh.dimension);
  std::vector<float> numbers(3 * mesh.vertex_count());
  for (std::size_t vertex = 0; vertex < mesh.vertex_count(); ++vertex)
    for (std::size_t k = 0; k < D; ++k)
      numbers[3 * vertex + k] = static_cast<float>(mesh.positions[vertex * D + k]);
  return numbers;
}

// For triangles without extent at the start or at the end.
Mesh halfway(const Mesh& start, const Mesh& end) {
  Mesh mesh = start;
  for (std::size_t place = 0; place < mesh.positions.size(); ++place)
    mesh.positions.set(place, (start.positions[place] + end.positions[place]) / 2);
  return mesh;
}

// glTF's colours are linear, ours sRGB.
std::uint16_t linear(double srgb) {
  const double share = std::clamp(srgb / 255, 0.0, 1.0);
  const double light = share <= 0.04045 ? share / 12.92 : std::pow((share + 0.055) / 1.055, 2.4);
  return static_cast<std::uint16_t>(std::lround(light * 65535));
}

std::vector<std::uint16_t> colours_of(const Mesh& mesh) {
  const auto channels = vertex_colours(mesh);
  if (!channels) return {};
  std::vector<std::uint16_t> colours;
  colours.reserve(4 * mesh.vertex_count());
  for (std::size_t vertex = 0; vertex < mesh.vertex_count(); ++vertex) {
    for (const Attribute* channel : *channels) colours.push_back(linear(value_of(*channel, vertex)));
    colours.push_back(65535);
  }
  return colours;
}

} // namespace

GlbMovie::GlbMovie(GlbOptions options) : options_(std::move(options)) {}
GlbMovie::GlbMovie(GlbMovie&&) noexcept = default;
GlbMovie::~GlbMovie() = default;

Status GlbMovie::add(const Mesh& mesh, double time, double seconds, const Mesh* end) {
  const bool triangles = mesh.dimension == 3 && mesh.simplex_dimension == 2;
  if (!triangles && !(mesh.simplex_dimension == 1 && (mesh.dimension == 2 || mesh.dimension == 3)))
    return Error{
        Code::invalid_argument,
        text("a frame of a .glb is made of triangles in 3 dimensions or of segments in 2 or 3, not of ",
             mesh.simplex_dimension, "-simplices in ", mesh.dimension)};
  if (end && (end->dimension != mesh.dimension || end->vertex_count() != mesh.vertex_count()))
    return Error{Code::invalid_argument,
                 text("a frame of ", mesh.vertex_count(), " vertices in ", mesh.dimension,
                      " dimensions does not move to ", end->vertex_count(), " in ", end->dimension)};
  if (frames_.empty() ? seconds != 0 : !(seconds > before_))
    return Error{Code::invalid_argument, text("frame ", frames_.size(), " is to be shown at ", seconds,
                                              " seconds; the first is at 0, the others ascend")};
  if (mesh.vertex_count() >= UINT32_MAX)
    return Error{Code::invalid_argument,
                 text("a frame has ", mesh.vertex_count(), " vertices; glTF counts to ", UINT32_MAX - 1)};
  try {
    Frame frame;
    frame.time = time;
    frame.seconds = static_cast<float>(seconds);
    // Moments that are closer than f32 can tell are shown as shortly as it can tell.
    if (!frames_.empty() && frame.seconds <= frames_.back().seconds)
      frame.seconds = std::nextafter(frames_.back().seconds, HUGE_VALF);
    frame.corners_per_simplex = mesh.simplex_dimension + 1;
    frame.positions = in_space(mesh);
    if (end) frame.end_positions = in_space(*end);
    if (triangles && end && !find_attribute(mesh, Attribute::Location::vertex, normal_attribute, 3)) {
      frame.normals = vertex_normals(halfway(mesh, *end));
    } else if (triangles) {
      frame.normals = vertex_normals(mesh);
      if (end) frame.end_normals = vertex_normals(*end);
    }
    frame.colours = colours_of(mesh);
    const Attribute* tracks = track_of_simplices(mesh);
    const auto corners = static_cast<std::size_t>(frame.corners_per_simplex);
    std::map<std::int64_t, Frame::Part> parts;
    for (std::size_t simplex = 0; simplex < mesh.simplex_count(); ++simplex) {
      const std::int64_t track = tracks ? static_cast<std::int64_t>(value_of(*tracks, simplex)) : -1;
      for (std::size_t corner = 0; corner < corners; ++corner)
        parts[track].corners.push_back(
            static_cast<std::uint32_t>(mesh.simplices[simplex * corners + corner]));
    }
    for (auto& [track, part] : parts) {
      part.track = track;
      frame.parts.push_back(std::move(part));
    }
    frames_.push_back(std::move(frame));
    before_ = seconds;
  } catch (const std::bad_alloc&) {
    return Error{Code::out_of_memory, text("not enough memory for ", frames_.size() + 1, " frames")};
  }
  return {};
}

// The JSON, and the numbers that it describes.
class GlbWriter {
 public:
  explicit GlbWriter(const GlbMovie& movie) : movie_(movie), options_(movie.options_) {
    if (options_.quantised) find_box();
    json_["asset"] = {{"version", "2.0"}, {"generator", "hyperiso"}};
    json_["scene"] = 0;
    json_["scenes"] = Json::array({{{"nodes", {0}}}});
    for (const char* list : {"nodes", "meshes", "materials", "accessors", "bufferViews"})
      json_[list] = Json::array();
    add_frames();
    add_animation();
    for (const char* list : {"meshes", "materials", "accessors", "bufferViews"})
      if (json_[list].empty()) json_.erase(list);
    if (!bytes_.empty()) json_["buffers"] = Json::array({{{"byteLength", bytes_.size()}}});
    if (options_.quantised)
      for (const char* list : {"extensionsUsed", "extensionsRequired"})
        json_[list] = {"KHR_mesh_quantization"};
  }

  Status write(const std::filesystem::path& path, FileGroup* group) const {
    // Names may hold bytes that are no UTF-8.
    std::string json = json_.dump(-1, ' ', false, Json::error_handler_t::replace);
    json.append((4 - json.size() % 4) % 4, ' ');
    const std::uint64_t size = 12 + 8 + json.size() + (bytes_.empty() ? 0 : 8 + bytes_.size());
    if (size > UINT32_MAX)
      return Error{Code::file_unsupported, text(path.string(), ": ", byte_size(size),
                                                " are more than a .glb can hold, 4 GiB; take fewer ",
                                                "frames, a part of the field, or quantise")};
    auto file = AtomicFile::create(path);
    if (!file) return file.error();
    file->write("glTF" + number(2) + number(size) + number(json.size()) + "JSON");
    file->write(json);
    if (!bytes_.empty()) {
      file->write(number(bytes_.size()) + std::string("BIN\0", 4));
      file->write(bytes_.data(), bytes_.size());
    }
    return file->commit(group);
  }

 private:
  static std::string number(std::uint64_t value) {
    std::string bytes;
    for (int byte = 0; byte < 4; ++byte) bytes += static_cast<char>(value >> 8 * byte & 255);
    return bytes;
  }

  void find_box() {
    std::array<float, 3> high;
    low_.fill(HUGE_VALF), high.fill(-HUGE_VALF);
    for (const auto& frame : movie_.frames_) {
      for (const auto* positions : {&frame.positions, &frame.end_positions})
        for (std::size_t place = 0; place < positions->size(); ++place) {
          low_[place % 3] = std::min(low_[place % 3], (*positions)[place]);
          high[place % 3] = std::max(high[place % 3], (*positions)[place]);
        }
      if (!frame.end_positions.empty()) last_step_ = INT16_MAX; // differences of steps are signed
    }
    double extent = 0;
    for (std::size_t k = 0; k < 3; ++k) {
      if (!(low_[k] <= high[k]))
        low_[k] = 0;
      else
        extent = std::max(extent, static_cast<double>(high[k]) - low_[k]);
    }
    if (extent > 0) step_ = extent / last_step_;
  }

  // Node 0 turns the axes, its children are the frames; quantised, a node in between gives back the
  // coordinates.
  void add_frames() {
    const double half = std::sqrt(0.5);
    Json surface{{"name", options_.name.empty() ? "surface" : options_.name},
                 {"rotation", {-half, 0, 0, half}}};
    if (!options_.space_unit.empty()) surface["extras"]["unit"] = options_.space_unit;
    if (!options_.time_unit.empty()) surface["extras"]["time_unit"] = options_.time_unit;
    nodes().push_back(std::move(surface));
    if (options_.quantised)
      add_child(0, {{"name", "quantised"}, {"translation", low_}, {"scale", {step_, step_, step_}}});
    const std::size_t above = nodes().size() - 1;
    for (std::size_t frame = 0; frame < movie_.frames_.size(); ++frame) {
      Json node{{"name", text("frame ", frame)}, {"extras", {{"time", movie_.frames_[frame].time}}}};
      if (frame > 0) node["scale"] = {0, 0, 0};
      frame_nodes_.push_back(add_child(above, std::move(node)));
      mesh_nodes_.emplace_back();
      add_parts(movie_.frames_[frame], frame_nodes_.back());
    }
  }

  // A frame without tracks is one mesh at its node, with tracks a child node for each. All parts share the
  // vertices.
  void add_parts(const auto& frame, std::size_t node) {
    if (frame.parts.empty()) return;
    Json attributes{{"POSITION", add_positions(frame.positions)}};
    if (!frame.normals.empty()) attributes["NORMAL"] = add_normals(frame.normals);
    if (!frame.colours.empty())
      attributes["COLOR_0"] =
          add_accessor(frame.colours, 4, type_u16, {{"normalized", true}}, target_vertices, 8);
    Json target;
    if (!frame.end_positions.empty()) {
      target["POSITION"] = add_ways(frame.positions, frame.end_positions);
      if (!frame.end_normals.empty()) target["NORMAL"] = add_turns(frame.normals, frame.end_normals);
    }
    const bool divided = frame.parts.size() > 1 || frame.parts[0].track >= 0;
    for (const auto& part : frame.parts) {
      Json primitive{{"attributes", attributes},
                     {"indices", add_corners(part.corners, frame.positions.size() / 3)},
                     {"material", material_of(part.track, !frame.colours.empty())},
                     {"mode", frame.corners_per_simplex == 2 ? mode_lines : mode_triangles}};
      if (!target.is_null()) primitive["targets"] = Json::array({target});
      Json mesh{{"primitives", Json::array({primitive})}};
      if (!target.is_null()) mesh["weights"] = {0}; // VTK 9.1 fails without
      json_["meshes"].push_back(std::move(mesh));
      const std::size_t number = json_["meshes"].size() - 1;
      if (divided) {
        const std::string name = part.track >= 0 ? text("track ", part.track) : "no track";
        mesh_nodes_.back().push_back(add_child(node, {{"name", name}, {"mesh", number}}));
      } else {
        nodes()[node]["mesh"] = number;
        mesh_nodes_.back().push_back(node);
      }
    }
  }

  std::size_t material_of(std::int64_t track, bool coloured) {
    const std::int64_t key = coloured ? -2 : track;
    const auto [known, is_new] = materials_.emplace(key, materials_.size());
    if (!is_new) return known->second;
    Json colour{1, 1, 1, 1};
    if (!coloured) {
      const Colour rgb = track >= 0 ? label_colour(track) : Colour{0x8f, 0xb3, 0xd9};
      colour = {linear(rgb.red) / 65535.0, linear(rgb.green) / 65535.0, linear(rgb.blue) / 65535.0, 1};
    }
    json_["materials"].push_back(
        {{"pbrMetallicRoughness",
          {{"baseColorFactor", colour}, {"metallicFactor", 0}, {"roughnessFactor", 0.6}}},
         {"doubleSided", true}});
    return known->second;
  }

  // Frame i is there from time i to time i + 1, in frames per second, and moves in between; the first shows
  // where nothing is played.
  void add_animation() {
    const std::size_t count = frame_nodes_.size();
    const auto moves = [](const auto& frame) { return !frame.end_positions.empty(); };
    if (count < 2 && !moves(movie_.frames_[0])) return;
    Json samplers = Json::array(), channels = Json::array();
    const auto add = [&](std::size_t node, const char* path, const char* interpolation, std::size_t times,
                         std::size_t values) {
      channels.push_back({{"sampler", samplers.size()}, {"target", {{"node", node}, {"path", path}}}});
      samplers.push_back({{"input", times}, {"interpolation", interpolation}, {"output", values}});
    };
    const auto scales = [&](const std::vector<float>& wanted) {
      std::vector<float> numbers;
      for (const float scale : wanted) numbers.insert(numbers.end(), 3, scale);
      return add_accessor(numbers, 3, type_float);
    };
    const std::size_t until = scales({1, 0}), during = scales({0, 1, 0}), from = scales({0, 1, 1});
    std::optional<std::size_t> from_start_to_end;
    const auto seconds = [&](std::size_t frame) {
      return frame < count
                 ? movie_.frames_[frame].seconds
                 : movie_.frames_.back().seconds + static_cast<float>(1 / options_.frames_per_second);
    };
    for (std::size_t frame = 0; frame < count; ++frame) {
      std::vector<float> times{0};
      if (frame > 0) times.push_back(seconds(frame));
      times.push_back(seconds(frame + 1));
      add(frame_nodes_[frame], "scale", "STEP", add_times(times),
          frame == 0          ? until
          : frame + 1 < count ? during
                              : from);
      if (!moves(movie_.frames_[frame])) continue;
      if (!from_start_to_end) from_start_to_end = add_accessor(std::vector<float>{0, 1}, 1, type_float);
      const std::size_t shown = add_times({seconds(frame), seconds(frame + 1)});
      for (const std::size_t node : mesh_nodes_[frame])
        add(node, "weights", "LINEAR", shown, *from_start_to_end);
    }
    json_["animations"] = Json::array({{{"name", "time"}, {"samplers", samplers}, {"channels", channels}}});
  }

  std::size_t add_times(const std::vector<float>& times) {
    return add_accessor(times, 1, type_float, {{"min", {times.front()}}, {"max", {times.back()}}});
  }

  std::size_t add_positions(const std::vector<float>& positions) {
    if (!options_.quantised) return add_floats(positions);
    return add_steps<std::uint16_t>(positions.size(), type_u16,
                                    [&](std::size_t place) { return step_of(positions, place); });
  }
  // From the ones to the others, as morph targets are given.
  std::size_t add_ways(const std::vector<float>& starts, const std::vector<float>& ends) {
    if (!options_.quantised) return add_floats(differences(starts, ends));
    return add_steps<std::int16_t>(starts.size(), type_i16, [&](std::size_t place) {
      return step_of(ends, place) - step_of(starts, place);
    });
  }

  static std::vector<float> differences(const std::vector<float>& starts, const std::vector<float>& ends) {
    std::vector<float> result(starts.size());
    std::ranges::transform(ends, starts, result.begin(), std::minus());
    return result;
  }
  int step_of(const std::vector<float>& positions, std::size_t place) const {
    const double share = (static_cast<double>(positions[place]) - low_[place % 3]) / step_;
    return static_cast<int>(std::clamp<long>(std::lround(share), 0, last_step_));
  }
  template <class Step>
  std::size_t add_steps(std::size_t count, int type, const auto& step_at) {
    std::vector<Step> steps; // padded to four
    steps.reserve(count / 3 * 4);
    std::array<int, 3> low, high;
    low.fill(INT_MAX), high.fill(INT_MIN);
    for (std::size_t place = 0; place < count; ++place) {
      const int step = step_at(place);
      low[place % 3] = std::min(low[place % 3], step);
      high[place % 3] = std::max(high[place % 3], step);
      steps.push_back(static_cast<Step>(step));
      if (place % 3 == 2) steps.push_back(0);
    }
    return add_accessor(steps, 3, type, {{"min", low}, {"max", high}}, target_vertices, 8);
  }

  std::size_t add_normals(const std::vector<float>& normals) {
    if (!options_.quantised) return add_accessor(normals, 3, type_float, {}, target_vertices, 12);
    return add_bytes(normals);
  }
  // From the ones to the others. Bytes hold turns of up to about 60 degrees; of one that is larger they hold
  // a part.
  std::size_t add_turns(const std::vector<float>& starts, const std::vector<float>& ends) {
    std::vector<float> turns = differences(starts, ends);
    if (!options_.quantised) return add_accessor(turns, 3, type_float, {}, target_vertices, 12);
    for (std::size_t place = 0; place < turns.size(); place += 3) {
      float most = 1;
      for (std::size_t k = 0; k < 3; ++k) most = std::max(most, std::abs(turns[place + k]));
      for (std::size_t k = 0; k < 3; ++k) turns[place + k] /= most;
    }
    return add_bytes(turns);
  }
  std::size_t add_bytes(const std::vector<float>& shares) {
    std::vector<std::int8_t> steps; // padded to four
    steps.reserve(shares.size() / 3 * 4);
    for (std::size_t place = 0; place < shares.size(); ++place) {
      steps.push_back(static_cast<std::int8_t>(std::lround(shares[place] * 127)));
      if (place % 3 == 2) steps.push_back(0);
    }
    return add_accessor(steps, 3, type_byte, {{"normalized", true}}, target_vertices, 4);
  }

  // Triples with the bounds that glTF asks for.
  std::size_t add_floats(const std::vector<float>& numbers) {
    std::array<float, 3> low, high;
    low.fill(HUGE_VALF), high.fill(-HUGE_VALF);
    for (std::size_t place = 0; place < numbers.size(); ++place) {
      low[place % 3] = std::min(low[place % 3], numbers[place]);
      high[place % 3] = std::max(high[place % 3], numbers[place]);
    }
    return add_accessor(numbers, 3, type_float, {{"min", low}, {"max", high}}, target_vertices, 12);
  }

  std::size_t add_corners(const std::vector<std::uint32_t>& corners, std::size_t vertices) {
    if (vertices > 65535) return add_accessor(corners, 1, type_u32, {}, target_corners);
    return add_accessor(std::vector<std::uint16_t>(corners.begin(), corners.end()), 1, type_u16, {},
                        target_corners);
  }

  // `stride`: bytes from one element to the next, where that is to be said.
  template <class T>
  std::size_t add_accessor(const std::vector<T>& numbers, std::size_t components, int type,
                           const Json& more = Json::object(), int target = 0, std::size_t stride = 0) {
    const std::size_t bytes = numbers.size() * sizeof(T);
    Json view{{"buffer", 0}, {"byteOffset", bytes_.size()}, {"byteLength", bytes}};
    if (stride > 0) view["byteStride"] = stride;
    if (target > 0) view["target"] = target;
    json_["bufferViews"].push_back(std::move(view));
    const std::size_t start = bytes_.size();
    bytes_.resize(start + (bytes + 3) / 4 * 4);
    std::memcpy(bytes_.data() + start, numbers.data(), bytes);

    constexpr const char* types[] = {"", "SCALAR", "VEC2", "VEC3", "VEC4"};
    const std::size_t count = stride > 0 ? bytes / stride : numbers.size() / components;
    Json accessor{{"bufferView", json_["bufferViews"].size() - 1},
                  {"componentType", type},
                  {"count", count},
                  {"type", types[components]}};
    if (!more.is_null()) accessor.update(more);
    json_["accessors"].push_back(std::move(accessor));
    return json_["accessors"].size() - 1;
  }

  Json& nodes() { return json_["nodes"]; }
  std::size_t add_child(std::size_t parent, Json node) {
    const std::size_t number = nodes().size();
    nodes().push_back(std::move(node));
    nodes()[parent]["children"].push_back(number);
    return number;
  }

  const GlbMovie& movie_;
  const GlbOptions& options_;
  Json json_;
  std::vector<char> bytes_;
  std::vector<std::size_t> frame_nodes_;
  std::vector<std::vector<std::size_t>> mesh_nodes_; // of each frame: those with its meshes
  std::map<std::int64_t, std::size_t> materials_;
  std::array<float, 3> low_{}; // quantised
  double step_ = 1;
  int last_step_ = UINT16_MAX;
};

Status GlbMovie::write(const std::filesystem::path& path, FileGroup* group) const {
  if (frames_.empty()) return Error{Code::invalid_argument, text(path.string(), ": a movie needs a frame")};
  try {
    return GlbWriter(*this).write(path, group);
  } catch (const std::bad_alloc&) {
    return no_memory_to_write(path);
  }
}

} // namespace hyperiso
