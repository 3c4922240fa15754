// Characters as artists and exporters leave them.
#include <gtest/gtest.h>

#include "core/character/gltf_import.hpp"
#include "core/character/pose.hpp"
#include "tests/character/shared_files.hpp"
#include "tests/character/whole_character.hpp"

namespace pelt {
namespace {

struct RealFile {
  const char* file;
  size_t vertices, triangles, joints, clips, materials;
  bool uvs;
  float unit_scale;
};

class RealFiles : public testing::TestWithParam<RealFile> {};

TEST_P(RealFiles, ImportsWhole) {
  const RealFile& want = GetParam();
  const std::string path = test::FindShared(want.file);
  if (path.empty()) GTEST_SKIP() << want.file << " is not there (set PELT_SHARED)";
  const Character c = ImportGltfFile(path);
  test::ExpectWhole(c);
  EXPECT_EQ(c.mesh.position.size(), want.vertices);
  EXPECT_EQ(c.mesh.triangles.size(), want.triangles);
  EXPECT_EQ(c.skeleton.name.size(), want.joints);
  EXPECT_EQ(c.clips.size(), want.clips);
  EXPECT_EQ(c.mesh.materials.size(), want.materials);
  EXPECT_EQ(!c.mesh.uv.empty(), want.uvs);
  EXPECT_EQ(DefaultUnitScale(c).metres_per_unit, want.unit_scale);
  test::ExpectRestAgrees(c, want.unit_scale);
}

// A posed character is about as large as a resting one: no track reaches the wrong joint.
TEST_P(RealFiles, MovesWithinReason) {
  const RealFile& want = GetParam();
  const std::string path = test::FindShared(want.file);
  if (path.empty()) GTEST_SKIP() << want.file << " is not there (set PELT_SHARED)";
  const Character c = ImportGltfFile(path);
  const SkeletonBlock skeleton = MakeSkeletonBlock(c.skeleton);
  const glm::mat4 root = PlaceCharacter(glm::mat4(1.0f), want.unit_scale);
  const RestGeometry rest = ComputeRestGeometry(c, want.unit_scale);
  for (const Clip& clip : c.clips) {
    double moved = 0.0;
    for (double t : {0.21, 0.5, 0.83}) {
      const PoseBlock pose = MakePose(c.skeleton, &clip, t * clip.duration_s, true, root);
      const std::vector<glm::dvec3> skinned = test::SkinPositions(c.mesh, pose, skeleton);
      for (size_t v = 0; v < skinned.size(); ++v) {
        const glm::dvec3 d = skinned[v] - glm::dvec3(rest.position[v]);
        moved = std::max(moved, std::sqrt(glm::dot(d, d)));
      }
    }
    EXPECT_GT(moved, 0.005) << clip.name;
    EXPECT_LT(moved, 2.5) << clip.name;
  }
}

INSTANTIATE_TEST_SUITE_P(Shared, RealFiles,
                         testing::Values(RealFile{"Fox.glb", 434, 576, 25, 3, 1, true, 0.01f},
                                         RealFile{"Wolf.glb", 3994, 1962, 53, 12, 4, false, 0.1f},
                                         RealFile{"RiggedFigure.glb", 365, 256, 21, 1, 1, false,
                                                  1.0f}),
                         [](const auto& info) {
                           const std::string file = info.param.file;
                           return file.substr(0, file.find('.'));
                         });

}  // namespace
}  // namespace pelt
