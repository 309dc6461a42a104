// A surface that comes slab by slab is, to the byte, the one that comes as a whole: whatever the type, the
// method, the number of threads, and wherever samples are missing. A source that fails, or lies, ends it.

#include "check.hpp"
#include "extract/extract_with.hpp"
#include "extract/slab_engine.hpp"
#include "peak_memory.hpp"

#include <cstring>
#include <gtest/gtest.h>
#include <limits>

using namespace hyperiso;
using check::OwnedField;

namespace {

// Gives steps as a reader might: each in memory of its own, gone when it is no longer held.
class StepsOf : public StepSource {
 public:
  template <class T, int D>
  explicit StepsOf(const FieldView<const T, D>& view) {
    info_.type = sample_type_of<T>();
    info_.axes.assign(view.grid.axes.begin(), view.grid.axes.end());
    field_ = Field{info_,
                   {std::shared_ptr<const void>(), reinterpret_cast<const std::byte*>(view.samples)},
                   {view.strides.begin(), view.strides.end()}};
  }
  const FieldInfo& info() const override { return info_; }
  Result<Field> read(std::int64_t begin, std::int64_t end) override {
    EXPECT_EQ(end, begin + 1);
    EXPECT_EQ(begin, next_++) << "each step once, in order";
    if (begin == broken_step) return Error{Code::file_unreadable, "the disk is gone"};
    const Field step = field_.cropped(info_.dimension() - 1, begin, end);
    if (begin == other_step) return step.cropped(0, 0, info_.axes[0].count - 1);
    if (in_place) return step;
    std::erase_if(held_, [](const auto& held) { return held.expired(); });
    auto copy = allocate_field(step.info);
    const auto stride = static_cast<std::size_t>(size_of(info_.type));
    std::byte* to = copy->samples;
    const std::int64_t rows = step.info.samples() / step.info.axes[0].count;
    std::vector<std::int64_t> index(step.info.axes.size(), 0);
    for (std::int64_t row = 0; row < rows; ++row) {
      std::int64_t offset = 0;
      for (std::size_t axis = 0; axis < index.size(); ++axis) offset += index[axis] * step.strides[axis];
      for (std::int64_t x = 0; x < step.info.axes[0].count; ++x, to += stride)
        std::memcpy(to, step.samples.get() + static_cast<std::size_t>(offset + x * step.strides[0]) * stride,
                    stride);
      for (std::size_t axis = 1; axis < index.size() && ++index[axis] == step.info.axes[axis].count; ++axis)
        index[axis] = 0;
    }
    held_.push_back(copy->field.samples);
    most_held = std::max(most_held, held_.size());
    return copy->field;
  }

  std::int64_t broken_step = -1, other_step = -1;
  bool in_place = false;
  std::size_t most_held = 0; // steps at once

