#include "cli/frames.hpp"

#include "cli/dispatch.hpp"
#include "cli/failure.hpp"
#include "core/text.hpp"
#include "hyperiso/slice.hpp"
#include "hyperiso/track.hpp"
#include "hyperiso/view.hpp"
#include "view/track_labels.hpp"

#include <algorithm>
#include <cmath>

namespace hyperiso::cli {
namespace {

constexpr int lowest_animated = 3;

std::pair<double, double> ends_of(const Axis& axis) {
  return std::minmax({axis.coordinate(0), axis.coordinate(axis.count - 1)});
}

// What the map to the world does to time: scale * t + offset. Fails where it mixes time with space.
struct WorldTime {
  double scale = 1, offset = 0;

  explicit WorldTime(const FieldInfo& info) {
    if (!info.world) return;
    const std::size_t D = info.axes.size();
    const double* row = &info.world->linear[(D - 1) * D];
    if (std::any_of(row, row + D - 1, [](double share) { return share != 0; }))
      fail_usage("the field's map to the world mixes time with space: there are no frames of one moment");
    scale = row[D - 1];
    offset = info.world->offset[D - 1];
  }
  double operator()(double time) const { return scale * time + offset; }
  Axis operator()(Axis axis) const {
    axis.origin = (*this)(axis.origin);
    axis.spacing *= scale;
    for (double& coordinate : axis.coordinates) coordinate = (*this)(coordinate);
    return axis;
  }
};

// Names the simplices of a surface in space and time by the track that their earliest corner is in.
void add_track_ids(Mesh& mesh, const TrackingGraph& graph) {
  const std::vector<std::int32_t> of_vertices = tracks_of_vertices(mesh, graph);
  const auto D = static_cast<std::size_t>(mesh.dimension);
  std::vector<std::int32_t> tracks(mesh.simplex_count(), -1);
  for (std::size_t simplex = 0; simplex < tracks.size(); ++simplex) {
    double earliest = HUGE_VAL;
    for (std::size_t corner = 0; corner < D; ++corner) {
      const std::size_t vertex = mesh.simplices[simplex * D + corner];
      const double time = mesh.positions[vertex * D + D - 1];
      if (of_vertices[vertex] < 0 || !(time < earliest)) continue;
      earliest = time;
      tracks[simplex] = of_vertices[vertex];
    }
  }
  mesh.attributes.push_back({"track_id", Attribute::Location::simplex, 1, std::move(tracks)});
}

std::vector<double> times_of_events(const TrackingGraph& graph, const WorldTime& world_time) {
  std::vector<double> times;
  for (const TrackingEvent& event : graph.events)
    if (event.type != EventType::open_start && event.type != EventType::open_end)
      times.push_back(world_time(event.time));
  return times;
}

template <int D>
class FieldFrames final : public Frames {
 public:
  FieldFrames(std::unique_ptr<SelectedSteps> steps, std::vector<NamedSteps> others, double isovalue,
              ExtractOptions extraction, bool normals, bool quiet)
      : steps_(std::move(steps)), others_(std::move(others)), isovalue_(isovalue), extraction_(extraction),
        slicer_(*steps_, isovalue, options_of(extraction, normals)), quiet_(quiet),
        world_time_(steps_->info()), axes_(steps_->info().axes) {
    axes_.back() = world_time_(axes_.back());
  }

  const std::vector<Axis>& axes() const override { return axes_; }
  std::pair<double, double> times() const override { return ends_of(axes().back()); }
  void check(double time) const override { (void)take(samples_around(axes().back(), time)); }
  double read_seconds() const override { return steps_->read_seconds(); }

  Mesh at(double time) override {
    const double on_axis = on_axis_at(time);
    Mesh mesh = take(slicer_.slice(Hyperplane<D>::at(D - 1, on_axis)));
    if (world()) transform(mesh, at_coordinate(*world(), D - 1, on_axis));
    return mesh;
  }
  MovingFrame moving(double time, double until) override {
    const double on_axis = on_axis_at(time);
    auto slice = take(slicer_.moving_slice(on_axis, on_axis_at(until)));
    MovingFrame frame{std::move(slice.start), std::move(slice.end)};
    if (!world()) return frame;
    for (std::size_t row = 0; row + 1 < D; ++row)
      if (world()->linear[row * D + D - 1] != 0)
        fail_usage("--morph: the field's map to the world moves space with time; what stops within a frame "
                   "would go on");
    for (Mesh* mesh : {&frame.start, &frame.end}) transform(*mesh, at_coordinate(*world(), D - 1, on_axis));
    return frame;
  }

