#pragma once
// Error messages from pieces: text("axis ", name, " has ", count, " samples").

#include <sstream>
#include <string>

namespace hyperiso {

template <class... Pieces>
std::string text(const Pieces&... pieces) {
  std::ostringstream out;
  out.precision(17);
  (out << ... << pieces);
  return out.str();
}

} // namespace hyperiso
