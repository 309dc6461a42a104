#pragma once
// Whether what -o names can be written, told before anything is read or computed.

#include <CLI/App.hpp>

#include <string>
#include <vector>

namespace hyperiso::cli {

// Fails if -o of the verb is "-", lies where nothing can be written, or if what is written replaces a file
// that is read: by that name or another, or as one of several numbered files. A folder, which `track` writes,
// must be new, empty, or of an earlier run.
void check_output(const CLI::App& verb);

} // namespace hyperiso::cli