  std::vector<double> events() override {
    ProgressBar bar("track", quiet_);
    TrackOptions tracking;
    tracking.extraction = extraction_;
    tracking.extraction.progress = bar.callback();
    tracking.measure_features = false;
    return times_of_events(take(track(*steps_, isovalue_, tracking)), world_time_);
  }

 private:
  const std::optional<Affine>& world() const { return steps_->info().world; }
  double on_axis_at(double time) const {
    const SampleRange around = take(samples_around(axes().back(), time));
    const bool at_step = around.end - around.begin == 1; // then to the bit
    return at_step ? steps_->info().axes.back().coordinate(around.begin)
                   : (time - world_time_.offset) / world_time_.scale;
  }
  FieldSliceOptions options_of(const ExtractOptions& extraction, bool normals) const {
    FieldSliceOptions options;
    static_cast<ExtractOptions&>(options) = extraction;
    options.with_normals = normals;
    for (const NamedSteps& other : others_) options.others.push_back({other.name, other.steps.get()});
    return options;
  }

  std::unique_ptr<SelectedSteps> steps_;
  std::vector<NamedSteps> others_;
  double isovalue_;
  ExtractOptions extraction_;
  FieldSlicer<D> slicer_;
  bool quiet_;
  WorldTime world_time_;
  std::vector<Axis> axes_; // time as it is in the world
};

template <int D>
class MeshFrames final : public Frames {
 public:
  // `events`: where they are known.
  MeshFrames(Mesh&& mesh, Precision precision, double read_seconds,
             std::optional<std::vector<double>> events = std::nullopt)
      : mesh_(std::move(mesh)), index_(mesh_), axes_(axes_of(mesh_)), precision_(precision),
        read_seconds_(read_seconds), events_(std::move(events)) {
    if (knows_times()) return;
    times_ = {HUGE_VAL, -HUGE_VAL};
    for (std::size_t vertex = 0; vertex < mesh_.vertex_count(); ++vertex) {
      const double time = mesh_.positions[vertex * D + D - 1];
      times_ = {std::min(times_.first, time), std::max(times_.second, time)};
    }
  }

  const std::vector<Axis>& axes() const override { return axes_; }
  std::pair<double, double> times() const override { return knows_times() ? ends_of(axes_.back()) : times_; }
  void check(double time) const override {
    if (knows_times())
      (void)take(samples_around(axes_.back(), time));
    else if (!(times_.first <= time && time <= times_.second))
      fail_usage(text("time ", time, " is outside the surface, which is there from ", times_.first, " to ",
                      times_.second));
  }
  double read_seconds() const override { return read_seconds_; }
  Mesh at(double time) override {
    return take(index_.slice(mesh_, Hyperplane<D>::at(D - 1, time), {.precision = precision_}));
  }
  MovingFrame moving(double time, double until) override {
    auto slice = take(moving_slice(mesh_, time, until, precision_));
    return {std::move(slice.start), std::move(slice.end)};
  }
  std::vector<double> events() override {
    if (events_) return *events_;
    fail_usage("--events: the input is a mesh; finding events needs the field");
  }

 private:
  bool knows_times() const { return axes_.back().count > 0 && std::isfinite(axes_.back().coordinate(0)); }

