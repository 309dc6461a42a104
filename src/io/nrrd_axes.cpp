// What an NRRD header says of the axes, for nrrd_header.hpp.

#include "core/determinant.hpp"
#include "core/text.hpp"
#include "io/nrrd_header.hpp"
#include "io/nrrd_keys.hpp"
#include "io/parse.hpp"

#include <algorithm>
#include <cmath>

namespace hyperiso {
namespace {

using Vector = std::vector<double>;

// What nrrd_crop_key holds.
struct CroppedFrom {
  double origin;
  std::int64_t first;
};

// The header's words about one axis.
struct AxisFields {
  std::int64_t size = 0;
  std::string kind; // lower case; "domain" if not given
  std::string label, unit;
  double spacing = NAN, min = NAN, max = NAN;
  bool cell_centred = false;
  std::optional<Vector> direction; // `space_dimension` numbers
  std::optional<std::vector<double>> coordinates;
  std::optional<CroppedFrom> cropped_from;
};

struct Space {
  std::size_t dimension = 0;
  bool last_is_time = false;
  Vector origin;
  std::vector<std::string> units;
};

// Reads the header's axes, one field after the other, into `axes` and `space`.
class AxesParser {
 public:
  AxesParser(const NrrdHeader& header, const std::filesystem::path& path) : header_(header), path_(path) {}
  std::vector<AxisFields> axes;
  Space space;

  Status parse() {
    Status status = parse_sizes();
    if (status)
      status = parse_words("kinds", [](AxisFields& axis, std::string_view word) {
        axis.kind = lower_case(word);
        return true;
      });
    if (status)
      status = parse_words("centers", [](AxisFields& axis, std::string_view word) {
        const std::string centre = lower_case(word);
        axis.cell_centred = centre == "cell";
        return centre == "cell" || centre == "node" || centre == "none" || centre == "???";
      });
    if (status) status = parse_number_words("spacings", &AxisFields::spacing);
    if (status) status = parse_number_words("axis mins", &AxisFields::min);
    if (status) status = parse_number_words("axis maxs", &AxisFields::max);
    if (status) status = parse_strings("labels", &AxisFields::label);
    if (status) status = parse_strings("units", &AxisFields::unit);
    if (status) status = parse_space();
    if (status) status = parse_keys();
    return status;
  }

  Error malformed(std::string_view what) const {
    return {Code::file_malformed, text(path_.string(), ": ", what)};
  }

 private:
  Error not_one_each(std::string_view field, std::size_t found) const {
    return malformed(text("\"", field, ":\" has ", found, " entries for ", axes.size(), " axes"));
  }

  Status parse_sizes() {
    constexpr std::int64_t most = 16; // by the format
    const std::string *dimension = header_.field("dimension"), *sizes = header_.field("sizes");
    if (!dimension) return malformed("the header has no line \"dimension:\"");
    if (!sizes) return malformed("the header has no line \"sizes:\"");
    const auto count = number_from<std::int64_t>(*dimension);
    if (!count || *count < 1 || *count > most)
      return malformed(text("\"dimension:\" is ", in_quotes(*dimension), ", not a number from 1 to ", most));
    axes.resize(static_cast<std::size_t>(*count));
    const auto words = split(*sizes);
    if (words.size() != axes.size()) return not_one_each("sizes", words.size());
    for (std::size_t axis = 0; axis < axes.size(); ++axis) {
      const auto size = number_from<std::int64_t>(words[axis]);
      if (!size || *size < 1)
        return malformed(text("the size ", in_quotes(words[axis]), " is not a number of at least 1"));
      axes[axis].size = *size;
      axes[axis].kind = "domain";
    }
    return {};
  }

  template <class Use>
  Status parse_words(const std::string& field, Use&& use) {
    const std::string* value = header_.field(field);
    if (!value) return {};
    const auto words = split(*value);
    if (words.size() != axes.size()) return not_one_each(field, words.size());
    for (std::size_t axis = 0; axis < axes.size(); ++axis)
      if (!use(axes[axis], words[axis]))
        return malformed(text(in_quotes(words[axis]), " in \"", field, ":\" has no meaning there"));
    return {};
  }

  // nan stands for an unknown number.
  Status parse_number_words(const std::string& field, double AxisFields::*member) {
    return parse_words(field, [&](AxisFields& axis, std::string_view word) {
      const auto number = number_from<double>(word);
      if (!number || std::isinf(*number)) return false;
      axis.*member = *number;
      return true;
    });
  }

  // "..." for each, with \" inside.
  std::optional<std::vector<std::string>> strings(std::string_view words) const {
    std::vector<std::string> result;
    while (!(words = trimmed(words)).empty()) {
      if (words[0] != '"') return std::nullopt;
      std::string entry;
      std::size_t i = 1;
      for (; i < words.size() && words[i] != '"'; ++i) {
        if (words[i] == '\\' && i + 1 < words.size()) ++i;
        entry += words[i];
      }
      if (i == words.size()) return std::nullopt;
      result.push_back(std::move(entry));
      words.remove_prefix(i + 1);
    }
    return result;
  }

