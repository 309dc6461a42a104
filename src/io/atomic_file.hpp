#pragma once
// Files that appear whole or not at all.

#include "hyperiso/io.hpp"

#include <cstdint>
#include <filesystem>
#include <functional>
#include <string_view>
#include <vector>

namespace hyperiso {

// Writes beside the target under the name .hyperiso-RANDOM.part and renames at `commit`; until then,
// and after any failure, what was at the target stays as it was. The temporary file is removed by the
// destructor, or by `remove_unfinished_files` (hyperiso/io.hpp) when a signal ends the program. A temporary
// name beside the target works on every file system; O_TMPFILE does not, and needs a name all the same to
// replace an existing file.
//
// A new file gets the permissions the umask allows, a replaced one keeps its own; a symbolic link stays, the
// file it leads to is replaced, or made. Pipes, devices and open descriptors (/dev/stdout, /dev/fd/N) have
// nothing to rename: they are written as they are.
class AtomicFile {
 public:
  // Error: file_unwritable, naming the target and the system's reason.
  static Result<AtomicFile> create(const std::filesystem::path& target);
  // A temporary file for what will be needed to write the target: beside it, or where the system keeps such
  // files if the target has no place in a folder. It is never committed. The same errors.
  static Result<AtomicFile> create_scratch(const std::filesystem::path& target);
  AtomicFile(AtomicFile&& other) noexcept;
  AtomicFile& operator=(AtomicFile&&) = delete;
  ~AtomicFile();

  // Buffered. A failure is kept and reported by `commit`; writing on after it does nothing.
  void write(const void* data, std::size_t bytes);
  void write(std::string_view characters) { write(characters.data(), characters.size()); }
  bool failed() const { return error_number_ != 0; }
  Status status() const; // the failure, as `commit` would report it
  const std::filesystem::path& target() const { return target_; }
  // Of the file that is written to, for another program to write it; nothing may have been written here.
  int descriptor() const { return descriptor_; }

  // Leaves room for `bytes` that are known later; `fill` writes them there. One gap at a time. In a file that
  // cannot seek, what follows the gap stays in memory until it is filled.
  void leave_gap(std::size_t bytes);
  void fill_gap(std::string_view bytes);

  // What was written so far to a temporary file. Error: file_unwritable. Throws std::bad_alloc.
  Result<Buffer> read_back();
  std::uint64_t written() const { return flushed_ + buffer_.size(); } // bytes

  // Is called every few hundred kilobytes, for who writes from pages that need not stay in memory.
  void set_on_flush(std::function<void()> on_flush) { on_flush_ = std::move(on_flush); }

  // Flushes to the device, closes and renames; with a group, the group does this, and the
  // file waits for it without a descriptor or a buffer. Error: file_unwritable. Call
  // once, last.
  Status commit(FileGroup* group = nullptr);

 private:
  explicit AtomicFile(std::filesystem::path target);
  void open_temporary();
  void open_in_place();
  void flush();
  void write_through(const char* data, std::size_t bytes);
  void sync();
  void close();
  friend class FileGroup;
  Status sync_closed(); // of a file that waits in a group
  Status take_place();
  Error error() const;

  std::filesystem::path target_;    // as the caller named it, for messages
  std::filesystem::path replaces_;  // what the rename replaces; empty when written in place
  std::filesystem::path temporary_; // empty when written in place
  UnfinishedFile* unfinished_ = nullptr;
  int descriptor_ = -1;
  int error_number_ = 0;
  std::vector<char> buffer_;
  bool has_gap_ = false;
  std::size_t gap_in_buffer_ = 0; // in place
  std::uint64_t gap_in_file_ = 0; // in a temporary file
  std::uint64_t flushed_ = 0;     // bytes
  std::function<void()> on_flush_;
};

// Of a writer that runs out of memory.
Error no_memory_to_write(const std::filesystem::path& target);

} // namespace hyperiso
