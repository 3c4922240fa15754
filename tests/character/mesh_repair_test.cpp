// Mesh repair on small meshes whose answers are known, and on random ones by its invariants.
#include "core/character/mesh_repair.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "core/random.hpp"

namespace pelt {
namespace {

// Vertices without normals, tangents or UVs, all on joint 0.
Mesh MakeMesh(std::vector<glm::vec3> position, std::vector<std::array<uint32_t, 3>> triangles) {
  Mesh m;
  m.position = std::move(position);
  m.normal.assign(m.position.size(), glm::vec3(0.0f));
  m.tangent.assign(m.position.size(), glm::vec4(0.0f));
  m.joints.assign(m.position.size(), {0, 0, 0, 0});
  m.weights.assign(m.position.size(), {1, 0, 0, 0});
  m.triangle_material.assign(triangles.size(), 0);
  m.triangles = std::move(triangles);
  return m;
}

TEST(MeshRepair, WeldMergesEqualsOnly) {
  Mesh m =
      MakeMesh({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, -0.0f}, {9, 9, 9}},
               {{0, 1, 2}, {3, 4, 5}});
  m.normal[3] = {0, 0, 1};          // vertex 3 differs from 1
  EXPECT_EQ(WeldVertices(&m), 2u);  // 5 is 2; 6 is unused
  ASSERT_EQ(m.position.size(), 5u);
  EXPECT_EQ(m.triangles[0], (std::array<uint32_t, 3>{0, 1, 2}));
  EXPECT_EQ(m.triangles[1], (std::array<uint32_t, 3>{3, 4, 2}));
  EXPECT_EQ(m.joints.size(), 5u);
  EXPECT_EQ(m.weights.size(), 5u);
  EXPECT_EQ(WeldVertices(&m), 0u);
}

TEST(MeshRepair, WeldLooksAtJointsWeightsAndUvs) {
  for (int what = 0; what < 3; ++what) {
    Mesh m = MakeMesh({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 0}}, {{0, 1, 2}, {3, 2, 1}});
    m.uv.assign(4, {0, 0});
    if (what == 0) m.joints[3][1] = 5;
    if (what == 1) m.weights[3] = {0.5f, 0.5f, 0, 0};
    if (what == 2) m.uv[3] = {0, 1};
    EXPECT_EQ(WeldVertices(&m), 0u) << what;
  }
}

TEST(MeshRepair, DegenerateTrianglesGo) {
  Mesh m = MakeMesh({{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {0, 1, 0}},
                    {{0, 0, 1}, {0, 1, 2}, {0, 1, 3}, {3, 1, 3}});
  m.triangle_material = {0, 1, 2, 3};
  EXPECT_EQ(DropDegenerateTriangles(&m), 3u);
  EXPECT_EQ(m.triangles, (std::vector<std::array<uint32_t, 3>>{{0, 1, 3}}));
  EXPECT_EQ(m.triangle_material, std::vector<uint16_t>{2});
}

TEST(MeshRepair, NormalsWeighByAreaAcrossSeams) {
  // A large triangle facing +z and a small one facing +x share an edge, but not its vertices.
  Mesh m = MakeMesh({{0, 0, 0}, {-4, 0, 0}, {0, -1, 0}, {0, 0, 0}, {0, -1, 0}, {0, 0, -1}},
                    {{0, 1, 2}, {3, 4, 5}});
  EXPECT_EQ(GenerateNormals(&m), 6u);
  // Areas 2 and 0.5; the first faces +z, the second +x.
  const double length = std::sqrt(4.0 + 0.25);
  for (size_t v : {0, 2, 3, 4}) {
    EXPECT_NEAR(m.normal[v].x, 0.5 / length, 1e-6) << v;
    EXPECT_NEAR(m.normal[v].z, 2.0 / length, 1e-6) << v;
  }
  EXPECT_EQ(m.normal[1], glm::vec3(0, 0, 1));
  EXPECT_EQ(m.normal[5], glm::vec3(1, 0, 0));
}

TEST(MeshRepair, NormalsOfAFoldedSheet) {
  Mesh m = MakeMesh({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 1, 2}, {0, 2, 1}});
  EXPECT_EQ(GenerateNormals(&m), 3u);
  for (const glm::vec3& n : m.normal) EXPECT_EQ(n, glm::vec3(0, 0, 1));
}

