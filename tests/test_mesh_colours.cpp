// Colours that pictures, films and coloured meshes share.

#include "hyperiso/colours.hpp"

#include <cmath>
#include <gtest/gtest.h>
#include <limits>

using namespace hyperiso;

namespace {

Mesh with_values(const std::vector<double>& values) {
  Mesh mesh(3, 2);
  mesh.positions.reset(values.size() * 3, true);
  mesh.attributes.push_back({"speed", Attribute::Location::vertex, 1, values});
  return mesh;
}

Colour colour_at(const Mesh& mesh, std::size_t vertex) {
  const auto channel = [&](std::size_t number) {
    return static_cast<std::uint8_t>(
        std::get<std::vector<std::int32_t>>(mesh.attributes[number].values)[vertex]);
  };
  return {channel(1), channel(2), channel(3)};
}

} // namespace

TEST(Colours, ends_middle_beyond_and_nan) {
  EXPECT_EQ(viridis(0), (Colour{0x44, 0x01, 0x54}));
  EXPECT_EQ(viridis(0.5), (Colour{0x21, 0x91, 0x8c}));
  EXPECT_EQ(viridis(1), (Colour{0xfd, 0xe7, 0x25}));
  EXPECT_EQ(viridis(-7), viridis(0));
  EXPECT_EQ(viridis(HUGE_VAL), viridis(1));
  EXPECT_EQ(viridis(std::nan("")), colour_of_nan);
}

TEST(Colours, a_range_that_is_found_leaves_out_what_is_not_finite) {
  const double infinity = std::numeric_limits<double>::infinity();
  Mesh mesh = with_values({2, std::nan(""), 4, infinity, 3, -infinity});
  const auto range = colour_vertices(mesh, "speed");
  ASSERT_TRUE(range);
  EXPECT_EQ(range->low, 2);
  EXPECT_EQ(range->high, 4);
  for (const auto& [vertex, colour] : std::vector<std::pair<std::size_t, Colour>>{
           {0, viridis(0)}, {1, colour_of_nan}, {2, viridis(1)}, {3, viridis(1)}, {4, viridis(0.5)}})
    EXPECT_EQ(colour_at(mesh, vertex), colour) << vertex;
}

// Again and again, and where all values are one or there is none.
TEST(Colours, replace_those_there_are) {
  Mesh mesh = with_values({1, 1});
  ASSERT_TRUE(colour_vertices(mesh, "speed"));
  EXPECT_EQ(colour_at(mesh, 0), viridis(0.5));
  ASSERT_TRUE(colour_vertices(mesh, "speed", ColourRange{1, 2}));
  EXPECT_EQ(mesh.attributes.size(), 4u);
  EXPECT_EQ(colour_at(mesh, 1), viridis(0));
  Mesh nothing = with_values({});
  EXPECT_TRUE(colour_vertices(nothing, "speed"));
}

TEST(Colours, what_cannot_colour) {
  Mesh mesh = with_values({1, 2});
  mesh.attributes.push_back({"normal", Attribute::Location::vertex, 3, std::vector<double>(6)});
  for (const char* name : {"depth", "normal"}) {
    const auto range = colour_vertices(mesh, name);
    ASSERT_FALSE(range);
    EXPECT_EQ(range.error().code, Code::invalid_argument);
  }
}
