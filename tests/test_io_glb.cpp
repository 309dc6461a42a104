// The .glb of frames that know their tracks; the rest is read by other programs' readers (viewer/test,
// test_glb_vtk.py).

#include "check.hpp"
#include "hyperiso/colours.hpp"
#include "hyperiso/glb.hpp"
#include "temporary_folder.hpp"

#include <cstring>
#include <fstream>
#include <nlohmann/json.hpp>

using namespace hyperiso;
using Json = nlohmann::json;

namespace {

// Two triangles that share an edge.
Mesh frame_of_tracks(std::vector<std::int32_t> tracks) {
  Mesh mesh(3, 2);
  const float positions[]{0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 2};
  mesh.positions.reset(12, false);
  for (std::size_t k = 0; k < 12; ++k) mesh.positions.set(k, positions[k]);
  const std::uint32_t corners[]{0, 1, 2, 0, 2, 3};
  mesh.simplices.reset(6, false);
  for (std::size_t k = 0; k < 6; ++k) mesh.simplices.set(k, corners[k]);
  if (!tracks.empty())
    mesh.attributes.push_back({"track_id", Attribute::Location::simplex, 1, std::move(tracks)});
  return mesh;
}

Json json_of(const GlbMovie& movie) {
  const TemporaryFolder folder;
  const Status written = movie.write(folder / "a.glb");
  EXPECT_TRUE(written) << written.error().message;
  std::ifstream file(folder / "a.glb", std::ios::binary);
  std::string bytes(std::istreambuf_iterator<char>(file), {});
  std::uint32_t length = 0;
  std::memcpy(&length, bytes.data() + 12, 4);
  return Json::parse(bytes.substr(20, length));
}

} // namespace

TEST(IoGlb, a_node_for_each_track_below_that_of_the_frame) {
  GlbMovie movie;
  EXPECT_TRUE(movie.add(frame_of_tracks({4, 7}), 0.25, 0));
  EXPECT_TRUE(movie.add(frame_of_tracks({4, -1}), 0.5, 0.1));
  const Json json = json_of(movie);
  const auto children = [&](std::size_t node) {
    std::vector<std::string> names;
    for (const std::size_t child : json["nodes"][node].value("children", std::vector<std::size_t>{}))
      names.push_back(json["nodes"][child]["name"]);
    return names;
  };
  EXPECT_EQ(children(0), (std::vector<std::string>{"frame 0", "frame 1"}));
  const auto frames = json["nodes"][0]["children"].get<std::vector<std::size_t>>();
  EXPECT_EQ(children(frames[0]), (std::vector<std::string>{"track 4", "track 7"}));
  EXPECT_EQ(children(frames[1]), (std::vector<std::string>{"no track", "track 4"}));
  EXPECT_EQ(json["nodes"][frames[1]]["extras"]["time"], 0.5);
  EXPECT_EQ(json["materials"].size(), 3u); // track 4 has one in both frames
}

TEST(IoGlb, the_same_frames_give_the_same_bytes) {
  const TemporaryFolder folder;
  const auto bytes = [&](const char* name) {
    GlbMovie movie({.quantised = true});
    EXPECT_TRUE(movie.add(frame_of_tracks({}), 0, 0));
    EXPECT_TRUE(movie.write(folder / name));
    std::ifstream file(folder / name, std::ios::binary);
    return std::string(std::istreambuf_iterator<char>(file), {});
  };
  EXPECT_EQ(bytes("a.glb"), bytes("b.glb"));
}

// A frame that moves has a target, and its nodes are told how far it is; one that does not has none.
TEST(IoGlb, a_target_for_frames_that_move) {
  for (const bool quantised : {false, true}) {
    GlbMovie movie({.quantised = quantised});
    Mesh end = frame_of_tracks({});
    end.positions.set(11, -2); // further than all are wide
    EXPECT_TRUE(movie.add(frame_of_tracks({4, 7}), 0, 0, &end));
    EXPECT_TRUE(movie.add(frame_of_tracks({}), 1, 0.5));
    const Json json = json_of(movie);
    ASSERT_EQ(json["meshes"].size(), 3u);
    for (std::size_t mesh : {0, 1}) EXPECT_EQ(json["meshes"][mesh]["primitives"][0]["targets"].size(), 1u);
    EXPECT_FALSE(json["meshes"][2]["primitives"][0].contains("targets"));
    const std::size_t target = json["meshes"][0]["primitives"][0]["targets"][0]["POSITION"];
    const Json& ways = json["accessors"][target];
    EXPECT_EQ(ways["componentType"], quantised ? 5122 : 5126);
    EXPECT_EQ(ways["min"][2], quantised ? -32767 : -4);
    EXPECT_EQ(ways["max"], (Json{0, 0, 0}));
    const Json& animation = json["animations"][0];
    std::vector<std::string> moved;
    for (const Json& channel : animation["channels"]) {
      if (channel["target"]["path"] != "weights") continue;
      moved.push_back(json["nodes"][channel["target"]["node"].get<std::size_t>()]["name"]);
      const Json& sampler = animation["samplers"][channel["sampler"].get<std::size_t>()];
      EXPECT_EQ(sampler["interpolation"], "LINEAR");
      const Json& seconds = json["accessors"][sampler["input"].get<std::size_t>()];
      EXPECT_EQ(seconds["min"], Json{0.0});
      EXPECT_EQ(seconds["max"], Json{0.5});
    }
    EXPECT_EQ(moved, (std::vector<std::string>{"track 4", "track 7"}));
  }
}

TEST(IoGlb, what_it_cannot_hold) {
  GlbMovie movie;
  const Mesh other(3, 2);
  EXPECT_EQ(movie.add(frame_of_tracks({}), 0, 0, &other).error().code, Code::invalid_argument);
  EXPECT_EQ(movie.write("none.glb").error().code, Code::invalid_argument);
  EXPECT_EQ(movie.add(Mesh(4, 3), 0, 0).error().code, Code::invalid_argument);
  EXPECT_EQ(movie.add(frame_of_tracks({}), 0, 1).error().code, Code::invalid_argument);
  EXPECT_TRUE(movie.add(frame_of_tracks({}), 0, 0));
  EXPECT_EQ(movie.add(frame_of_tracks({}), 1, 0).error().code, Code::invalid_argument);
  EXPECT_EQ(movie.write("/nowhere/a.glb").error().code, Code::file_unwritable);
}