 private:
  FieldInfo info_;
  Field field_;
  std::int64_t next_ = 0;
  std::vector<std::weak_ptr<const std::byte>> held_;
};

template <class Numbers>
void append(const Numbers& from, std::vector<std::byte>& to) {
  const auto* bytes = static_cast<const std::byte*>(from.data());
  to.insert(to.end(), bytes, bytes + from.bytes());
}

template <class Numbers>
void expect_bytes(const std::vector<std::byte>& bytes, const Numbers& expected) {
  ASSERT_EQ(bytes.size(), expected.bytes());
  EXPECT_TRUE(bytes.empty() || std::memcmp(bytes.data(), expected.data(), bytes.size()) == 0);
}

// Concatenates the slabs as the header says, and compares them with the whole.
template <class T, int D>
void expect_whole(const FieldView<const T, D>& field, double isovalue, const ExtractOptions& options,
                  const EngineOptions& engine_options, bool in_place = false) {
  const auto whole = extract(field, isovalue, options);
  ASSERT_TRUE(whole) << whole.error().message;
  StepsOf source(field);
  source.in_place = in_place;
  std::vector<std::byte> positions, simplices;
  std::vector<GridEdge> edges;
  std::uint64_t vertices = 0, simplex_count = 0, active_cells = 0;
  std::int64_t steps = 0;
  const Status status = stream_with(
      source, isovalue,
      [&](SurfaceSlab& slab) -> Status {
        EXPECT_EQ(slab.step, steps++);
        EXPECT_EQ(slab.first_vertex, vertices);
        EXPECT_EQ(slab.first_simplex, simplex_count);
        EXPECT_EQ(slab.mesh.grid_axes.size(), whole->grid_axes.size());
        vertices += slab.mesh.vertex_count();
        simplex_count += slab.mesh.simplex_count();
        active_cells += slab.mesh.active_cells;
        append(slab.mesh.positions, positions);
        append(slab.mesh.simplices, simplices);
        edges.insert(edges.end(), slab.mesh.edges.begin(), slab.mesh.edges.end());
        if (slab.step % 3 == 1) Mesh taken = std::move(slab.mesh); // a sink may
        return {};
      },
      options, engine_options);
  ASSERT_TRUE(status) << status.error().message;
  EXPECT_EQ(steps, field.dims()[D - 1] - 1);
  EXPECT_EQ(active_cells, whole->active_cells);
  expect_bytes(positions, whole->positions);
  expect_bytes(simplices, whole->simplices);
  EXPECT_TRUE(std::ranges::equal(edges, whole->edges));
}

template <class T, int D>
void expect_whole_on_every_path(const FieldView<const T, D>& field, double isovalue,
                                ExtractOptions options = {}) {
  for (const Method method : {Method::hull, Method::component, Method::simplicial})
    for (const int threads : {1, 2, 3}) {
      SCOPED_TRACE(testing::Message() << "method " << static_cast<int>(method) << ", threads " << threads);
      options.method = method;
      options.threads = threads;
      EngineOptions engine_options;
      if (threads == 3) engine_options.unit_samples = 1; // as many units as there can be
      expect_whole(field, isovalue, options, engine_options, threads == 2);
      if (testing::Test::HasFailure()) return;
    }
}

template <class T, int D>
OwnedField<T, D> noise(const std::array<std::int64_t, D>& dims, unsigned seed = 1) {
  return check::random_field<T, D>(dims, 100, seed);
}

template <int D>
OwnedField<float, D> with_missing(const std::array<std::int64_t, D>& dims, double share,
                                  std::int64_t first_step = 0, std::int64_t end_step = INT64_MAX) {
  auto field = noise<float, D>(dims, 3);
  std::mt19937 random(4);
  std::bernoulli_distribution missing(share);
  const auto step_samples = static_cast<std::int64_t>(field.samples.size()) / dims[D - 1];
  for (std::size_t i = 0; i < field.samples.size(); ++i) {
    const std::int64_t step = static_cast<std::int64_t>(i) / step_samples;
    if (step >= first_step && step < end_step && missing(random))
      field.samples[i] = std::numeric_limits<float>::quiet_NaN();
  }
  return field;
}

// Balls that move, made when they are asked for.
class MovingBalls final : public StepSource {
 public:
  explicit MovingBalls(std::int64_t n, std::int64_t steps) {
    info_.axes.assign(4, Axis{n});
    info_.axes.back().count = steps;
  }
  const FieldInfo& info() const override { return info_; }
  Result<Field> read(std::int64_t begin, std::int64_t end) override {
    FieldInfo info = info_;
    info.axes.back() = info.axes.back().cropped(begin, end);
    auto step = allocate_field(info);
    auto* sample = reinterpret_cast<float*>(step->samples);
    const std::int64_t n = info_.axes[0].count;
    const auto square = [&](std::int64_t x) { // of the distance to the middle of the ball in each eighth
      const float from_middle = static_cast<float>((x + begin) % (n / 2)) - static_cast<float>(n) / 4;
      return from_middle * from_middle;
    };
    for (std::int64_t z = 0; z < n; ++z)
      for (std::int64_t y = 0; y < n; ++y)
        for (std::int64_t x = 0; x < n; ++x) *sample++ = square(x) + square(y) + square(z);
    return step->field;
  }

