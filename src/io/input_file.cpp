#include "io/input_file.hpp"

#include "core/text.hpp"

#include <cerrno>
#include <fcntl.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <system_error>
#include <unistd.h>

namespace hyperiso {
namespace {

Error system_error(const std::filesystem::path& path, int number) {
  if (number == ENOENT || number == ENOTDIR)
    return {Code::file_not_found, text(path.string(), ": there is no such file")};
  return {Code::file_unreadable,
          text(path.string(), ": cannot be read: ", std::generic_category().message(number))};
}

struct Descriptor {
  int number;
  ~Descriptor() {
    if (number >= 0) close(number);
  }
};

} // namespace

Result<std::shared_ptr<const InputFile>> InputFile::open(const std::filesystem::path& path) {
  // Not blocking: opening a pipe nobody writes to would wait for ever.
  const Descriptor descriptor{::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK)};
  if (descriptor.number < 0) return system_error(path, errno);
  struct stat status {};
  if (fstat(descriptor.number, &status) != 0) return system_error(path, errno);
  if (S_ISDIR(status.st_mode))
    return Error{Code::file_unreadable, text(path.string(), ": is a folder, not a file")};
  if (!S_ISREG(status.st_mode))
    return Error{Code::file_unreadable,
                 text(path.string(), ": is not a regular file; save its content to one first")};
  if (status.st_size == 0) return Error{Code::file_malformed, text(path.string(), ": the file is empty")};
  const auto size = static_cast<std::size_t>(status.st_size);
  void* data = mmap(nullptr, size, PROT_READ, MAP_SHARED, descriptor.number, 0);
  if (data == MAP_FAILED) return system_error(path, errno);
  return std::shared_ptr<const InputFile>(new InputFile(path, {static_cast<const std::byte*>(data), size}));
}

void InputFile::release(std::span<const std::byte> bytes) const {
  const auto page = static_cast<std::uintptr_t>(sysconf(_SC_PAGESIZE));
  const auto begin = (reinterpret_cast<std::uintptr_t>(bytes.data()) + page - 1) / page * page;
  const auto end = reinterpret_cast<std::uintptr_t>(bytes.data() + bytes.size()) / page * page;
  if (begin < end)
    madvise(reinterpret_cast<void*>(begin), end - begin, MADV_DONTNEED); // read again if needed
}

InputFile::~InputFile() { munmap(const_cast<std::byte*>(bytes_.data()), bytes_.size()); }

} // namespace hyperiso
