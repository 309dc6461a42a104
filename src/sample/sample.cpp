#include "hyperiso/sample.hpp"

#include "core/nearest.hpp"
#include "core/random.hpp"
#include "core/text.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <new>
#include <numbers>

namespace hyperiso {
namespace {

constexpr std::size_t most_axes = 8;
constexpr double pi = std::numbers::pi;

constexpr SampleField fields[] = {
    {"gaussians", "blobs that approach each other and merge", 0.5, 1, 0.7},
    {"gyroid", "the gyroid, a surface that fills space, drifting along its diagonal", 0, 1, 0},
    {"ball", "a ball of radius 1/2 that moves along x", 0.5, 1, 0.5},
    {"torus-morph", "a sphere that becomes a torus, then two spheres", 0.5, 2, 1},
    {"marschner-lobb", "fine rings, hard on every method, that run outwards", 0.5, 1, 0},
    {"noise", "independent random values: a surface everywhere", 0.5, 1, 0},
};

const SampleField* find_field(const std::string& name) {
  const auto* found = std::ranges::find_if(fields, [&](const SampleField& f) { return f.name == name; });
  return found == std::end(fields) ? nullptr : found;
}

// A place in space and time.
struct Point {
  std::array<double, most_axes> x{};
  std::size_t axes = 0; // of space
  double time = 0;
  std::uint64_t number = 0; // of the sample
};

double square(double x) { return x * x; }

// The squared distance from the centre (first, 0, 0, ...).
double squared_distance(const Point& point, double first) {
  double sum = square(point.x[0] - first);
  for (std::size_t axis = 1; axis < point.axes; ++axis) sum += square(point.x[axis]);
  return sum;
}

using Centre = std::array<double, most_axes>;

// Where the blobs are at time 0: two at x = -0.6 and 0.6, more of them anywhere in [-0.8, 0.8].
std::vector<Centre> blob_starts(const SampleOptions& options, std::size_t axes) {
  std::vector<Centre> starts(static_cast<std::size_t>(options.blobs));
  for (std::size_t blob = 0; blob < starts.size(); ++blob) {
    starts[blob] = {};
    if (options.blobs <= 2)
      starts[blob][0] = blob == 0 ? -0.6 : 0.6;
    else
      for (std::size_t axis = 0; axis < axes; ++axis)
        starts[blob][axis] = 1.6 * uniform(options.seed, blob * most_axes + axis) - 0.8;
  }
  return starts;
}

double gaussians(const Point& point, const std::vector<Centre>& starts) {
  const double way_left = 1 - 0.75 * point.time;
  double sum = 0;
  for (const Centre& start : starts) {
    double distance = 0;
    for (std::size_t axis = 0; axis < point.axes; ++axis)
      distance += square(point.x[axis] - way_left * start[axis]);
    sum += std::exp(-distance / 0.08);
  }
  return sum;
}

double gyroid(const Point& point) {
  double sum = 0;
  for (std::size_t axis = 0; axis < point.axes; ++axis) {
    const double next = point.x[(axis + 1) % point.axes];
    sum += std::sin(2 * pi * (point.x[axis] + point.time)) * std::cos(2 * pi * (next + point.time));
  }
  return sum;
}

double ball(const Point& point) { return 1 - std::sqrt(squared_distance(point, 0.8 * point.time - 0.4)); }

double torus_morph(const Point& point) {
  const double to_origin = squared_distance(point, 0);
  const double sphere = 1 - std::sqrt(to_origin);
  const double to_axis = square(point.x[0]) + (point.axes > 1 ? square(point.x[1]) : 0);
  const double to_circle = square(std::sqrt(to_axis) - 0.55) + (to_origin - to_axis);
  const double torus = 1 - 2.5 * std::sqrt(std::max(to_circle, 0.0));
  const double to_nearer_centre = std::min(squared_distance(point, -0.5), squared_distance(point, 0.5));
  const double two_spheres = 1 - 1.6 * std::sqrt(to_nearer_centre);
  return point.time < 1 ? std::lerp(sphere, torus, point.time)
                        : std::lerp(torus, two_spheres, point.time - 1);
}

double marschner_lobb(const Point& point) {
  constexpr double depth = 0.25, frequency = 6;
  const double along = point.x[point.axes - 1];
  const double radius = std::sqrt(std::max(squared_distance(point, 0) - square(along), 0.0));
  const double rings = std::cos(2 * pi * (frequency * std::cos(pi * radius / 2) + point.time));
  return (1 - std::sin(pi * along / 2) + depth * (1 + rings)) / (2 * (1 + depth));
}

// What an integer type can show of the field, from its lowest to its highest number.
struct Range {
  double low, high;
};
Range range_of(const std::string& name, std::size_t axes_of_space) {
  if (name == "gaussians") return {0, 2};
  // Each term is at most (sin^2 + cos^2) / 2, and the squares of each axis add up to 1.
  if (name == "gyroid")
    return {-0.5 * static_cast<double>(axes_of_space), 0.5 * static_cast<double>(axes_of_space)};
  return {0, 1};
}

// Integer types are scaled, floating-point types hold the values as they are.
template <class T>
double scaled(double value, Range range) {
  return std::is_floating_point_v<T> ? value : scaled_to<T>(value, range.low, range.high);
}

bool has_time(const SampleOptions& options) { return options.time.value_or(options.dims.size() >= 4); }

std::size_t axes_of_space(const SampleOptions& options) {
  return options.dims.size() - (has_time(options) ? 1 : 0);
}

Axis axis_between(double low, double high, std::int64_t count, const char* name) {
  Axis axis;
  axis.count = count;
  axis.name = name;
  if (count > 1) {
    axis.origin = low;
    axis.spacing = (high - low) / static_cast<double>(count - 1);
  }
  return axis;
}

FieldInfo describe(const SampleField& field, const SampleOptions& options) {
  constexpr const char* names[most_axes] = {"x", "y", "z", "u", "v", "w", "p", "q"};
  FieldInfo info;
  info.name = field.name;
  info.type = options.type;
  info.has_time = has_time(options);
  const std::size_t space = axes_of_space(options);
  for (std::size_t axis = 0; axis < options.dims.size(); ++axis)
    info.axes.push_back(axis < space ? axis_between(-1, 1, options.dims[axis], names[axis])
                                     : axis_between(0, field.end_of_time, options.dims[axis], "t"));
  return info;
}

Status check(const SampleOptions& options) {
  const std::size_t axes = options.dims.size();
  if (axes < 2 || axes > most_axes)
    return Error{Code::invalid_argument, text("a sample field has 2 to 8 axes, not ", axes)};
  for (const std::int64_t count : options.dims)
    if (count < 1) return Error{Code::invalid_argument, text("an axis cannot have ", count, " samples")};
  if (options.blobs < 1)
    return Error{Code::invalid_argument, text("there cannot be ", options.blobs, " blobs")};
  return {};
}

// Moves on to the next sample in memory; false after the last.
bool advance(std::vector<std::int64_t>& index, const std::vector<Axis>& axes) {
  for (std::size_t axis = 0; axis < axes.size(); ++axis) {
    if (++index[axis] < axes[axis].count) return true;
    index[axis] = 0;
  }
  return false;
}

template <class T, class Value>
Status fill(T* samples, const FieldInfo& info, double still, Range range, const Progress& progress,
            const Value& value) {
  constexpr std::uint64_t progress_every = 1 << 16;
  const auto total = static_cast<double>(info.samples());
  Point point;
  point.axes = info.axes.size() - (info.has_time ? 1 : 0);
  std::vector<std::int64_t> index(info.axes.size(), 0);
  do {
    if (point.number % progress_every == 0 && progress &&
        !progress(static_cast<double>(point.number) / total))
      return Error{Code::cancelled, "cancelled"};
    for (std::size_t axis = 0; axis < point.axes; ++axis)
      point.x[axis] = info.axes[axis].coordinate(index[axis]);
    point.time = info.has_time ? info.axes.back().coordinate(index.back()) : still;
    samples[point.number] = nearest<T>(scaled<T>(value(point), range));
    ++point.number;
  } while (advance(index, info.axes));
  return {};
}

template <class T>
Status fill_named(T* samples, const FieldInfo& info, const SampleField& field, const SampleOptions& options) {
  const Range range = range_of(field.name, axes_of_space(options));
  const auto fill_with = [&](const auto& value) {
    return fill(samples, info, field.still, range, options.progress, value);
  };
  const std::string name = field.name;
  if (name == "gaussians")
    return fill_with([starts = blob_starts(options, axes_of_space(options))](const Point& point) {
      return gaussians(point, starts);
    });
  if (name == "gyroid") return fill_with(gyroid);
  if (name == "ball") return fill_with(ball);
  if (name == "torus-morph") return fill_with(torus_morph);
  if (name == "marschner-lobb") return fill_with(marschner_lobb);
  return fill_with([&](const Point& point) { return uniform(options.seed, point.number); });
}

} // namespace

std::span<const SampleField> sample_fields() { return fields; }

Result<FieldInfo> describe_sample(const std::string& name, const SampleOptions& options) {
  const SampleField* field = find_field(name);
  if (!field) {
    std::string names;
    for (const SampleField& known : fields) names += (names.empty() ? "" : ", ") + std::string(known.name);
    return Error{Code::invalid_argument, text("there is no sample field '", name, "'; there are ", names)};
  }
  if (const Status status = check(options); !status) return status.error();
  return describe(*field, options);
}

Result<Field> make_sample(const std::string& name, const SampleOptions& options) {
  try {
    auto info = describe_sample(name, options);
    if (!info) return info.error();
    auto made = allocate_field(*info, options.memory_limit);
    if (!made) return made.error();
    const Status filled = visit_sample_type(options.type, [&](auto sample) {
      return fill_named(reinterpret_cast<decltype(sample)*>(made->samples), *info, *find_field(name),
                        options);
    });
    if (!filled) return filled.error();
    return std::move(made->field);
  } catch (const std::bad_alloc&) {
    return Error{Code::out_of_memory, "no memory for the sample field"};
  }
}

double sample_isovalue(const std::string& name, const SampleOptions& options) {
  const Range range = range_of(name, axes_of_space(options));
  return visit_sample_type(
      options.type, [&](auto sample) { return scaled<decltype(sample)>(find_field(name)->isovalue, range); });
}

} // namespace hyperiso
