#pragma once
// What every single-file format comes down to: axes in the order of the file, and a sequence of bytes.

#include "hyperiso/io.hpp"
#include "io/byte_source.hpp"

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace hyperiso {

// A field as its file describes it.
struct StoredField {
  std::string name;
  SampleType type = SampleType::f32;
  std::vector<Axis> axes;       // in the order of the file, fastest first; names may be empty
  std::optional<int> time_axis; // number of the axis that the file says is time
  // Axis coordinates to world; row and column k belong to axis k of the file.
  std::optional<Affine> world;
  std::vector<std::filesystem::path> files; // that have the samples, if it is not this one
};

// Time where a file says nothing of its axes: the last of four or more.
std::optional<int> usual_time_axis(std::size_t dimension);

// Names the axes that have no name: t for time, x, y, z for up to three others, x0, x1, ... for more.
void name_axes(std::vector<Axis>& axes, std::optional<int> time_axis);

// Places the samples of an axis: origin and spacing where those give every coordinate to the bit, else the
// coordinates. False if they are not finite and strictly monotone. Requires one for every sample.
bool set_coordinates(Axis& axis, std::vector<double> coordinates);

// product of the counts times the size of a sample. Error: file_malformed where it overflows, an axis is
// empty or there is no axis; `path` is for the message.
Result<std::uint64_t> bytes_of(const std::vector<Axis>& axes, SampleType type,
                               const std::filesystem::path& path);

// "2x3x4"
std::string dims_text(const std::vector<Axis>& axes);

// A reader of samples that `source` holds in the order of the file; `swap_bytes` where their byte order is
// not this machine's. Moves time, or the axis that the options name, to the end by its stride.
// Requires that bytes_of(stored.axes) is no error and that the source was made for so many bytes.
Result<std::unique_ptr<FieldReader>> read_stored(StoredField stored, std::unique_ptr<ByteSource> source,
                                                 bool swap_bytes, const std::filesystem::path& path,
                                                 const ReadOptions& options);

// Checks the range of FieldReader::read.
Status check_range(const FieldInfo& info, std::int64_t begin, std::int64_t end,
                   const std::filesystem::path& path);
// Memory for samples that are read, within the limit. `path` is for the message.
Result<NewField> allocate_to_read(FieldInfo info, std::uint64_t memory_limit,
                                  const std::filesystem::path& path);

// Runs `work`, which may throw std::bad_alloc.
template <class Work>
auto without_bad_alloc(const std::filesystem::path& path, Work&& work) -> decltype(work()) {
  try {
    return work();
  } catch (const std::bad_alloc&) {
    return Error{Code::out_of_memory, path.string() + ": no memory to read it"};
  }
}

} // namespace hyperiso