  Status parse_strings(const std::string& field, std::string AxisFields::*member) {
    const std::string* value = header_.field(field);
    if (!value) return {};
    const auto entries = strings(*value);
    if (!entries) return malformed(text("\"", field, ":\" is not a row of strings in quotes"));
    if (entries->size() != axes.size()) return not_one_each(field, entries->size());
    for (std::size_t axis = 0; axis < axes.size(); ++axis) axes[axis].*member = (*entries)[axis];
    return {};
  }

  Status parse_space() {
    const std::string *name = header_.field("space"), *dimension = header_.field("space dimension");
    if (!name && !dimension) return {};
    if (name) {
      static constexpr std::string_view in_time[] = {"right-anterior-superior-time",
                                                     "rast",
                                                     "left-anterior-superior-time",
                                                     "last",
                                                     "left-posterior-superior-time",
                                                     "lpst",
                                                     "scanner-xyz-time",
                                                     "3d-right-handed-time",
                                                     "3d-left-handed-time"};
      space.last_is_time =
          std::find(std::begin(in_time), std::end(in_time), lower_case(*name)) != std::end(in_time);
      space.dimension = space.last_is_time ? 4 : 3;
    } else {
      const auto count = number_from<std::size_t>(*dimension);
      if (!count || *count < 1 || *count > 8)
        return malformed(
            text("\"space dimension:\" is ", in_quotes(*dimension), ", not a number from 1 to 8"));
      space.dimension = *count;
    }
    space.origin.assign(space.dimension, 0);
    if (const std::string* origin = header_.field("space origin")) {
      std::string_view words = *origin;
      auto vector = next_vector(words);
      if (!vector || !trimmed(words).empty()) return malformed("\"space origin:\" is not one vector");
      for (std::size_t k = 0; k < space.dimension; ++k)
        if (!std::isnan((*vector)[k])) space.origin[k] = (*vector)[k]; // nan: unknown
    }
    if (const std::string* units = header_.field("space units")) {
      const auto entries = strings(*units);
      if (!entries || entries->size() != space.dimension)
        return malformed(text("\"space units:\" is not a row of ", space.dimension, " strings in quotes"));
      space.units = *entries;
    }
    return parse_directions();
  }

  Status parse_directions() {
    const std::string* directions = header_.field("space directions");
    if (!directions) return {};
    std::string_view words = *directions;
    for (AxisFields& axis : axes) {
      words = trimmed(words);
      if (lower_case(words.substr(0, 4)) == "none") {
        words.remove_prefix(4);
        continue;
      }
      auto vector = next_vector(words);
      if (!vector)
        return malformed(text("\"space directions:\" is not a vector of ", space.dimension,
                              " numbers, or none, for each axis"));
      // Some writers put nan or 0 where the format says none.
      const bool none =
          std::all_of(vector->begin(), vector->end(), [](double v) { return std::isnan(v) || v == 0; });
      if (!none) axis.direction = std::move(*vector);
    }
    if (trimmed(words).empty()) return {};
    return malformed(text("\"space directions:\" has more than ", axes.size(), " entries"));
  }

  // "(1,2,3)", taken off the front: as many numbers as the space has dimensions, none infinite.
  std::optional<Vector> next_vector(std::string_view& words) const {
    words = trimmed(words);
    const std::size_t end = words.find(')');
    if (words.empty() || words[0] != '(' || end == std::string_view::npos) return std::nullopt;
    std::string_view inside = words.substr(1, end - 1);
    words.remove_prefix(end + 1);
    Vector vector;
    while (vector.size() <= space.dimension) {
      const std::size_t comma = inside.find(',');
      const auto number = number_from<double>(trimmed(inside.substr(0, comma)));
      if (!number || std::isinf(*number)) return std::nullopt;
      vector.push_back(*number);
      if (comma == std::string_view::npos) break;
      inside.remove_prefix(comma + 1);
    }
    if (vector.size() != space.dimension) return std::nullopt;
    return vector;
  }

  const std::string* value_of(const std::string& key) const {
    const auto found = header_.key_values.find(key);
    return found == header_.key_values.end() ? nullptr : &found->second;
  }

