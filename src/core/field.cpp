#include "hyperiso/field.hpp"

#include "core/text.hpp"
#include "hyperiso/number_array.hpp"

#include <algorithm>
#include <charconv>
#include <new>

namespace hyperiso {

Axis Axis::cropped(std::int64_t begin, std::int64_t end) const {
  Axis axis = *this;
  axis.count = end - begin;
  axis.first = first + begin;
  if (!coordinates.empty()) axis.coordinates.assign(coordinates.begin() + begin, coordinates.begin() + end);
  return axis;
}

std::size_t size_of(SampleType type) {
  return visit_sample_type(type, [](auto sample) { return sizeof sample; });
}

namespace {
constexpr const char* sample_type_names[] = {"u8", "i8", "u16", "i16", "u32", "i32", "f32", "f64"};
}

const char* name_of(SampleType type) { return sample_type_names[static_cast<int>(type)]; }

std::optional<SampleType> sample_type_named(const std::string& name) {
  const auto* found = std::find(std::begin(sample_type_names), std::end(sample_type_names), name);
  if (found == std::end(sample_type_names)) return std::nullopt;
  return static_cast<SampleType>(found - std::begin(sample_type_names));
}

std::int64_t FieldInfo::samples() const {
  std::int64_t product = 1;
  for (const Axis& axis : axes) product *= axis.count;
  return product;
}

std::optional<int> FieldInfo::axis_named(const std::string& axis_name) const {
  for (int axis = 0; axis < dimension(); ++axis)
    if (!axis_name.empty() && axes[static_cast<std::size_t>(axis)].name == axis_name) return axis;
  int number = 0;
  const char* end = axis_name.data() + axis_name.size();
  const auto [stop, error] = std::from_chars(axis_name.data(), end, number);
  if (error == std::errc{} && stop == end && number >= 0 && number < dimension()) return number;
  return std::nullopt;
}

Field Field::cropped(int axis, std::int64_t begin, std::int64_t end) const {
  Field field = *this;
  auto& cut = field.info.axes[static_cast<std::size_t>(axis)];
  cut = cut.cropped(begin, end);
  const auto bytes =
      begin * strides[static_cast<std::size_t>(axis)] * static_cast<std::int64_t>(size_of(info.type));
  field.samples = std::shared_ptr<const std::byte>(samples, samples.get() + bytes);
  return field;
}

Result<NewField> allocate_field(FieldInfo info, std::uint64_t memory_limit) {
  std::uint64_t bytes = size_of(info.type);
  std::vector<std::int64_t> strides;
  std::int64_t stride = 1;
  for (const Axis& axis : info.axes) {
    if (axis.count < 0 || __builtin_mul_overflow(bytes, static_cast<std::uint64_t>(axis.count), &bytes) ||
        bytes > static_cast<std::uint64_t>(PTRDIFF_MAX))
      return Error{Code::invalid_argument,
                   text("the field's sizes multiply to more bytes than memory can address")};
    strides.push_back(stride);
    stride *= axis.count;
  }
  if (bytes > memory_limit)
    return Error{Code::out_of_memory, text("the field takes ", byte_size(bytes), ", the memory limit is ",
                                           byte_size(memory_limit))};
  try {
    const auto memory = std::make_shared<Buffer>();
    memory->reset(std::max<std::uint64_t>(bytes, 1));
    auto* samples = static_cast<std::byte*>(memory->data());
    return NewField{Field{std::move(info), {memory, samples}, std::move(strides)}, samples};
  } catch (const std::bad_alloc&) {
    return Error{Code::out_of_memory, text("no memory for a field of ", byte_size(bytes))};
  }
}

} // namespace hyperiso
