// Thousands of damaged files: each either imports to whole data or is refused with an Error.
// Nothing else may happen; run it under the address and undefined-behaviour sanitizers.
#include <gtest/gtest.h>

#include <algorithm>

#include "core/character/builtin_character.hpp"
#include "core/character/gltf_import.hpp"
#include "core/character/pose.hpp"
#include "core/error.hpp"
#include "core/file_bytes.hpp"
#include "core/random.hpp"
#include "tests/character/gltf_builder.hpp"
#include "tests/character/shared_files.hpp"
#include "tests/character/whole_character.hpp"

namespace pelt::test {
namespace {

size_t JsonEnd(const std::vector<std::byte>& file) {
  uint32_t length = 0;
  for (size_t i = 0; i < 4; ++i) length |= uint32_t(file[12 + i]) << (8 * i);
  return std::min(file.size(), size_t(20) + length);
}

// One kind of damage, drawn by `random`.
std::vector<std::byte> Damage(std::vector<std::byte> file, Random* random) {
  const size_t json_end = JsonEnd(file);
  const uint32_t kind = random->Below(6);
  const uint32_t times = 1 + random->Below(4);
  for (uint32_t i = 0; i < times; ++i) {
    const size_t in_json = 20 + random->Below(uint32_t(json_end - 20));
    const size_t anywhere = random->Below(uint32_t(file.size()));
    if (kind == 0) file[anywhere] ^= std::byte(1u << random->Below(8));
    if (kind == 1) file[in_json] ^= std::byte(1u << random->Below(8));
    if (kind == 2) file[in_json] = std::byte("0123456789-,]}[{\"e.: "[random->Below(21)]);
    if (kind == 3) file[anywhere] = std::byte(random->Below(2) ? 0xff : 0x7f);
    if (kind == 4) {  // another number where one stands
      const std::string digits = "0123456789";
      size_t at = in_json;
      while (at < json_end && digits.find(char(file[at])) == std::string::npos) ++at;
      if (at < json_end) file[at] = std::byte(digits[random->Below(10)]);
    }
  }
  if (kind == 5) file.resize(random->Below(uint32_t(file.size())));
  return file;
}

struct Outcome {
  int imported = 0, refused = 0;
};

Outcome MutateAll(const std::vector<std::byte>& file, int count, uint64_t seed) {
  Outcome outcome;
  for (int i = 0; i < count && !testing::Test::HasFatalFailure(); ++i) {
    Random random(MixSeed(seed, uint64_t(i)));
    const std::vector<std::byte> damaged = Damage(file, &random);
    try {
      const Character c = ImportGltf(damaged, "damaged");
      ExpectWhole(c);
      if (!c.clips.empty()) MakePose(c.skeleton, &c.clips[0], 0.37, true, glm::mat4(1.0f));
      DefaultUnitScale(c);
      ++outcome.imported;
    } catch (const Error& e) {
      EXPECT_EQ(std::string(e.what()).rfind("damaged: ", 0), 0u) << e.what();
      ++outcome.refused;
    }
  }
  return outcome;
}

TEST(GltfMutation, Quad) {
  GltfBuilder b = MakeQuad();
  const int input = b.Floats("SCALAR", {0, 1});
  const int output = b.Floats("VEC4", {0, 0, 0, 1, 0, 0, 1, 0});
  b.animations = "{\"samplers\":[{\"input\":" + std::to_string(input) +
                 ",\"output\":" + std::to_string(output) +
                 "}],\"channels\":[{\"sampler\":0,\"target\":{\"node\":1,\"path\":\"rotation\"}}]}";
  const Outcome outcome = MutateAll(b.Glb(), 5000, 1);
  EXPECT_GT(outcome.imported, 200);
  EXPECT_GT(outcome.refused, 2000);
}

TEST(GltfMutation, Builtin) {
  const Outcome outcome = MutateAll(MakeBuiltinCharacterGlb({.tiny = true}), 1500, 2);
  EXPECT_GT(outcome.imported, 100);
  EXPECT_GT(outcome.refused, 300);
}

TEST(GltfMutation, Fox) {
  const std::string path = FindShared("Fox.glb");
  if (path.empty()) GTEST_SKIP() << "Fox.glb is not there (set PELT_SHARED)";
  const Outcome outcome = MutateAll(ReadFileBytes("model", path).OrThrow(), 1000, 3);
  EXPECT_GT(outcome.imported, 50);
  EXPECT_GT(outcome.refused, 300);
}

}  // namespace
}  // namespace pelt::test
