#pragma once
// The samples of a field as one sequence of bytes, wherever and however they are stored.

#include "hyperiso/field.hpp"
#include "hyperiso/result.hpp"
#include "io/input_file.hpp"

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <string_view>

namespace hyperiso {

class ByteSource {
 public:
  virtual ~ByteSource() = default;
  // Fills `out` with the bytes from `offset` on. Requires that they lie within the size the source was made
  // with. Errors: file_malformed, naming the file.
  virtual Status read(std::uint64_t offset, std::span<std::byte> out) = 0;
  // The same bytes where they lie, or nothing if they do not lie in memory as they are.
  virtual std::shared_ptr<const std::byte> in_place(std::uint64_t offset, std::uint64_t bytes) {
    return (void)offset, (void)bytes, nullptr;
  }
  // Going back to earlier bytes costs as much as starting again.
  virtual bool sequential() const { return false; }
};

// The bytes of `file` from `offset` on.
std::unique_ptr<ByteSource> plain_source(std::shared_ptr<const InputFile> file, std::uint64_t offset);

// A stream that can only be decoded from its beginning.
class Decoder {
 public:
  virtual ~Decoder() = default;
  // Fills `out`, or says what is wrong with the stream.
  virtual Status decode(std::span<std::byte> out) = 0;
  // An error if the stream holds more.
  virtual Status expect_end() = 0;
};

// `size` bytes of a stream, after the first `skip`. `start` opens the stream from its beginning. Reading the
// last byte also checks that the stream ends there, unless `may_continue`.
std::unique_ptr<ByteSource> stream_source(std::function<Result<std::unique_ptr<Decoder>>()> start,
                                          std::uint64_t skip, std::uint64_t size, bool may_continue = false);

enum class Compression { gzip, bzip2 };
// Decodes the members of a gzip or bzip2 file, from `offset` on.
Result<std::unique_ptr<Decoder>> open_compressed(Compression compression,
                                                 std::shared_ptr<const InputFile> file, std::uint64_t offset);
// Most bytes that one compressed byte can stand for, rounded up: a header that promises more is wrong.
std::uint64_t largest_expansion(Compression compression);

// Decimal numbers, separated by white space or commas, to samples of `type`. `owner` keeps `characters`.
std::unique_ptr<Decoder> text_decoder(std::shared_ptr<const void> owner, std::string_view characters,
                                      SampleType type, std::string file_name);
// Two hexadecimal digits a byte; white space is skipped.
std::unique_ptr<Decoder> hex_decoder(std::shared_ptr<const InputFile> file, std::uint64_t offset);

// Sources of `part_bytes` each, one after the other; `open` is called for a part when it is needed, and the
// part used last stays open.
std::unique_ptr<ByteSource>
joined_source(std::function<Result<std::unique_ptr<ByteSource>>(std::uint64_t part)> open,
              std::uint64_t part_bytes);

} // namespace hyperiso
