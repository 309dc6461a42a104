// Samples alone (.raw, .bin), and with NumPy's header (.npy, version 1).

#include "core/text.hpp"
#include "io/formats.hpp"
#include "io/npy_header.hpp"
#include "io/sample_runs.hpp"

#include <bit>
#include <cassert>

namespace hyperiso {

void write_raw(AtomicFile& file, const Field& field) {
  for_each_run(field, [&](std::span<const std::byte> run) { file.write(run.data(), run.size()); });
}

std::string npy_header(char kind, std::size_t bytes, std::span<const std::uint64_t> shape) {
  const char* order = bytes == 1 ? "|" : std::endian::native == std::endian::big ? ">" : "<";
  std::string counts;
  for (std::size_t axis = 0; axis < shape.size(); ++axis)
    counts += text(shape[axis], axis + 1 < shape.size() ? ", " : shape.size() == 1 ? "," : "");
  std::string dictionary =
      text("{'descr': '", order, kind, bytes, "', 'fortran_order': False, 'shape': (", counts, "), }");

  // Magic, version and length take 10 bytes; the samples must begin at a multiple of 64.
  constexpr std::size_t before = 10, alignment = 64;
  dictionary.append((alignment - (before + dictionary.size() + 1) % alignment) % alignment, ' ');
  dictionary += '\n';
  assert(dictionary.size() < 65536); // 16 axes of 20 digits are far from it
  std::string header("\x93NUMPY\x01\x00", 8);
  header += {static_cast<char>(dictionary.size() & 255), static_cast<char>(dictionary.size() >> 8)};
  return header + dictionary;
}

void write_npy(AtomicFile& file, const Field& field) {
  std::vector<std::uint64_t> shape;
  for (std::size_t axis = field.info.axes.size(); axis-- > 0;)
    shape.push_back(static_cast<std::uint64_t>(field.info.axes[axis].count));
  file.write(npy_header(name_of(field.info.type)[0], size_of(field.info.type), shape));
  write_raw(file, field);
}

} // namespace hyperiso
