// For builds without the viewer.

#include "view/shell.hpp"

namespace hyperiso {

std::span<const unsigned char> compressed_shell() { return {}; }
std::span<const unsigned char> compressed_core() { return {}; }

} // namespace hyperiso
