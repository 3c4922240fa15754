// sample_pose and joint_palette against plain double-precision references.
#include <gtest/gtest.h>

#include <cmath>
#include <memory>

#include "core/kernels/joint_palette.hpp"
#include "core/kernels/sample_pose.hpp"
#include "tests/kernels/run_kernel.hpp"

namespace pelt::test {
namespace {

constexpr float kIdentity[12] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0};

std::unique_ptr<PoseBlock> MakePose(uint32_t joint_count, uint32_t seed) {
  auto pose = std::make_unique<PoseBlock>();
  // Lanes that nothing fills hold what memory held.
  Poison(*pose);
  std::mt19937 random(seed);
  for (uint32_t j = 0; j < joint_count; ++j) {
    for (int k = 0; k < 4; ++k) {
      for (int c = 0; c < 3; ++c) {
        pose->translation_key[k][c][j] = Uniform(random, -2.0f, 2.0f);
        pose->scale_key[k][c][j] = Uniform(random, 0.5f, 1.5f);
      }
      for (int c = 0; c < 4; ++c)
        pose->rotation_key[k][c][j] = Uniform(random, -0.3f, 0.3f) + (c == 3 ? 1.0f : 0.0f);
      pose->translation_weight[k][j] = Uniform(random, -0.5f, 1.0f);
      pose->rotation_weight[k][j] = Uniform(random, 0.0f, 1.0f);
      pose->scale_weight[k][j] = 0.25f;
    }
  }
  for (int i = 0; i < 12; ++i) pose->root[i] = kIdentity[i] + Uniform(random, -0.2f, 0.2f);
  pose->joint_count = joint_count;
  pose->teleported = 0;
  return pose;
}

std::unique_ptr<SkeletonBlock> MakeSkeleton(uint32_t joint_count, uint32_t seed) {
  auto skeleton = std::make_unique<SkeletonBlock>();
  std::mt19937 random(seed);
  for (uint32_t j = 0; j < joint_count; ++j) {
    // Two roots, long chains and wide fans.
    skeleton->parent[j] = j < 2 ? -1 : int32_t(j - 1 - random() % (j < 4 ? 1 : 3));
    for (int i = 0; i < 12; ++i)
      skeleton->inverse_bind[j][i] = kIdentity[i] + Uniform(random, -0.3f, 0.3f);
  }
  return skeleton;
}

// ---- sample_pose --------------------------------------------------------------------------------

template <class V>
LocalPoseBlock SampleOf(const PoseBlock& pose) {
  return OutputOf<SamplePose<V>, LocalPoseBlock>(nullptr, pose);
}

TEST(SamplePose, BlendsKeysAsTheDoubleReferenceDoes) {
  const auto pose = MakePose(65, 1);
  const LocalPoseBlock local = SampleOf<ArrayVec<4>>(*pose);
  for (uint32_t j = 0; j < 65; ++j) {
    double q[4] = {}, length = 0.0;
    for (int c = 0; c < 4; ++c) {
      for (int k = 0; k < 4; ++k)
        q[c] += double(pose->rotation_key[k][c][j]) * pose->rotation_weight[k][j];
      length += q[c] * q[c];
    }
    for (int c = 0; c < 4; ++c) EXPECT_NEAR(local.rotation[c][j], q[c] / std::sqrt(length), 2e-6);
    for (int c = 0; c < 3; ++c) {
      double translation = 0.0, scale = 0.0;
      for (int k = 0; k < 4; ++k) {
        translation += double(pose->translation_key[k][c][j]) * pose->translation_weight[k][j];
        scale += double(pose->scale_key[k][c][j]) * pose->scale_weight[k][j];
      }
      EXPECT_NEAR(local.translation[c][j], translation, 2e-6);
      EXPECT_NEAR(local.scale[c][j], scale, 2e-6);
    }
  }
}

TEST(SamplePose, JointsNotInUseAndVanishedRotationsAreTheIdentity) {
  auto pose = MakePose(17, 2);
  for (int k = 0; k < 4; ++k)
    for (int c = 0; c < 4; ++c) pose->rotation_key[k][c][5] = 0.0f;
  const LocalPoseBlock local = SampleOf<ArrayVec<8>>(*pose);
  for (int c = 0; c < 4; ++c) EXPECT_EQ(local.rotation[c][5], c == 3 ? 1.0f : 0.0f);
  for (uint32_t j = 17; j < kJointsPerCharacter; ++j) {
    for (int c = 0; c < 4; ++c) ASSERT_EQ(local.rotation[c][j], c == 3 ? 1.0f : 0.0f) << j;
    for (int c = 0; c < 3; ++c) {
      ASSERT_EQ(local.translation[c][j], 0.0f) << j;
      ASSERT_EQ(local.scale[c][j], 1.0f) << j;
    }
  }
}

TEST(SamplePose, SameBlockOnEveryVector) {
  for (uint32_t joint_count : {1u, 16u, 65u, 255u, 256u}) {
    const auto pose = MakePose(joint_count, joint_count);
    ExpectOnEveryVector(
        SampleOf<ArrayVec<4>>(*pose), [&]<class V> { return SampleOf<V>(*pose); }, joint_count);
  }
}

// ---- joint_palette ------------------------------------------------------------------------------

struct Matrix {
  double m[3][4];
};

Matrix Multiply(const Matrix& a, const Matrix& b) {
  Matrix out;
  for (int r = 0; r < 3; ++r) {
    for (int c = 0; c < 4; ++c) {
      out.m[r][c] = c == 3 ? a.m[r][3] : 0.0;
      for (int k = 0; k < 3; ++k) out.m[r][c] += a.m[r][k] * b.m[k][c];
    }
  }
  return out;
}

Matrix FromFloats(const float* m) {
  Matrix out;
  for (int i = 0; i < 12; ++i) out.m[i / 4][i % 4] = m[i];
  return out;
}

// The local matrix, column by column: each axis turned by v' = v + 2 u x (u x v + w v).
Matrix LocalMatrix(const LocalPoseBlock& local, uint32_t j) {
  Matrix out;
  const double u[3] = {local.rotation[0][j], local.rotation[1][j], local.rotation[2][j]};
  const double w = local.rotation[3][j];
  for (int axis = 0; axis < 3; ++axis) {
    double v[3] = {}, a[3], b[3];
    v[axis] = local.scale[axis][j];
    for (int c = 0; c < 3; ++c) {
      const int d = (c + 1) % 3, e = (c + 2) % 3;
      a[c] = u[d] * v[e] - u[e] * v[d] + w * v[c];
    }
    for (int c = 0; c < 3; ++c) {
      const int d = (c + 1) % 3, e = (c + 2) % 3;
      b[c] = u[d] * a[e] - u[e] * a[d];
      out.m[c][axis] = v[c] + 2.0 * b[c];
    }
  }
  for (int c = 0; c < 3; ++c) out.m[c][3] = local.translation[c][j];
  return out;
}

struct PaletteScene {
  std::unique_ptr<PoseBlock> pose;
  std::unique_ptr<SkeletonBlock> skeleton;
  std::unique_ptr<LocalPoseBlock> local = std::make_unique<LocalPoseBlock>();
  std::unique_ptr<PaletteBlock> palette = std::make_unique<PaletteBlock>();

