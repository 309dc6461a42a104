#pragma once
// Words and numbers in the headers of files. Nothing here trusts its input.

#include <charconv>
#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace hyperiso {

inline bool is_space(char c) { return c == ' ' || (c >= '\t' && c <= '\r'); }

inline std::string_view trimmed(std::string_view words) {
  while (!words.empty() && is_space(words.front())) words.remove_prefix(1);
  while (!words.empty() && is_space(words.back())) words.remove_suffix(1);
  return words;
}

inline std::string lower_case(std::string_view words) {
  std::string lower(words);
  for (char& c : lower)
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
  return lower;
}

// The next word, taken off the front of `rest`; empty if none is left. `is_separator(c)` ends a word.
template <class IsSeparator>
std::string_view next_word(std::string_view& rest, IsSeparator is_separator) {
  std::size_t begin = 0;
  while (begin < rest.size() && is_separator(rest[begin])) ++begin;
  std::size_t end = begin;
  while (end < rest.size() && !is_separator(rest[end])) ++end;
  const std::string_view word = rest.substr(begin, end - begin);
  rest.remove_prefix(end);
  return word;
}

// The next line, taken off the front of `rest`, without its end.
inline std::string_view next_line(std::string_view& rest) {
  const std::size_t end = rest.find('\n');
  std::string_view line = rest.substr(0, end);
  rest.remove_prefix(end == std::string_view::npos ? rest.size() : end + 1);
  if (!line.empty() && line.back() == '\r') line.remove_suffix(1);
  return line;
}

inline std::vector<std::string_view> split(std::string_view words) {
  std::vector<std::string_view> result;
  for (std::string_view word; !(word = next_word(words, is_space)).empty();) result.push_back(word);
  return result;
}

// The whole word as a number. Floating point: also nan, inf and a leading +. Nothing if it is not one or does
// not fit the type.
template <class T>
std::optional<T> number_from(std::string_view word) {
  if (word.size() > 1 && word[0] == '+' && word[1] != '-') word.remove_prefix(1);
  T value{};
  const char* end = word.data() + word.size();
  const auto [stop, error] = std::from_chars(word.data(), end, value);
  if (error != std::errc{} || stop != end) return std::nullopt;
  return value;
}

// As many numbers as there are words; nothing if one is not a number.
template <class T>
std::optional<std::vector<T>> numbers_from(std::string_view words) {
  std::vector<T> numbers;
  for (std::string_view word; !(word = next_word(words, is_space)).empty();) {
    const auto number = number_from<T>(word);
    if (!number) return std::nullopt;
    numbers.push_back(*number);
  }
  return numbers;
}

// What a file says, fit for one line of an error message.
inline std::string in_quotes(std::string_view words) {
  constexpr std::size_t longest = 60;
  std::string result = "'";
  for (const char c : words.substr(0, longest)) result += c >= ' ' && c != '\x7f' ? c : '?';
  return result + (words.size() > longest ? "...'" : "'");
}

} // namespace hyperiso
