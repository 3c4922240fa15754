// Characters as artists and exporters leave them; and small ones, each of which went wrong in one way.
#include <gtest/gtest.h>

#include <cctype>

#include "core/character/gltf_import.hpp"
#include "core/character/pose.hpp"
#include "core/error.hpp"
#include "core/groom/bake.hpp"
#include "core/groom/surface_colour.hpp"
#include "tests/character/shared_files.hpp"
#include "tests/character/whole_character.hpp"

namespace pelt::test {
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
  const std::string path = FindShared(want.file);
  if (path.empty()) GTEST_SKIP() << want.file << " is not there (set PELT_SHARED)";
  const Character c = ImportGltfFile(path);
  ExpectWhole(c);
  EXPECT_EQ(c.mesh.position.size(), want.vertices);
  EXPECT_EQ(c.mesh.triangles.size(), want.triangles);
  EXPECT_EQ(c.skeleton.name.size(), want.joints);
  EXPECT_EQ(c.clips.size(), want.clips);
  EXPECT_EQ(c.mesh.materials.size(), want.materials);
  EXPECT_EQ(!c.mesh.uv.empty(), want.uvs);
  EXPECT_EQ(DefaultUnitScale(c).metres_per_unit, want.unit_scale);
  ExpectRestAgrees(c, want.unit_scale);
}

