#include "cli/manual.hpp"

#include <algorithm>
#include <fmt/format.h>
#include <sstream>

namespace hyperiso::cli {
namespace {

constexpr std::size_t line_width = 80;
constexpr std::size_t text_column = 24; // of the descriptions of options

// Words filled into lines that all start at `indent`; the first one is there already.
std::string filled(const std::string& words, std::size_t indent) {
  std::istringstream in(words);
  std::string out;
  std::size_t column = indent;
  for (std::string word; in >> word;) {
    const bool first = column == indent;
    if (!first && column + 1 + word.size() > line_width) {
      out += '\n' + std::string(indent, ' ');
      column = indent;
    } else if (!first) {
      out += ' ';
      ++column;
    }
    out += word;
    column += word.size();
  }
  return out;
}

// A command over as many lines as it takes, to be pasted into a shell.
std::string command_lines(const std::string& command) {
  constexpr std::size_t indent = 2, deeper = 4;
  std::istringstream in(command);
  std::string out(indent, ' ');
  std::size_t column = indent;
  for (std::string word; in >> word;) {
    const bool first = column == indent;
    if (!first && column + 1 + word.size() + 2 > line_width) {
      out += " \\\n" + std::string(deeper, ' ');
      column = deeper;
    } else if (!first) {
      out += ' ';
      ++column;
    }
    out += word;
    column += word.size();
  }
  return out + '\n';
}

// "  left      description, in as many lines as it takes".
std::string row(const std::string& left, const std::string& description) {
  const bool fits = left.size() + 3 < text_column;
  std::string out = "  " + left;
  out += fits ? std::string(text_column - out.size(), ' ') : '\n' + std::string(text_column, ' ');
  return out + filled(description, text_column) + '\n';
}

std::string left_of(const CLI::Option& option) {
  if (option.get_positional()) return option.get_name() + (option.get_expected_max() > 1 ? "..." : "");
  std::string names;
  for (const auto& name : option.get_snames()) names += (names.empty() ? "-" : ", -") + name;
  for (const auto& name : option.get_lnames()) names += (names.empty() ? "--" : ", --") + name;
  return option.get_type_name().empty() ? names : names + ' ' + option.get_type_name();
}

std::string options_of(const CLI::App& app, const std::string& group) {
  std::string rows;
  for (const CLI::Option* option : app.get_options())
    if (option->get_group() == group) rows += row(left_of(*option), option->get_description());
  return rows.empty() ? rows : fmt::format("\n{}:\n{}", group, rows);
}

std::string verbs_of(const CLI::App& app) {
  std::string rows;
  for (const CLI::App* verb : app.get_subcommands(nullptr))
    rows += row(verb->get_name(), verb->get_description());
  return rows.empty() ? rows : "\nVerbs:\n" + rows;
}

std::string manual_of(const CLI::App& app, const Manual& manual, const std::string& name) {
  std::string out = fmt::format("{}: {}\n\nUsage:\n", name, app.get_description());
  for (const std::string& usage : manual.usage) out += fmt::format("  hyperiso {}\n", usage);
  for (const std::string& paragraph : manual.paragraphs)
    out += '\n' + (paragraph.starts_with(' ') ? paragraph : filled(paragraph, 0)) + '\n';
  out += verbs_of(app);
  for (const std::string& group : app.get_groups())
    if (group != "Options") out += options_of(app, group);
  out += options_of(app, "Options"); // --help
  if (!manual.examples.empty()) out += "\nExamples:\n";
  for (const Example& example : manual.examples) {
    if (!example.what.empty()) out += fmt::format("  # {}\n", example.what);
    out += command_lines(example.command);
  }
  return out;
}

} // namespace

void set_manual(CLI::App& app, Manual manual) {
  app.formatter_fn([manual = std::move(manual)](const CLI::App* shown, std::string name, CLI::AppFormatMode) {
    return manual_of(*shown, manual, name);
  });
}

} // namespace hyperiso::cli
