#include "hyperiso/result.hpp"

namespace hyperiso {

bool is_usage_error(Code code) {
  switch (code) {
  case Code::out_of_memory:
  case Code::cancelled:
  case Code::internal:
  case Code::file_unwritable:
    return false;
  default:
    return true;
  }
}

} // namespace hyperiso
