// The files underneath every format: outputs that appear whole or not at all, and VTK's array encoding.

#include "hyperiso/io.hpp"
#include "io/atomic_file.hpp"
#include "io/encoding.hpp"
#include "temporary_folder.hpp"

#include <csignal>
#include <cstring>
#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <thread>
#include <unistd.h>

using namespace hyperiso;
namespace fs = std::filesystem;

namespace {

std::string noise(std::size_t bytes) {
  std::string text(bytes, '\0');
  std::uint32_t state = 1;
  for (char& c : text) c = static_cast<char>((state = state * 1664525 + 1013904223) >> 24);
  return text;
}

Status write_file(const fs::path& path, std::string_view content) {
  auto file = AtomicFile::create(path);
  if (!file) return file.error();
  file->write(content);
  return file->commit();
}

void expect_unwritable(const Status& status, const fs::path& path, int error_number) {
  ASSERT_FALSE(status);
  EXPECT_EQ(status.error().code, Code::file_unwritable);
  EXPECT_NE(status.error().message.find(path.string()), std::string::npos) << status.error().message;
  EXPECT_NE(status.error().message.find(std::strerror(error_number)), std::string::npos)
      << status.error().message;
}

} // namespace

TEST(AtomicFile, appears_whole_at_commit_and_leaves_nothing_else) {
  const TemporaryFolder folder;
  const std::string content = noise(1'000'003);
  auto file = AtomicFile::create(folder / "a");
  ASSERT_TRUE(file);
  for (std::size_t start = 0, size = 1; start < content.size(); start += size, size = size * 3 + 1)
    file->write(std::string_view(content).substr(start, size));
  EXPECT_FALSE(fs::exists(folder / "a"));
  ASSERT_TRUE(file->commit());
  EXPECT_EQ(content_of(folder / "a"), content);
  EXPECT_EQ(folder.names(), std::vector<std::string>{"a"});
}