  // What no field of the format can tell: our own keys, and those of 3D Slicer's sequences, which may be
  // words.
  Status parse_keys() {
    for (std::size_t number = 0; number < axes.size(); ++number) {
      AxisFields& axis = axes[number];
      const auto size = static_cast<std::size_t>(axis.size);
      const std::string key = nrrd_coordinates_key(axis.label);
      if (const std::string* words = value_of(key)) {
        axis.coordinates = numbers_from<double>(*words);
        if (!axis.coordinates || axis.coordinates->size() != size)
          return malformed(text("\"", key, ":=\" is not one number for each of ", size, " samples"));
      } else if (const std::string* times = value_of(text("axis ", number, " index values"))) {
        auto coordinates = numbers_from<double>(*times);
        if (Axis scratch;
            coordinates && coordinates->size() == size && set_coordinates(scratch, *coordinates))
          axis.coordinates = std::move(coordinates);
      }
      if (const std::string* words = value_of(nrrd_crop_key(axis.label))) {
        const auto parts = split(*words);
        const auto origin = parts.size() == 2 ? number_from<double>(parts[0]) : std::nullopt;
        const auto first = parts.size() == 2 ? number_from<std::int64_t>(parts[1]) : std::nullopt;
        constexpr std::int64_t most = std::int64_t{1} << 53; // beyond it, numbers of samples are not exact
        if (!origin || !first || *first < -most || *first > most)
          return malformed(
              text("\"", nrrd_crop_key(axis.label), ":=\" is not an origin and a sample number"));
        axis.cropped_from = CroppedFrom{*origin, *first};
      }
    }
    return {};
  }

