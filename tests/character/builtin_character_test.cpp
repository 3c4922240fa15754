// The built-in monster: whole, closed, fixed to the byte, and moving as its clips promise.
#include "core/character/builtin_character.hpp"

#include <gtest/gtest.h>

#include <cstring>
#include <map>
#include <set>

#include "core/character/gltf_import.hpp"
#include "core/character/pose.hpp"
#include "core/random.hpp"
#include "tests/character/whole_character.hpp"

namespace pelt::test {
namespace {

uint64_t DigestOf(const std::vector<std::byte>& bytes) {
  uint64_t digest = bytes.size();
  for (std::byte b : bytes) digest = MixSeed(digest, uint64_t(b));
  return digest;
}

// The bytes are the promise: every compiler, optimisation level and machine must reach these.
TEST(BuiltinCharacter, BytesAreFixed) {
  EXPECT_EQ(DigestOf(MakeBuiltinCharacterGlb({})), 16202231247772561911ull);
  EXPECT_EQ(DigestOf(MakeBuiltinCharacterGlb({.seed = 7, .tiny = true})), 15109188045267576245ull);
  EXPECT_EQ(DigestOf(MakeBuiltinCharacterGlb({.body = BuiltinBody::kScorpion})),
            16880319888632814622ull);
}

// And stands in the middle, on the ground. Its lowest and its highest corner.
std::pair<glm::vec3, glm::vec3> ExpectNeedsNoRepair(const Character& c) {
  ExpectWhole(c);
  ExpectRestAgrees(c, 1.0f);
  EXPECT_TRUE(c.notes.empty()) << c.notes[0];
  EXPECT_EQ(DefaultUnitScale(c).metres_per_unit, 1.0f);
  glm::vec3 low(1e9f), high(-1e9f);
  for (const glm::vec3& p : c.mesh.position) {
    low = glm::min(low, p);
    high = glm::max(high, p);
  }
  EXPECT_NEAR(low.y, 0.0f, 0.02f);
  EXPECT_NEAR(low.x, -high.x, 0.01f);
  return {low, high};
}

TEST(BuiltinCharacter, IsWholeAndNeedsNoRepair) {
  const Character c = MakeBuiltinCharacter({});
  const auto [low, high] = ExpectNeedsNoRepair(c);
  EXPECT_EQ(c.skeleton.name.size(), 24u);
  EXPECT_EQ(c.mesh.materials,
            (std::vector<std::string>{"head", "brow", "body", "arm", "leg", "tail", "eye"}));
  EXPECT_GT(c.mesh.position.size(), 3000u);
  EXPECT_LT(c.mesh.position.size(), 6000u);
  EXPECT_FALSE(c.mesh.uv.empty());
  EXPECT_NEAR(high.y, 1.2f, 0.05f);
}

TEST(BuiltinCharacter, ScorpionIsWholeAndNeedsNoRepair) {
  const Character c = MakeBuiltinCharacter({.body = BuiltinBody::kScorpion});
  const auto [low, high] = ExpectNeedsNoRepair(c);
  EXPECT_EQ(c.name, "scorpion");
  EXPECT_EQ(c.skeleton.name.size(), 34u);
  EXPECT_EQ(c.mesh.materials,
            (std::vector<std::string>{"head", "body", "tail", "sting", "claw", "leg", "eye"}));
  EXPECT_NEAR(high.z - low.z, 1.25f, 0.1f);
}

// Every edge of the surface, by position, has exactly one triangle on either side.
TEST(BuiltinCharacter, SurfaceIsClosedAndFacesOut) {
  for (const BuiltinCharacterOptions& options :
       {BuiltinCharacterOptions{}, {.seed = 3}, {.seed = 11}, {.body = BuiltinBody::kScorpion}}) {
    const Mesh m = MakeBuiltinCharacter(options).mesh;
    const uint64_t seed = options.seed;
    auto key = [&m](uint32_t v) {
      return std::array<float, 3>{m.position[v].x, m.position[v].y, m.position[v].z};
    };
    std::map<std::pair<std::array<float, 3>, std::array<float, 3>>, int> edges;
    double volume = 0.0;
    size_t against = 0;
    for (const auto& t : m.triangles) {
      const glm::dvec3 a(m.position[t[0]]), b(m.position[t[1]]), c(m.position[t[2]]);
      volume += glm::dot(a, glm::cross(b, c)) / 6.0;
      against += glm::dot(glm::cross(b - a, c - a), glm::dvec3(m.normal[t[0]])) < 0.0;
      for (size_t i = 0; i < 3; ++i) ++edges[{key(t[i]), key(t[(i + 1) % 3])}];
    }
    size_t open = 0;
    for (const auto& [edge, count] : edges) {
      const auto back = edges.find({edge.second, edge.first});
      open += back == edges.end() || back->second != count;
    }
    EXPECT_EQ(open, 0u) << seed;
    EXPECT_GT(volume, 0.03) << seed;
    EXPECT_LT(double(against) / double(m.triangles.size()), 0.002) << seed;
  }
}

TEST(BuiltinCharacter, TinyIsTiny) {
  for (uint64_t seed = 0; seed < 6; ++seed) {
    const Character c = MakeBuiltinCharacter({.seed = seed, .tiny = true});
    ExpectWhole(c);
    ExpectRestAgrees(c, 1.0f);
    EXPECT_LE(c.mesh.position.size(), 200u);
    EXPECT_GE(c.mesh.position.size(), 100u);
    EXPECT_EQ(c.clips.size(), 4u);
  }
}

TEST(BuiltinCharacter, CastOfSeventeenDiffers) {
  std::set<uint64_t> digests;
  for (uint64_t seed = 0; seed < 17; ++seed) {
    const std::vector<std::byte> glb = MakeBuiltinCharacterGlb({.seed = seed, .detail = 0.6f});
    digests.insert(DigestOf(glb));
    const Character c = ImportGltf(glb, "cast");
    ExpectWhole(c);
    EXPECT_EQ(c.mesh.materials.size(), 7u) << seed;
    EXPECT_EQ(DefaultUnitScale(c).metres_per_unit, 1.0f) << seed;
  }
  EXPECT_EQ(digests.size(), 17u);
}

TEST(BuiltinCharacter, DetailGrowsVertices) {
  const size_t coarse = MakeBuiltinCharacter({.detail = 0.5f}).mesh.position.size();
  const size_t fine = MakeBuiltinCharacter({.detail = 1.0f}).mesh.position.size();
  EXPECT_GT(fine, 3 * coarse);
  EXPECT_LT(fine, 5 * coarse);
}

struct Player {
  Character character = MakeBuiltinCharacter({.tiny = true});
  SkeletonBlock skeleton = MakeSkeletonBlock(character.skeleton);
  std::vector<glm::dvec3> At(const char* clip, double t, bool loop) const {
    const Clip* found = FindClip(character, clip);
    return SkinPositions(character.mesh,
                         MakePose(character.skeleton, found, t, loop, glm::mat4(1.0f)), skeleton);
  }
  static double Apart(const std::vector<glm::dvec3>& a, const std::vector<glm::dvec3>& b) {
    double most = 0.0;
    for (size_t v = 0; v < a.size(); ++v)
      most = std::max(most, std::sqrt(glm::dot(a[v] - b[v], a[v] - b[v])));
    return most;
  }
};

TEST(BuiltinCharacter, WalkIsVigorousAndSmoothAcrossTheLoop) {
  const Player player;
  EXPECT_EQ(FindClip(player.character, "walk")->duration_s, 1.0f);
  EXPECT_GT(Player::Apart(player.At("walk", 0.25, true), player.At("walk", 0.75, true)), 0.25);
  // Second differences at 60 Hz: accelerations stay below 40 m/s^2, the seam included.
  const double h = 1.0 / 60;
  for (int frame = -30; frame < 60; ++frame) {
    const auto a = player.At("walk", (frame - 1) * h, true), b = player.At("walk", frame * h, true);
    const auto c = player.At("walk", (frame + 1) * h, true);
    for (size_t v = 0; v < a.size(); ++v) {
      const glm::dvec3 acceleration = (a[v] - 2.0 * b[v] + c[v]) / (h * h);
      ASSERT_LT(std::sqrt(glm::dot(acceleration, acceleration)), 40.0) << frame;
    }
  }
}

TEST(BuiltinCharacter, IdleComesToRestBitForBit) {
  const Player player;
  const Clip* idle = FindClip(player.character, "idle");
  ASSERT_NE(idle, nullptr);
  EXPECT_GT(Player::Apart(player.At("idle", 0.0, false), player.At("idle", 0.5, false)), 0.02);
  const PoseBlock still = MakePose(player.character.skeleton, idle, 0.51, false, glm::mat4(1.0f));
  for (double t : {0.52, 1.0, 17.3, 59.9, 60.0, 1000.0}) {
    const PoseBlock later = MakePose(player.character.skeleton, idle, t, false, glm::mat4(1.0f));
    EXPECT_EQ(std::memcmp(&still, &later, sizeof still), 0) << t;
  }
}

TEST(BuiltinCharacter, ShakeShakesThenRests) {
  const Player player;
  const Clip* shake = FindClip(player.character, "shake");
  ASSERT_NE(shake, nullptr);
  EXPECT_GT(Player::Apart(player.At("shake", 0.42, true), player.At("shake", 0.58, true)), 0.1);
  EXPECT_LT(Player::Apart(player.At("shake", 1.1, true), player.At("shake", 1.5, true)), 1e-6);
}

TEST(BuiltinCharacter, GreetWavesOnAndOn) {
  const Player player;
  ASSERT_NE(FindClip(player.character, "greet"), nullptr);
  EXPECT_GT(Player::Apart(player.At("greet", 0.25, true), player.At("greet", 0.75, true)), 0.02);
  EXPECT_LT(Player::Apart(player.At("greet", 0.25, true), player.At("greet", 2.25, true)), 1e-6);
}

}  // namespace
}  // namespace pelt::test