TEST(AtomicFile, existing_target_stays_when_a_write_is_given_up) {
  const TemporaryFolder folder;
  ASSERT_TRUE(write_file(folder / "a", "old"));
  {
    auto file = AtomicFile::create(folder / "a");
    ASSERT_TRUE(file);
    file->write(noise(500'000));
  }
  EXPECT_EQ(content_of(folder / "a"), "old");
  EXPECT_EQ(folder.names(), std::vector<std::string>{"a"});
}

TEST(AtomicFile, existing_target_stays_when_the_disk_is_full) {
  const TemporaryFolder folder;
  ASSERT_TRUE(write_file(folder / "a", "old"));
  rlimit before{};
  ASSERT_EQ(getrlimit(RLIMIT_FSIZE, &before), 0);
  const rlimit small{100'000, before.rlim_max};
  const auto handler = std::signal(SIGXFSZ, SIG_IGN);
  ASSERT_EQ(setrlimit(RLIMIT_FSIZE, &small), 0);
  const Status big = write_file(folder / "a", noise(500'000));
  const Status late = write_file(folder / "a", noise(200'000)); // fits the buffer: fails while committing
  setrlimit(RLIMIT_FSIZE, &before);
  std::signal(SIGXFSZ, handler);
  expect_unwritable(big, folder / "a", EFBIG);
  expect_unwritable(late, folder / "a", EFBIG);
  EXPECT_EQ(content_of(folder / "a"), "old");
  EXPECT_EQ(folder.names(), std::vector<std::string>{"a"});
  expect_unwritable(write_file("/dev/full", "x"), "/dev/full", ENOSPC);
}

TEST(AtomicFile, targets_that_cannot_be_written) {
  const TemporaryFolder folder;
  const Status nowhere = write_file(folder / "missing" / "a", "x");
  ASSERT_FALSE(nowhere);
  EXPECT_EQ(nowhere.error().code, Code::file_unwritable);
  EXPECT_NE(nowhere.error().message.find("there is no folder " + (folder / "missing").string()),
            std::string::npos);
  expect_unwritable(write_file(folder / "", "x"), folder / "", EISDIR);
  fs::create_directory(folder / "d");
  expect_unwritable(write_file(folder / "d", "x"), folder / "d", EISDIR);
  expect_unwritable(write_file("", "x"), "", EISDIR);
  expect_unwritable(write_file("/dev/fd/987", "x"), "/dev/fd/987", EBADF);
  if (geteuid() == 0) return; // root may write everything
  ASSERT_TRUE(write_file(folder / "a", "old"));
  fs::permissions(folder / "a", fs::perms::owner_read);
  expect_unwritable(write_file(folder / "a", "new"), folder / "a", EACCES);
}

TEST(AtomicFile, keeps_permissions_and_symbolic_links) {
  const TemporaryFolder folder;
  ASSERT_TRUE(write_file(folder / "a", "old"));
  fs::permissions(folder / "a", fs::perms::owner_read | fs::perms::owner_write);
  fs::create_symlink("a", folder / "link");
  ASSERT_TRUE(write_file(folder / "link", "new"));
  EXPECT_TRUE(fs::is_symlink(folder / "link"));
  EXPECT_EQ(content_of(folder / "a"), "new");
  EXPECT_EQ(fs::status(folder / "a").permissions(), fs::perms::owner_read | fs::perms::owner_write);
}

// The end of a chain of links is made, where it is to be; a chain without an end is an error.
TEST(AtomicFile, links_that_lead_nowhere) {
  const TemporaryFolder folder;
  fs::create_directory(folder / "d");
  fs::create_symlink("d/second", folder / "first");
  fs::create_symlink("made", folder / "d" / "second");
  ASSERT_TRUE(write_file(folder / "first", "new"));
  EXPECT_TRUE(fs::is_symlink(folder / "first"));
  EXPECT_TRUE(fs::is_symlink(folder / "d" / "second"));
  EXPECT_EQ(content_of(folder / "d" / "made"), "new");
  fs::create_symlink("b", folder / "a");
  fs::create_symlink("a", folder / "b");
  expect_unwritable(write_file(folder / "a", "x"), folder / "a", ELOOP);
  EXPECT_TRUE(fs::is_symlink(folder / "a"));
}

// A pipe cannot seek: what follows a gap has to wait for it, in order.
TEST(AtomicFile, gap_is_filled_in_files_and_in_pipes) {
  const TemporaryFolder folder;
  const std::string after = noise(700'001);
  ASSERT_EQ(::mkfifo((folder / "pipe").c_str(), 0600), 0);
  std::string piped;
  std::thread reader([&] { piped = content_of(folder / "pipe"); });
  for (const char* name : {"pipe", "file"}) {
    auto file = AtomicFile::create(folder / name);
    ASSERT_TRUE(file);
    for (const char* header : {"12345", "abcde"}) {
      file->write("before ");
      file->leave_gap(5);
      file->write(after);
      file->fill_gap(header);
    }
    ASSERT_TRUE(file->commit());
  }
  reader.join();
  EXPECT_EQ(piped, "before 12345" + after + "before abcde" + after);
  EXPECT_EQ(content_of(folder / "file"), piped);
}

TEST(AtomicFile, open_descriptor_is_appended_to) {
  const TemporaryFolder folder;
  ASSERT_TRUE(write_file(folder / "a", "first "));
  const int descriptor = ::open((folder / "a").c_str(), O_WRONLY | O_APPEND);
  ASSERT_TRUE(write_file("/dev/fd/" + std::to_string(descriptor), "second"));
  ::close(descriptor);
  EXPECT_EQ(content_of(folder / "a"), "first second");
}

TEST(AtomicFile, signal_handler_removes_the_temporary_files) {
  const TemporaryFolder folder;
  auto a = AtomicFile::create(folder / "a"), b = AtomicFile::create(folder / "b");
  ASSERT_TRUE(a && b);
  EXPECT_EQ(folder.names().size(), 2u);
  remove_unfinished_files();
  EXPECT_TRUE(folder.names().empty());
  EXPECT_FALSE(a->commit());
  ASSERT_TRUE(write_file(folder / "c", "x"));
  remove_unfinished_files(); // a finished file is none of its business
  EXPECT_EQ(folder.names(), std::vector<std::string>{"c"});
}

// Several outputs of one run must not be left half there.
TEST(FileGroup, files_take_their_places_together) {
  const TemporaryFolder folder;
  FileGroup group;
  for (const char* name : {"a", "b"}) {
    auto file = AtomicFile::create(folder / name);
    ASSERT_TRUE(file);
    file->write("new");
    ASSERT_TRUE(file->commit(&group));
    EXPECT_FALSE(fs::exists(folder / name));
  }
  ASSERT_TRUE(group.commit());
  EXPECT_EQ(content_of(folder / "a"), "new");
  EXPECT_EQ(folder.names(), (std::vector<std::string>{"a", "b"}));
}

TEST(FileGroup, without_commit_nothing_changes_and_nothing_is_left) {
  const TemporaryFolder folder;
  ASSERT_TRUE(write_file(folder / "a", "old"));
  {
    FileGroup group;
    auto file = AtomicFile::create(folder / "a");
    file->write("new");
    ASSERT_TRUE(file->commit(&group));
  }
  EXPECT_EQ(content_of(folder / "a"), "old");
  EXPECT_EQ(folder.names(), std::vector<std::string>{"a"});
}

TEST(FileGroup, files_that_wait_for_the_others_are_removed_on_a_signal) {
  const TemporaryFolder folder;
  FileGroup group;
  auto file = AtomicFile::create(folder / "a");
  ASSERT_TRUE(file->commit(&group));
  remove_unfinished_files();
  EXPECT_TRUE(folder.names().empty());
  EXPECT_FALSE(group.commit());
}

TEST(FileGroup, folders_are_made_with_their_files_or_not_at_all) {
  const TemporaryFolder folder;
  const auto write_into = [&](FileGroup& group, const fs::path& inner) {
    ASSERT_TRUE(group.make_folder(inner)) << inner;
    auto file = AtomicFile::create(inner / "a");
    ASSERT_TRUE(file->commit(&group)) << inner;
  };
  for (const char* name : {"one/two", "one/two/", "one/./two", "one/three/../two/."}) {
    {
      FileGroup group;
      write_into(group, folder / name);
      EXPECT_TRUE(fs::is_directory(folder / "one/two"));
    }
    EXPECT_TRUE(folder.names().empty()) << name;
    FileGroup group;
    write_into(group, folder / name);
    remove_unfinished_files();
    EXPECT_TRUE(folder.names().empty()) << name;
  }
  FileGroup group;
  write_into(group, folder / "one/two");
  EXPECT_EQ(group.files(), std::vector<fs::path>{folder / "one/two/a"});
  ASSERT_TRUE(group.commit());
  remove_unfinished_files();
  EXPECT_TRUE(fs::exists(folder / "one/two/a"));
}

TEST(FileGroup, folders_that_others_use_stay) {
  const TemporaryFolder folder;
  fs::create_directory(folder / "there");
  {
    FileGroup group;
    ASSERT_TRUE(group.make_folder(folder / "there"));
    ASSERT_TRUE(group.make_folder(folder / "made"));
    ASSERT_TRUE(write_file(folder / "made/by another", ""));
    ASSERT_TRUE(write_file(folder / "file", ""));
    expect_unwritable(group.make_folder(folder / "file/in"), folder / "file", EEXIST);
    expect_unwritable(group.make_folder(folder / "file"), folder / "file", EEXIST);
  }
  EXPECT_EQ(folder.names(), (std::vector<std::string>{"file", "made", "there"}));
}

TEST(Base64, pieces_of_any_size_give_the_text_of_the_whole) {
  const char* vectors[][2] = {{"", ""},
                              {"f", "Zg=="},
                              {"fo", "Zm8="},
                              {"foo", "Zm9v"},
                              {"foob", "Zm9vYg=="},
                              {"fooba", "Zm9vYmE="},
                              {"foobar", "Zm9vYmFy"}};
  for (const auto& [bytes, expected] : vectors)
    for (std::size_t piece = 1; piece <= 6; ++piece) {
      Base64Encoder encoder;
      std::string encoded;
      const std::string_view all(bytes);
      for (std::size_t start = 0; start < all.size(); start += piece) {
        const auto part = all.substr(start, piece);
        encoder.append({reinterpret_cast<const unsigned char*>(part.data()), part.size()}, encoded);
      }
      encoder.finish(encoded);
      EXPECT_EQ(encoded, expected) << piece;
    }
}
