// gzip and bzip2 streams, for byte_source.hpp.

#include "core/text.hpp"
#include "io/byte_source.hpp"

#include <algorithm>
#include <bzlib.h>
#include <utility>
#include <zlib.h>

namespace hyperiso {
namespace {

enum class Step { more, end_of_member, damaged, out_of_memory };

// The two libraries behind one face. `next` and `room` are input and output left.
class Gzip {
 public:
  static constexpr const char* name = "gzip";
  static constexpr unsigned char magic[] = {0x1f, 0x8b};
  // 15 + 16: the largest window, a gzip header and checksum.
  Gzip() : ready_(inflateInit2(&stream_, 15 + 16) == Z_OK) {}
  Gzip(const Gzip&) = delete;
  Gzip& operator=(const Gzip&) = delete;
  ~Gzip() { inflateEnd(&stream_); }
  bool ready() const { return ready_; }
  bool restart() { return inflateReset(&stream_) == Z_OK; }

  Step step(std::span<const std::byte>& next, std::span<std::byte>& room) {
    stream_.next_in = const_cast<Bytef*>(reinterpret_cast<const Bytef*>(next.data()));
    stream_.avail_in = static_cast<uInt>(std::min<std::size_t>(next.size(), 1u << 30));
    stream_.next_out = reinterpret_cast<Bytef*>(room.data());
    stream_.avail_out = static_cast<uInt>(std::min<std::size_t>(room.size(), 1u << 30));
    const int result = inflate(&stream_, Z_NO_FLUSH);
    next = next.subspan(
        static_cast<std::size_t>(reinterpret_cast<const std::byte*>(stream_.next_in) - next.data()));
    room =
        room.subspan(static_cast<std::size_t>(reinterpret_cast<std::byte*>(stream_.next_out) - room.data()));
    return result == Z_STREAM_END                    ? Step::end_of_member
           : result == Z_OK || result == Z_BUF_ERROR ? Step::more
           : result == Z_MEM_ERROR                   ? Step::out_of_memory
                                                     : Step::damaged;
  }

 private:
  z_stream stream_{};
  bool ready_;
};

class Bzip2 {
 public:
  static constexpr const char* name = "bzip2";
  static constexpr unsigned char magic[] = {'B', 'Z'};
  Bzip2() : ready_(start()) {}
  Bzip2(const Bzip2&) = delete;
  Bzip2& operator=(const Bzip2&) = delete;
  ~Bzip2() { BZ2_bzDecompressEnd(&stream_); }
  bool ready() const { return ready_; }
  bool restart() {
    BZ2_bzDecompressEnd(&stream_);
    stream_ = {};
    return start();
  }

  Step step(std::span<const std::byte>& next, std::span<std::byte>& room) {
    stream_.next_in = const_cast<char*>(reinterpret_cast<const char*>(next.data()));
    stream_.avail_in = static_cast<unsigned>(std::min<std::size_t>(next.size(), 1u << 30));
    stream_.next_out = reinterpret_cast<char*>(room.data());
    stream_.avail_out = static_cast<unsigned>(std::min<std::size_t>(room.size(), 1u << 30));
    const int result = BZ2_bzDecompress(&stream_);
    next = next.subspan(
        static_cast<std::size_t>(reinterpret_cast<const std::byte*>(stream_.next_in) - next.data()));
    room =
        room.subspan(static_cast<std::size_t>(reinterpret_cast<std::byte*>(stream_.next_out) - room.data()));
    return result == BZ_STREAM_END  ? Step::end_of_member
           : result == BZ_OK        ? Step::more
           : result == BZ_MEM_ERROR ? Step::out_of_memory
                                    : Step::damaged;
  }

 private:
  bool start() { return BZ2_bzDecompressInit(&stream_, 0, 0) == BZ_OK; }
  bz_stream stream_{};
  bool ready_;
};

// Members may follow one another, as `cat a.gz b.gz` makes them; anything else after a member is an error.
template <class Library>
class CompressedDecoder final : public Decoder {
 public:
  CompressedDecoder(std::shared_ptr<const InputFile> file, std::uint64_t offset)
      : file_(std::move(file)), next_(file_->bytes().subspan(offset)) {}
  bool ready() const { return library_.ready(); }

  Status decode(std::span<std::byte> out) override {
    while (!out.empty()) {
      if (at_end_of_member_) {
        if (next_.empty())
          return malformed("end before the samples do: the file is truncated or its sizes are wrong");
        if (Status status = start_next_member(); !status) return status;
      }
      if (Status status = step(out); !status) return status;
    }
    return {};
  }

  Status expect_end() override {
    while (true) {
      if (at_end_of_member_) {
        if (next_.empty()) return {};
        if (Status status = start_next_member(); !status) return status;
      }
      std::byte extra{};
      std::span<std::byte> room(&extra, 1);
      if (Status status = step(room); !status) return status;
      if (room.empty()) return malformed("hold more samples than the sizes say");
    }
  }

 private:
  Status step(std::span<std::byte>& out) {
    const std::size_t input = next_.size(), room = out.size();
    switch (library_.step(next_, out)) {
    case Step::more:
      if (next_.size() == input && out.size() == room) return malformed("are truncated");
      return {};
    case Step::end_of_member:
      at_end_of_member_ = true;
      return {};
    case Step::out_of_memory:
      return Error{Code::out_of_memory, text(file_->path().string(), ": no memory to decompress")};
    case Step::damaged:
      break;
    }
    return malformed("are damaged");
  }
  Status start_next_member() {
    const auto starts_with = [&](unsigned char c, std::size_t i) {
      return next_.size() > i && next_[i] == std::byte{c};
    };
    if (!starts_with(Library::magic[0], 0) || !starts_with(Library::magic[1], 1))
      return malformed(text("are followed by ", next_.size(), " bytes that do not belong to them"));
    if (!library_.restart())
      return Error{Code::out_of_memory, text(file_->path().string(), ": no memory to decompress")};
    at_end_of_member_ = false;
    return {};
  }
  Error malformed(std::string_view what) const {
    return {Code::file_malformed, text(file_->path().string(), ": the ", Library::name, " data ", what)};
  }

  std::shared_ptr<const InputFile> file_;
  std::span<const std::byte> next_;
  Library library_;
  bool at_end_of_member_ = false;
};

template <class Library>
Result<std::unique_ptr<Decoder>> open_with(std::shared_ptr<const InputFile> file, std::uint64_t offset) {
  const auto path = file->path();
  auto decoder = std::make_unique<CompressedDecoder<Library>>(std::move(file), offset);
  if (!decoder->ready()) return Error{Code::out_of_memory, text(path.string(), ": no memory to decompress")};
  return std::unique_ptr<Decoder>(std::move(decoder));
}

} // namespace

Result<std::unique_ptr<Decoder>>
open_compressed(Compression compression, std::shared_ptr<const InputFile> file, std::uint64_t offset) {
  return compression == Compression::gzip ? open_with<Gzip>(std::move(file), offset)
                                          : open_with<Bzip2>(std::move(file), offset);
}

// Deflate copies at most 258 bytes for 2 bits of input (zlib's documentation: 1032 : 1). bzip2 has no such
// figure; a file of 45 million equal bytes, a full block of 900,000 after its run-length code, takes 46
// bytes.
std::uint64_t largest_expansion(Compression compression) {
  return compression == Compression::gzip ? 1032 : 1'500'000;
}

} // namespace hyperiso
