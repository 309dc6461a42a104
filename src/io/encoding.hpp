#pragma once
// Bytes as the text that VTK's XML files hold.

#include "io/atomic_file.hpp"

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace hyperiso {

// Base64 (RFC 4648) of bytes that come in pieces.
class Base64Encoder {
 public:
  // Appends to `text` what the bytes so far determine.
  void append(std::span<const unsigned char> bytes, std::string& text);
  // Appends the rest, padded with `=`, and starts anew.
  void finish(std::string& text);

 private:
  unsigned char pending_[3]{};
  std::size_t pending_count_ = 0;
};

// The content of one <DataArray format="binary"> of a file with compressor="vtkZLibDataCompressor" and
// header_type="UInt64": the base64 of the numbers (blocks, bytes per block, bytes of the last block if it is
// shorter, compressed bytes of each block), followed by the base64 of the compressed blocks. Little endian.
//
// Holds one block of the data at a time; the header goes into a gap of the file.
class CompressedArrayWriter {
 public:
  // `bytes` is the size of the whole array.
  CompressedArrayWriter(AtomicFile& file, std::uint64_t bytes);
  void append(const void* data, std::size_t bytes);
  // Requires that `append` has been given exactly the announced number of bytes.
  void finish();

 private:
  void compress_block(const unsigned char* block, std::size_t bytes);

  AtomicFile& file_;
  std::vector<std::uint64_t> header_;
  std::vector<unsigned char> block_;
  std::vector<unsigned char> compressed_;
  Base64Encoder encoder_;
  std::string text_;
};

} // namespace hyperiso
