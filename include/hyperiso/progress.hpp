#pragma once
/// \file
/// How long work tells how far it is, and is told to stop.

#include <functional>

namespace hyperiso {

/// Called now and then, from one thread, with the share done in [0, 1]; returns false to cancel: the work
/// then ends with Code::cancelled.
using Progress = std::function<bool(double)>;

} // namespace hyperiso
