#include "io/byte_source.hpp"

#include <algorithm>
#include <array>
#include <cstring>
#include <utility>

namespace hyperiso {
namespace {

class PlainSource final : public ByteSource {
 public:
  PlainSource(std::shared_ptr<const InputFile> file, std::uint64_t offset)
      : file_(std::move(file)), offset_(offset) {}
  Status read(std::uint64_t offset, std::span<std::byte> out) override {
    std::memcpy(out.data(), file_->bytes().data() + offset_ + offset, out.size());
    return {};
  }
  // Steps that nobody holds any more do not stay in memory.
  std::shared_ptr<const std::byte> in_place(std::uint64_t offset, std::uint64_t bytes) override {
    return {file_->bytes().data() + offset_ + offset, [file = file_, bytes](const std::byte* first) {
              file->release({first, bytes});
            }};
  }

 private:
  std::shared_ptr<const InputFile> file_;
  std::uint64_t offset_;
};

class StreamSource final : public ByteSource {
 public:
  StreamSource(std::function<Result<std::unique_ptr<Decoder>>()> start, std::uint64_t skip,
               std::uint64_t size, bool may_continue)
      : start_(std::move(start)), skip_(skip), end_(skip + size), may_continue_(may_continue) {}

  Status read(std::uint64_t offset, std::span<std::byte> out) override {
    const std::uint64_t begin = skip_ + offset;
    if (!decoder_ || begin < position_) {
      auto decoder = start_();
      if (!decoder) return decoder.error();
      decoder_ = std::move(*decoder);
      position_ = 0;
    }
    Status status = skip_to(begin);
    if (status) status = advance(out);
    if (status && position_ == end_ && !may_continue_) status = decoder_->expect_end();
    if (!status) decoder_.reset(); // a decoder that failed cannot go on
    return status;
  }
  bool sequential() const override { return true; }

 private:
  Status advance(std::span<std::byte> out) {
    Status status = decoder_->decode(out);
    position_ += out.size();
    return status;
  }
  Status skip_to(std::uint64_t position) {
    std::array<std::byte, 1 << 15> scratch;
    while (position_ < position) {
      const auto bytes = std::min<std::uint64_t>(position - position_, scratch.size());
      if (Status status = advance(std::span(scratch).first(bytes)); !status) return status;
    }
    return {};
  }

  std::function<Result<std::unique_ptr<Decoder>>()> start_;
  std::unique_ptr<Decoder> decoder_;
  std::uint64_t position_ = 0;
  std::uint64_t skip_, end_;
  bool may_continue_;
};

class JoinedSource final : public ByteSource {
 public:
  JoinedSource(std::function<Result<std::unique_ptr<ByteSource>>(std::uint64_t)> open,
               std::uint64_t part_bytes)
      : open_(std::move(open)), part_bytes_(part_bytes) {}

  Status read(std::uint64_t offset, std::span<std::byte> out) override {
    while (!out.empty()) {
      if (Status status = turn_to(offset / part_bytes_); !status) return status;
      const std::uint64_t begin = offset % part_bytes_;
      const auto bytes = std::min<std::uint64_t>(out.size(), part_bytes_ - begin);
      if (Status status = source_->read(begin, out.first(bytes)); !status) return status;
      out = out.subspan(bytes);
      offset += bytes;
    }
    return {};
  }
  std::shared_ptr<const std::byte> in_place(std::uint64_t offset, std::uint64_t bytes) override {
    const bool within_one = bytes > 0 && offset / part_bytes_ == (offset + bytes - 1) / part_bytes_;
    if (!within_one || !turn_to(offset / part_bytes_)) return nullptr;
    return source_->in_place(offset % part_bytes_, bytes);
  }

 private:
  Status turn_to(std::uint64_t part) {
    if (source_ && part == part_) return {};
    auto source = open_(part);
    if (!source) return source.error();
    source_ = std::move(*source);
    part_ = part;
    return {};
  }

  std::function<Result<std::unique_ptr<ByteSource>>(std::uint64_t)> open_;
  std::uint64_t part_bytes_;
  std::unique_ptr<ByteSource> source_;
  std::uint64_t part_ = 0;
};

} // namespace

std::unique_ptr<ByteSource> plain_source(std::shared_ptr<const InputFile> file, std::uint64_t offset) {
  return std::make_unique<PlainSource>(std::move(file), offset);
}

std::unique_ptr<ByteSource> stream_source(std::function<Result<std::unique_ptr<Decoder>>()> start,
                                          std::uint64_t skip, std::uint64_t size, bool may_continue) {
  return std::make_unique<StreamSource>(std::move(start), skip, size, may_continue);
}

std::unique_ptr<ByteSource>
joined_source(std::function<Result<std::unique_ptr<ByteSource>>(std::uint64_t part)> open,
              std::uint64_t part_bytes) {
  return std::make_unique<JoinedSource>(std::move(open), part_bytes);
}

} // namespace hyperiso