  explicit PaletteScene(uint32_t joint_count)
      : pose(MakePose(joint_count, 31)), skeleton(MakeSkeleton(joint_count, 32)) {
    Sample();
  }
  void Sample() { RunOnBlocks<SamplePose<ArrayVec<4>>>(nullptr, *pose, *local); }
  template <class V>
  void BuildPalette() {
    RunOnBlocks<JointPalette<V>>(nullptr, *pose, *skeleton, *local, *palette);
  }
};

TEST(JointPalette, IsTheProductOfDoubleMatrices) {
  PaletteScene scene(40);
  scene.BuildPalette<ArrayVec<4>>();
  Matrix world[40];
  for (uint32_t j = 0; j < 40; ++j) {
    const int32_t parent = scene.skeleton->parent[j];
    world[j] = Multiply(parent < 0 ? FromFloats(scene.pose->root) : world[parent],
                        LocalMatrix(*scene.local, j));
    const Matrix expected = Multiply(world[j], FromFloats(scene.skeleton->inverse_bind[j]));
    double size = 0.0;
    for (const auto& row : world[j].m)
      for (double v : row) size = std::max(size, std::fabs(v));
    for (int i = 0; i < 12; ++i) {
      EXPECT_NEAR(scene.palette->matrix[j][i], expected.m[i / 4][i % 4], 1e-5 * (1.0 + size))
          << "joint " << j << " element " << i;
    }
  }
}

TEST(JointPalette, SameBlockOnEveryVectorAndUnusedJointsAreTheIdentity) {
  for (uint32_t joint_count : {1u, 17u, 64u, 256u}) {
    PaletteScene reference(joint_count);
    reference.BuildPalette<ArrayVec<4>>();
    for (uint32_t j = joint_count; j < kJointsPerCharacter; ++j)
      ASSERT_EQ(std::memcmp(reference.palette->matrix[j], kIdentity, sizeof kIdentity), 0) << j;
    ForEveryVector([&]<class V>(const char* name) {
      PaletteScene scene(joint_count);
      scene.BuildPalette<V>();
      EXPECT_EQ(std::memcmp(scene.palette.get(), reference.palette.get(), sizeof(PaletteBlock)), 0)
          << name << ", " << joint_count << " joints";
    });
  }
}

uint32_t MovedCount(const PaletteBlock& palette) {
  uint32_t count = 0;
  for (uint32_t word : palette.moved) count += uint32_t(__builtin_popcount(word));
  return count;
}

TEST(JointPalette, MovedBitsSayExactlyWhichMatricesChanged) {
  PaletteScene scene(64);
  scene.BuildPalette<ArrayVec<4>>();
  EXPECT_EQ(MovedCount(*scene.palette), 64u) << "the first frame moves every joint";
  scene.BuildPalette<ArrayVec<4>>();
  EXPECT_EQ(MovedCount(*scene.palette), 0u) << "the same pose moves none";

  // One joint turned by the smallest step: it and everything below it may move, nothing else.
  const PaletteBlock before = *scene.palette;
  const uint32_t turned = 20;
  scene.pose->translation_key[0][1][turned] += 0.25f;
  scene.pose->translation_weight[0][turned] = 1.0f;
  scene.Sample();
  scene.BuildPalette<ArrayVec<4>>();
  bool below[64] = {};
  for (uint32_t j = 0; j < 64; ++j) {
    const int32_t parent = scene.skeleton->parent[j];
    below[j] = j == turned || (parent >= 0 && below[parent]);
    const bool moved = (scene.palette->moved[j / 32] >> (j % 32)) & 1u;
    const bool differs =
        std::memcmp(before.matrix[j], scene.palette->matrix[j], sizeof before.matrix[j]) != 0;
    EXPECT_EQ(moved, differs) << j;
    EXPECT_TRUE(!moved || below[j]) << j;
  }
  EXPECT_TRUE((scene.palette->moved[0] >> turned) & 1u);
}

TEST(JointPalette, ASignOfZeroCountsAsMoved) {
  PaletteScene scene(1);
  for (int c = 0; c < 4; ++c) scene.local->rotation[c][0] = c == 3 ? 1.0f : 0.0f;
  std::memcpy(scene.pose->root, kIdentity, sizeof kIdentity);
  std::memcpy(scene.skeleton->inverse_bind[0], kIdentity, sizeof kIdentity);
  scene.BuildPalette<ArrayVec<4>>();
  scene.BuildPalette<ArrayVec<4>>();
  ASSERT_EQ(scene.palette->moved[0], 0u);
  ASSERT_EQ(BitsOf(scene.palette->matrix[0][1]), 0u);
  scene.palette->matrix[0][1] = -0.0f;
  scene.BuildPalette<ArrayVec<4>>();
  EXPECT_EQ(scene.palette->moved[0], 1u);
  EXPECT_EQ(BitsOf(scene.palette->matrix[0][1]), 0u);
}

TEST(JointPalette, CopiesTeleported) {
  PaletteScene scene(3);
  scene.pose->teleported = 7;
  scene.BuildPalette<ArrayVec<4>>();
  EXPECT_EQ(scene.palette->teleported, 7u);
  scene.pose->teleported = 0;
  scene.BuildPalette<ArrayVec<4>>();
  EXPECT_EQ(scene.palette->teleported, 0u);
}

}  // namespace
}  // namespace pelt::test