  SimplexMesh<D> mesh_;
  SliceIndex<D> index_;
  std::vector<Axis> axes_;
  Precision precision_;
  double read_seconds_;
  std::optional<std::vector<double>> events_;
  std::pair<double, double> times_; // where the mesh does not know its grid
};

} // namespace

std::unique_ptr<Frames> frames_of_field(const FieldOptions& input, double isovalue,
                                        const SurfaceOptions& surface, const PointDataOptions& data,
                                        bool normals, const MachineOptions& machine,
                                        const PrintOptions& printing) {
  (void)surface.extract_options(machine); // wrong ones are told before anything is read
  auto steps = std::make_unique<SelectedSteps>(input.open(machine), input);
  steps->leave_out_flat_axes(lowest_animated);
  check_dimension(steps->info().dimension(), lowest_animated, highest_dimension, "the field");
  check_axes(steps->info());
  auto others = data.open(input, machine);
  for (const NamedSteps& other : others) other.steps->leave_out_flat_axes();
  const int dimension = steps->info().dimension();
  return with_dimension<lowest_animated>(dimension, "the field", [&](auto D) -> std::unique_ptr<Frames> {
    return std::make_unique<FieldFrames<decltype(D)::value>>(std::move(steps), std::move(others), isovalue,
                                                             surface.extract_options(machine), normals,
                                                             printing.quiet);
  });
}

std::unique_ptr<Frames> frames_with_tracks(const FieldOptions& input, const TrackingOptions& tracking,
                                           const TrackedFolder* folder, const SurfaceOptions& surface,
                                           const PointDataOptions& data, bool normals,
                                           const MachineOptions& machine, const PrintOptions& printing) {
  if (surface.method == "barycentric")
    fail_usage("--tracks: surfaces by --method barycentric have no grid edges to find their tracks by");
  const TrackOptions track_options = tracking.track_options(surface, machine);
  const double isovalue = tracking.isovalue();
  SelectedSteps steps(input.open(machine), input);
  steps.leave_out_flat_axes(lowest_animated);
  check_dimension(steps.info().dimension(), lowest_animated, highest_dimension, "the field");
  check_axes(steps.info());
  if (folder) folder->check_field(steps.info());
  const WorldTime world_time(steps.info());
  const std::int64_t count = steps.info().axes.back().count;
  const Field field = take(steps.read(0, count));
  std::vector<NamedField> others;
  for (const NamedSteps& other : data.open(input, machine)) {
    other.steps->leave_out_flat_axes();
    others.push_back({other.name, take(other.steps->read(0, other.steps->info().axes.back().count))});
  }
  FieldSteps in_memory(field);
  TrackingGraph graph = tracking.track(in_memory, track_options, printing.quiet);
  if (folder) folder->check_tracks(graph);
  take(use_boundary_pieces(graph, in_memory, track_options));

  const ExtractOptions extraction = surface.extract_options(machine); // with the memory that is left now
  return with_view<lowest_animated>(field, [&]<class T, int D>(const FieldView<T, D>& view) {
    Mesh mesh = take(extract(view, isovalue, extraction));
    if (normals || !others.empty())
      take(add_point_data(mesh, field, isovalue, extraction.inside, others, normals));
    add_track_ids(mesh, graph);
    if (field.info.world) transform(mesh, *field.info.world);
    return std::unique_ptr<Frames>(std::make_unique<MeshFrames<D>>(
        std::move(mesh), extraction.precision, steps.read_seconds(), times_of_events(graph, world_time)));
  });
}

std::unique_ptr<Frames> frames_of_mesh(const std::string& path, const SurfaceOptions& surface,
                                       const MachineOptions& machine, const PrintOptions& printing) {
  const Precision precision = surface.extract_options(machine).precision;
  const Stopwatch reading;
  Mesh mesh = mesh_in(path, printing.quiet);
  const double read_seconds = reading.seconds();
  if (mesh.simplex_dimension != mesh.dimension - 1)
    fail_usage(
        text(path, ": it holds ", simplex_noun(mesh.simplex_dimension), " in ", mesh.dimension,
             " dimensions; frames are cut from a surface through time, of tetrahedra in 4 dimensions or ",
             "triangles in 3"));
  return with_dimension<lowest_animated>(mesh.dimension, "the mesh", [&](auto D) -> std::unique_ptr<Frames> {
    return std::make_unique<MeshFrames<decltype(D)::value>>(std::move(mesh), precision, read_seconds);
  });
}

} // namespace hyperiso::cli