 private:
  FieldInfo info_;
};

} // namespace

TEST(Stream, two_dimensions) {
  for (const std::int64_t length : {2, 3, 64, 65, 130})
    expect_whole_on_every_path(noise<float, 2>({length, 9}).view, 0.5);
}

TEST(Stream, three_dimensions) {
  for (const std::int64_t length : {2, 9, 63, 64, 65})
    expect_whole_on_every_path(noise<float, 3>({length, 5, 7}).view, 0.5);
  expect_whole_on_every_path(noise<float, 3>({40, 20, 4}).view, 0); // several blocks in a layer
}

TEST(Stream, four_dimensions) {
  expect_whole_on_every_path(noise<float, 4>({9, 4, 3, 6}).view, 0);
  expect_whole_on_every_path(noise<float, 4>({65, 3, 18, 4}).view, -3);
  const auto ball = check::make_field<float, 4>(check::box_grid<4>(14, -1, 1), [](const auto& p) {
    return 0.5 - (p[0] * p[0] + p[1] * p[1] + p[2] * p[2] + p[3] * p[3]);
  });
  expect_whole_on_every_path(ball.view, 0);
}

TEST(Stream, five_dimensions) { expect_whole_on_every_path(noise<float, 5>({3, 3, 2, 2, 4}).view, 0); }

TEST(Stream, two_steps_are_one_slab) {
  expect_whole_on_every_path(noise<float, 2>({2, 2}).view, 0);
  expect_whole_on_every_path(noise<float, 4>({5, 4, 3, 2}).view, 0);
}

TEST(Stream, all_sample_types) {
  expect_whole_on_every_path(noise<std::uint8_t, 3>({9, 5, 5}).view, 50);
  expect_whole_on_every_path(noise<std::int8_t, 3>({9, 5, 5}).view, 0.5);
  expect_whole_on_every_path(noise<std::uint16_t, 3>({9, 5, 5}).view, 50);
  expect_whole_on_every_path(noise<std::int16_t, 4>({9, 5, 3, 4}).view, 0);
  expect_whole_on_every_path(noise<std::uint32_t, 3>({9, 5, 5}).view, 50);
  expect_whole_on_every_path(noise<std::int32_t, 3>({9, 5, 5}).view, 0);
  expect_whole_on_every_path(noise<double, 4>({9, 5, 3, 4}).view, 0);
}

TEST(Stream, samples_at_the_isovalue) {
  expect_whole_on_every_path(check::random_field<float, 3>({67, 7, 6}, 1, 2).view, 0);
  expect_whole_on_every_path(check::random_field<std::int8_t, 4>({9, 5, 4, 5}, 1, 2).view, 0,
                             {.inside = Inside::below});
}

// Whether an edge within a step has a vertex depends on the slabs on both its sides.
TEST(Stream, missing_samples) {
  for (const double share : {0.002, 0.05, 0.4}) {
    SCOPED_TRACE(share);
    expect_whole_on_every_path(with_missing<2>({67, 12}, share).view, 0);
    expect_whole_on_every_path(with_missing<3>({67, 6, 7}, share).view, 0);
    expect_whole_on_every_path(with_missing<4>({9, 4, 5, 6}, share).view, 0);
  }
}
// The first NaN comes late, where vertices have been numbered as if there were none.
TEST(Stream, missing_samples_in_some_steps_only) {
  for (std::int64_t step = 0; step < 6; ++step) {
    SCOPED_TRACE(step);
    for (const double share : {0.1, 1.}) {
      expect_whole_on_every_path(with_missing<3>({67, 9, 6}, share, step, step + 1).view, 0);
      expect_whole_on_every_path(with_missing<4>({9, 4, 5, 6}, share, step, step + 1).view, 0);
    }
  }
}

TEST(Stream, no_surface_still_has_its_slabs) {
  const auto field = noise<float, 3>({9, 5, 4});
  for (const double isovalue : {-1000., 1000.}) expect_whole_on_every_path(field.view, isovalue);
  expect_whole_on_every_path(noise<std::uint8_t, 3>({9, 5, 4}).view, 256);
  expect_whole_on_every_path(noise<float, 3>({9, 1, 4}).view, 0); // flat
}

