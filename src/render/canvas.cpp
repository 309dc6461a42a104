#include "render/canvas.hpp"

#include <cmath>
#include <cstring>
#include <new>

namespace hyperiso {

Canvas::Canvas(int width, int height)
    : width_(width), height_(height), surface_(cairo_image_surface_create(CAIRO_FORMAT_RGB24, width, height)),
      context_(cairo_create(surface_.get())) {
  if (cairo_status(context_.get()) != CAIRO_STATUS_SUCCESS) throw std::bad_alloc();
  rectangle({0, 0}, width, height, {255, 255, 255});
  cairo_select_font_face(context_.get(), "sans-serif", CAIRO_FONT_SLANT_NORMAL, CAIRO_FONT_WEIGHT_NORMAL);
  cairo_set_line_cap(context_.get(), CAIRO_LINE_CAP_ROUND);
}

void Canvas::set(Colour colour) {
  cairo_set_source_rgb(context_.get(), colour.red / 255.0, colour.green / 255.0, colour.blue / 255.0);
}

void Canvas::line(Place from, Place to, Colour colour, double thickness) {
  set(colour);
  cairo_set_line_width(context_.get(), thickness);
  cairo_move_to(context_.get(), from.x, from.y);
  cairo_line_to(context_.get(), to.x, to.y);
  cairo_stroke(context_.get());
}

void Canvas::rectangle(Place corner, double width, double height, Colour colour) {
  set(colour);
  cairo_rectangle(context_.get(), corner.x, corner.y, width, height);
  cairo_fill(context_.get());
}

void Canvas::frame(Place corner, double width, double height, Colour colour) {
  set(colour);
  cairo_set_line_width(context_.get(), 1);
  cairo_rectangle(context_.get(), corner.x, corner.y, width, height);
  cairo_stroke(context_.get());
}

void Canvas::text(const std::string& words, Place at, double size, Colour colour, Align align) {
  set(colour);
  cairo_set_font_size(context_.get(), size);
  cairo_text_extents_t extents;
  cairo_text_extents(context_.get(), words.c_str(), &extents);
  const double share = align == Align::left ? 0 : align == Align::centre ? 0.5 : 1;
  cairo_move_to(context_.get(), at.x - share * extents.x_advance, at.y);
  cairo_show_text(context_.get(), words.c_str());
  cairo_new_path(context_.get());
}

void Canvas::lay_over(const std::vector<Shaded>& pixels) {
  cairo_surface_flush(surface_.get());
  unsigned char* data = cairo_image_surface_get_data(surface_.get());
  const std::ptrdiff_t stride = cairo_image_surface_get_stride(surface_.get());
  const Shaded* shaded = pixels.data();
  for (int y = 0; y < height_; ++y)
    for (int x = 0; x < width_; ++x, ++shaded) {
      if (shaded->share == 0) continue;
      std::uint32_t pixel;
      std::memcpy(&pixel, data + y * stride + 4 * x, sizeof pixel);
      std::uint32_t mixed = 0;
      for (unsigned channel = 0; channel < 3; ++channel) {
        const unsigned shift = 16 - 8 * channel;
        const double value = std::lerp(double(pixel >> shift & 255), shaded->rgb[channel], shaded->share);
        mixed |= static_cast<std::uint32_t>(std::lround(value)) << shift;
      }
      std::memcpy(data + y * stride + 4 * x, &mixed, sizeof mixed);
    }
  cairo_surface_mark_dirty(surface_.get());
}

Image Canvas::image() const {
  cairo_surface_flush(surface_.get());
  Image image{width_, height_, {}};
  image.pixels.reserve(3 * static_cast<std::size_t>(width_) * static_cast<std::size_t>(height_));
  const unsigned char* data = cairo_image_surface_get_data(surface_.get());
  const std::ptrdiff_t stride = cairo_image_surface_get_stride(surface_.get());
  for (int y = 0; y < height_; ++y)
    for (int x = 0; x < width_; ++x) {
      std::uint32_t value;
      std::memcpy(&value, data + y * stride + 4 * x, sizeof value);
      for (const unsigned shift : {16u, 8u, 0u})
        image.pixels.push_back(static_cast<std::uint8_t>(value >> shift));
    }
  return image;
}

} // namespace hyperiso
