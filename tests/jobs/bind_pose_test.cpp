// The bind pose: every joint brings the mesh to where it was bound, in metres.
#include "core/bind_pose.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/jobs/tiny_scene.hpp"

namespace pelt::testing {
namespace {

TEST(BindPose, PutsTheMeshWhereItWasBound) {
  const Scenario scenario = TinyScenario();
  const std::vector<const Groom*> grooms = scenario.ActorGrooms();
  const Groom& groom = *grooms[0];
  const auto made = FurScene::Create(grooms).OrThrow();
  FurScene& scene = *made;
  for (uint32_t c = 0; c < grooms.size(); ++c) FillBindPose(*grooms[c], scene.Pose(c));
  RunInput(scene, {});
  const auto& palette = *scene.memory().Of<&Streams::palette>(0);
  ASSERT_GT(groom.joint_count, 3u);
  for (uint32_t j = 0; j < groom.joint_count; ++j)
    for (int r = 0; r < 3; ++r)
      for (int c = 0; c < 4; ++c)
        EXPECT_NEAR(palette.matrix[j][4 * r + c], r == c ? groom.unit_scale : 0.0f, 1e-4f)
            << "joint " << groom.joint_names[j] << ", row " << r << ", column " << c;
}

// Rotations by every sign of the quaternion's parts, scale, mirror and shift, down a chain of two.
TEST(BindPose, UndoesAnyInverseBind) {
  Groom groom;
  groom.unit_scale = 0.5f;
  groom.joint_count = 2;
  groom.skeleton.parent[0] = -1;
  groom.skeleton.parent[1] = 0;
  const float parent[12] = {0, -2, 0, 3, 2, 0, 0, -1, 0, 0, 2, 0.5f};
  for (const float sx : {1.0f, -1.0f})
    for (const float sy : {1.0f, -1.0f})
      for (const float sz : {1.0f, -1.0f}) {
        const float child[12] = {0, 0, sx, 1, sy, 0, 0, 2, 0, sz, 0, 3};
        std::copy_n(parent, 12, groom.skeleton.inverse_bind[0]);
        std::copy_n(child, 12, groom.skeleton.inverse_bind[1]);
        PoseBlock pose{};
        FillBindPose(groom, pose);
        EXPECT_EQ(pose.root[0], 0.5f);
        EXPECT_EQ(pose.joint_count, 2u);
        double global[3][4] = {{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}};
        for (uint32_t j = 0; j < 2; ++j) {
          double q[4], s[3], t[3];
          for (int c = 0; c < 4; ++c) q[c] = pose.rotation_key[0][c][j];
          for (int c = 0; c < 3; ++c) s[c] = pose.scale_key[0][c][j];
          for (int c = 0; c < 3; ++c) t[c] = pose.translation_key[0][c][j];
          const double x = q[0], y = q[1], z = q[2], w = q[3];
          EXPECT_NEAR(x * x + y * y + z * z + w * w, 1.0, 1e-6);
          const double local[3][4] = {{(1 - 2 * (y * y + z * z)) * s[0], 2 * (x * y - w * z) * s[1],
                                       2 * (x * z + w * y) * s[2], t[0]},
                                      {2 * (x * y + w * z) * s[0], (1 - 2 * (x * x + z * z)) * s[1],
                                       2 * (y * z - w * x) * s[2], t[1]},
                                      {2 * (x * z - w * y) * s[0], 2 * (y * z + w * x) * s[1],
                                       (1 - 2 * (x * x + y * y)) * s[2], t[2]}};
          double next[3][4];
          for (int r = 0; r < 3; ++r)
            for (int c = 0; c < 4; ++c) {
              next[r][c] = c == 3 ? global[r][3] : 0.0;
              for (int k = 0; k < 3; ++k) next[r][c] += global[r][k] * local[k][c];
            }
          std::copy_n(&next[0][0], 12, &global[0][0]);
          const float* inverse_bind = groom.skeleton.inverse_bind[j];
          for (int r = 0; r < 3; ++r)
            for (int c = 0; c < 4; ++c) {
              double value = c == 3 ? global[r][3] : 0.0;
              for (int k = 0; k < 3; ++k) value += global[r][k] * double(inverse_bind[4 * k + c]);
              EXPECT_NEAR(value, r == c ? 1.0 : 0.0, 1e-5)
                  << sx << sy << sz << " joint " << j << " row " << r << " column " << c;
            }
        }
      }
}

TEST(BindPose, StaysFiniteWithoutAnInverse) {
  Groom groom;
  groom.joint_count = 1;
  groom.skeleton.parent[0] = -1;
  PoseBlock pose{};
  FillBindPose(groom, pose);
  EXPECT_EQ(pose.rotation_key[0][3][0], 1.0f);
  EXPECT_EQ(pose.scale_key[0][0][0], 1.0f);
}

}  // namespace
}  // namespace pelt::testing
