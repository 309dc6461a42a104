#include "track/with_fields.hpp"

#include "core/sign.hpp"
#include "core/text.hpp"
#include "track/regions.hpp"

namespace hyperiso::track_detail {
namespace {

template <class T, int D> // D: of space
std::vector<FieldSum> sums(const FieldView<const T, D>& step, std::span<const std::uint32_t> owners,
                           std::size_t count) {
  std::vector<FieldSum> result(count);
  std::array<std::vector<double>, D> share;
  for (int axis = 0; axis < D; ++axis) share[axis] = shares(step.grid.axes[axis]);
  std::array<std::int64_t, D> index{};
  for (const std::uint32_t owner : owners) {
    if (owner != UINT32_MAX && !is_missing(step.at(index))) {
      const auto value = static_cast<double>(step.at(index));
      double size = 1;
      for (int axis = 0; axis < D; ++axis) size *= share[axis][static_cast<std::size_t>(index[axis])];
      add(result[owner], {size * value, value, value});
    }
    for (int axis = 0; axis < D && ++index[axis] == step.dims()[axis]; ++axis) index[axis] = 0;
  }
  return result;
}

} // namespace

Status check_with(const FieldInfo& tracked, const std::vector<FieldBeside>& with) {
  for (const FieldBeside& field : with) {
    const FieldInfo& info = field.source->info();
    bool same = info.dimension() == tracked.dimension();
    for (std::size_t axis = 0; same && axis < tracked.axes.size(); ++axis)
      same = info.axes[axis].count == tracked.axes[axis].count;
    if (!same)
      return Error{
          Code::invalid_argument,
          text("the field '", field.name, "' has not as many samples along each axis as the tracked one")};
  }
  return {};
}

Result<std::vector<FieldSum>> sums_by_owner(StepSource& source, std::int64_t step,
                                            std::span<const std::uint32_t> owners, std::size_t count) {
  const auto field = source.read(step, step + 1);
  if (!field) return field.error();
  return visit_sample_type(field->info.type, [&]<class T>(T) {
    return field->info.dimension() == 3 ? sums(field->template view<T, 3>().at_index(2, 0), owners, count)
                                        : sums(field->template view<T, 4>().at_index(3, 0), owners, count);
  });
}

void add(FieldSum& sum, const FieldSum& part) {
  sum.mass += part.mass;
  sum.minimum = std::min(sum.minimum, part.minimum);
  sum.maximum = std::max(sum.maximum, part.maximum);
}

} // namespace hyperiso::track_detail