TEST(MeshRepair, GivenNormalsStay) {
  Mesh m = MakeMesh({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 1, 2}});
  m.normal[1] = {1, 0, 0};
  EXPECT_EQ(GenerateNormals(&m), 2u);
  EXPECT_EQ(m.normal[1], glm::vec3(1, 0, 0));
  EXPECT_EQ(m.normal[0], glm::vec3(0, 0, 1));
}

// Two walls of a roof, each with its own normals: `degrees` between those. Areas 1 and 3.
Mesh Roof(double degrees) {
  const float c = float(std::cos(degrees * 3.14159265358979 / 180.0)),
              s = float(std::sin(degrees * 3.14159265358979 / 180.0));
  Mesh m = MakeMesh({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 0}, {0, 1, 0}, {-3 * c, 0, -3 * s}},
                    {{0, 1, 2}, {3, 4, 5}});
  const glm::vec3 left(-s, 0.0f, c);
  m.normal = {{0, 0, 1}, {0, 0, 1}, {0, 0, 1}, left, left, left};
  GenerateTangents(&m);
  return m;
}

TEST(MeshRepair, CreasesUpToAnAngleAreRound) {
  Mesh m = Roof(40.0);
  EXPECT_EQ(SmoothCreases(39.0, &m), 0u);
  EXPECT_EQ(SmoothCreases(41.0, &m), 4u);
  EXPECT_EQ(m.normal[0], m.normal[3]);
  EXPECT_EQ(m.normal[2], m.normal[4]);
  EXPECT_EQ(m.normal[1], glm::vec3(0, 0, 1));
  // By area, so three quarters of the way to the larger wall.
  const glm::vec3 left = Roof(40.0).normal[5];
  EXPECT_LT(glm::length(m.normal[0] - glm::normalize(glm::vec3(0, 0, 1) + 3.0f * left)), 1e-5f);
  for (size_t v = 0; v < m.normal.size(); ++v)
    EXPECT_NEAR(glm::dot(m.normal[v], glm::vec3(m.tangent[v])), 0.0f, 1e-6f);
}

TEST(MeshRepair, TinyAndHugeTrianglesHaveNormals) {
  for (float size : {1e-18f, 1e-10f, 1e10f, 1e15f}) {
    Mesh m = MakeMesh({{0, 0, 0}, {size, 0, 0}, {0, size, 0}}, {{0, 1, 2}});
    EXPECT_EQ(DropDegenerateTriangles(&m), 0u);
    GenerateNormals(&m);
    EXPECT_EQ(m.normal[0], glm::vec3(0, 0, 1)) << size;
  }
}

TEST(MeshRepair, TangentsFollowU) {
  Mesh m = MakeMesh({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 1, 2}});
  m.uv = {{0, 0}, {0, 1}, {2, 0}};  // u grows along +y, v along +x: mirrored
  GenerateNormals(&m);
  EXPECT_EQ(GenerateTangents(&m), 3u);
  for (const glm::vec4& t : m.tangent) EXPECT_EQ(t, glm::vec4(0, 1, 0, -1));
  m.tangent.assign(3, glm::vec4(0.0f));
  m.uv = {{0, 0}, {1, 0}, {0, 1}};
  GenerateTangents(&m);
  for (const glm::vec4& t : m.tangent) EXPECT_EQ(t, glm::vec4(1, 0, 0, 1));
}