  const NrrdHeader& header_;
  const std::filesystem::path& path_;
};

bool is_position(const AxisFields& axis) {
  static constexpr std::string_view positions[] = {"domain", "space", "time", "list", "none", "???"};
  return std::find(std::begin(positions), std::end(positions), axis.kind) != std::end(positions);
}

// An axis along which the samples are parts of one value.
Status refuse_components(const AxesParser& parser, const std::filesystem::path& path) {
  for (std::size_t axis = 0; axis < parser.axes.size(); ++axis)
    if (!is_position(parser.axes[axis]) && parser.axes[axis].size > 1)
      return Error{Code::file_unsupported,
                   text(path.string(), ": axis ", axis, " holds ", parser.axes[axis].size,
                        " components of one value (kind ", in_quotes(parser.axes[axis].kind),
                        "), but a field has one number at each point; pick one component "
                        "(unu slice -a ",
                        axis, " -p 0)")};
  return {};
}

// By kind, by name, by space, or by custom.
Result<std::optional<int>> find_time(const std::vector<AxisFields>& axes, const Space& space,
                                     const std::filesystem::path& path) {
  std::vector<int> times, lists, labelled, oriented;
  for (std::size_t i = 0; i < axes.size(); ++i) {
    const AxisFields& axis = axes[i];
    const std::string label = lower_case(axis.label);
    if (axis.kind == "time") times.push_back(static_cast<int>(i));
    if (axis.kind == "list") lists.push_back(static_cast<int>(i));
    if (label == "t" || label == "time") labelled.push_back(static_cast<int>(i));
    if (space.last_is_time && axis.direction && axis.direction->back() != 0 &&
        std::all_of(axis.direction->begin(), axis.direction->end() - 1, [](double v) { return v == 0; }))
      oriented.push_back(static_cast<int>(i));
  }
  if (times.size() > 1)
    return Error{Code::file_malformed, text(path.string(), ": ", times.size(), " axes are of kind time")};
  // Without a time axis, a list is the steps of a sequence, as 3D Slicer writes them.
  if (lists.size() + times.size() > 1)
    return Error{Code::file_unsupported,
                 text(path.string(), ": axis ", lists.back(), " is a list of values beside ",
                      times.empty() ? "another list" : "the time axis", "; pick one of them (unu slice -a ",
                      lists.back(), " -p 0)")};
  for (const auto& candidates : {times, lists, labelled, oriented})
    if (candidates.size() == 1) return std::optional<int>(candidates[0]);
  if (!axes.empty() && axes.back().kind == "space") return std::optional<int>();
  return usual_time_axis(axes.size());
}

// Position of the samples along an axis outside the space.
Status place_along_axis(const AxisFields& fields, std::size_t number, const AxesParser& parser, Axis& axis) {
  const bool has_min = !std::isnan(fields.min), has_max = !std::isnan(fields.max);
  const double intervals = static_cast<double>(fields.size - (fields.cell_centred ? 0 : 1));
  axis.spacing = !std::isnan(fields.spacing)           ? fields.spacing
                 : has_min && has_max && intervals > 0 ? (fields.max - fields.min) / intervals
                                                       : 1;
  if (axis.spacing == 0 || !std::isfinite(axis.spacing))
    return parser.malformed(text("the spacing of axis ", number, " is ", axis.spacing));
  const double margin = fields.cell_centred ? axis.spacing / 2 : 0;
  if (has_min)
    axis.origin = fields.min + margin;
  else if (has_max)
    axis.origin = fields.max - margin - static_cast<double>(fields.size - 1) * axis.spacing;
  // A program that moves the samples may not know the key: then the position of sample 0 belies it.
  if (const auto& whole = fields.cropped_from;
      whole && whole->origin + static_cast<double>(whole->first) * axis.spacing == axis.origin) {
    axis.origin = whole->origin;
    axis.first = whole->first;
  }
  return {};
}

// Places the axes that have a direction in space. Component k of the space belongs to the k-th of them, the
// last to time if that is among them. Where a direction lies along its own component, and no other does,
// origin and spacing say it all; the other axes keep their spacing and an affine map their direction. A space
// that has not as many dimensions as there are directions cannot be a map of the axes: they keep their
// spacing only.
Status place_in_space(const AxesParser& parser, StoredField& field) {
  const auto& axes = parser.axes;
  const Space& space = parser.space;
  std::vector<std::size_t> of_component;
  for (std::size_t axis = 0; axis < axes.size(); ++axis)
    if (axes[axis].direction && field.time_axis != static_cast<int>(axis)) of_component.push_back(axis);
  if (field.time_axis && axes[static_cast<std::size_t>(*field.time_axis)].direction)
    of_component.push_back(static_cast<std::size_t>(*field.time_axis));

  const bool is_map = of_component.size() == space.dimension;
  for (const std::size_t number : of_component)
    for (const double component : *axes[number].direction)
      if (std::isnan(component)) return parser.malformed("\"space directions:\" has a nan");
  // Component k is that of its axis alone, and nothing else: origin and spacing of the axis say it all.
  const auto is_alone = [&](std::size_t k) {
    const AxisFields& fields = axes[of_component[k]];
    if (!is_map || fields.coordinates || (*fields.direction)[k] == 0) return false;
    for (std::size_t other = 0; other < space.dimension; ++other)
      if (other != k && ((*fields.direction)[other] != 0 || (*axes[of_component[other]].direction)[k] != 0))
        return false;
    return true;
  };

  const std::size_t D = axes.size();
  bool diagonal = is_map;
  Affine world{Vector(D * D), Vector(D)};
  for (std::size_t axis = 0; axis < D; ++axis) world.linear[axis * D + axis] = axes[axis].direction ? 0 : 1;
  for (std::size_t k = 0; k < of_component.size(); ++k) {
    const std::size_t number = of_component[k];
    const AxisFields& fields = axes[number];
    Axis& axis = field.axes[number];
    const Vector& direction = *fields.direction;
    double length = 0;
    for (const double component : direction) length = std::hypot(length, component);
    const bool alone = is_alone(k);
    diagonal = diagonal && alone;
    axis.origin = alone ? space.origin[k] : 0;
    axis.spacing = alone ? direction[k] : length;
    if (!is_map) continue;
    if (axis.unit.empty() && !space.units.empty()) axis.unit = space.units[k];
    if (alone) {
      world.linear[number * D + number] = 1;
      continue;
    }
    // Coordinates of our own are positions in units of the direction, whatever its length.
    const double unit_length = fields.coordinates ? 1 : length;
    for (std::size_t row = 0; row < space.dimension; ++row)
      world.linear[of_component[row] * D + number] = direction[row] / unit_length;
    world.offset[number] = space.origin[k];
  }
  if (is_map && !diagonal) {
    if (determinant(world.linear, static_cast<int>(D)) == 0)
      return parser.malformed("\"space directions:\" do not span the space");
    field.world = std::move(world);
  }
  return {};
}

} // namespace

Status interpret_nrrd_axes(const NrrdHeader& header, const std::filesystem::path& path, StoredField& field) {
  AxesParser parser(header, path);
  if (Status status = parser.parse(); !status) return status;
  if (Status status = refuse_components(parser, path); !status) return status;
  std::erase_if(parser.axes, [](const AxisFields& axis) { return !is_position(axis); });
  const auto& axes = parser.axes;

  field.axes.resize(axes.size());
  for (std::size_t i = 0; i < axes.size(); ++i) {
    field.axes[i].count = axes[i].size;
    field.axes[i].name = axes[i].label;
    field.axes[i].unit = axes[i].unit;
  }
  if (const auto bytes = bytes_of(field.axes, field.type, path); !bytes) return bytes.error();
  const auto time_axis = find_time(axes, parser.space, path);
  if (!time_axis) return time_axis.error();
  field.time_axis = *time_axis;

  for (std::size_t i = 0; i < axes.size(); ++i)
    if (!axes[i].direction)
      if (Status status = place_along_axis(axes[i], i, parser, field.axes[i]); !status) return status;
  if (Status status = place_in_space(parser, field); !status) return status;
  for (std::size_t i = 0; i < axes.size(); ++i)
    if (axes[i].coordinates && !set_coordinates(field.axes[i], *axes[i].coordinates))
      return parser.malformed(text("the coordinates of axis ", i, " do not rise or fall all the way"));
  return {};
}

} // namespace hyperiso
