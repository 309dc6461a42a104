// What holds for every history, on real data.

#include "hyperiso/io.hpp"
#include "hyperiso/measure.hpp"
#include "hyperiso/slice.hpp"
#include "hyperiso/track_files.hpp"
#include "regions_of_samples.hpp"
#include "temporary_folder.hpp"

#include <filesystem>

namespace hyperiso {
namespace {

using check::map_samples;
using check::signature;
using check::time_field;
using check::track_field;

TrackOptions with(Method method, Tracked tracked = Tracked::surface, Inside inside = Inside::above) {
  TrackOptions options;
  options.tracked = tracked;
  options.extraction.method = method;
  options.extraction.inside = inside;
  return options;
}

// The samples with steps as times.
check::OwnedField<float, 4> numbered(const Field& data, std::int64_t first_step, std::int64_t end_step) {
  const auto view = data.view<float, 4>();
  auto dims = view.dims();
  dims[3] = end_step - first_step;
  return check::make_field<float, 4>(unit_grid<4>(dims), [&](const std::array<double, 4>& point) {
    std::array<std::int64_t, 4> index;
    for (std::size_t axis = 0; axis < 4; ++axis) index[axis] = static_cast<std::int64_t>(point[axis]);
    index[3] += first_step;
    return view.at(index);
  });
}
check::OwnedField<float, 4> numbered(const Field& data) {
  return numbered(data, 0, data.view<float, 4>().dims()[3]);
}

// Arcs in and out balance; without ties nothing happens at a step; an arc has one Euler characteristic, and
// if it is a surface the genus of one.
void expect_sound(const TrackingGraph& graph, const check::OwnedField<float, 4>& field, double isovalue) {
  const bool has_ties = std::ranges::find(field.samples, static_cast<float>(isovalue)) != field.samples.end();
  std::int64_t sum = 0;
  for (const auto& event : graph.events) {
    sum += static_cast<std::int64_t>(event.arcs_out.size()) - static_cast<std::int64_t>(event.arcs_in.size());
    if (!has_ties) {
      EXPECT_EQ(event.time == std::floor(event.time),
                event.type == EventType::open_start || event.type == EventType::open_end);
    }
  }
  EXPECT_EQ(sum, 0);
  std::map<std::int64_t, std::int64_t> euler;
  for (const auto& row : graph.features) {
    EXPECT_GE(row.volume, 0);
    if (has_ties) continue;
    if (row.arc >= 0) { // else it is part of an event at the first or last step
      EXPECT_EQ(euler.emplace(row.arc, row.euler_characteristic).first->second, row.euler_characteristic);
    }
    if (graph.tracked == Tracked::surface) {
      EXPECT_GE(row.genus(), 0);
      EXPECT_EQ(row.genus(), std::floor(row.genus()));
    }
  }
}

// At moments between events, the pieces that `slice` cuts out of the mesh are the arcs alive, and their Euler
// characteristic changes from moment to moment by what the events say. K: 3 of a surface, 4 of a region.
template <int K>
void compare_with_slices(const TrackingGraph& graph, const check::OwnedField<float, 4>& field,
                         std::vector<double> levels, Method method, int moments) {
  FieldSteps steps(time_field(field));
  FieldSliceOptions options;
  options.method = method;
  FieldSlicer<4, K> slicer(steps, std::move(levels), options);
  std::mt19937 random(7);
  std::optional<std::int64_t> euler;
  auto event = graph.events.begin();
  for (int i = 0; i < moments; ++i) {
    const double share = (i + std::uniform_real_distribution<double>(0.1, 0.9)(random)) / moments;
    const double time = share * static_cast<double>(graph.steps - 1);
    const auto cut = slicer.slice(Hyperplane<4>::at(3, time));
    ASSERT_TRUE(cut) << cut.error().message;
    const auto measured = measure(*cut);
    EXPECT_EQ(check::pieces_at(graph, time).components, static_cast<std::int64_t>(measured->components))
        << "at " << time;
    for (; event != graph.events.end() && event->time < time; ++event)
      if (euler) *euler += event->delta_euler;
    EXPECT_EQ(euler.value_or(measured->euler_characteristic), measured->euler_characteristic)
        << "at " << time;
    euler = measured->euler_characteristic;
  }
}

void check_surfaces(const Field& data, double isovalue) {
  const auto field = numbered(data);
  const auto graph = track_field(time_field(field), isovalue);
  expect_sound(graph, field, isovalue);
  compare_with_slices<3>(graph, field, {isovalue}, Method::hull, 24);

  auto negated = field;
  for (float& sample : negated.samples) sample = -sample;
  EXPECT_EQ(signature(graph), signature(track_field(time_field(negated), -isovalue,
                                                    with(Method::hull, Tracked::surface, Inside::below))));
  const auto dims = field.view.dims();
  const auto backwards = [&](auto index) {
    index[3] = dims[3] - 1 - index[3];
    return index;
  };
  EXPECT_EQ(signature(graph),
            signature(track_field(time_field(map_samples<4>(field, backwards, dims)), isovalue), true));
}

void check_simplicial_surfaces(const Field& data, double isovalue, std::int64_t first_step,
                               std::int64_t end_step) {
  const auto field = numbered(data, first_step, end_step);
  const auto dims = field.view.dims();
  const auto graph = track_field(time_field(field), isovalue, with(Method::simplicial));
  expect_sound(graph, field, isovalue);
  compare_with_slices<3>(graph, field, {isovalue}, Method::simplicial, 12);
  const auto turned = [](auto index) { return std::array{index[2], index[0], index[1], index[3]}; };
  EXPECT_EQ(
      signature(graph),
      signature(track_field(time_field(map_samples<4>(field, turned, {dims[1], dims[2], dims[0], dims[3]})),
                            isovalue, with(Method::simplicial))));
}

void check_regions(const Field& data, double isovalue, Method method, std::int64_t first_step,
                   std::int64_t end_step) {
  const auto field = numbered(data, first_step, end_step);
  const auto graph = track_field(time_field(field), isovalue, with(method, Tracked::region));
  expect_sound(graph, field, isovalue);
  check::expect_regions_of_samples<4>(graph, field.view, isovalue, method);
  const double above_all = std::ranges::max(field.samples) + 1.0;
  if (method == Method::hull) compare_with_slices<4>(graph, field, {isovalue, above_all}, method, 8);
}

// Read step by step by several threads, the history is that of the field in memory, to the byte of each file.
void compare_with_stream(FieldReader& reader, double isovalue) {
  TrackOptions options;
  options.extraction.threads = 1;
  const auto whole = track_field(*reader.read(), isovalue, options);
  options.extraction.threads = 3;
  const auto streamed = track(reader, isovalue, options);
  ASSERT_TRUE(streamed) << streamed.error().message;
  const TemporaryFolder folder;
  ASSERT_TRUE(write_tracking(whole, folder / "whole"));
  ASSERT_TRUE(write_tracking(*streamed, folder / "streamed"));
  int files = 0;
  for (const auto& entry : std::filesystem::directory_iterator(folder / "whole")) {
    const auto other = folder / "streamed" / entry.path().filename();
    EXPECT_TRUE(content_of(entry.path()) == content_of(other)) << entry.path().filename();
    ++files;
  }
  EXPECT_GE(files, 12);
}

class RealField : public ::testing::Test {
 protected:
  void read(const std::vector<std::filesystem::path>& files) {
    auto opened = open_field(files);
    ASSERT_TRUE(opened) << opened.error().message;
    reader = std::move(*opened);
    field = *reader->read();
  }
  std::unique_ptr<FieldReader> reader;
  Field field;
};

class WaterOfTheDamBreak : public RealField {
 protected:
  void SetUp() override {
    read({std::filesystem::path(HYPERISO_SOURCE_FOLDER) / "examples/data/alpha_water_24x24x24x41.nrrd"});
  }
};

TEST_F(WaterOfTheDamBreak, surfaces) { check_surfaces(field, 0.5); }
TEST_F(WaterOfTheDamBreak, simplicial_surfaces) { check_simplicial_surfaces(field, 0.5, 29, 41); }
TEST_F(WaterOfTheDamBreak, regions) { check_regions(field, 0.5, Method::hull, 0, 41); }
TEST_F(WaterOfTheDamBreak, simplicial_regions) { check_regions(field, 0.5, Method::simplicial, 10, 20); }
TEST_F(WaterOfTheDamBreak, step_by_step) { compare_with_stream(*reader, 0.5); }

// 64 x 64 x 64 samples at 60 steps, beside the repository.
class ViscousFingers : public RealField {
 protected:
  void SetUp() override {
    const char* shared = std::getenv("HYPERISO_SHARED_DATA");
    const auto folder = (shared ? std::filesystem::path(shared)
                                : std::filesystem::path(HYPERISO_SOURCE_FOLDER) / ".." / "shared" / "data") /
                        "viscous_fingers";
    if (!std::filesystem::exists(folder)) GTEST_SKIP() << folder << " is not there";
    std::vector<std::filesystem::path> files;
    for (const auto& entry : std::filesystem::directory_iterator(folder)) files.push_back(entry.path());
    std::ranges::sort(files);
    read(files);
  }
};

TEST_F(ViscousFingers, surfaces) { check_surfaces(field, 30); }
TEST_F(ViscousFingers, simplicial_surfaces) { check_simplicial_surfaces(field, 30, 48, 60); }
TEST_F(ViscousFingers, regions) { check_regions(field, 30, Method::hull, 0, 60); }
TEST_F(ViscousFingers, simplicial_regions) { check_regions(field, 30, Method::simplicial, 52, 55); }
TEST_F(ViscousFingers, step_by_step) { compare_with_stream(*reader, 30); }

} // namespace
} // namespace hyperiso
