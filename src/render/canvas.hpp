#pragma once
// A picture on which cairo draws lines and text.

#include "hyperiso/render.hpp"

#include <cairo.h>
#include <memory>

namespace hyperiso {

struct Place {
  double x, y; // pixels from the left and from the top
};

// What covers a pixel: the mean colour of it, 0 to 255, and its share of the pixel.
struct Shaded {
  std::array<double, 3> rgb{};
  double share = 0;
};

enum class Align { left, centre, right };

// Throws std::bad_alloc where cairo has no memory.
class Canvas {
 public:
  Canvas(int width, int height); // white

  void line(Place from, Place to, Colour colour, double thickness);
  void rectangle(Place corner, double width, double height, Colour colour); // filled
  void frame(Place corner, double width, double height, Colour colour);     // its outline
  void text(const std::string& words, Place at, double size, Colour colour, Align align = Align::left);

  void lay_over(const std::vector<Shaded>& pixels);

  int width() const { return width_; }
  int height() const { return height_; }
  Image image() const;

 private:
  void set(Colour colour);

  struct Destroy {
    void operator()(cairo_surface_t* surface) const { cairo_surface_destroy(surface); }
    void operator()(cairo_t* context) const { cairo_destroy(context); }
  };
  int width_, height_;
  std::unique_ptr<cairo_surface_t, Destroy> surface_;
  std::unique_ptr<cairo_t, Destroy> context_;
};

} // namespace hyperiso