TEST(MeshRepair, TangentsAreUnitAndAcrossWhateverComesIn) {
  Random random(5);
  auto draw = [&random](double reach) {
    glm::vec3 v;
    for (int c = 0; c < 3; ++c) v[c] = float(random.Uniform(-reach, reach));
    return v;
  };
  for (int with_uv = 0; with_uv < 2; ++with_uv) {
    Mesh m = MakeMesh(std::vector<glm::vec3>(300), {});
    for (auto& p : m.position) p = draw(1.0);
    for (int i = 0; i < 500; ++i)
      m.triangles.push_back({random.Below(300), random.Below(300), random.Below(300)});
    m.triangle_material.assign(500, 0);
    if (with_uv) {
      m.uv.resize(300);
      for (auto& uv : m.uv) uv = glm::vec2(draw(1.0));
      for (size_t v = 0; v < 50; ++v) m.uv[v] = {0.5f, 0.5f};  // degenerate charts
      for (size_t v = 0; v < 20; ++v) m.tangent[v] = glm::vec4(draw(1.0), -1.0f);
    }
    DropDegenerateTriangles(&m);
    WeldVertices(&m);
    GenerateNormals(&m);
    GenerateTangents(&m);
    for (size_t v = 0; v < m.position.size(); ++v) {
      const glm::dvec3 n(m.normal[v]), t(m.tangent[v]);
      ASSERT_NEAR(glm::dot(n, n), 1.0, 1e-6) << v;
      ASSERT_NEAR(glm::dot(t, t), 1.0, 1e-6) << v;
      ASSERT_NEAR(glm::dot(n, t), 0.0, 1e-6) << v;
      ASSERT_EQ(std::abs(m.tangent[v].w), 1.0f) << v;
    }
  }
}

TEST(MeshRepair, PickedTangentIsAcross) {
  Random random(6);
  for (int i = 0; i < 10000; ++i) {
    glm::dvec3 n(random.Uniform(-1, 1), random.Uniform(-1, 1), random.Uniform(-1, 1));
    if (i < 6)
      n = {i == 0   ? 1
           : i == 1 ? -1
                    : 0,
           i == 2   ? 1
           : i == 3 ? -1
                    : 0,
           i == 4   ? 1
           : i == 5 ? -1
                    : 0};
    n /= std::sqrt(glm::dot(n, n));
    const glm::dvec3 t = PickTangent(n);
    ASSERT_NEAR(glm::dot(t, t), 1.0, 1e-12);
    ASSERT_NEAR(glm::dot(t, n), 0.0, 1e-12);
  }
}

// A strip of triangles whose middle lost its weights: each takes them from the nearer end.
TEST(MeshRepair, LostWeightsAreBorrowed) {
  std::vector<glm::vec3> position;
  std::vector<std::array<uint32_t, 3>> triangles;
  for (uint32_t i = 0; i < 9; ++i) position.push_back({float(i), float(i % 2), 0});
  for (uint32_t i = 0; i + 2 < 9; ++i) triangles.push_back({i, i + 1, i + 2});
  position.push_back({0, 9, 0});  // of no triangle
  Mesh m = MakeMesh(position, triangles);
  std::vector<uint8_t> lost(10, 1);
  lost[0] = lost[8] = 0;
  m.joints[0] = {3, 4, 0, 0};
  m.weights[0] = {0.75f, 0.25f, 0, 0};
  m.joints[8] = {5, 0, 0, 0};
  EXPECT_EQ(BorrowWeights(&m, lost), 7u);
  for (size_t v = 0; v < 9; ++v) {
    EXPECT_EQ(m.joints[v], m.joints[v < 4 ? 0 : v > 4 ? 8 : (m.joints[4][0] == 3 ? 0 : 8)]) << v;
    EXPECT_EQ(m.weights[v], m.weights[m.joints[v][0] == 3 ? 0 : 8]) << v;
  }
  EXPECT_EQ(m.joints[9][0], 0) << "no vertex to borrow from";
  EXPECT_EQ(BorrowWeights(&m, std::vector<uint8_t>(10, 0)), 0u);
  EXPECT_EQ(BorrowWeights(&m, std::vector<uint8_t>(10, 1)), 0u) << "no vertex has any";
}

// A seam's other side is at the same place, nearer than any corner.
TEST(MeshRepair, LostWeightsAreBorrowedAcrossSeams) {
  Mesh m = MakeMesh({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0}},
                    {{0, 1, 2}, {3, 5, 4}});
  m.joints[3] = {7, 0, 0, 0};
  EXPECT_EQ(BorrowWeights(&m, {0, 1, 0, 0, 0, 0}), 1u);
  EXPECT_EQ(m.joints[1][0], 7);
}

}  // namespace
}  // namespace pelt
