#include "io/stored_field.hpp"

#include "core/text.hpp"
#include "io/parse.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace hyperiso {
namespace {

template <std::size_t Bytes>
void swap_each(std::span<std::byte> samples) {
  for (std::size_t start = 0; start + Bytes <= samples.size(); start += Bytes)
    std::reverse(samples.data() + start, samples.data() + start + Bytes);
}

void swap_bytes_of(std::span<std::byte> samples, std::size_t sample_bytes) {
  if (sample_bytes == 2) swap_each<2>(samples);
  if (sample_bytes == 4) swap_each<4>(samples);
  if (sample_bytes == 8) swap_each<8>(samples);
}

// The numbers of the file's axes in the field's order: `last` at the end, the others as they were.
std::vector<std::size_t> order_with_last(std::size_t dimension, std::size_t last) {
  std::vector<std::size_t> order;
  for (std::size_t axis = 0; axis < dimension; ++axis)
    if (axis != last) order.push_back(axis);
  order.push_back(last);
  return order;
}

Affine reordered(const Affine& world, const std::vector<std::size_t>& order) {
  const std::size_t D = order.size();
  Affine result{std::vector<double>(D * D), std::vector<double>(D)};
  for (std::size_t row = 0; row < D; ++row) {
    result.offset[row] = world.offset[order[row]];
    for (std::size_t column = 0; column < D; ++column)
      result.linear[row * D + column] = world.linear[order[row] * D + order[column]];
  }
  return result;
}

class StoredFieldReader final : public FieldReader {
 public:
  StoredFieldReader(FieldInfo info, std::vector<std::filesystem::path> files, std::vector<std::size_t> order,
                    std::unique_ptr<ByteSource> source, bool swap_bytes, std::filesystem::path path,
                    std::uint64_t memory_limit)
      : order_(std::move(order)), source_(std::move(source)), swap_bytes_(swap_bytes), path_(std::move(path)),
        memory_limit_(memory_limit) {
    info_ = std::move(info);
    files_ = std::move(files);
    for (std::size_t axis = 0; axis < order_.size(); ++axis) {
      const std::int64_t count = info_.axes[axis].count;
      (order_[axis] < order_.back() ? inner_ : order_[axis] > order_.back() ? outer_ : steps_) *= count;
    }
  }

  Result<Field> read(std::int64_t begin, std::int64_t end) override {
    if (Status status = check_range(info_, begin, end, path_); !status) return status.error();
    return without_bad_alloc(path_, [&]() -> Result<Field> {
      if (auto field = in_place(begin, end)) return std::move(*field);
      return copied(begin, end);
    });
  }

 private:
  std::uint64_t bytes(std::int64_t samples) const {
    return static_cast<std::uint64_t>(samples) * size_of(info_.type);
  }

  // Strides of samples in the order of the file with `steps` along the last axis of the field.
  std::vector<std::int64_t> strides(std::int64_t steps) const {
    std::vector<std::int64_t> strides(order_.size());
    std::int64_t stride = 1;
    for (std::size_t stored = 0; stored < order_.size(); ++stored) {
      const auto axis =
          static_cast<std::size_t>(std::find(order_.begin(), order_.end(), stored) - order_.begin());
      strides[axis] = stride;
      stride *= stored == order_.back() ? steps : info_.axes[axis].count;
    }
    return strides;
  }

  std::optional<Field> in_place(std::int64_t begin, std::int64_t end) {
    if (swap_bytes_ && size_of(info_.type) > 1) return std::nullopt;
    const std::int64_t first = begin * inner_, last = ((outer_ - 1) * steps_ + end) * inner_;
    auto samples = source_->in_place(bytes(first), bytes(last - first));
    if (!samples || reinterpret_cast<std::uintptr_t>(samples.get()) % size_of(info_.type) != 0)
      return std::nullopt;
    FieldInfo info = info_;
    info.axes.back() = info.axes.back().cropped(begin, end);
    return Field{std::move(info), std::move(samples), strides(steps_)};
  }

