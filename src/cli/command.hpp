#pragma once
// The verbs, one file each.

#include <CLI/App.hpp>

#include <functional>

namespace hyperiso::cli {

// Exit codes other than 0.
constexpr int exit_failure = 1; // the machine: I/O, memory; or a check that failed
constexpr int exit_usage = 2;   // the caller: wrong usage, unusable input

// A verb with its options declared; `run` works once they are parsed. It gives the exit code, or throws
// Failure, before anything appears on standard output.
struct Command {
  CLI::App* app;
  std::function<int()> run;
};

Command info_command(CLI::App& program);
Command extract_command(CLI::App& program);
Command interval_command(CLI::App& program);
Command slice_command(CLI::App& program);
Command track_command(CLI::App& program);
Command measure_command(CLI::App& program);
Command animate_command(CLI::App& program);
Command morph_command(CLI::App& program);
Command table_command(CLI::App& program);
Command sample_command(CLI::App& program);
Command convert_command(CLI::App& program);
Command view_command(CLI::App& program); // only where the viewer is built

} // namespace hyperiso::cli