TEST(Stream, one_step_has_no_slab) {
  const auto field = noise<float, 3>({9, 5, 1});
  StepsOf source(field.view);
  EXPECT_TRUE(stream(source, 0, [](SurfaceSlab&) -> Status {
    ADD_FAILURE();
    return {};
  }));
}

TEST(Stream, precision_and_no_edges) {
  ExtractOptions options;
  options.precision = Precision::f64;
  options.keep_edges = false;
  expect_whole_on_every_path(noise<float, 4>({9, 4, 3, 6}).view, 0, options);
}

TEST(Stream, wide_numbers) {
  const auto field = noise<float, 3>({9, 5, 6});
  const auto whole = extract(field.view, 0);
  StepsOf source(field.view);
  EngineOptions engine_options;
  engine_options.wide_indices = true;
  ASSERT_TRUE(stream_with(
      source, 0,
      [&](SurfaceSlab& slab) -> Status {
        EXPECT_TRUE(slab.mesh.simplices.wide());
        for (std::size_t i = 0; i < slab.mesh.simplices.size(); ++i)
          EXPECT_EQ(slab.mesh.simplices[i], whole->simplices[slab.first_simplex * 3 + i]);
        return {};
      },
      {}, engine_options));
}

// Time first in memory, axes that fall, uneven steps, a crop.
TEST(Stream, strides_and_axes) {
  const auto field = noise<float, 4>({7, 6, 5, 8});
  FieldView<const float, 4> view = field.view;
  std::swap(view.strides[0], view.strides[3]);
  std::swap(view.grid.axes[0].count, view.grid.axes[3].count);
  view.grid.axes[3].coordinates = {9, 7, 6.5, 3, 2, 0, -1};
  view.grid.axes[1].spacing = -0.5;
  expect_whole_on_every_path(view, 0);
  view.grid.axes[0].spacing = -1;
  expect_whole_on_every_path(view.cropped(3, 2, 6).cropped(0, 1, 7).cropped(2, 1, 4), 0);
}

TEST(Stream, two_steps_in_memory_three_where_samples_are_missing) {
  for (const bool missing : {false, true}) {
    const auto field = missing ? with_missing<3>({20, 20, 12}, 0.1) : noise<float, 3>({20, 20, 12});
    StepsOf source(field.view);
    ASSERT_TRUE(stream(source, 0, [](SurfaceSlab&) { return Status{}; }));
    EXPECT_EQ(source.most_held, missing ? 3u : 2u);
  }
}

TEST(Stream, a_source_that_fails_ends_it) {
  const auto field = noise<float, 3>({9, 5, 8});
  StepsOf source(field.view);
  source.broken_step = 5;
  std::int64_t slabs = 0;
  const Status status = stream(source, 0, [&](SurfaceSlab&) { return ++slabs, Status{}; });
  ASSERT_FALSE(status);
  EXPECT_EQ(status.error().code, Code::file_unreadable);
  EXPECT_EQ(slabs, 4);
}

TEST(Stream, a_step_of_another_size_is_refused) {
  const auto field = noise<float, 3>({9, 5, 8});
  StepsOf source(field.view);
  source.other_step = 3;
  const Status status = stream(source, 0, [](SurfaceSlab&) { return Status{}; });
  ASSERT_FALSE(status);
  EXPECT_EQ(status.error().code, Code::invalid_argument);
  EXPECT_NE(status.error().message.find("step 3 of the source has 8 samples along axis 0, not 9"),
            std::string::npos)
      << status.error().message;
}

TEST(Stream, a_sink_that_fails_ends_it) {
  const auto field = noise<float, 3>({9, 5, 8});
  StepsOf source(field.view);
  std::int64_t slabs = 0;
  const Status status = stream(source, 0, [&](SurfaceSlab&) -> Status {
    if (++slabs == 3) return Error{Code::file_unwritable, "the disk is full"};
    return {};
  });
  ASSERT_FALSE(status);
  EXPECT_EQ(status.error().code, Code::file_unwritable);
  EXPECT_EQ(slabs, 3);
}

