#pragma once
// The text of --help.

#include <CLI/App.hpp>
#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>

#include <string>
#include <vector>

namespace hyperiso::cli {

struct Example {
  std::string what; // empty: it follows from the one before
  std::string command;
};

// What a manual says besides the options, which it lists in their groups.
struct Manual {
  std::vector<std::string> usage;      // without "hyperiso"
  std::vector<std::string> paragraphs; // an entry that starts with a space stays as it is, others are filled
  std::vector<Example> examples;
};

// Makes --help of `app` print its description, the manual and its options and verbs, at most 80 columns wide.
void set_manual(CLI::App& app, Manual manual);

} // namespace hyperiso::cli
