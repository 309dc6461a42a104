// Moving pieces: .npz, and the formats of meshes.

#include "core/text.hpp"
#include "hyperiso/morph_files.hpp"
#include "io/atomic_file.hpp"
#include "io/npy_header.hpp"
#include "io/parse.hpp"

#include <array>
#include <new>
#include <zlib.h>

namespace hyperiso {
namespace {

// An archive of files that are stored as they are, with the sizes of ZIP64 (PKWARE's APPNOTE, 4.3 and 4.5).
class ZipWriter {
 public:
  explicit ZipWriter(AtomicFile& file) : file_(file) {}

  // One file: `header` followed by `bytes` bytes of `data`.
  void add(const std::string& name, const std::string& header, const void* data, std::uint64_t bytes) {
    Entry entry{name, 0, header.size() + bytes, written_};
    entry.checksum = checksum(0, header.data(), header.size());
    entry.checksum = checksum(entry.checksum, static_cast<const char*>(data), bytes);
    put(number<4>(0x04034b50) + number<2>(version) + common_fields(entry) + number<2>(name.size()) +
        number<2>(4 + 16) + name + number<2>(1) + number<2>(16) + number<8>(entry.size) +
        number<8>(entry.size));
    put(header);
    file_.write(data, bytes);
    written_ += bytes;
    entries_.push_back(std::move(entry));
  }

  void finish() {
    const std::uint64_t start = written_;
    for (const Entry& entry : entries_)
      put(number<4>(0x02014b50) + number<2>(version) + number<2>(version) + common_fields(entry) +
          number<2>(entry.name.size()) + number<2>(4 + 24) + number<2>(0) + number<2>(0) + number<2>(0) +
          number<4>(0) + number<4>(0xffffffff) + entry.name + number<2>(1) + number<2>(24) +
          number<8>(entry.size) + number<8>(entry.size) + number<8>(entry.offset));
    const std::uint64_t end = written_, count = entries_.size();
    put(number<4>(0x06064b50) + number<8>(44) + number<2>(version) + number<2>(version) + number<4>(0) +
        number<4>(0) + number<8>(count) + number<8>(count) + number<8>(end - start) + number<8>(start));
    put(number<4>(0x07064b50) + number<4>(0) + number<8>(end) + number<4>(1));
    put(number<4>(0x06054b50) + number<2>(0) + number<2>(0) + number<2>(count) + number<2>(count) +
        number<4>(0xffffffff) + number<4>(0xffffffff) + number<2>(0));
  }

 private:
  struct Entry {
    std::string name;
    std::uint32_t checksum;
    std::uint64_t size, offset;
  };
  static constexpr std::uint64_t version = 45; // of ZIP: 4.5 knows 64-bit sizes

  template <int Bytes>
  static std::string number(std::uint64_t value) {
    std::string bytes;
    for (int byte = 0; byte < Bytes; ++byte) bytes += static_cast<char>(value >> 8 * byte & 255);
    return bytes;
  }
  // From the flags to the sizes, which stand in the 64-bit fields; the time is 1 January 1980.
  static std::string common_fields(const Entry& entry) {
    return number<2>(0) + number<2>(0) + number<2>(0) + number<2>(1 << 5 | 1) + number<4>(entry.checksum) +
           number<4>(0xffffffff) + number<4>(0xffffffff);
  }
  static std::uint32_t checksum(std::uint32_t before, const char* data, std::uint64_t bytes) {
    return static_cast<std::uint32_t>(::crc32_z(before, reinterpret_cast<const Bytef*>(data), bytes));
  }
  void put(const std::string& bytes) {
    file_.write(bytes);
    written_ += bytes.size();
  }

  AtomicFile& file_;
  std::vector<Entry> entries_;
  std::uint64_t written_ = 0;
};

bool is_npz(const std::filesystem::path& path) { return lower_case(path.extension().string()) == ".npz"; }

template <int D>
Status write_npz(const MorphPieces<D>& pieces, const std::filesystem::path& path, FileGroup* group) {
  auto file = AtomicFile::create(path);
  if (!file) return file.error();
  ZipWriter archive(*file);
  const std::uint64_t count = pieces.count();
  for (const auto& [name, points] : {std::pair{"start.npy", &pieces.starts}, {"end.npy", &pieces.ends}})
    archive.add(name,
                npy_header('f', points->wide() ? 8 : 4,
                           std::array<std::uint64_t, 3>{count, MorphPieces<D>::corners, D - 1}),
                points->data(), points->bytes());
  const std::array shape{count};
  for (const auto& [name, times] :
       {std::pair{"start_time.npy", &pieces.start_times}, {"end_time.npy", &pieces.end_times}})
    archive.add(name, npy_header('f', sizeof(double), shape), times->data(), count * sizeof(double));
  archive.add("simplex.npy", npy_header('u', sizeof(std::uint64_t), shape), pieces.simplices.data(),
              count * sizeof(std::uint64_t));
  archive.finish();
  return file->commit(group);
}

} // namespace

template <int D>
Status write_morph(const MorphPieces<D>& pieces, const std::filesystem::path& path, FileGroup* group) {
  try {
    if (is_npz(path)) return write_npz(pieces, path, group);
    WriteMeshOptions options;
    options.group = group;
    return write_mesh(morph_mesh(pieces), path, options);
  } catch (const std::bad_alloc&) {
    return no_memory_to_write(path);
  }
}

Status check_morph_format(int dimension, const std::filesystem::path& path) {
  if (is_npz(path)) return {};
  const auto fits = check_mesh_format(dimension - 1, dimension - 2, path);
  if (!fits) return Error{fits.error().code, fits.error().message + "; npz holds moving pieces too"};
  return {};
}

template Status write_morph(const MorphPieces<3>&, const std::filesystem::path&, FileGroup*);
template Status write_morph(const MorphPieces<4>&, const std::filesystem::path&, FileGroup*);

} // namespace hyperiso
