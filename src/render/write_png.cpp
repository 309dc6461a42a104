#include "hyperiso/render.hpp"
#include "io/atomic_file.hpp"

#include <cairo.h>
#include <cstring>
#include <memory>
#include <new>

namespace hyperiso {
namespace {

struct Destroy {
  void operator()(cairo_surface_t* surface) const { cairo_surface_destroy(surface); }
};

cairo_status_t write_part(void* file, const unsigned char* data, unsigned length) {
  static_cast<AtomicFile*>(file)->write(data, length);
  return CAIRO_STATUS_SUCCESS; // the file keeps its failure
}

} // namespace

Status write_png(const Image& image, const std::filesystem::path& path, FileGroup* group) {
  try {
    const std::unique_ptr<cairo_surface_t, Destroy> surface(
        cairo_image_surface_create(CAIRO_FORMAT_RGB24, image.width, image.height));
    if (cairo_surface_status(surface.get()) != CAIRO_STATUS_SUCCESS) return no_memory_to_write(path);
    unsigned char* data = cairo_image_surface_get_data(surface.get());
    const std::ptrdiff_t stride = cairo_image_surface_get_stride(surface.get());
    const std::uint8_t* pixel = image.pixels.data();
    for (int y = 0; y < image.height; ++y)
      for (int x = 0; x < image.width; ++x, pixel += 3) {
        const std::uint32_t value = std::uint32_t{pixel[0]} << 16 | std::uint32_t{pixel[1]} << 8 | pixel[2];
        std::memcpy(data + y * stride + 4 * x, &value, sizeof value);
      }
    cairo_surface_mark_dirty(surface.get());
    auto file = AtomicFile::create(path);
    if (!file) return file.error();
    if (cairo_surface_write_to_png_stream(surface.get(), write_part, &*file) != CAIRO_STATUS_SUCCESS)
      return no_memory_to_write(path);
    return file->commit(group);
  } catch (const std::bad_alloc&) {
    return no_memory_to_write(path);
  }
}

} // namespace hyperiso
