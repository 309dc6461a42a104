// Samples alone (.raw, .bin), and with NumPy's header (.npy, version 1).

#include "core/text.hpp"
#include "io/formats.hpp"
#include "io/sample_runs.hpp"

#include <bit>
#include <cassert>

namespace hyperiso {

void write_raw(AtomicFile& file, const Field& field) {
  for_each_run(field, [&](std::span<const std::byte> run) { file.write(run.data(), run.size()); });
}

void write_npy(AtomicFile& file, const Field& field) {
  const std::string type = name_of(field.info.type); // "f32"
  const std::size_t bytes = size_of(field.info.type);
  const char* order = bytes == 1 ? "|" : std::endian::native == std::endian::big ? ">" : "<";
  std::string shape;
  for (std::size_t axis = field.info.axes.size(); axis-- > 0;)
    shape += text(field.info.axes[axis].count, axis > 0 ? ", " : field.info.axes.size() == 1 ? "," : "");
  std::string header =
      text("{'descr': '", order, type[0], bytes, "', 'fortran_order': False, 'shape': (", shape, "), }");

  // Magic, version and length take 10 bytes; the samples must begin at a multiple of 64.
  constexpr std::size_t before = 10, alignment = 64;
  header.append((alignment - (before + header.size() + 1) % alignment) % alignment, ' ');
  header += '\n';
  assert(header.size() < 65536); // 16 axes of 20 digits are far from it
  file.write(std::string_view("\x93NUMPY\x01\x00", 8));
  const char length[] = {static_cast<char>(header.size() & 255), static_cast<char>(header.size() >> 8)};
  file.write(std::string_view(length, 2));
  file.write(header);
  write_raw(file, field);
}

} // namespace hyperiso
