// NRRD with an attached header (.nrrd), raw or gzip.

#include "core/text.hpp"
#include "io/formats.hpp"
#include "io/nrrd_keys.hpp"
#include "io/parse.hpp"
#include "io/sample_runs.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <zlib.h>

namespace hyperiso {
namespace {

// In the order of SampleType.
constexpr const char* type_names[] = {"unsigned char", "signed char", "unsigned short", "short",
                                      "unsigned int",  "int",         "float",          "double"};

// A string that has to stay on its line.
std::string on_one_line(std::string words) {
  for (char& c : words)
    if (static_cast<unsigned char>(c) < ' ') c = ' ';
  return words;
}

std::string quoted_string(const std::string& words) {
  std::string result = "\"";
  for (const char c : on_one_line(words)) {
    if (c == '"' || c == '\\') result += '\\';
    result += c;
  }
  return result + '"';
}

// One entry for each axis.
template <class Entry>
std::string line(const char* field, std::size_t axes, Entry&& entry) {
  std::string result = text(field, ":");
  for (std::size_t axis = 0; axis < axes; ++axis) result += text(" ", entry(axis));
  return result + "\n";
}

// An affine map that leaves time alone: time needs no direction then.
bool keeps_time(const FieldInfo& info) {
  const std::size_t D = info.axes.size(), time = D - 1;
  if (!info.has_time || info.world->offset[time] != 0) return false;
  for (std::size_t k = 0; k < D; ++k) {
    const double expected = k == time ? 1 : 0;
    if (info.world->linear[time * D + k] != expected || info.world->linear[k * D + time] != expected)
      return false;
  }
  return true;
}

// Without an affine map: spacing and the positions of the first and last sample (unu crops keep the position
// only if both are there). nan: the coordinates are listed by key. Axes before `first_axis` have a direction.
std::string positions(const FieldInfo& info, std::size_t first_axis) {
  const auto& axes = info.axes;
  const auto numbers = [&](const char* field, auto&& number) {
    return line(field, axes.size(), [&](std::size_t axis) {
      return axis < first_axis || !axes[axis].coordinates.empty() ? NAN : number(axes[axis]);
    });
  };
  return numbers("spacings", [](const Axis& axis) { return axis.spacing; }) +
         numbers("axis mins", [](const Axis& axis) { return axis.coordinate(0); }) +
         numbers("axis maxs", [](const Axis& axis) { return axis.coordinate(axis.count - 1); }) +
         line("centerings", axes.size(),
              [&](std::size_t axis) { return axis < first_axis ? "???" : "node"; }) +
         line("units", axes.size(),
              [&](std::size_t axis) { return quoted_string(axis < first_axis ? "" : axes[axis].unit); });
}

// With one: sample 0 and the step to the next sample along each axis, in the world. An axis with listed
// coordinates has the direction of its unit.
std::string orientation(const FieldInfo& info) {
  const auto& axes = info.axes;
  const std::size_t D = axes.size(), oriented = keeps_time(info) ? D - 1 : D;
  const auto vector = [&](auto&& component) {
    std::string result = "(";
    for (std::size_t row = 0; row < oriented; ++row) result += text(row > 0 ? "," : "", component(row));
    return result + ")";
  };
  std::string result = text("space dimension: ", oriented, "\n");
  result += line("space directions", D, [&](std::size_t axis) -> std::string {
    if (axis >= oriented) return "none";
    const double step = axes[axis].coordinates.empty() ? axes[axis].spacing : 1;
    return vector([&](std::size_t row) { return info.world->linear[row * D + axis] * step; });
  });
  result += "space origin: " + vector([&](std::size_t row) {
              double position = info.world->offset[row];
              for (std::size_t axis = 0; axis < oriented; ++axis)
                if (axes[axis].coordinates.empty())
                  position += info.world->linear[row * D + axis] * axes[axis].coordinate(0);
              return position;
            }) +
            "\n";
  result += line("space units", oriented, [&](std::size_t axis) { return quoted_string(axes[axis].unit); });
  return oriented < D ? result + positions(info, oriented) : result;
}

// What the keys say that the fields of the format cannot.
std::string keys(const FieldInfo& info) {
  std::string result;
  for (const Axis& axis : info.axes) {
    if (!axis.coordinates.empty()) {
      result += nrrd_coordinates_key(axis.name) + ":=";
      for (std::size_t i = 0; i < axis.coordinates.size(); ++i)
        result += text(i > 0 ? " " : "", axis.coordinates[i]);
      result += "\n";
    } else if (axis.first != 0 && !info.world) {
      result += text(nrrd_crop_key(axis.name), ":=", axis.origin, " ", axis.first, "\n");
    }
  }
  return result;
}

std::string header_of(const FieldInfo& info, bool compress) {
  const auto& axes = info.axes;
  const std::size_t D = axes.size();
  std::string header = "NRRD0004\n# Format: http://teem.sourceforge.net/nrrd/format.html\n";
  if (!info.name.empty()) header += text("content: ", on_one_line(info.name), "\n");
  header += text("type: ", type_names[static_cast<int>(info.type)], "\ndimension: ", D, "\n");
  header += line("sizes", D, [&](std::size_t axis) { return axes[axis].count; });
  header += info.world ? orientation(info) : positions(info, 0);
  // Readers take the last of four or more axes for time, unless it is said to be space.
  const char* other = D >= 4 && !info.has_time ? "space" : "domain";
  header +=
      line("kinds", D, [&](std::size_t axis) { return info.has_time && axis + 1 == D ? "time" : other; });
  header += line("labels", D, [&](std::size_t axis) { return quoted_string(axes[axis].name); });
  header += text("endian: ", std::endian::native == std::endian::big ? "big" : "little", "\n");
  header += text("encoding: ", compress ? "gzip" : "raw", "\n");
  header += keys(info);
  return header;
}

// Ends the header so that raw samples begin at a multiple of 64 bytes and can be used where they lie.
std::string ended(std::string header) {
  constexpr std::size_t alignment = 64, ends = 3; // "#", the end of its line, the empty line
  const std::size_t padding = (alignment - (header.size() + ends) % alignment) % alignment;
  return header + "#" + std::string(padding, ' ') + "\n\n";
}

void write_compressed(AtomicFile& file, const Field& field) {
  z_stream stream{};
  // 15 + 16: the largest window, in the format of gzip files. Without a time in its header: the same field
  // gives the same bytes.
  if (deflateInit2(&stream, Z_DEFAULT_COMPRESSION, Z_DEFLATED, 15 + 16, 8, Z_DEFAULT_STRATEGY) != Z_OK)
    throw std::bad_alloc();
  struct End {
    z_stream& stream;
    ~End() { deflateEnd(&stream); }
  } end{stream};
  std::vector<unsigned char> room(std::size_t{1} << 18);
  const auto deflate_all = [&](std::span<const std::byte> bytes, int flush) {
    do {
      const std::size_t part = std::min<std::size_t>(bytes.size(), std::size_t{1} << 30);
      stream.next_in = const_cast<Bytef*>(reinterpret_cast<const Bytef*>(bytes.data()));
      stream.avail_in = static_cast<uInt>(part);
      bytes = bytes.subspan(part);
      do {
        stream.next_out = room.data();
        stream.avail_out = static_cast<uInt>(room.size());
        deflate(&stream, bytes.empty() ? flush : Z_NO_FLUSH);
        file.write(room.data(), room.size() - stream.avail_out);
      } while (stream.avail_out == 0);
    } while (!bytes.empty() && !file.failed());
  };
  for_each_run(field, [&](std::span<const std::byte> run) {
    if (!file.failed()) deflate_all(run, Z_NO_FLUSH);
  });
  deflate_all({}, Z_FINISH);
}

} // namespace

Status check_fits_nrrd(const FieldInfo& info, const std::filesystem::path& path) {
  constexpr std::size_t most_axes = 16, most_dimensions = 8; // by the format
  if (info.axes.size() > most_axes || (info.world && info.axes.size() > most_dimensions))
    return Error{Code::file_unsupported,
                 text(path.string(), ": NRRD cannot hold a field with ", info.axes.size(), " axes")};
  for (const Axis& axis : info.axes) {
    const auto same_name = std::ranges::count(info.axes, axis.name, &Axis::name);
    const bool is_key = on_one_line(axis.name) == axis.name && trimmed(axis.name) == axis.name &&
                        axis.name.find_first_of(":\\") == std::string::npos && !axis.name.empty();
    if ((!axis.coordinates.empty() || axis.first != 0) && (same_name > 1 || !is_key))
      return Error{Code::invalid_argument,
                   text(path.string(), ": the coordinates of axis ", in_quotes(axis.name),
                        " need a name of its own, without colons, to be written under")};
  }
  return {};
}

void write_nrrd(AtomicFile& file, const Field& field, bool compress) {
  file.write(ended(header_of(field.info, compress)));
  if (compress)
    write_compressed(file, field);
  else
    write_raw(file, field);
}

} // namespace hyperiso
