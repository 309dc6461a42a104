#pragma once
// The options that verbs share, in groups: each group declares its options and turns them into what the
// library takes. All functions throw Failure where an option has no meaning.

#include "hyperiso/extract.hpp"
#include "hyperiso/io.hpp"

#include <CLI/App.hpp>

#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace hyperiso::cli {

// --json, --quiet
struct PrintOptions {
  bool json = false;
  bool quiet = false;

  void add_to(CLI::App& app);
};

// --memory, --threads
struct MachineOptions {
  std::string memory, threads;

  void add_to(CLI::App& app);
  // Bytes the program may hold: --memory, or 80 % of what is free now.
  std::uint64_t memory_limit() const;
  // The same, less what it holds already.
  std::uint64_t memory_left() const;
  int thread_count() const; // 0: one per processor
};

// The samples that were asked for: of which axis which part.
struct Selection {
  std::vector<std::pair<std::int64_t, std::int64_t>> ranges; // [begin, end) per axis
};

// INPUT..., --variable, --time-axis, --crop, --steps and the description of raw files
struct FieldOptions {
  std::vector<std::string> paths;
  std::string variable, time_axis, crop, steps, dims, type, skip;
  bool big_endian = false;

  // Declares INPUT..., then the rest. `instead` is what INPUT may be besides a field.
  void add_to(CLI::App& app, const std::string& instead = {});
  std::unique_ptr<FieldReader> open(const MachineOptions& machine) const;
  // What --crop and --steps leave of a field.
  Selection selection(const FieldInfo& info) const;
};

// The description of what was selected.
FieldInfo selected(const FieldInfo& info, const Selection& selection);

// Reads the selected samples: along the last axis only these, of the others all, cropped then. Shows that it
// does, unless `quiet`.
Field read_selection(FieldReader& reader, const Selection& selection, bool quiet = true);

// --iso
std::vector<double> parse_isovalues(const std::string& iso);

// --method, --cut, --inside, --precision
struct SurfaceOptions {
  std::string method = "hull", cut, inside = "above", precision = "f32";

  void add_to(CLI::App& app);
  // For a surface that is made now, with the memory that is left now.
  ExtractOptions extract_options(const MachineOptions& machine) const;
};

// -o, --format
struct MeshOutputOptions {
  std::string path, format;

  // `several` says how several results are named.
  void add_to(CLI::App& app, const std::string& several);
  bool wanted() const { return !path.empty(); }
  // Fails if the format of the file `written` cannot hold simplices of dimension `simplex_dimension` in
  // R^dimension.
  void check(int dimension, int simplex_dimension, const std::string& written) const;
  // The name of the format that a file is written in: "vtu", "ply", ...
  std::string format_of(const std::string& written) const;
  WriteMeshOptions write_options(const std::vector<Axis>& axes, FileGroup& group) const;
};

// -o, --compress
struct FieldOutputOptions {
  std::string path;
  bool compress = false;

  void add_to(CLI::App& app);
  // Fails if there is no path or no format there for such a field.
  void check(const FieldInfo& info) const;
  // Gives the seconds it took.
  double write(const Field& field, bool quiet) const;
  // What is there then, for people.
  std::string files_of(const FieldInfo& info) const;

 private:
  WriteFieldOptions write_options() const;
};

} // namespace hyperiso::cli
