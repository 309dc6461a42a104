#include "cli/seed.hpp"

#include "cli/failure.hpp"
#include "cli/parse.hpp"
#include "core/text.hpp"
#include "hyperiso/slice.hpp"

#include <algorithm>
#include <cmath>

namespace hyperiso::cli {
namespace {

std::vector<double> coordinates_of(const std::string& point, const std::vector<Axis>& axes) {
  std::vector<double> coordinates = parse_numbers("--seed", point);
  if (coordinates.size() != axes.size())
    fail_usage(text("--seed: ", coordinates.size(), " coordinates; the field has ", axes.size(), " axes"));
  return coordinates;
}

} // namespace

std::vector<std::int64_t> cell_at(const std::string& point, const std::vector<Axis>& axes) {
  const std::vector<double> coordinates = coordinates_of(point, axes);
  std::vector<std::int64_t> cell;
  for (std::size_t axis = 0; axis < axes.size(); ++axis)
    cell.push_back(std::min(take(samples_around(axes[axis], coordinates[axis])).begin, axes[axis].count - 2));
  return cell;
}

std::vector<std::int64_t> sample_at(const std::string& point, const std::vector<Axis>& axes) {
  const std::vector<double> coordinates = coordinates_of(point, axes);
  std::vector<std::int64_t> sample;
  for (std::size_t axis = 0; axis < axes.size(); ++axis) {
    const auto [begin, end] = take(samples_around(axes[axis], coordinates[axis]));
    const auto distance = [&](std::int64_t index) {
      return std::abs(axes[axis].coordinate(index) - coordinates[axis]);
    };
    sample.push_back(distance(end - 1) < distance(begin) ? end - 1 : begin);
  }
  return sample;
}

} // namespace hyperiso::cli
