// A limit of memory is one of all that is held, where vertices are looked up or corners wait for numbers too:
// within it the surface comes, without it an error does, and neither ever holds more.

#include "check.hpp"
#include "core/text.hpp"
#include "peak_memory.hpp"

using namespace hyperiso;
using namespace hyperiso::check;

namespace {

constexpr std::uint64_t mebibyte = 1 << 20;
// What growing lists leave of their old places in the heap, and the rounding to large pages: no share of a
// surface.
constexpr std::uint64_t heap = 12 * mebibyte;

template <class T, int D>
void expect_within_limit(const FieldView<const T, D>& field, ExtractOptions options) {
  options.memory_limit = UINT64_MAX;
  const auto needed = peak_memory_of([&] { EXPECT_TRUE(extract(field, 0, options)); });
  if (!needed) GTEST_SKIP() << "the system tells no peak";
  ASSERT_GT(*needed, 2 * heap) << "too little to tell";
  bool fits = false, fails = false;
  for (const std::uint64_t share : {2, 14, 20}) {
    options.memory_limit = *needed / 16 * share;
    Status status;
    const auto peak = peak_memory_of([&] {
      if (const auto mesh = extract(field, 0, options); !mesh) status = mesh.error();
    });
    EXPECT_LE(*peak, options.memory_limit + heap) << share << " in 16 of what is held without a limit";
    (status ? fits : fails) = true;
    if (status) continue;
    EXPECT_EQ(status.error().code, Code::out_of_memory);
    EXPECT_NE(status.error().message.find(byte_size(options.memory_limit)), std::string::npos);
  }
  EXPECT_TRUE(fits) << "with a quarter more";
  EXPECT_TRUE(fails) << "with a small part";
}

} // namespace

TEST(MemoryLimit, barycentric) {
  expect_within_limit(random_field<float, 4>({8, 8, 8, 5}, 1000, 1).view, {.method = Method::barycentric});
  expect_within_limit(random_field<float, 3>({50, 50, 30}, 1000, 1).view,
                      {.method = Method::barycentric, .precision = Precision::f64});
}

// All cells in one layer: every vertex may be met again.
TEST(MemoryLimit, barycentric_in_one_layer) {
  expect_within_limit(random_field<float, 4>({40, 50, 2, 2}, 1000, 1).view, {.method = Method::barycentric});
}

// The error comes before the work: the simplices are counted first.
TEST(MemoryLimit, barycentric_far_beyond_it) {
  const auto field = random_field<float, 4>({12, 12, 12, 8}, 1000, 1);
  const auto peak = peak_memory_of([&] {
    EXPECT_FALSE(extract(field.view, 0, {.method = Method::barycentric, .memory_limit = 64 * mebibyte}));
  });
  if (!peak) GTEST_SKIP() << "the system tells no peak";
  EXPECT_LT(*peak, 4 * mebibyte);
}

TEST(MemoryLimit, six_dimensions) {
  expect_within_limit(random_field<float, 6>({6, 4, 4, 4, 3, 2}, 1000, 1).view,
                      {.method = Method::simplicial});
}

// One cell of this is much.
TEST(MemoryLimit, seven_dimensions) {
  expect_within_limit(random_field<float, 7>({5, 3, 2, 2, 2, 2, 2}, 1000, 1).view,
                      {.method = Method::simplicial, .keep_edges = false});
}

// Many cells with little in each.
TEST(MemoryLimit, flat_surface_in_six_dimensions) {
  OwnedField<float, 6> field = random_field<float, 6>({7, 7, 7, 6, 6, 6}, 1000, 1);
  for (std::size_t i = 0; i < field.samples.size(); ++i)
    field.samples[i] = static_cast<float>(i / (field.samples.size() / 6)) - 2.5F;
  expect_within_limit(field.view, {.keep_edges = false});
}
