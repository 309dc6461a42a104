#pragma once
// Inside the program, and only there, an Error travels as an exception: a verb reads top to bottom and main
// reports whatever stopped it.

#include "hyperiso/result.hpp"

#include <utility>

namespace hyperiso::cli {

struct Failure {
  Error error;
};

[[noreturn]] inline void fail_usage(std::string message) {
  throw Failure{{Code::invalid_argument, std::move(message)}};
}

// The value of a result; throws Failure if there is none.
template <class T>
T take(Result<T> result) {
  if (!result) throw Failure{result.error()};
  return *std::move(result);
}
inline void take(const Status& status) {
  if (!status) throw Failure{status.error()};
}

} // namespace hyperiso::cli
