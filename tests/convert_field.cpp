// Reads a field and writes it: what the tests in Python compare with other readers and writers.
//
//     convert_field INPUT... OUTPUT [--gzip] [--steps BEGIN END]

#include "hyperiso/io.hpp"

#include <charconv>
#include <iostream>
#include <string_view>

namespace {

std::int64_t number(std::string_view word) {
  std::int64_t value = 0;
  std::from_chars(word.data(), word.data() + word.size(), value);
  return value;
}

int fail(const hyperiso::Error& error) {
  std::cerr << error.message << "\n";
  return 1;
}

} // namespace

int main(int count, char** words) {
  std::vector<std::filesystem::path> paths;
  hyperiso::WriteFieldOptions how;
  std::int64_t begin = 0, end = -1;
  for (int i = 1; i < count; ++i) {
    const std::string_view word = words[i];
    if (word == "--gzip") {
      how.compress = true;
    } else if (word == "--steps" && i + 2 < count) {
      begin = number(words[++i]);
      end = number(words[++i]);
    } else {
      paths.emplace_back(word);
    }
  }
  if (paths.size() < 2) return fail({hyperiso::Code::invalid_argument, "an input and an output are needed"});
  const std::filesystem::path output = paths.back();
  paths.pop_back();

  const auto reader = hyperiso::open_field(paths);
  if (!reader) return fail(reader.error());
  const auto field = (*reader)->read(begin, end < 0 ? (*reader)->info().axes.back().count : end);
  if (!field) return fail(field.error());
  const auto written = write_field(*field, output, how);
  return written ? 0 : fail(written.error());
}
