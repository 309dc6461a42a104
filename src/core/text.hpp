#pragma once
// Text for messages.

#include <charconv>
#include <cmath>
#include <cstdint>
#include <locale>
#include <sstream>
#include <string>
#include <type_traits>

namespace hyperiso {

// The shortest decimal number that reads back as the same bits: 0.1, not 0.10000000000000001.
template <class Real>
std::string shortest(Real number) {
  char digits[64];
  return std::string(digits, std::to_chars(digits, digits + sizeof digits, number).ptr);
}

// A message from pieces: text("axis ", name, " has ", count, " samples").
template <class... Pieces>
std::string text(const Pieces&... pieces) {
  std::ostringstream out;
  out.imbue(std::locale::classic()); // no thousands separators, whatever the program has set
  const auto put = [&](const auto& piece) {
    if constexpr (std::is_floating_point_v<std::decay_t<decltype(piece)>>)
      out << shortest(piece);
    else
      out << piece;
  };
  (put(pieces), ...);
  return out.str();
}

// A number of bytes for people: "512 B", "1.5 MiB".
inline std::string byte_size(std::uint64_t bytes) {
  constexpr const char* units[] = {"B", "KiB", "MiB", "GiB", "TiB", "PiB", "EiB"};
  auto amount = static_cast<double>(bytes);
  std::size_t unit = 0;
  for (; amount >= 1024; amount /= 1024) ++unit;
  return text(std::round(amount * 10) / 10, " ", units[unit]);
}

} // namespace hyperiso
