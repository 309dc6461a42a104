// What a picture shows: a box with its axes, the surface in it, the time and a bar of colours.

#include "core/text.hpp"
#include "hyperiso/render.hpp"
#include "mesh/attributes.hpp"
#include "render/camera.hpp"
#include "render/canvas.hpp"
#include "render/ray_cast.hpp"

#include <cstdio>
#include <new>

namespace hyperiso {
namespace {

constexpr Colour ink{34, 38, 46}, pale_ink{110, 116, 128}, edge_colour{196, 200, 208},
    curve_colour{42, 104, 168};

// A number for people, of at most four digits.
std::string short_number(double value) {
  char digits[32];
  std::snprintf(digits, sizeof digits, "%.4g", value);
  return digits;
}

// Sizes of text and lines follow the picture, down to what can be read.
double unit_of(const Canvas& canvas) {
  return std::max(0.7, std::min(canvas.width(), canvas.height()) / 720.0);
}

Place place_of(const std::array<double, 2>& pixel) { return {pixel[0], pixel[1]}; }

std::string name_of_axis(const RenderOptions& options, std::size_t axis) {
  return axis < options.axis_names.size() ? options.axis_names[axis] : std::string();
}

// The corner of the box that is nearest to the camera; bit k: the upper end of axis k.
unsigned nearest_corner(const Camera& camera) {
  unsigned corner = 0;
  for (unsigned k = 0; k < 3; ++k) corner |= (camera.back[k] > 0 ? 1u : 0u) << k;
  return corner;
}

// The edges that nothing in the box can be behind.
void draw_box(Canvas& canvas, const Camera& camera) {
  const unsigned nearest = nearest_corner(camera);
  for (unsigned from = 0; from < 8; ++from)
    for (unsigned axis = 0; axis < 3; ++axis) {
      const unsigned to = from | 1u << axis;
      if (to == from || from == nearest || to == nearest) continue;
      canvas.line(place_of(camera.pixel(camera.box_corner(from))),
                  place_of(camera.pixel(camera.box_corner(to))), edge_colour, unit_of(canvas));
    }
}

// Of the two edges along an axis that are on the outline, the lower one, or the left one of an axis that
// stands upright; its lower corner.
unsigned labelled_edge(const Camera& camera, unsigned axis) {
  const unsigned nearest = nearest_corner(camera);
  unsigned chosen = 8;
  double best = 0;
  for (unsigned corner = 0; corner < 8; ++corner) {
    if (corner >> axis & 1) continue;
    unsigned like_nearest = 0;
    for (unsigned other = 0; other < 3; ++other)
      if (other != axis) like_nearest += (corner >> other & 1) == (nearest >> other & 1);
    if (like_nearest != 1) continue;
    const auto a = camera.pixel(camera.box_corner(corner)),
               b = camera.pixel(camera.box_corner(corner | 1u << axis));
    const double merit = axis == 2 ? -(a[0] + b[0]) : a[1] + b[1];
    if (chosen == 8 || merit > best) chosen = corner, best = merit;
  }
  return chosen;
}

void label_axes(Canvas& canvas, const Camera& camera, const RenderOptions& options) {
  const double size = unit_of(canvas);
  const auto middle = camera.pixel({0, 0, 0});
  for (unsigned axis = 0; axis < 3; ++axis) {
    const unsigned corner = labelled_edge(camera, axis);
    const auto a = camera.pixel(camera.box_corner(corner)),
               b = camera.pixel(camera.box_corner(corner | 1u << axis));
    const double length = std::hypot(b[0] - a[0], b[1] - a[1]);
    if (length < 60 * size) continue; // seen end on
    // Away from the box, at right angles to the edge.
    Vector away{(b[1] - a[1]) / length, -(b[0] - a[0]) / length, 0};
    if (away[0] * (middle[0] - a[0]) + away[1] * (middle[1] - a[1]) > 0) away = {-away[0], -away[1], 0};
    const Align align = away[0] > 0.3 ? Align::left : away[0] < -0.3 ? Align::right : Align::centre;
    const auto write = [&](const std::string& words, double share, double distance, double height,
                           Colour colour) {
      canvas.text(words,
                  {a[0] + share * (b[0] - a[0]) + away[0] * distance * size,
                   a[1] + share * (b[1] - a[1]) + (away[1] * distance + 5) * size},
                  height * size, colour, align);
    };
    write(name_of_axis(options, axis), 0.5, 20, 16, ink);
    write(short_number(options.low[axis]), 0.06, 14, 13, pale_ink);
    write(short_number(options.high[axis]), 0.94, 14, 13, pale_ink);
  }
}

// The colour of a segment: of its vertices, of its track, or one for all.
Colour colour_of_segment(const Mesh& frame, std::size_t segment,
                         const std::optional<ColourChannels>& channels, const Attribute* tracks) {
  if (channels) {
    const auto mean = [&](const Attribute* channel) {
      return static_cast<std::uint8_t>((value_of(*channel, frame.simplices[2 * segment]) +
                                        value_of(*channel, frame.simplices[2 * segment + 1])) /
                                       2);
    };
    return {mean((*channels)[0]), mean((*channels)[1]), mean((*channels)[2])};
  }
  if (tracks && value_of(*tracks, segment) >= 0)
    return label_colour(static_cast<std::int64_t>(value_of(*tracks, segment)));
  return curve_colour;
}

// A frame in the plane: axis 0 to the right, axis 1 up, both to one scale.
void draw_curves(Canvas& canvas, const Mesh& frame, const RenderOptions& options) {
  const double size = unit_of(canvas);
  const double left = 90 * size, top = 90 * size;
  const double across = canvas.width() - left - (options.colour_bar ? 170 : 90) * size;
  const double down = canvas.height() - top - 80 * size;
  const double width = options.high[0] - options.low[0], height = options.high[1] - options.low[1];
  double scale = std::min(across / width, down / height);
  if (!std::isfinite(scale)) scale = width > 0 ? across / width : height > 0 ? down / height : 1;
  const Place corner{left + (across - scale * width) / 2, top + (down - scale * height) / 2};
  const auto place = [&](std::size_t vertex) {
    return Place{corner.x + scale * (frame.positions[2 * vertex] - options.low[0]),
                 corner.y + scale * (options.high[1] - frame.positions[2 * vertex + 1])};
  };
  canvas.frame(corner, scale * width, scale * height, edge_colour);
  const auto channels = vertex_colours(frame);
  const Attribute* tracks = track_of_simplices(frame);
  for (std::size_t segment = 0; segment < frame.simplex_count(); ++segment)
    canvas.line(place(frame.simplices[2 * segment]), place(frame.simplices[2 * segment + 1]),
                colour_of_segment(frame, segment, channels, tracks), 2 * size);

  const double right = corner.x + scale * width, bottom = corner.y + scale * height;
  canvas.text(short_number(options.low[0]), {corner.x, bottom + 20 * size}, 13 * size, pale_ink);
  canvas.text(short_number(options.high[0]), {right, bottom + 20 * size}, 13 * size, pale_ink, Align::right);
  canvas.text(name_of_axis(options, 0), {(corner.x + right) / 2, bottom + 24 * size}, 16 * size, ink,
              Align::centre);
  const double beside = corner.x - 8 * size;
  canvas.text(short_number(options.low[1]), {beside, bottom}, 13 * size, pale_ink, Align::right);
  canvas.text(short_number(options.high[1]), {beside, corner.y + 12 * size}, 13 * size, pale_ink,
              Align::right);
  canvas.text(name_of_axis(options, 1), {beside, (corner.y + bottom) / 2 + 5 * size}, 16 * size, ink,
              Align::right);
}

void draw_colour_bar(Canvas& canvas, const RenderOptions::ColourBar& bar) {
  const double size = unit_of(canvas);
  const double width = 16 * size, height = 260 * size;
  const Place corner{canvas.width() - 92 * size, (canvas.height() - height) / 2};
  constexpr int steps = 130;
  for (int step = 0; step < steps; ++step)
    canvas.rectangle({corner.x, corner.y + height * step / steps}, width, height / steps + 1,
                     viridis(1 - (step + 0.5) / steps));
  canvas.frame(corner, width, height, edge_colour);
  canvas.text(bar.name, {corner.x + width / 2, corner.y - 14 * size}, 16 * size, ink, Align::centre);
  for (const double share : {0.0, 0.5, 1.0})
    canvas.text(short_number(std::lerp(bar.range.low, bar.range.high, share)),
                {corner.x + width + 6 * size, corner.y + (1 - share) * height + 5 * size}, 13 * size,
                pale_ink);
}

Status check(const Mesh& frame, const RenderOptions& options) {
  const auto wrong = [](const auto&... pieces) { return Error{Code::invalid_argument, text(pieces...)}; };
  const bool surface = frame.dimension == 3 && frame.simplex_dimension == 2;
  if (!surface && !(frame.dimension == 2 && frame.simplex_dimension == 1))
    return wrong("a picture shows triangles in 3 dimensions or segments in 2, not ", frame.simplex_dimension,
                 "-simplices in ", frame.dimension);
  for (const int pixels : {options.width, options.height})
    if (pixels < 64 || pixels > 8192)
      return wrong("a picture of ", options.width, "x", options.height, " pixels: each is 64 to 8192");
  const auto D = static_cast<std::size_t>(frame.dimension);
  if (options.low.size() != D || options.high.size() != D)
    return wrong("the box of a picture has ", options.low.size(), " axes, the frame ", D);
  for (std::size_t k = 0; k < D; ++k)
    if (!std::isfinite(options.low[k]) || !std::isfinite(options.high[k]) || options.low[k] > options.high[k])
      return wrong("the box of a picture goes from ", options.low[k], " to ", options.high[k]);
  if (!std::isfinite(options.azimuth) || !(std::abs(options.elevation) <= 90))
    return wrong("a view from ", options.azimuth, ", ", options.elevation,
                 ": the elevation is from -90 to 90 degrees");
  return {};
}

} // namespace

Status check_rendering() { return {}; }

Result<Image> render(const Mesh& frame, const std::string& label, const RenderOptions& options) {
  if (const Status valid = check(frame, options); !valid) return valid.error();
  try {
    Canvas canvas(options.width, options.height);
    if (frame.dimension == 2) {
      draw_curves(canvas, frame, options);
    } else {
      const Camera camera(options);
      draw_box(canvas, camera);
      canvas.lay_over(cast_rays(frame, camera, options));
      label_axes(canvas, camera, options);
    }
    const double size = unit_of(canvas);
    canvas.text(label, {28 * size, 44 * size}, 24 * size, ink);
    canvas.text(options.title, {28 * size, 70 * size}, 16 * size, pale_ink);
    if (options.colour_bar) draw_colour_bar(canvas, *options.colour_bar);
    return canvas.image();
  } catch (const std::bad_alloc&) {
    return Error{Code::out_of_memory,
                 text("not enough memory for a picture of ", frame.simplex_count(), " simplices")};
  }
}

} // namespace hyperiso