  // Reads only the steps asked for. They are one run of bytes if time is the last axis of the file, else one
  // run for each index along the axes after it.
  Result<Field> copied(std::int64_t begin, std::int64_t end) {
    if (kept_ && begin == kept_step_ && end == begin + 1) return *kept_;
    FieldInfo info = info_;
    info.axes.back() = info.axes.back().cropped(begin, end);
    auto memory = allocate_to_read(std::move(info), memory_limit_, path_);
    if (!memory) return memory.error();
    memory->field.strides = strides(end - begin);

    std::span<std::byte> out(memory->samples, bytes((end - begin) * inner_ * outer_));
    if (kept_ && begin == kept_step_ && begin < end) {
      std::copy_n(kept_->samples.get(), bytes(inner_), out.data());
      out = out.subspan(bytes(inner_));
      ++begin;
    }
    kept_.reset();
    const std::span<std::byte> fresh = out;
    const auto run = bytes((end - begin) * inner_);
    for (std::int64_t block = 0; block < outer_ && run > 0; ++block, out = out.subspan(run))
      if (Status status = source_->read(bytes((block * steps_ + begin) * inner_), out.first(run)); !status)
        return status.error();
    if (swap_bytes_) swap_bytes_of(fresh, size_of(info_.type));
    if (outer_ == 1 && source_->sequential() && end > begin) keep_last_step(memory->field, end);
    return std::move(memory->field);
  }

  // Readers of two steps at a time come back for the second as the first of the next pair: without it, a
  // compressed file would be decoded anew for every pair. A step that was read alone is shared.
  void keep_last_step(const Field& field, std::int64_t end) {
    kept_step_ = end - 1;
    const std::int64_t steps = field.info.axes.back().count;
    kept_ = field.cropped(field.info.dimension() - 1, steps - 1, steps);
    if (steps == 1) return;
    auto copy = allocate_field(kept_->info);
    if (!copy) return kept_.reset();
    std::copy_n(kept_->samples.get(), bytes(inner_), copy->samples);
    copy->field.strides = kept_->strides;
    kept_ = std::move(copy->field);
  }

  std::vector<std::size_t> order_; // the file's axis for each of the field's
  // Samples before, along and after the last axis, in the order of the file.
  std::int64_t inner_ = 1, steps_ = 1, outer_ = 1;
  std::unique_ptr<ByteSource> source_;
  bool swap_bytes_;
  std::filesystem::path path_;
  std::uint64_t memory_limit_;
  std::optional<Field> kept_; // the step kept_step_
  std::int64_t kept_step_ = -1;
};

} // namespace

std::optional<int> usual_time_axis(std::size_t dimension) {
  if (dimension < 4) return std::nullopt;
  return static_cast<int>(dimension) - 1;
}

void name_axes(std::vector<Axis>& axes, std::optional<int> time_axis) {
  const std::size_t others = axes.size() - (time_axis ? 1 : 0);
  std::size_t number = 0;
  for (std::size_t axis = 0; axis < axes.size(); ++axis) {
    std::string name;
    if (time_axis && axis == static_cast<std::size_t>(*time_axis))
      name = "t";
    else
      name = others <= 3 ? std::string(1, "xyz"[number]) : text("x", number), ++number;
    if (axes[axis].name.empty()) axes[axis].name = name;
  }
}

bool set_coordinates(Axis& axis, std::vector<double> coordinates) {
  const std::size_t count = coordinates.size();
  for (std::size_t i = 0; i < count; ++i) {
    if (!std::isfinite(coordinates[i])) return false;
    if (i == 0) continue;
    const bool rises = coordinates[i] > coordinates[i - 1], falls = coordinates[i] < coordinates[i - 1];
    if (coordinates[1] > coordinates[0] ? !rises : !falls) return false;
  }
  axis.origin = coordinates[0];
  axis.spacing = count > 1 ? coordinates[1] - coordinates[0] : 1;
  axis.coordinates.clear();
  for (std::size_t i = 0; i < count; ++i)
    if (axis.coordinate(static_cast<std::int64_t>(i)) != coordinates[i]) {
      axis.coordinates = std::move(coordinates);
      break;
    }
  return true;
}

