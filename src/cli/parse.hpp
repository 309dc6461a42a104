#pragma once
// The values of options: text -> numbers, ranges and sizes. Each function takes the name of the option for
// its message and throws Failure (wrong usage).

#include "hyperiso/field.hpp"

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace hyperiso::cli {

std::vector<std::string> split(std::string_view text, char separator);

double parse_number(std::string_view option, std::string_view text);               // finite
std::vector<double> parse_numbers(std::string_view option, std::string_view text); // "0.1,0.2"
// "0.1,0.2", "0:1:0.25" (from 0 to 1 in steps of 0.25, both ends included), or a mixture "0,1:2:0.5"
std::vector<double> parse_series(std::string_view option, std::string_view text);
std::int64_t parse_integer(std::string_view option, std::string_view text); // decimal, not negative
std::uint64_t parse_bytes(std::string_view option, std::string_view text);  // "512M", "1.5GiB", "2e9"
std::vector<std::int64_t> parse_counts(std::string_view option,
                                       std::string_view text); // "64,64,10", each >= 1
SampleType parse_sample_type(std::string_view option, std::string_view text);

// Samples [begin, end); what is left out is the first or the end of the axis.
struct IndexRange {
  std::optional<std::int64_t> begin, end;
};
IndexRange parse_range(std::string_view option, std::string_view text); // "2:10", "2:", ":10", ":", ""

// Levels: "a:b", "a:b:n" for n of them, or "a,b,...".
std::vector<double> parse_levels(std::string_view option, const std::string& range);

} // namespace hyperiso::cli
