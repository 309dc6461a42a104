#pragma once
/// \file
/// A value or an Error. Whatever goes wrong with data, files, options or memory comes back through Result: no
/// exception leaves a call that gives one. Others may throw std::bad_alloc. Nothing here prints or exits.

#include <cassert>
#include <string>
#include <utility>
#include <variant>

namespace hyperiso {

/// What kind of thing went wrong. Ranges per folder of src/; stable across releases.
enum class Code : int {
  // core, 100...
  invalid_argument = 100, ///< an option or argument has no meaning: `message` says what would be right
  out_of_memory = 101,    ///< the result would pass the memory limit, or the system refused the memory
  cancelled = 102,        ///< the progress callback asked to stop
  internal = 103,         ///< a defect of hyperiso itself
  // table, 200...
  unsupported_dimension = 200,
  // extract, slice, 300...
  invalid_isovalue = 300,
  outside_domain = 301, ///< a plane, a time or a range that misses the data
  // io, 400...
  file_not_found = 400,
  file_unreadable = 401,  ///< exists but cannot be opened or read
  file_malformed = 402,   ///< its content contradicts itself or its format
  file_unsupported = 403, ///< a well-formed file that uses something hyperiso does not read
  file_unwritable = 404,
};

struct Error {
  Code code;
  std::string message; ///< one line: what is wrong, where (file, axis, value), what would be right
};

/// True where the caller gave something unusable (the program exits with 2); false where the machine failed
/// (it exits with 1).
bool is_usage_error(Code code);

/// A value of type T or an Error. Test it, then dereference it.
template <class T>
class [[nodiscard]] Result {
 public:
  Result(T value) : state_(std::in_place_index<0>, std::move(value)) {}
  Result(Error error) : state_(std::in_place_index<1>, std::move(error)) {}

  explicit operator bool() const { return state_.index() == 0; }
  T& operator*() & { return assert(*this), *std::get_if<0>(&state_); }
  const T& operator*() const& { return assert(*this), *std::get_if<0>(&state_); }
  T&& operator*() && { return assert(*this), std::move(*std::get_if<0>(&state_)); }
  T* operator->() { return &**this; }
  const T* operator->() const { return &**this; }
  const Error& error() const { return assert(!*this), *std::get_if<1>(&state_); }

 private:
  std::variant<T, Error> state_;
};

/// Success or an Error.
template <>
class [[nodiscard]] Result<void> {
 public:
  Result() = default;
  Result(Error error) : error_(std::move(error)), failed_(true) {}

  explicit operator bool() const { return !failed_; }
  const Error& error() const { return assert(failed_), error_; }

 private:
  Error error_{};
  bool failed_ = false;
};

using Status = Result<void>;

} // namespace hyperiso
