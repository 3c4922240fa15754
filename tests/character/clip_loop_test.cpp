#include <gtest/gtest.h>

#include "core/character/builtin_character.hpp"
#include "core/character/clips.hpp"
#include "core/character/gltf_import.hpp"
#include "tests/character/gltf_builder.hpp"
#include "tests/character/shared_files.hpp"

namespace pelt::test {
namespace {

// The base goes through `places` along x, evenly in a second.
Character Moving(const std::vector<float>& places) {
  GltfBuilder b = MakeQuad();
  std::vector<float> times, values;
  for (size_t k = 0; k < places.size(); ++k) {
    times.push_back(float(k) / float(places.size() - 1));
    for (const float c : {places[k], 0.0f, 0.0f}) values.push_back(c);
  }
  b.animations = "{\"samplers\":[{\"input\":" + std::to_string(b.Floats("SCALAR", times)) +
                 ",\"output\":" + std::to_string(b.Floats("VEC3", values)) +
                 "}],\"channels\":[{\"sampler\":0,\"target\":{\"node\":0,\"path\":"
                 "\"translation\"}}]}";
  return ImportGltf(b.Glb(), "quad");
}
bool Jumps(const std::vector<float>& places) {
  const Character c = Moving(places);
  return JumpsWhereItLoops(c, c.clips[0]);
}

TEST(ClipLoop, OnlyWhatEndsElsewhereJumps) {
  EXPECT_TRUE(Jumps({0, 1}));        // walks away
  EXPECT_TRUE(Jumps({0, 100}));      // however far
  EXPECT_FALSE(Jumps({0, 1, 0}));    // comes back
  EXPECT_FALSE(Jumps({0, 0.005f}));  // hardly moves
  EXPECT_FALSE(Jumps({0, 0}));       // stands
  // Round and round, the last of 30 keys left out.
  std::vector<float> swing;
  for (int k = 0; k < 30; ++k) swing.push_back(k < 15 ? float(k) : float(30 - k));
  EXPECT_FALSE(Jumps(swing));
}

// Idle ends in another stand than it begins in.
TEST(ClipLoop, OfTheBuiltInClipsIdleJumps) {
  for (const BuiltinBody body : {BuiltinBody::kMonster, BuiltinBody::kScorpion}) {
    const Character c = MakeBuiltinCharacter({.body = body});
    for (const Clip& clip : c.clips)
      EXPECT_EQ(JumpsWhereItLoops(c, clip), clip.name == "idle") << clip.name;
  }
}

TEST(ClipLoop, RealFiles) {
  const std::string fox = FindShared("Fox.glb");
  const std::string root = FindShared("27_root_motion_loop.glb", "cases/characters");
  if (fox.empty() || root.empty()) GTEST_SKIP() << "files are not there (set PELT_SHARED)";
  const Character standing = ImportGltfFile(fox), walking = ImportGltfFile(root);
  for (const Clip& clip : standing.clips)
    EXPECT_FALSE(JumpsWhereItLoops(standing, clip)) << clip.name;
  EXPECT_TRUE(JumpsWhereItLoops(walking, walking.clips[0]));
}

}  // namespace
}  // namespace pelt::test
