#include "io/atomic_file.hpp"

#include "core/text.hpp"
#include "hyperiso/io.hpp"

#include <atomic>
#include <cerrno>
#include <charconv>
#include <csignal>
#include <cstring>
#include <fcntl.h>
#include <optional>
#include <random>
#include <string>
#include <sys/stat.h>
#include <unistd.h>

namespace hyperiso {

// The temporary files of this process and the folders made for them, for a signal handler to remove. Entries
// are added and reused, never freed, so that a handler can walk the list at any moment. A name changes only
// while its entry is `busy`, and a handler reads it only after taking the entry for good: it never sees a
// name that is being replaced.
struct UnfinishedFile {
  enum State { free, busy, live, taken };
  std::atomic<State> state{busy};
  std::string name;
  bool is_folder = false;
  UnfinishedFile* next = nullptr;
};

namespace {

std::atomic<UnfinishedFile*> unfinished_files{nullptr};
static_assert(decltype(unfinished_files)::is_always_lock_free);
static_assert(decltype(UnfinishedFile::state)::is_always_lock_free);

bool change_state(UnfinishedFile* entry, UnfinishedFile::State from, UnfinishedFile::State to) {
  return entry->state.compare_exchange_strong(from, to);
}

UnfinishedFile* register_unfinished(const std::filesystem::path& file, bool is_folder = false) {
  UnfinishedFile* entry = unfinished_files.load();
  while (entry && !change_state(entry, UnfinishedFile::free, UnfinishedFile::busy)) entry = entry->next;
  if (!entry) {
    entry = new UnfinishedFile;
    entry->next = unfinished_files.load();
    while (!unfinished_files.compare_exchange_weak(entry->next, entry)) {
    }
  }
  entry->name = file.string();
  entry->is_folder = is_folder;
  entry->state = UnfinishedFile::live;
  return entry;
}

void forget_unfinished(UnfinishedFile* entry) {
  change_state(entry, UnfinishedFile::live, UnfinishedFile::free);
}

constexpr std::size_t buffer_size = std::size_t{1} << 18;

// Opening /dev/stdout anew would write at the start of a file that the shell opened for appending, and fails
// for sockets; the descriptor itself is what is meant.
std::optional<int> descriptor_named(const std::string& path) {
  if (path == "/dev/stdout") return STDOUT_FILENO;
  if (path == "/dev/stderr") return STDERR_FILENO;
  for (const std::string_view folder : {"/dev/fd/", "/proc/self/fd/"}) {
    if (!path.starts_with(folder)) continue;
    int number = 0;
    const char* end = path.data() + path.size();
    const auto [stop, problem] = std::from_chars(path.data() + folder.size(), end, number);
    if (problem == std::errc{} && stop == end) return number;
  }
  return std::nullopt;
}

// What a symbolic link leads to in the end, there or not; nothing if it leads in circles.
std::optional<std::filesystem::path> followed(std::filesystem::path path) {
  constexpr int most_links = 40; // as Linux
  std::error_code failure;
  for (int links = 0; std::filesystem::is_symlink(std::filesystem::symlink_status(path, failure)); ++links) {
    if (links == most_links) return std::nullopt;
    path = path.parent_path() / std::filesystem::read_symlink(path, failure);
  }
  return path;
}

int open_retrying(const char* path, int flags, mode_t mode = 0) {
  int descriptor;
  do descriptor = ::open(path, flags | O_CLOEXEC, mode);
  while (descriptor < 0 && errno == EINTR);
  return descriptor;
}

} // namespace

void remove_unfinished_files() noexcept {
  const int saved = errno;
  for (UnfinishedFile* entry = unfinished_files.load(); entry; entry = entry->next)
    if (change_state(entry, UnfinishedFile::live, UnfinishedFile::taken) && !entry->is_folder)
      ::unlink(entry->name.c_str());
  for (bool removed = true; removed;) { // inner folders before outer ones
    removed = false;
    for (UnfinishedFile* entry = unfinished_files.load(); entry; entry = entry->next)
      removed |=
          entry->state == UnfinishedFile::taken && entry->is_folder && ::rmdir(entry->name.c_str()) == 0;
  }
  errno = saved;
}

AtomicFile::AtomicFile(std::filesystem::path target) : target_(std::move(target)) {
  buffer_.reserve(buffer_size);
}

AtomicFile::AtomicFile(AtomicFile&& other) noexcept
    : target_(std::move(other.target_)), replaces_(std::move(other.replaces_)),
      temporary_(std::move(other.temporary_)), unfinished_(std::exchange(other.unfinished_, nullptr)),
      descriptor_(std::exchange(other.descriptor_, -1)), error_number_(other.error_number_),
      buffer_(std::move(other.buffer_)), has_gap_(other.has_gap_), gap_in_buffer_(other.gap_in_buffer_),
      gap_in_file_(other.gap_in_file_), flushed_(other.flushed_), on_flush_(std::move(other.on_flush_)) {}

AtomicFile::~AtomicFile() {
  if (descriptor_ >= 0) ::close(descriptor_);
  if (!unfinished_) return;
  ::unlink(temporary_.c_str());
  forget_unfinished(unfinished_);
}

Result<AtomicFile> AtomicFile::create(const std::filesystem::path& target) {
  AtomicFile file(target);
  struct stat there {};
  const bool exists = ::stat(target.c_str(), &there) == 0;
  if (exists && S_ISDIR(there.st_mode))
    file.error_number_ = EISDIR;
  else if (descriptor_named(target) || (exists && !S_ISREG(there.st_mode)))
    file.open_in_place();
  else if (exists && ::access(target.c_str(), W_OK) != 0)
    file.error_number_ = errno; // a rename would replace even a file that is marked read-only
  else
    file.open_temporary();
  if (!file.failed() && exists && !file.temporary_.empty() &&
      ::fchmod(file.descriptor_, there.st_mode & 07777) != 0)
    file.error_number_ = errno;
  if (file.failed()) return file.error();
  return file;
}

Result<AtomicFile> AtomicFile::create_scratch(const std::filesystem::path& target) {
  struct stat there {};
  const bool in_place =
      descriptor_named(target) || (::stat(target.c_str(), &there) == 0 && !S_ISREG(there.st_mode));
  if (!in_place) return create(target);
  std::error_code none;
  auto file = create(std::filesystem::temp_directory_path(none) / "hyperiso");
  if (file) file->target_ = target;
  return file;
}

void AtomicFile::open_in_place() {
  const auto named = descriptor_named(target_);
  descriptor_ =
      named ? ::fcntl(*named, F_DUPFD_CLOEXEC, 0) : open_retrying(target_.c_str(), O_WRONLY | O_NOCTTY);
  if (descriptor_ < 0) error_number_ = errno;
}

void AtomicFile::open_temporary() {
  if (const auto end = followed(target_)) {
    replaces_ = *end;
  } else {
    error_number_ = ELOOP;
    return;
  }
  if (!replaces_.has_filename()) {
    error_number_ = EISDIR;
    return;
  }
  std::random_device random; // no other process, on this machine or another, may pick the same name
  temporary_ = replaces_.parent_path() / text(".hyperiso-", std::hex, random(), random(), ".part");
  unfinished_ = register_unfinished(temporary_); // before it exists: a signal finds it at any moment
  descriptor_ = open_retrying(temporary_.c_str(), O_RDWR | O_CREAT | O_EXCL, 0666);
  if (descriptor_ < 0) error_number_ = errno;
}

void AtomicFile::write(const void* data, std::size_t bytes) {
  if (failed()) return;
  const auto* characters = static_cast<const char*>(data);
  const bool holds_back = has_gap_ && temporary_.empty();
  if (!holds_back && buffer_.size() + bytes > buffer_size) flush();
  if (!holds_back && bytes >= buffer_size)
    write_through(characters, bytes);
  else
    buffer_.insert(buffer_.end(), characters, characters + bytes);
}

void AtomicFile::leave_gap(std::size_t bytes) {
  if (failed()) return;
  flush();
  has_gap_ = true;
  gap_in_buffer_ = buffer_.size();
  gap_in_file_ = flushed_;
  buffer_.insert(buffer_.end(), bytes, ' ');
}

void AtomicFile::fill_gap(std::string_view bytes) {
  if (failed()) return;
  has_gap_ = false;
  if (temporary_.empty()) {
    std::memcpy(buffer_.data() + gap_in_buffer_, bytes.data(), bytes.size());
    flush();
    return;
  }
  flush();
  if (failed()) return;
  if (::lseek(descriptor_, static_cast<off_t>(gap_in_file_), SEEK_SET) < 0) error_number_ = errno;
  const std::uint64_t end = flushed_;
  write_through(bytes.data(), bytes.size());
  flushed_ = end;
  if (!failed() && ::lseek(descriptor_, 0, SEEK_END) < 0) error_number_ = errno;
}

Result<Buffer> AtomicFile::read_back() {
  flush();
  if (failed()) return error();
  return Buffer::of_file(descriptor_, static_cast<std::size_t>(flushed_));
}

void AtomicFile::flush() {
  write_through(buffer_.data(), buffer_.size());
  buffer_.clear();
  if (on_flush_) on_flush_();
}

void AtomicFile::write_through(const char* data, std::size_t bytes) {
  while (bytes > 0 && !failed()) {
    const ssize_t written = ::write(descriptor_, data, bytes);
    if (written < 0) {
      if (errno != EINTR) error_number_ = errno;
      continue;
    }
    data += written;
    bytes -= static_cast<std::size_t>(written);
    flushed_ += static_cast<std::uint64_t>(written);
  }
}

// Some file systems only learn at this point that there is no room.
void AtomicFile::sync() {
  if (!failed() && !temporary_.empty() && ::fsync(descriptor_) != 0 && errno != EINVAL) error_number_ = errno;
}

void AtomicFile::close() {
  if (descriptor_ < 0) return;
  const int closed = ::close(std::exchange(descriptor_, -1));
  if (!failed() && closed != 0 && errno != EINTR) error_number_ = errno;
}

Status AtomicFile::commit(FileGroup* group) {
  flush();
  buffer_ = {};
  if (!group) sync();
  close();
  if (!failed() && group) {
    group->files_.push_back(std::move(*this));
    return {};
  }
  return take_place();
}

Status AtomicFile::sync_closed() {
  if (temporary_.empty()) return {};
  descriptor_ = open_retrying(temporary_.c_str(), O_RDONLY);
  if (descriptor_ < 0) {
    error_number_ = errno;
    return error();
  }
  sync();
  close();
  return status();
}

Status AtomicFile::take_place() {
  if (!failed() && unfinished_) {
    if (::rename(temporary_.c_str(), replaces_.c_str()) == 0)
      forget_unfinished(std::exchange(unfinished_, nullptr));
    else
      error_number_ = errno;
  }
  if (failed()) return error();
  return {};
}

Status AtomicFile::status() const {
  if (failed()) return error();
  return {};
}

Error AtomicFile::error() const {
  std::error_code failure;
  const std::filesystem::path folder = replaces_.parent_path();
  const bool has_folder = folder.empty() || std::filesystem::exists(folder, failure);
  return Error{Code::file_unwritable,
               error_number_ == ENOENT && !has_folder
                   ? text("cannot write ", target_.string(), ": there is no folder ", folder.string())
                   : text("cannot write ", target_.string(), ": ", std::strerror(error_number_))};
}

namespace {

// What ends a program comes while no file, or every file, has its place.
class SignalsWait {
 public:
  SignalsWait() {
    sigset_t all;
    ::sigfillset(&all);
    ::pthread_sigmask(SIG_SETMASK, &all, &before_);
  }
  SignalsWait(const SignalsWait&) = delete;
  ~SignalsWait() { ::pthread_sigmask(SIG_SETMASK, &before_, nullptr); }

