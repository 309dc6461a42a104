#include "view/deflate.hpp"

#include <zlib.h>

#include <new>

namespace hyperiso {

std::vector<unsigned char> deflated(std::span<const unsigned char> bytes) {
  z_stream stream{};
  constexpr int raw = -15, memory_level = 9, compression_level = 6;
  if (deflateInit2(&stream, compression_level, Z_DEFLATED, raw, memory_level, Z_DEFAULT_STRATEGY) != Z_OK)
    throw std::bad_alloc();
  std::vector<unsigned char> result(deflateBound(&stream, bytes.size()));
  stream.next_in = const_cast<unsigned char*>(bytes.data());
  stream.avail_in = static_cast<uInt>(bytes.size());
  stream.next_out = result.data();
  stream.avail_out = static_cast<uInt>(result.size());
  deflate(&stream, Z_FINISH);
  result.resize(stream.total_out);
  deflateEnd(&stream);
  return result;
}

} // namespace hyperiso
