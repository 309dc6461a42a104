// The program: picks the verb, runs it, and turns whatever stops it into one line and an exit code.

#include "cli/command.hpp"
#include "cli/console.hpp"
#include "cli/failure.hpp"
#include "cli/manual.hpp"
#include "cli/output_path.hpp"
#include "cli/signals.hpp"
#include "core/text.hpp"

#include <algorithm>
#include <exception>
#include <new>
#include <vector>

namespace hyperiso::cli {
namespace {

constexpr const char* short_help =
    "hyperiso " HYPERISO_VERSION ": isosurfaces of volumes that change over time\n"
    "\n"
    "  hyperiso info FILE                          what does it hold?\n"
    "  hyperiso extract FILE --iso 0.5 -o out.vtu  the surface through all of time\n"
    "  hyperiso slice out.vtu --time 0.3 -o at.vtp the surface at any time\n"
#ifdef HYPERISO_HAS_VIEWER
    "  hyperiso view FILE --iso 0.5 -o out.html    a page that plays it\n"
#endif
    "\n"
    "'hyperiso --help' says all, 'hyperiso VERB --help' all about a verb.\n";

Manual program_manual() {
  return {{"VERB INPUT... [options]", "VERB --help", "--version"},
          {"Isosurfaces of 2D, 3D and 4D fields; the fourth axis is usually time. The surface of a volume "
           "that changes "
           "over time is one mesh of tetrahedra in space and time, and can be cut at any moment.",
           "Axis 0 varies fastest in memory (x), the last axis slowest (usually t). A sample is inside if it "
           "is at "
           "least the isovalue. Results go to standard output, messages and the progress bar to standard "
           "error. A run "
           "that fails leaves the files that were there.",
           "  Exit code  0  success\n"
           "             1  the machine failed: reading, writing, memory; or a check failed\n"
           "             2  wrong usage, or an input that cannot be used\n"
           "           130  interrupted (Ctrl-C)"},
          {{"what is in a file?", "hyperiso info examples/data/alpha_water_24x24x24x41.nrrd"},
           {"the surface through all of time, and at one moment",
            "hyperiso extract examples/data/alpha_water_24x24x24x41.nrrd --iso 0.5 -o water.vtu"},
           {"", "hyperiso slice water.vtu --time 0.33 -o water_0.33.ply"}}};
}

// The verb that was asked for, or none.
const Command* chosen(const std::vector<Command>& commands) {
  const auto found =
      std::ranges::find_if(commands, [](const Command& command) { return command.app->parsed(); });
  return found == commands.end() ? nullptr : &*found;
}

// CLI11 takes a first word that is no verb for a stray argument; this names it.
void check_verb(const CLI::App& program, const std::vector<std::string>& arguments) {
  const std::string& word = arguments.front();
  if (word.starts_with('-') ||
      std::ranges::any_of(program.get_subcommands(nullptr),
                          [&](const CLI::App* verb) { return verb->get_name() == word; }))
    return;
  std::string verbs;
  for (const CLI::App* verb : program.get_subcommands(nullptr))
    verbs += (verbs.empty() ? "" : ", ") + verb->get_name();
  fail_usage(text("there is no verb '", word, "'; there are ", verbs));
}

// CLI11 takes the argument that follows for the missing value.
void check_values(const std::vector<std::string>& arguments) {
  for (const std::string& argument : arguments)
    if (argument.size() > 3 && argument.starts_with("--") && argument.find('=') == argument.size() - 1)
      fail_usage(text(argument, " has no value; write it after the =, or leave the option out"));
}

// What the verb has to offer where memory does not suffice.
std::string memory_advice(const CLI::App& verb) {
  const auto has = [&](const char* option) { return verb.get_option_no_throw(option) != nullptr; };
  if (!has("--memory")) return {};
  std::string advice = "; --memory sets the limit";
  if (has("--crop")) return advice + ", --crop and --steps take less";
  return has("--dims") ? advice + ", smaller --dims take less" : advice;
}

int run(std::vector<std::string> arguments) {
  if (arguments.empty()) {
    print_usage(short_help);
    return exit_usage;
  }
  CLI::App program("isosurfaces of volumes that change over time", "hyperiso");
  program.set_help_flag("-h,--help", "print this manual; after a verb, that of the verb");
  program.set_version_flag("--version", "hyperiso " HYPERISO_VERSION, "print the version");
  program.require_subcommand(1);
  set_manual(program, program_manual());
  std::vector<Command> commands = {
      info_command(program),    extract_command(program), interval_command(program), slice_command(program),
      animate_command(program), morph_command(program),   track_command(program),    measure_command(program),
      table_command(program),   sample_command(program),  convert_command(program)};
#ifdef HYPERISO_HAS_VIEWER
  commands.push_back(view_command(program));
#endif
  check_verb(program, arguments);
  check_values(arguments);
  try {
    std::ranges::reverse(arguments); // as CLI11 takes them
    program.parse(std::move(arguments));
  } catch (const CLI::CallForHelp&) {
    print(program.help());
    return 0;
  } catch (const CLI::CallForVersion& version) {
    print(text(version.what(), '\n'));
    return 0;
  } catch (const CLI::ParseError& error) {
    const Command* command = chosen(commands);
    fail_usage(
        text(error.what(), "; see 'hyperiso ", command ? command->app->get_name() + " " : "", "--help'"));
  }
  const Command& command = *chosen(commands);
  check_output(*command.app);
  try {
    return command.run();
  } catch (Failure& failure) {
    if (failure.error.code == Code::out_of_memory) failure.error.message += memory_advice(*command.app);
    throw;
  }
}

int report(const Error& error) {
  print_error(error.message);
  if (error.code == Code::cancelled) return 130;
  return is_usage_error(error.code) ? exit_usage : exit_failure;
}

} // namespace
} // namespace hyperiso::cli

int main(int argc, char** argv) {
  using namespace hyperiso;
  cli::install_signal_handlers();
  try {
    return cli::run({argv + std::min(argc, 1), argv + argc});
  } catch (const cli::Failure& failure) {
    return cli::report(failure.error);
  } catch (const cli::ReaderGone&) {
    return 0;
  } catch (const std::bad_alloc&) {
    return cli::report({Code::out_of_memory, "not enough memory"});
  } catch (const std::exception& unexpected) {
    return cli::report({Code::internal, text("unexpected: ", unexpected.what())});
  }
}
