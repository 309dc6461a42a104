#pragma once
// Files that are read, mapped into memory.

#include "hyperiso/result.hpp"

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <span>
#include <string_view>

namespace hyperiso {

// A regular, non-empty file, mapped as a whole: opening it costs nothing, and only the parts that are looked
// at are read from the disk. Must not be made shorter while it is open.
class InputFile {
 public:
  // Errors: file_not_found; file_unreadable (not a regular file, no permission); file_malformed if it is
  // empty.
  static Result<std::shared_ptr<const InputFile>> open(const std::filesystem::path& path);
  InputFile(const InputFile&) = delete;
  InputFile& operator=(const InputFile&) = delete;
  ~InputFile();

  const std::filesystem::path& path() const { return path_; }
  std::uint64_t size() const { return bytes_.size(); }
  std::span<const std::byte> bytes() const { return bytes_; }
  // Nobody will look at these bytes soon: the pages that hold nothing else need not stay in memory.
  void release(std::span<const std::byte> bytes) const;
  std::string_view characters() const {
    return {reinterpret_cast<const char*>(bytes_.data()), bytes_.size()};
  }

 private:
  InputFile(std::filesystem::path path, std::span<const std::byte> bytes)
      : path_(std::move(path)), bytes_(bytes) {}

  std::filesystem::path path_;
  std::span<const std::byte> bytes_;
};

} // namespace hyperiso