 private:
  sigset_t before_;
};

} // namespace

Error no_memory_to_write(const std::filesystem::path& target) {
  return {Code::out_of_memory, text("no memory to write ", target.string())};
}

FileGroup::FileGroup() = default;
FileGroup::FileGroup(FileGroup&&) noexcept = default;
FileGroup::~FileGroup() {
  files_.clear();
  remove_folders();
}

void FileGroup::remove_folders() {
  for (; !folders_.empty(); folders_.pop_back()) {
    ::rmdir(folders_.back()->name.c_str());
    forget_unfinished(folders_.back());
  }
}

Status FileGroup::make_folder(const std::filesystem::path& folder) {
  if (folder.empty()) return {}; // where the program runs
  const auto exists = [&] {
    std::error_code failure;
    return std::filesystem::is_directory(folder, failure);
  };
  if (exists()) return {};
  const Status around = make_folder(folder.parent_path());
  if (!around || exists()) return around; // a/ and a/. once there is a
  folders_.push_back(register_unfinished(folder, true));
  if (::mkdir(folder.c_str(), 0777) == 0) return {};
  const int error_number = errno;
  forget_unfinished(folders_.back());
  folders_.pop_back();
  return Error{Code::file_unwritable,
               text("cannot make the folder ", folder.string(), ": ", std::strerror(error_number))};
}

std::vector<std::filesystem::path> FileGroup::files() const {
  std::vector<std::filesystem::path> files;
  for (const AtomicFile& file : files_) files.push_back(file.target());
  return files;
}

Status FileGroup::commit() {
  const SignalsWait all_of_them;
  for (AtomicFile& file : files_) // all at once: the first often takes the others along to the device
    if (const Status synced = file.sync_closed(); !synced) return synced;
  for (AtomicFile& file : files_)
    if (const Status placed = file.take_place(); !placed) return placed;
  for (UnfinishedFile* folder : std::exchange(folders_, {})) forget_unfinished(folder);
  return {};
}

} // namespace hyperiso
