// The bits of a step that tracking takes: the same whoever passes over them.

#include "check.hpp"
#include "track/step_mask.hpp"

#include <gtest/gtest.h>

namespace hyperiso {
namespace {

// Steps of a million samples and more are shared among threads, plane by plane.
TEST(TrackMasks, of_large_steps_are_those_of_one_thread) {
  auto field = check::random_field<float, 3>({130, 128, 128}, 3, 1);
  field.samples[field.samples.size() / 2] = std::nanf("");
  const track_detail::StepMask one(field.view, 1, Inside::above), many(field.view, 1, Inside::above, 4);
  ASSERT_EQ(one.rows(), many.rows());
  EXPECT_TRUE(many.has_missing());
  for (std::size_t row = 0; row < one.rows(); ++row) {
    ASSERT_EQ(one.uniform(row), many.uniform(row));
    for (std::size_t word = 0; word < one.words(); ++word) ASSERT_EQ(one.row(row)[word], many.row(row)[word]);
  }
}

} // namespace
} // namespace hyperiso
