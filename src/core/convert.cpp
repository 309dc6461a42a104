#include "hyperiso/convert.hpp"

#include "core/nearest.hpp"
#include "core/rows.hpp"
#include "core/text.hpp"

namespace hyperiso {
namespace {

struct Counts {
  std::uint64_t missing = 0, clamped = 0;
};

template <class To, class From>
void convert_row(const From* from, std::int64_t stride, std::int64_t count, To* to,
                 const ConvertOptions& options, Counts& counts) {
  constexpr double lowest = std::numeric_limits<To>::lowest(), highest = std::numeric_limits<To>::max();
  for (std::int64_t i = 0; i < count; ++i) {
    auto value = static_cast<double>(from[i * stride]);
    if (options.rescale) value = scaled_to<To>(value, options.rescale->low, options.rescale->high);
    if (std::isnan(value) && !std::is_floating_point_v<To>) {
      ++counts.missing;
      continue;
    }
    const double rounded = std::is_floating_point_v<To> ? value : std::nearbyint(value);
    if (std::isfinite(value) && (rounded < lowest || rounded > highest)) ++counts.clamped;
    to[i] = nearest<To>(value);
  }
}

template <class To, class From>
Status convert_samples(const Field& field, To* to, const ConvertOptions& options, Counts& counts) {
  const auto* from = reinterpret_cast<const From*>(field.samples.get());
  const std::int64_t count = field.info.axes[0].count;
  const std::int64_t rows = count > 0 ? field.info.samples() / count : 0;
  std::int64_t row = 0;
  bool go_on = true;
  for_each_row(field, [&](std::int64_t offset) {
    if (options.progress && go_on && row % 1024 == 0)
      go_on = options.progress(static_cast<double>(row) / static_cast<double>(rows));
    if (go_on) convert_row(from + offset, field.strides[0], count, to + row * count, options, counts);
    ++row;
  });
  if (!go_on) return Error{Code::cancelled, "cancelled"};
  return {};
}

} // namespace

Result<Converted> convert(const Field& field, const ConvertOptions& options) {
  if (options.rescale) {
    const auto [low, high] = *options.rescale;
    if (!std::isfinite(low) || !std::isfinite(high) || low == high)
      return Error{Code::invalid_argument, text("cannot rescale from ", low, " to ", high,
                                                ": two different finite numbers are needed")};
  }
  FieldInfo info = field.info;
  info.type = options.type;
  auto made = allocate_field(std::move(info), options.memory_limit);
  if (!made) return made.error();
  Counts counts;
  const Status status = visit_sample_type(options.type, [&](auto to) {
    return visit_sample_type(field.info.type, [&](auto from) {
      return convert_samples<decltype(to), decltype(from)>(
          field, reinterpret_cast<decltype(to)*>(made->samples), options, counts);
    });
  });
  if (!status) return status.error();
  if (counts.missing > 0)
    return Error{Code::invalid_argument,
                 text(counts.missing, counts.missing == 1 ? " sample is" : " samples are",
                      " NaN (no data), which ", name_of(options.type), " cannot hold; f32 and f64 can")};
  return Converted{std::move(made->field), counts.clamped};
}

} // namespace hyperiso