// A posed character is about as large as a resting one: no track reaches the wrong joint.
TEST_P(RealFiles, MovesWithinReason) {
  const RealFile& want = GetParam();
  const std::string path = FindShared(want.file);
  if (path.empty()) GTEST_SKIP() << want.file << " is not there (set PELT_SHARED)";
  const Character c = ImportGltfFile(path);
  const SkeletonBlock skeleton = MakeSkeletonBlock(c.skeleton);
  const glm::mat4 root = PlaceCharacter(glm::mat4(1.0f), want.unit_scale);
  const RestGeometry rest = ComputeRestGeometry(c, want.unit_scale);
  for (const Clip& clip : c.clips) {
    double moved = 0.0;
    for (double t : {0.21, 0.5, 0.83}) {
      const PoseBlock pose = MakePose(c.skeleton, &clip, t * clip.duration_s, true, root);
      const std::vector<glm::dvec3> skinned = SkinPositions(c.mesh, pose, skeleton);
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

// A strip of skin, and how many strands grow on it; `colour` is its surface's mean, linear.
struct CaseFile {
  const char* file;
  const char* mask;
  double strands;
  glm::vec3 colour;
  const char* note = "";
};

class CaseFiles : public testing::TestWithParam<CaseFile> {};

TEST_P(CaseFiles, AreRight) {
  const CaseFile& want = GetParam();
  const std::string path = FindShared(want.file, "cases/characters");
  if (path.empty()) GTEST_SKIP() << want.file << " is not there (set PELT_SHARED)";
  const Character c = ImportGltfFile(path);
  ExpectWhole(c);
  const FurSetup setup = ReadFurSetup(
      std::string("[[layer]]\nname = 'coat'\nlength = 0.03\ndensity = 28000\n") + want.mask,
      "case.toml", path.substr(0, path.find("/characters/")) + "/characters");
  const Groom groom = BakeGroom(c, ComputeRestGeometry(c, 1.0f), setup, 1.0f);
  EXPECT_NEAR(double(groom.layers.at(0).strand_count), want.strands, 0.01 * want.strands);
  const SurfaceColour surface(c);
  glm::vec3 mean(0.0f);
  for (uint32_t t = 0; t < c.mesh.triangles.size(); ++t)
    mean += surface.At({t, {0.4f, 0.3f, 0.3f}}) / float(c.mesh.triangles.size());
  for (int i = 0; i < 3; ++i) EXPECT_NEAR(mean[i], want.colour[i], 0.01f) << "rgb"[i];
  std::string notes;
  for (const std::string& note : c.notes) notes += note + "\n";
  EXPECT_NE(notes.find(want.note), std::string::npos) << notes;
  EXPECT_EQ(notes.find("left out"), std::string::npos) << notes;
}

std::string NameOf(const testing::TestParamInfo<CaseFile>& info) {
  std::string name = info.param.file + std::string(*info.param.mask ? "_bald" : "");
  for (char& c : name)
    if (!std::isalnum(static_cast<unsigned char>(c))) c = '_';
  return name;
}

constexpr const char* kBald = "mask = { bald = 'bald_half.png' }";
INSTANTIATE_TEST_SUITE_P(
    Shared, CaseFiles,
    testing::Values(
        CaseFile{"00_control.glb", "", 20573, {1, 1, 1}},
        CaseFile{"13a_uv_float.glb", "", 20573, {0.5f, 0.5f, 0}},
        CaseFile{"13a_uv_float.glb", kBald, 10289, {0.5f, 0.5f, 0}},
        CaseFile{"13b_uv_u16_not_normalised.glb", kBald, 10289, {0.5f, 0.5f, 0}},
        CaseFile{"13e_uv_as_gltfpack.glb", kBald, 10289, {0.5f, 0.5f, 0}},
        CaseFile{"14_spaces/a.gltf", "", 20573, {0.5f, 0.5f, 0}},
        CaseFile{"20_specular_glossiness.glb", "", 20573, {0.8f, 0.1f, 0.05f}},
        CaseFile{"34b_alpha_mask_half_cut_out.glb", "", 10285, {0.5f, 0.176f, 0.023f}, "alpha"},
        CaseFile{"45_mtoon_body_unlit.glb", "", 18001, {1, 1, 1}}),
    NameOf);

// Small files that stand for what is found in the field, and what is right for each: all are the
// same strip of fur.
struct FieldFile {
  const char* file;
  size_t triangles = 128, joints = 3, clips = 1;
  const char* note = "";     // part of one
  const char* refusal = "";  // part of it, where it is right to refuse
};

class FieldFiles : public testing::TestWithParam<FieldFile> {};

TEST_P(FieldFiles, AsIsRight) {
  const FieldFile& want = GetParam();
  const std::string path = FindShared(want.file, "cases/characters");
  if (path.empty()) GTEST_SKIP() << want.file << " is not there (set PELT_SHARED)";
  Character c;
  try {
    c = ImportGltfFile(path);
  } catch (const Error& e) {
    ASSERT_NE(std::string(want.refusal), "") << e.what();
    EXPECT_NE(std::string(e.what()).find(want.refusal), std::string::npos) << e.what();
    EXPECT_LE(std::string(e.what()).size(), 300u);
    return;
  }
  ASSERT_EQ(std::string(want.refusal), "");
  ExpectWhole(c);
  EXPECT_EQ(c.mesh.triangles.size(), want.triangles);
  EXPECT_EQ(c.skeleton.name.size(), want.joints);
  EXPECT_EQ(c.clips.size(), want.clips);
  std::string notes;
  for (const std::string& note : c.notes) {
    EXPECT_LE(note.size(), 300u) << note;
    notes += note + "\n";
  }
  EXPECT_NE(notes.find(want.note), std::string::npos) << want.note << " is not in: " << notes;
}

INSTANTIATE_TEST_SUITE_P(
    Shared, FieldFiles,
    testing::Values(
        FieldFile{
            .file = "01_channel_without_node.gltf", .clips = 2, .note = "1 channels move no joint"},
        FieldFile{.file = "03_triangle_strip.gltf"},
        FieldFile{.file = "05_extra_lines_primitive.gltf",
                  .note = "1 primitives of points or lines were left out"},
        FieldFile{.file = "07_two_scenes.gltf",
                  .note = "scene 0 'hero' was read; 1 mesh nodes outside of it were left out"},
        FieldFile{.file = "09_same_clip_names.gltf",
                  .clips = 2,
                  .note = "two clips are called 'mixamo.com'; the second is now 'mixamo.com 2'"},
        FieldFile{.file = "10_negative_key_time.gltf", .note = "the clip was left out"},
        FieldFile{.file = "12_meshopt_gltfpack.glb",
                  .refusal = "EXT_meshopt_compression is not read; undo it: gltf-transform cp"},
        FieldFile{.file = "16_303_joints_3_used.glb", .note = "300 of 303 joints move no vertex"},
        FieldFile{.file = "17c_all_zero_in_rest.glb", .refusal = "rest pose: has no size"},
        FieldFile{.file = "18_non_uniform_joint_scale.glb", .note = "have normals that fit it"},
        FieldFile{.file = "22b_data_uri.gltf"},
        FieldFile{.file = "24_one_primitive_without_joints.glb", .note = "hangs on no joint"},
        FieldFile{.file = "27_root_motion_loop.glb"}),
    [](const auto& info) {
      std::string name = info.param.file;
      for (char& ch : name)
        if (!std::isalnum(uint8_t(ch))) ch = '_';
      return name;
    });

}  // namespace
}  // namespace pelt::test
