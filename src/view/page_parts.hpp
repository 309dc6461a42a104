#pragma once
// What pages of surfaces and pages of fields have in common.

#include "hyperiso/view.hpp"
#include "io/atomic_file.hpp"
#include "view/payload.hpp"

#include <nlohmann/json.hpp>

#include <limits>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace hyperiso {

using Json = nlohmann::ordered_json;

constexpr std::size_t most_vertices = std::size_t{1} << 24;  // the payload's vertex codes have 24 bits
constexpr std::size_t most_simplices = std::size_t{1} << 25; // a texture of 2048 x 16384

// Fails if there are more.
Status check_size(std::uint64_t simplices, std::uint64_t vertices);

// The axes of what is shown, each with a name and a range.
struct Ranges {
  std::vector<Axis> axes;
  std::vector<double> minimum, maximum;

  std::vector<Quantiser> quantisers() const;
};

// Completes the axes of `options`: an axis without samples gets the range of the mesh; with a world
// transform, all get those of the box around the moved grid, whatever surface it holds.
Ranges ranges_of(const Mesh& mesh, const PageOptions& options);

// Everything the page is told but for where its data stands. invalid_argument if it has nothing of the name
// that it is to be coloured by.
Result<Json> metadata_of(int dimension, int simplex_dimension, const PageOptions& options,
                         const Ranges& ranges, const std::vector<Quantiser>& quantisers,
                         const std::vector<EncodedAttribute>& attributes);

// A page being written: the viewer up to its data, the metadata, the blocks, the rest. Each block is an
// element of its own, so that the page can say how far it has been read. Nothing is there before `finish`.
class PageFile {
 public:
  // Error: file_unwritable, internal.
  static Result<PageFile> create(const PageOptions& options, const std::filesystem::path& path);

  // False if the page would pass the limit.
  bool write_metadata(const Json& metadata);
  bool write_block(std::span<const unsigned char> compressed);
  Result<void> finish();
  Error too_large(std::string_view what) const; // "a page of WHAT would be larger than ..."

 private:
  PageFile(AtomicFile&& file, std::string shell, std::size_t data_end, std::uint64_t limit)
      : file_(std::move(file)), shell_(std::move(shell)), data_end_(data_end), limit_(limit), left_(limit) {}
  bool write(std::string_view text);

  AtomicFile file_;
  std::string shell_;
  std::size_t data_end_; // where the shell goes on
  std::uint64_t limit_, left_;
};

} // namespace hyperiso