TEST(Stream, progress_grows_and_cancels) {
  const auto field = noise<float, 4>({9, 5, 4, 8});
  double last = 0;
  StepsOf source(field.view);
  ExtractOptions options;
  options.progress = [&](double share) {
    EXPECT_GE(share, last);
    EXPECT_LE(share, 1);
    last = share;
    return true;
  };
  ASSERT_TRUE(stream(
      source, 0, [](SurfaceSlab&) { return Status{}; }, options));
  EXPECT_EQ(last, 1);

  StepsOf again(field.view);
  options.progress = [&](double share) { return share < 0.5; };
  const Status status = stream(
      again, 0, [](SurfaceSlab&) { return Status{}; }, options);
  ASSERT_FALSE(status);
  EXPECT_EQ(status.error().code, Code::cancelled);
}

TEST(Stream, memory_limit_is_that_of_a_slab) {
  const auto field = noise<float, 3>({30, 30, 40});
  std::uint64_t largest = 0;
  StepsOf source(field.view);
  ASSERT_TRUE(stream(source, 0, [&](SurfaceSlab& slab) {
    largest = std::max<std::uint64_t>(largest, slab.mesh.positions.bytes() + slab.mesh.simplices.bytes() +
                                                   8 * slab.mesh.edges.size());
    return Status{};
  }));
  ExtractOptions options;
  options.memory_limit = largest;
  StepsOf again(field.view);
  EXPECT_TRUE(stream(
      again, 0, [](SurfaceSlab&) { return Status{}; }, options));
  options.memory_limit = largest - 1;
  StepsOf third(field.view);
  const Status status = stream(
      third, 0, [](SurfaceSlab&) { return Status{}; }, options);
  ASSERT_FALSE(status);
  EXPECT_EQ(status.error().code, Code::out_of_memory);
}

TEST(Stream, what_cannot_be_streamed_is_told) {
  const auto field = noise<float, 3>({9, 5, 4});
  const SlabSink sink = [](SurfaceSlab&) { return Status{}; };
  StepsOf source(field.view);
  EXPECT_EQ(stream(source, std::nan(""), sink).error().code, Code::invalid_isovalue);
  EXPECT_EQ(stream(source, 0, sink, {.method = Method::barycentric}).error().code, Code::invalid_argument);
  EXPECT_EQ(stream(source, 0, sink, {.threads = -1}).error().code, Code::invalid_argument);
  const auto six = noise<float, 6>({2, 2, 2, 2, 2, 2});
  StepsOf in_six(six.view);
  EXPECT_EQ(stream(in_six, 0, sink).error().code, Code::unsupported_dimension);
}

// Measured by the system: two steps, one slab's mesh and a tenth; and what the threads take and the rounding
// to large pages, which is no share of the field: 268 MB here.
TEST(Stream, peak_memory_is_that_of_two_steps_and_a_slab) {
  MovingBalls warm_up(16, 4), source(128, 32);
  ASSERT_TRUE(stream(warm_up, 10, [](SurfaceSlab&) { return Status{}; })); // makes the table
  std::uint64_t largest = 0, simplices = 0;
  const auto peak = check::peak_memory_of([&] {
    EXPECT_TRUE(stream(source, 300, [&](SurfaceSlab& slab) {
      largest = std::max<std::uint64_t>(largest, slab.mesh.positions.bytes() + slab.mesh.simplices.bytes() +
                                                     sizeof(GridEdge) * slab.mesh.edges.size());
      simplices += slab.mesh.simplex_count();
      return Status{};
    }));
  });
  if (!peak) GTEST_SKIP() << "the system tells no peak";
  ASSERT_GT(simplices, 1'000'000u);
  const std::uint64_t step = 128 * 128 * 128 * sizeof(float);
  EXPECT_LT(*peak, (2 * step + largest) * 11 / 10 + (12u << 20)) << "a slab takes " << largest;
}
