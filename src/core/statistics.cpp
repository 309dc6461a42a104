#include "hyperiso/statistics.hpp"

#include "core/random.hpp"
#include "core/rows.hpp"

#include <algorithm>
#include <cmath>

namespace hyperiso {
namespace {

constexpr std::uint64_t most_drawn = std::uint64_t{1} << 20;

// The value half way between the two neighbours in `ascending` that part it into the classes with the
// greatest variance between them.
double otsu_threshold(const std::vector<double>& ascending) {
  const auto count = static_cast<double>(ascending.size());
  // From the smallest value and in units of the range: sums that neither overflow nor lose their digits.
  const double low = ascending.front(), range = ascending.back() / 2 - low / 2;
  const auto normalised = [&](double value) { return (value / 2 - low / 2) / range; };
  double total = 0;
  for (const double value : ascending) total += normalised(value);
  double below = 0, greatest = -1, threshold = low;
  for (std::size_t i = 0; i + 1 < ascending.size(); ++i) {
    below += normalised(ascending[i]);
    if (ascending[i] == ascending[i + 1]) continue;
    const double share = static_cast<double>(i + 1) / count;
    const double difference = below / share - (total - below) / (1 - share);
    const double between = share * (1 - share) * difference * difference;
    if (between > greatest) {
      greatest = between;
      threshold = ascending[i] / 2 + ascending[i + 1] / 2;
    }
  }
  return threshold;
}

// To the power of ten at or below a thousandth of the range.
double rounded(double value, double range) {
  const double exponent = std::floor(std::log10(range)) - 3;
  if (!(std::abs(exponent) < 300)) return value;
  const double factor = std::pow(10, std::abs(exponent));
  return exponent < 0 ? std::round(value * factor) / factor : std::round(value / factor) * factor;
}

} // namespace

double Statistics::quantile(double share) const {
  const auto last = static_cast<double>(drawn.size() - 1);
  return drawn[static_cast<std::size_t>(std::clamp(std::ceil(share * (last + 1)) - 1, 0.0, last))];
}

std::vector<SuggestedIsovalue> suggest_isovalues(const Statistics& statistics) {
  if (statistics.finite() == 0 || statistics.drawn.front() == statistics.drawn.back()) return {};
  const double range = statistics.maximum - statistics.minimum;
  const double middle = statistics.minimum / 2 + statistics.maximum / 2;
  std::vector<SuggestedIsovalue> suggestions{
      {rounded(otsu_threshold(statistics.drawn), range), "parts the values best into low and high"},
      {rounded(middle, range), "the middle of the range"}};
  if (suggestions[0].isovalue == suggestions[1].isovalue) suggestions.pop_back();
  return suggestions;
}

template <class T>
void StatisticsCollector::add_row(const T* samples, std::int64_t count, std::int64_t stride) {
  for (std::int64_t i = 0; i < count; ++i) {
    const auto value = static_cast<double>(samples[i * stride]);
    ++statistics_.samples;
    if (std::isnan(value)) {
      ++statistics_.missing;
      continue;
    }
    if (std::isinf(value)) {
      ++statistics_.infinite;
      continue;
    }
    const std::uint64_t seen = statistics_.finite() - 1;
    if (seen == 0) statistics_.minimum = statistics_.maximum = value;
    statistics_.minimum = std::min(statistics_.minimum, value);
    statistics_.maximum = std::max(statistics_.maximum, value);
    // Reservoir sampling: every sample has the same chance to be among the drawn.
    if (seen < most_drawn)
      statistics_.drawn.push_back(value);
    else if (const std::uint64_t place = scramble(0, random_++) % (seen + 1); place < most_drawn)
      statistics_.drawn[place] = value;
  }
}

void StatisticsCollector::add(const Field& piece) {
  visit_sample_type(piece.info.type, [&](auto sample) {
    const auto* samples = reinterpret_cast<const decltype(sample)*>(piece.samples.get());
    for_each_row(piece, [&](std::int64_t offset) {
      add_row(samples + offset, piece.info.axes[0].count, piece.strides[0]);
    });
  });
}

Statistics StatisticsCollector::finish() && {
  std::ranges::sort(statistics_.drawn);
  return std::move(statistics_);
}

} // namespace hyperiso