Result<std::uint64_t> bytes_of(const std::vector<Axis>& axes, SampleType type,
                               const std::filesystem::path& path) {
  if (axes.empty()) return Error{Code::file_malformed, text(path.string(), ": the field has no axis")};
  std::uint64_t bytes = size_of(type);
  for (const Axis& axis : axes)
    if (axis.count < 1)
      return Error{Code::file_malformed,
                   text(path.string(), ": the sizes ", dims_text(axes), " are not all at least 1")};
    else if (__builtin_mul_overflow(bytes, static_cast<std::uint64_t>(axis.count), &bytes) ||
             bytes > static_cast<std::uint64_t>(PTRDIFF_MAX))
      return Error{Code::file_malformed, text(path.string(), ": the sizes ", dims_text(axes),
                                              " multiply to more bytes than memory can address")};
  return bytes;
}

std::string dims_text(const std::vector<Axis>& axes) {
  std::string result;
  for (const Axis& axis : axes) result += text(result.empty() ? "" : "x", axis.count);
  return result;
}

Result<std::unique_ptr<FieldReader>> read_stored(StoredField stored, std::unique_ptr<ByteSource> source,
                                                 bool swap_bytes, const std::filesystem::path& path,
                                                 const ReadOptions& options) {
  std::optional<int> last = stored.time_axis;
  if (!options.time_axis.empty()) {
    FieldInfo as_stored;
    as_stored.axes = stored.axes;
    name_axes(as_stored.axes, stored.time_axis);
    last = as_stored.axis_named(options.time_axis);
    if (!last) {
      std::string names;
      for (const Axis& axis : as_stored.axes) names += (names.empty() ? "" : ", ") + in_quotes(axis.name);
      return Error{Code::invalid_argument, text(path.string(), ": no axis is called ",
                                                in_quotes(options.time_axis), "; its axes are ", names)};
    }
  }
  name_axes(stored.axes, last);
  for (const Axis& axis : stored.axes)
    if (!std::isfinite(axis.coordinate(0)) || !std::isfinite(axis.coordinate(axis.count - 1)))
      return Error{Code::file_malformed,
                   text(path.string(), ": axis ", axis.name, " runs from ", axis.coordinate(0), " to ",
                        axis.coordinate(axis.count - 1), ", beyond all numbers")};

  const std::size_t dimension = stored.axes.size();
  const auto order = order_with_last(dimension, last ? static_cast<std::size_t>(*last) : dimension - 1);
  FieldInfo info;
  info.name = std::move(stored.name);
  info.type = stored.type;
  info.has_time = last.has_value();
  if (stored.world) info.world = reordered(*stored.world, order);
  for (const std::size_t axis : order) info.axes.push_back(std::move(stored.axes[axis]));
  return std::unique_ptr<FieldReader>(
      std::make_unique<StoredFieldReader>(std::move(info), std::move(stored.files), order, std::move(source),
                                          swap_bytes, path, options.memory_limit));
}

Status check_range(const FieldInfo& info, std::int64_t begin, std::int64_t end,
                   const std::filesystem::path& path) {
  const Axis& axis = info.axes.back();
  if (0 <= begin && begin <= end && end <= axis.count) return {};
  return Error{Code::invalid_argument,
               text(path.string(), ": ", begin, ":", end, " is not a range within the ", axis.count,
                    " samples along axis ", axis.name)};
}

Result<NewField> allocate_to_read(FieldInfo info, std::uint64_t memory_limit,
                                  const std::filesystem::path& path) {
  auto memory = allocate_field(std::move(info), memory_limit);
  if (!memory) return Error{memory.error().code, text(path.string(), ": ", memory.error().message)};
  return memory;
}

} // namespace hyperiso
