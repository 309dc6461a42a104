#pragma once
// What the vertices of a surface carry: --with, --normals, --colour-by.

#include "cli/options.hpp"
#include "hyperiso/colours.hpp"
#include "hyperiso/interpolate.hpp"

namespace hyperiso::cli {

// The samples that were selected, as a source of steps of their own. Keeps the steps it read last, for those
// who ask for the same again, and the seconds that reading took.
class SelectedSteps final : public StepSource {
 public:
  SelectedSteps(std::unique_ptr<FieldReader> reader, const FieldOptions& input);
  const FieldInfo& info() const override { return info_; }
  Result<Field> read(std::int64_t begin, std::int64_t end) override;
  double read_seconds() const { return read_seconds_; }

  // From now on without its axes of one sample, but for the last. Fails, naming one, if it has no more than
  // `lowest` axes with it.
  void leave_out_flat_axes(int lowest = 1);

 private:
  std::unique_ptr<FieldReader> reader_;
  Selection selection_;
  FieldInfo info_;
  std::vector<std::size_t> axes_; // of the file, those that info_ has
  std::optional<Field> held_;     // steps held_begin_ to held_end_
  std::int64_t held_begin_ = 0, held_end_ = 0;
  double read_seconds_ = 0;
};

// A field of --with and what it is called.
struct NamedSteps {
  std::string name;
  std::unique_ptr<SelectedSteps> steps;
};

struct PointDataOptions {
  std::vector<std::string> with;
  bool normals = false;
  std::string colour_by, colour_range;

  // `coloured`: what --colour-by is for; `whole`: what the range is taken of where none is given.
  void add_to(CLI::App& app, const std::string& coloured = ".ply",
              const std::string& whole = "of each file, so give it for a series");
  std::optional<ColourRange> range() const; // --colour-range
  // Whether the field has to be looked at again once there is a surface.
  bool from_field() const { return normals || !with.empty(); }
  // Fails where what is asked for cannot be written as asked.
  void check(const MeshOutputOptions& output, const std::string& path) const;
  // The fields of --with: files, or variables of the input.
  std::vector<NamedSteps> open(const FieldOptions& input, const MachineOptions& machine) const;
  // Colours the vertices, if asked to.
  void colour(Mesh& mesh) const;
};

} // namespace hyperiso::cli
