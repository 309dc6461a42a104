#pragma once
// Bytes as the text that VTK's XML files hold.

#include "io/atomic_file.hpp"

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace hyperiso {

// `text` as the value of an XML attribute in double quotes. Control characters that XML cannot hold become _.
std::string xml_escaped(std::string_view text);

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

// Bytes of base64 text, blanks between its digits allowed. A padded text may be followed by another.
class Base64Decoder {
 public:
  // Takes from the front of `text` what the next `bytes` bytes need and returns how many it decoded: fewer
  // if the text ends or holds something else.
  std::size_t decode(std::string_view& text, unsigned char* destination, std::size_t bytes);

 private:
  bool decode_group(std::string_view& text);

  unsigned char decoded_[3]{};
  std::size_t begin_ = 0, end_ = 0; // of what is decoded and not yet taken
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
