#include "cli/output_path.hpp"

#include "cli/failure.hpp"
#include "cli/surface.hpp"
#include "cli/tracked_folder.hpp"
#include "core/text.hpp"
#include "io/atomic_file.hpp"

#include <algorithm>
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

bool names_files(const fs::path& input) {
  constexpr const char* suffixes[] = {".nrrd", ".nhdr", ".pvd", ".series"};
  return std::ranges::find(suffixes, input.extension().string()) != std::end(suffixes);
}

// The files that the verb was told to read, and those that they name.
std::vector<std::string> inputs_of(const CLI::App& verb) {
  std::vector<std::string> inputs = values_of(verb, "INPUT");
  for (const std::string& given : values_of(verb, "--with")) {
    const auto equals = given.find('=');
    inputs.push_back(equals == std::string::npos ? given : given.substr(equals + 1));
  }
  for (std::size_t named = inputs.size(); named-- > 0;) {
    if (!names_files(inputs[named])) continue;
    if (const auto reader = open_field({inputs[named]})) // else the verb says why not
      for (const fs::path& file : (*reader)->files()) inputs.push_back(file.string());
  }
  return inputs;
}

// Names that a table, a picture or a mesh would have: `track` writes all of them, into one folder.
bool looks_like_file(const fs::path& path) {
  constexpr const char* suffixes[] = {".csv", ".tsv", ".txt", ".json", ".xml",    ".graphml", ".gexf", ".dot",
                                      ".svg", ".png", ".pdf", ".html", ".vtu",    ".vtp",     ".vti",  ".vtk",
                                      ".pvd", ".ply", ".stl", ".obj",  ".off",    ".glb",     ".mp4",  ".gif",
                                      ".npy", ".npz", ".raw", ".nrrd", ".series", ".geojson"};
  return std::ranges::find(suffixes, path.extension().string()) != std::end(suffixes);
}

// What is in a folder beside hidden files, the first by name.
std::optional<std::string> something_in(const fs::path& folder) {
  std::optional<std::string> first;
  std::error_code failure;
  for (const auto& entry : fs::directory_iterator(folder, failure)) {
    const std::string name = entry.path().filename().string();
    if (!name.starts_with('.') && (!first || name < *first)) first = name;
  }
  return first;
}

void check_folder(const std::string& output, const std::vector<std::string>& selected) {
  for (const std::string& select : selected) // FOLDER:ID
    if (std::error_code failure; fs::equivalent(output, select.substr(0, select.rfind(':')), failure))
      fail_usage(text("-o: ", output, " is the folder that --select reads; name another"));
  std::error_code failure;
  if (!fs::exists(output, failure)) {
    if (looks_like_file(output))
      fail_usage(text("-o: track writes a folder of tables, graphs and surfaces, and ", output,
                      " is the name of a file; name a folder, such as ",
                      fs::path(output).replace_extension().string()));
    FileGroup attempt;
    return take(attempt.make_folder(output));
  }
  if (!fs::is_directory(output, failure))
    fail_usage(text("-o: ", output, " is a file, and track writes a folder of them; name another"));
  const fs::path folder = output;
  if (const auto other = something_in(folder); other && !files_of_tracked_folder(output))
    fail_usage(text("-o: ", output, " holds files that track did not write, such as ", *other,
                    "; name a new or an empty folder, such as ", (folder / "tracks").string()));
  take(AtomicFile::create(folder / "tracks.csv"));
}

void check_file(const fs::path& output) {
  const fs::path folder = output.parent_path();
  if (has_number_pattern(folder.string())) return;
  std::error_code failure;
  if (!folder.empty() && !fs::exists(folder, failure))
    throw Failure{{Code::file_unwritable, text("-o ", output.string(), ": there is no folder ",
                                               folder.string(), "; make it first")}};
  const bool has_place = !fs::exists(output, failure) || fs::is_regular_file(output, failure);
  if (has_place) take(AtomicFile::create(output));
}

} // namespace

void check_output(const CLI::App& verb) {
  const std::vector<std::string> given = values_of(verb, "--output");
  if (given.empty() || given.front().empty()) return;
  const std::string& output = given.front();
  // Standard output has the report; a file called "-" is nobody's wish.
  if (output == "-")
    fail_usage(
        "-o: results are not written to standard output, which has the report; name a file instead of -");
  for (const std::string& input : inputs_of(verb))
    if (replaces(output, input))
      fail_usage(text("-o: ", output, " would replace ", input, ", which is read; name another file"));
  if (verb.get_name() == "track")
    check_folder(output, values_of(verb, "--select"));
  else
    check_file(output);
}

} // namespace hyperiso::cli
