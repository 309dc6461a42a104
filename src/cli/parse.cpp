#include "cli/parse.hpp"

#include "cli/failure.hpp"
#include "core/text.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <utility>

namespace hyperiso::cli {
namespace {

[[noreturn]] void fail(std::string_view option, std::string_view found, std::string_view right) {
  fail_usage(text(option, ": '", found, "' is not ", right));
}

// The number that all of `digits` spells; nothing if it does not spell one.
template <class Number>
std::optional<Number> spelled(std::string_view digits) {
  if (digits.size() > 1 && digits.front() == '+' && digits[1] != '-') digits.remove_prefix(1);
  Number number{};
  const auto [stop, problem] = std::from_chars(digits.data(), digits.data() + digits.size(), number);
  if (problem != std::errc{} || stop != digits.data() + digits.size()) return std::nullopt;
  return number;
}

} // namespace

std::vector<std::string> split(std::string_view text, char separator) {
  std::vector<std::string> pieces;
  for (;;) {
    const auto place = text.find(separator);
    pieces.emplace_back(text.substr(0, place));
    if (place == std::string_view::npos) return pieces;
    text.remove_prefix(place + 1);
  }
}

double parse_number(std::string_view option, std::string_view text) {
  const auto number = spelled<double>(text);
  if (!number) fail(option, text, "a number");
  if (!std::isfinite(*number)) fail(option, text, "a finite number");
  return *number;
}

std::vector<double> parse_numbers(std::string_view option, std::string_view text) {
  std::vector<double> numbers;
  for (const std::string& piece : split(text, ',')) numbers.push_back(parse_number(option, piece));
  return numbers;
}

std::vector<double> parse_series(std::string_view option, std::string_view text) {
  constexpr double most = 1e6, rounding = 1e-9; // a last step that misses the end by less is one on it
  std::vector<double> numbers;
  for (const std::string& piece : split(text, ',')) {
    const auto parts = split(piece, ':');
    if (parts.size() == 1) {
      numbers.push_back(parse_number(option, piece));
      continue;
    }
    if (parts.size() != 3) fail(option, piece, "a number or a series FROM:TO:STEP");
    const double from = parse_number(option, parts[0]), to = parse_number(option, parts[1]),
                 step = parse_number(option, parts[2]);
    const double steps = (to - from) / step;
    if (!(steps >= 0)) fail(option, piece, "a series FROM:TO:STEP whose steps lead from FROM to TO");
    if (steps > most) fail(option, piece, "a series of at most a million numbers");
    for (double i = 0; i <= steps + rounding; ++i) {
      const double number = from + i * step;
      numbers.push_back(std::abs(number - to) <= rounding * std::abs(step) ? to : number);
    }
  }
  return numbers;
}

std::int64_t parse_integer(std::string_view option, std::string_view text) {
  const auto number = spelled<std::int64_t>(text);
  if (!number || *number < 0) fail(option, text, "a whole number from 0 on");
  return *number;
}

std::uint64_t parse_bytes(std::string_view option, std::string_view text) {
  constexpr std::string_view right = "a size in bytes, such as 800M, 4G or 1.5GiB";
  const auto is_unit = [](char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z'); };
  std::string_view digits = text;
  while (!digits.empty() && is_unit(digits.back())) digits.remove_suffix(1);
  std::string unit(text.substr(digits.size()));
  std::ranges::transform(unit, unit.begin(), [](unsigned char c) { return std::toupper(c); });

  constexpr std::string_view prefixes = "KMGTPE";
  double factor = 1;
  if (!unit.empty() && unit != "B") {
    const auto power = prefixes.find(unit.front());
    const std::string rest = unit.substr(1);
    if (power == std::string_view::npos || !(rest.empty() || rest == "B" || rest == "IB"))
      fail(option, text, right);
    factor = std::pow(rest == "B" ? 1000 : 1024, static_cast<double>(power + 1));
  }
  const auto number = spelled<double>(digits);
  if (!number || !(*number >= 0)) fail(option, text, right);
  const double bytes = *number * factor;
  return bytes < 0x1p64 ? static_cast<std::uint64_t>(bytes) : UINT64_MAX;
}

std::vector<std::int64_t> parse_counts(std::string_view option, std::string_view text) {
  std::vector<std::int64_t> counts;
  for (const std::string& piece : split(text, ',')) {
    const auto count = spelled<std::int64_t>(piece);
    if (!count || *count < 1) fail(option, piece, "a number of samples, 1 or more");
    counts.push_back(*count);
  }
  return counts;
}

SampleType parse_sample_type(std::string_view option, std::string_view text) {
  const auto type = sample_type_named(std::string(text));
  if (!type) fail(option, text, "a sample type: u8, i8, u16, i16, u32, i32, f32 or f64");
  return *type;
}

IndexRange parse_range(std::string_view option, std::string_view text) {
  if (text.empty()) return {};
  const auto ends = split(text, ':');
  if (ends.size() != 2) fail(option, text, "a range of indices BEGIN:END");
  IndexRange range;
  for (const auto& [piece, end] : {std::pair{&ends[0], &range.begin}, std::pair{&ends[1], &range.end}}) {
    if (piece->empty()) continue;
    *end = spelled<std::int64_t>(*piece);
    if (!*end || **end < 0) fail(option, text, "a range of indices BEGIN:END");
  }
  return range;
}

std::vector<double> parse_levels(std::string_view option, const std::string& range) {
  if (range.find(':') == std::string::npos) return parse_numbers(option, range);
  const std::vector<std::string> parts = split(range, ':');
  if (parts.size() > 3) fail_usage(text(option, ": '", range, "' is not A:B, A:B:N or a list of levels"));
  const double low = parse_number(option, parts[0]), high = parse_number(option, parts[1]);
  const std::int64_t count = parts.size() == 3 ? parse_integer(option, parts[2]) : 2;
  if (count < 2 || count > 65536) fail_usage(text(option, ": ", count, " levels; there can be 2 to 65536"));
  std::vector<double> levels;
  for (std::int64_t i = 0; i < count; ++i)
    levels.push_back(std::lerp(low, high, static_cast<double>(i) / static_cast<double>(count - 1)));
  return levels;
}

} // namespace hyperiso::cli
