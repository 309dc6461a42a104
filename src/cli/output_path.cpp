#include "cli/output_path.hpp"

#include "cli/failure.hpp"
#include "cli/surface.hpp"
#include "core/text.hpp"

#include <charconv>
#include <filesystem>
#include <fmt/format.h>
#include <optional>

namespace hyperiso::cli {
namespace {

namespace fs = std::filesystem;

// Whether both name one file, through links too. What is no file, such as a terminal, is not replaced.
bool is_same_file(const fs::path& a, const fs::path& b) {
  std::error_code failure;
  return fs::is_regular_file(a, failure) && fs::equivalent(a, b, failure);
}

// The number that the digits of `name` before its suffix spell.
std::optional<std::size_t> number_in(const fs::path& name) {
  const std::string stem = name.stem().string();
  const std::size_t first = stem.find_last_not_of("0123456789") + 1;
  std::size_t number = 0;
  const auto read = std::from_chars(stem.data() + first, stem.data() + stem.size(), number);
  if (read.ec != std::errc{}) return std::nullopt;
  return number;
}

// Whether writing to `output`, by itself or with a number, replaces `input`.
bool replaces(const std::string& output, const fs::path& input) {
  if (is_same_file(output, input)) return true;
  const std::string suffix = fs::path(output).extension().string();
  if (suffix == ".vti" && is_same_file(fs::path(output).replace_extension("pvd"), input)) return true;
  const auto number = number_in(input);
  if (!number) return false;
  if (has_number_pattern(output)) return is_same_file(with_number("-o", output, *number), input);
  if (suffix != ".pvd" && suffix != ".vti") return false;
  const std::string of_series = fs::path(output).replace_extension(input.extension()).string();
  return is_same_file(with_suffix(of_series, fmt::format("{:04}", *number)), input);
}

std::vector<std::string> values_of(const CLI::App& verb, const char* option) {
  const CLI::Option* found = verb.get_option_no_throw(option);
  return found && found->count() > 0 ? found->results() : std::vector<std::string>{};
}

// The files that the verb was told to read, as far as they are named.
std::vector<std::string> inputs_of(const CLI::App& verb) {
  std::vector<std::string> inputs = values_of(verb, "INPUT");
  for (const std::string& given : values_of(verb, "--with")) {
    const auto equals = given.find('=');
    inputs.push_back(equals == std::string::npos ? given : given.substr(equals + 1));
  }
  return inputs;
}

} // namespace

void check_output(const CLI::App& verb) {
  const std::vector<std::string> given = values_of(verb, "--output");
  if (given.empty()) return;
  const std::string& output = given.front();
  // Standard output has the report; a file called "-" is nobody's wish.
  if (output == "-")
    fail_usage(
        "-o: results are not written to standard output, which has the report; name a file instead of -");
  for (const std::string& input : inputs_of(verb))
    if (replaces(output, input))
      fail_usage(text("-o: ", output, " would replace ", input, ", which is read; name another file"));
  const fs::path folder = fs::path(output).parent_path();
  std::error_code failure;
  const bool makes_folders = verb.get_name() == "track";
  if (!makes_folders && !folder.empty() && !has_number_pattern(folder.string()) &&
      !fs::exists(folder, failure))
    throw Failure{{Code::file_unwritable,
                   text("-o ", output, ": there is no folder ", folder.string(), "; make it first")}};
}

} // namespace hyperiso::cli
