#pragma once
// Whether what -o names can be written, told before anything is read or computed.

#include <CLI/App.hpp>

#include <string>
#include <vector>

namespace hyperiso::cli {

// Fails if -o of the verb is "-", lies in a folder that is not there, or if what is written replaces a file
// that is read: by that name or another, or as one of several numbered files.
void check_output(const CLI::App& verb);

} // namespace hyperiso::cli
