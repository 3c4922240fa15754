// Every feature of glTF that a character may use, one small file each. (Long because the features
// are many; each test stands alone.)
#include "core/character/gltf_import.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <limits>

#include "core/character/pose.hpp"
#include "core/error.hpp"
#include "tests/character/gltf_builder.hpp"
#include "tests/error_from.hpp"
#include "tests/test_folder.hpp"

namespace pelt::test {
namespace {

bool HasNote(const Character& c, const std::string& part) {
  for (const std::string& note : c.notes)
    if (note.find(part) != std::string::npos) return true;
  return false;
}

// The quad as every variant must come out.
void ExpectQuad(const Character& c) {
  ASSERT_EQ(c.mesh.position.size(), 4u);
  ASSERT_EQ(c.mesh.triangles.size(), 2u);
  for (size_t v = 0; v < 4; ++v) {
    for (int i = 0; i < 3; ++i)
      EXPECT_EQ(c.mesh.position[v][i], kQuadPositions[3 * v + size_t(i)]) << v;
    EXPECT_EQ(c.mesh.joints[v][0], v < 2 ? 0 : 1) << v;
    EXPECT_EQ(c.mesh.weights[v], glm::vec4(1, 0, 0, 0)) << v;
    EXPECT_EQ(c.mesh.normal[v], glm::vec3(0, 0, 1)) << v;
  }
  EXPECT_EQ(c.skeleton.name, (std::vector<std::string>{"base", "tip"}));
  EXPECT_EQ(c.skeleton.parent, (std::vector<int32_t>{-1, 0}));
  EXPECT_EQ(c.skeleton.rest[1].translation, glm::vec3(0, 1, 0));
  EXPECT_EQ(c.skeleton.inverse_bind[1][3], glm::vec4(0, -1, 0, 1));
}

TEST(GltfImport, PlainQuad) {
  const Character c = Import(MakeQuad());
  ExpectQuad(c);
  EXPECT_EQ(c.name, "quad.glb");
  EXPECT_EQ(c.mesh.materials, std::vector<std::string>{"default"});
  EXPECT_TRUE(c.mesh.uv.empty());
  EXPECT_TRUE(HasNote(c, "no normal"));
}

TEST(GltfImport, IndicesOfEveryType) {
  for (int type : {kU8, kU16, kU32}) {
    GltfBuilder b = MakeQuad({.indices = false});
    if (type == kU8) b.Indices(b.Add(kU8, "SCALAR", std::vector<uint8_t>{0, 1, 2, 0, 2, 3}));
    if (type == kU16) b.Indices(b.Add(kU16, "SCALAR", kQuadIndices));
    if (type == kU32) b.Indices(b.Add(kU32, "SCALAR", std::vector<uint32_t>{0, 1, 2, 0, 2, 3}));
    ExpectQuad(Import(b));
  }
}

TEST(GltfImport, NoIndicesWelds) {
  GltfBuilder b = MakeQuad({false, false, false, false, true});
  std::vector<float> position, weights;
  std::vector<uint8_t> joints;
  for (uint16_t i : kQuadIndices) {
    for (size_t c = 0; c < 3; ++c) position.push_back(kQuadPositions[3 * i + c]);
    for (size_t c = 0; c < 4; ++c) weights.push_back(kQuadWeights[4 * i + c]);
    for (size_t c = 0; c < 4; ++c) joints.push_back(kQuadJoints[4 * i + c]);
  }
  b.Attribute("POSITION", b.Floats("VEC3", position));
  b.Attribute("JOINTS_0", b.Add(kU8, "VEC4", joints));
  b.Attribute("WEIGHTS_0", b.Floats("VEC4", weights));
  const Character c = Import(b);
  ExpectQuad(c);
  EXPECT_TRUE(HasNote(c, "6 vertices welded to 4"));
}

TEST(GltfImport, JointsAsShortsAndWeightsAsIntegers) {
  for (int type : {kU8, kU16}) {
    GltfBuilder b = MakeQuad({.joints = false, .weights = false});
    std::vector<uint8_t> j = kQuadJoints;
    j[1] = 1;  // vertex 0 hangs on the tip too
    b.Attribute("JOINTS_0", b.Add(kU16, "VEC4", std::vector<uint16_t>(j.begin(), j.end())));
    if (type == kU8) {
      std::vector<uint8_t> w;
      for (float f : kQuadWeights) w.push_back(uint8_t(f * 255));
      w[0] = 51;  // 0.2 on joint 0 and 0.8 on joint 1
      w[1] = 204;
      b.Attribute("WEIGHTS_0", b.Add(kU8, "VEC4", w, ",\"normalized\":true"));
    } else {
      std::vector<uint16_t> w;
      for (float f : kQuadWeights) w.push_back(uint16_t(f * 65535));
      w[0] = 13107;
      w[1] = 52428;
      b.Attribute("WEIGHTS_0", b.Add(kU16, "VEC4", w, ",\"normalized\":true"));
    }
    const Character c = Import(b);
    ASSERT_EQ(c.mesh.position.size(), 4u);
    EXPECT_EQ(c.mesh.joints[0][0], 1);
    EXPECT_EQ(c.mesh.joints[0][1], 0);
    EXPECT_NEAR(c.mesh.weights[0][0], 0.8f, 1e-6f);
    EXPECT_NEAR(c.mesh.weights[0][1], 0.2f, 1e-6f);
    EXPECT_EQ(c.mesh.weights[2], glm::vec4(1, 0, 0, 0));
  }
}

TEST(GltfImport, ByteStridesAndOffsets) {
  GltfBuilder b = MakeQuad({.position = false, .weights = false});
  std::vector<float> mixed;  // position, pad, weights: 32 bytes per vertex
  for (size_t v = 0; v < 4; ++v) {
    for (size_t c = 0; c < 3; ++c) mixed.push_back(kQuadPositions[3 * v + c]);
    mixed.push_back(1e9f);
    for (size_t c = 0; c < 4; ++c) mixed.push_back(kQuadWeights[4 * v + c]);
  }
  const int view = b.View(mixed, 32);
  b.Attribute("POSITION", b.Accessor(view, kF32, 4, "VEC3"));
  b.Attribute("WEIGHTS_0", b.Accessor(view, kF32, 4, "VEC4", ",\"byteOffset\":16"));
  ExpectQuad(Import(b));
}

TEST(GltfImport, SparseOverData) {
  GltfBuilder b = MakeQuad({.position = false});
  std::vector<float> wrong = kQuadPositions;
  wrong[3] = 77;  // vertex 1
  wrong[9] = 88;  // vertex 3
  const int base = b.View(wrong);
  const int indices = b.View(std::vector<uint16_t>{1, 3});
  const int values = b.View(std::vector<float>{1, 0, 0, 0, 1, 0});
  b.Attribute("POSITION", b.Accessor(base, kF32, 4, "VEC3",
                                     ",\"sparse\":{\"count\":2,\"indices\":{\"bufferView\":" +
                                         std::to_string(indices) +
                                         ",\"componentType\":5123},\"values\":{\"bufferView\":" +
                                         std::to_string(values) + "}}"));
  ExpectQuad(Import(b));
}

TEST(GltfImport, SparseOverZeros) {
  GltfBuilder b = MakeQuad({.position = false});
  const int indices = b.View(std::vector<uint8_t>{1, 2, 3});
  const int values = b.View(std::vector<float>{1, 0, 0, 1, 1, 0, 0, 1, 0});
  b.Attribute("POSITION", b.Accessor(-1, kF32, 4, "VEC3",
                                     ",\"sparse\":{\"count\":3,\"indices\":{\"bufferView\":" +
                                         std::to_string(indices) +
                                         ",\"componentType\":5121},\"values\":{\"bufferView\":" +
                                         std::to_string(values) + "}}"));
  ExpectQuad(Import(b));
}

TEST(GltfImport, NoInverseBindMatricesMeansIdentity) {
  GltfBuilder b = MakeQuad({.skin = false});
  b.skins = R"({"joints":[0,1]})";
  const Character c = Import(b);
  for (const glm::mat4& m : c.skeleton.inverse_bind) EXPECT_EQ(m, glm::mat4(1.0f));
  // The tip's vertices are then carried up by its rest translation.
  const RestGeometry rest = ComputeRestGeometry(c, 1.0f);
  EXPECT_EQ(rest.position[2], glm::vec3(1, 2, 0));
  EXPECT_EQ(rest.position[1], glm::vec3(1, 0, 0));
}

TEST(GltfImport, AncestorsJoinTheSkeletonParentsFirst) {
  GltfBuilder b = MakeQuad({.skin = false});
  // Listed children first; "scale" and "top" are no joints, "stray" is not needed.
  b.nodes =
      R"({"name":"tip","translation":[0,1,0]},{"name":"base","children":[0]},)"
      R"({"name":"quad","mesh":0,"skin":0},{"name":"scale","scale":[2,2,2],"children":[5,1]},)"
      R"({"name":"top","translation":[5,0,0],"children":[3,2]},{"name":"stray"})";
  b.skins = R"({"joints":[1,0]})";
  const Character c = Import(b);
  EXPECT_EQ(c.skeleton.name, (std::vector<std::string>{"top", "scale", "base", "tip"}));
  EXPECT_EQ(c.skeleton.parent, (std::vector<int32_t>{-1, 0, 1, 2}));
  EXPECT_EQ(c.mesh.joints[0][0], 2);
  EXPECT_EQ(c.mesh.joints[2][0], 3);
  // (1, 1, 0) under tip (+1 in y), times 2, plus 5 in x.
  EXPECT_EQ(ComputeRestGeometry(c, 0.5f).position[2], glm::vec3(3.5f, 2, 0));
}

TEST(GltfImport, NodeMatrixIsDecomposed) {
  GltfBuilder b = MakeQuad();
  // 90 degrees about z, scale (2, 3, 4), translation (5, 6, 7); columns.
  b.nodes = R"({"name":"base","children":[1],"matrix":[0,2,0,0,-3,0,0,0,0,0,4,0,5,6,7,1]},)"
            R"({"name":"tip","matrix":[-1,0,0,0,0,1,0,0,0,0,1,0,0,0,0,1]},)"
            R"({"name":"quad","mesh":0,"skin":0})";
  const Character c = Import(b);
  const JointPose& base = c.skeleton.rest[0];
  EXPECT_EQ(base.translation, glm::vec3(5, 6, 7));
  EXPECT_EQ(base.scale, glm::vec3(2, 3, 4));
  EXPECT_NEAR(base.rotation.z, std::sqrt(0.5f), 1e-6f);
  EXPECT_NEAR(base.rotation.w, std::sqrt(0.5f), 1e-6f);
  // A mirror becomes a negative scale.
  EXPECT_EQ(c.skeleton.rest[1].scale, glm::vec3(-1, 1, 1));
  EXPECT_NEAR(std::abs(c.skeleton.rest[1].rotation.w), 1.0f, 1e-6f);
}

TEST(GltfImport, SeveralPrimitivesAndMaterials) {
  GltfBuilder b = MakeQuad();
  b.materials = R"({"name":"fur"},{},{"name":"unused"})";
  const std::string attributes = "{\"attributes\":{" + b.attributes + "}" + b.primitive_more;
  b.meshes = "{\"name\":\"fox\",\"primitives\":[" + attributes + ",\"material\":1}," + attributes +
             ",\"material\":0}]}";
  const Character c = Import(b);
  EXPECT_EQ(c.mesh.materials, (std::vector<std::string>{"material 1", "fur"}));
  EXPECT_EQ(c.mesh.triangle_material, (std::vector<uint16_t>{0, 0, 1, 1}));
  EXPECT_EQ(c.mesh.position.size(), 4u);  // the same vertices
}

// The same mesh once more, with a skin of these inverse bind matrices.
void AddSecondMesh(GltfBuilder& b, const std::vector<float>& inverse_bind) {
  b.skins += ",{\"joints\":[0,1],\"inverseBindMatrices\":" +
             std::to_string(b.Floats("MAT4", inverse_bind)) + "}";
  const std::string mesh =
      "{\"primitives\":[{\"attributes\":{" + b.attributes + "}" + b.primitive_more + "}]}";
  b.meshes = mesh + "," + mesh;
  b.nodes += R"(,{"name":"second","mesh":1,"skin":1})";
}

TEST(GltfImport, TwoSkinsOfOneSkeletonMeetInOneBindSpace) {
  GltfBuilder b = MakeQuad();
  // The second skin was bound with the mesh moved by (10, 0, 0): inverse bind * that offset.
  AddSecondMesh(b, {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 10, 0,  0, 1,
                    1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 10, -1, 0, 1});
  const Character c = Import(b);
  EXPECT_TRUE(HasNote(c, "another mesh space"));
  ASSERT_EQ(c.mesh.position.size(), 8u);
  const RestGeometry rest = ComputeRestGeometry(c, 1.0f);
  for (size_t v = 0; v < 4; ++v) {
    EXPECT_EQ(rest.position[v], c.mesh.position[v]);
    EXPECT_EQ(rest.position[v + 4], c.mesh.position[v] + glm::vec3(10, 0, 0));
  }
}

TEST(GltfImport, SkinsThatDisagreeJointByJointGetJointsOfTheirOwn) {
  GltfBuilder b = MakeQuad();
  AddSecondMesh(b, {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1,
                    2, 0, 0, 0, 0, 2, 0, 0, 0, 0, 2, 0, 0, 0, 3, 1});
  const Character c = Import(b);
  EXPECT_TRUE(HasNote(c, "joints of its own"));
  EXPECT_EQ(c.skeleton.name, (std::vector<std::string>{"base", "tip", "tip of skin 1"}));
  const RestGeometry rest = ComputeRestGeometry(c, 1.0f);
  // Vertices on the base fall together with the first mesh's; those on the tip do not.
  ASSERT_EQ(rest.position.size(), 6u);
  EXPECT_EQ(rest.position[4], glm::vec3(2, 3, 3));  // 2 * (1, 1, 0) + (0, 0, 3) + tip (0, 1, 0)
}

TEST(GltfImport, UvsNormalsTangentsAreTaken) {
  GltfBuilder b = MakeQuad();
  b.Attribute("TEXCOORD_0",
              b.Add(kU16, "VEC2", std::vector<uint16_t>{0, 0, 65535, 0, 65535, 65535, 0, 65535},
                    ",\"normalized\":true"));
  b.Attribute("NORMAL", b.Floats("VEC3", {0, 0, -2, 0, 0, -2, 0, 0, -2, 0, 0, -2}));
  b.Attribute("TANGENT", b.Floats("VEC4", {0, 1, 0, -1, 0, 1, 0, -1, 0, 1, 0, -1, 0, 3, 4, 1}));
  const Character c = Import(b);
  EXPECT_EQ(c.mesh.uv[2], glm::vec2(1, 1));
  EXPECT_EQ(c.mesh.normal[0], glm::vec3(0, 0, -1));
  EXPECT_EQ(c.mesh.tangent[0], glm::vec4(0, 1, 0, -1));
  EXPECT_EQ(c.mesh.tangent[3], glm::vec4(0, 1, 0, 1));  // made orthogonal
  EXPECT_TRUE(c.notes.empty()) << c.notes[0];
}

TEST(GltfImport, QuantisedPositions) {
  GltfBuilder b = MakeQuad({.position = false});
  b.Attribute(
      "POSITION",
      b.Accessor(b.View(std::vector<int16_t>{0, 0, 0, 0, 1, 0, 0, 0, 1, 1, 0, 0, 0, 1, 0, 0}, 8),
                 kI16, 4, "VEC3"));
  b.more = R"(,"extensionsRequired":["KHR_mesh_quantization"])";
  ExpectQuad(Import(b));
}

TEST(GltfImport, MoreThanFourInfluencesKeepTheLargest) {
  GltfBuilder b = MakeQuad({.joints = false, .weights = false, .skin = false});
  b.nodes = R"({"children":[1,2,3,4]},{},{},{},{},{"mesh":0,"skin":0})";
  b.skins = R"({"joints":[0,1,2,3,4]})";
  std::vector<uint8_t> j0, j1;
  std::vector<float> w0, w1;
  for (int v = 0; v < 4; ++v) {
    for (uint8_t j : {0, 1, 2, 3}) j0.push_back(j);
    for (float w : {0.1f, 0.2f, 0.05f, 0.25f}) w0.push_back(w);
    for (uint8_t j : {4, 1, 0, 0}) j1.push_back(j);
    for (float w : {0.3f, 0.1f, 0.0f, 0.0f}) w1.push_back(w);  // joint 1 twice: 0.3
  }
  b.Attribute("JOINTS_0", b.Add(kU8, "VEC4", j0));
  b.Attribute("WEIGHTS_0", b.Floats("VEC4", w0));
  b.Attribute("JOINTS_1", b.Add(kU8, "VEC4", j1));
  b.Attribute("WEIGHTS_1", b.Floats("VEC4", w1));
  const Character c = Import(b);
  EXPECT_TRUE(HasNote(c, "4 vertices had more than 4 influences"));
  EXPECT_EQ(c.skeleton.name[0], "joint 0");  // unnamed
  const glm::vec4 w = c.mesh.weights[0];
  EXPECT_NEAR(w[0], 0.3f / 0.95f, 1e-6f);
  EXPECT_NEAR(w[1], 0.3f / 0.95f, 1e-6f);
  EXPECT_NEAR(w[2], 0.25f / 0.95f, 1e-6f);
  EXPECT_NEAR(w[3], 0.1f / 0.95f, 1e-6f);
  EXPECT_EQ(c.mesh.joints[0][2], 3);
  EXPECT_EQ(c.mesh.joints[0][3], 0);
}

TEST(GltfImport, WeightsAreRepairedAloud) {
  GltfBuilder b = MakeQuad({.joints = false, .weights = false});
  std::vector<uint8_t> joints = kQuadJoints;
  joints[13] = 200;  // vertex 3, weight 0
  b.Attribute("JOINTS_0", b.Add(kU8, "VEC4", joints));
  b.Attribute("WEIGHTS_0", b.Floats("VEC4", {3, 0, 0, 0, 0, 0, 0, 0, 1, -0.5f, 0, 0, 1, 0, 0, 0}));
  const Character c = Import(b);
  EXPECT_TRUE(HasNote(c, "1 vertices had skin weights that did not sum to 1"));
  EXPECT_TRUE(HasNote(c, "1 vertices had no skin weight"));
  EXPECT_TRUE(HasNote(c, "1 skin weights were negative"));
  EXPECT_TRUE(HasNote(c, "1 joint indices of weight 0"));
  for (const glm::vec4& w : c.mesh.weights) EXPECT_EQ(w, glm::vec4(1, 0, 0, 0));
}

TEST(GltfImport, DegenerateTrianglesAreDroppedAloud) {
  GltfBuilder b = MakeQuad({.indices = false});
  b.Indices(b.Add(kU16, "SCALAR", std::vector<uint16_t>{0, 1, 2, 1, 1, 2, 0, 2, 3}));
  const Character c = Import(b);
  ExpectQuad(c);
  EXPECT_TRUE(HasNote(c, "1 triangles without area"));
}

TEST(GltfImport, UnskinnedMeshesAreLeftOutAloud) {
  GltfBuilder b = MakeQuad();
  b.nodes += R"(,{"name":"hat","mesh":0})";
  const Character c = Import(b);
  ExpectQuad(c);
  EXPECT_TRUE(HasNote(c, "1 mesh nodes without a skin"));
}

TEST(GltfImport, DoubleNamesBecomeUnique) {
  GltfBuilder b = MakeQuad();
  b.nodes = R"({"name":"bone","children":[1]},{"name":"bone"},{"mesh":0,"skin":0})";
  EXPECT_EQ(Import(b).skeleton.name, (std::vector<std::string>{"bone", "bone 2"}));
}

// An animation of the tip with one sampler per channel.
std::string Animate(const std::string& name, int input, int output, const std::string& how,
                    const std::string& path, int node = 1) {
  return "{\"name\":\"" + name + "\",\"samplers\":[{\"input\":" + std::to_string(input) +
         ",\"output\":" + std::to_string(output) + ",\"interpolation\":\"" + how +
         "\"}],\"channels\":[{\"sampler\":0,\"target\":{\"node\":" + std::to_string(node) +
         ",\"path\":\"" + path + "\"}}]}";
}

TEST(GltfImport, AnimationsOfEveryKind) {
  GltfBuilder b = MakeQuad();
  const int input = b.Floats("SCALAR", {0.0f, 2.0f});
  const int moves = b.Floats("VEC3", {0, 1, 0, 4, 1, 0});
  const int cubic = b.Floats("VEC3", {0, 0, 0, 0, 1, 0, 1, 0, 0, -1, 0, 0, 4, 1, 0, 0, 0, 0});
  const int turn =
      b.Add(kI8, "VEC4", std::vector<int8_t>{0, 0, 0, 127, 0, 0, 90, 90}, ",\"normalized\":true");
  b.animations = Animate("step", input, moves, "STEP", "translation") + "," +
                 Animate("linear", input, moves, "LINEAR", "scale") + "," +
                 Animate("spline", input, cubic, "CUBICSPLINE", "translation") + "," +
                 Animate("turn", input, turn, "LINEAR", "rotation") + "," +
                 Animate("", input, moves, "LINEAR", "translation", 2);
  const Character c = Import(b);
  ASSERT_EQ(c.clips.size(), 5u);
  EXPECT_EQ(c.clips[0].tracks[0].interpolation, Interpolation::kStep);
  EXPECT_EQ(c.clips[1].tracks[0].channel, Channel::kScale);
  EXPECT_EQ(c.clips[2].tracks[0].value.size(), 6u);
  EXPECT_EQ(c.clips[2].tracks[0].value[2], glm::vec4(1, 0, 0, 0));
  EXPECT_EQ(c.clips[2].duration_s, 2.0f);
  EXPECT_EQ(c.clips[3].tracks[0].joint, 1u);
  EXPECT_NEAR(c.clips[3].tracks[0].value[1].z, std::sqrt(0.5f), 1e-6f);  // made unit
  EXPECT_EQ(c.clips[4].name, "clip 4");
  EXPECT_TRUE(c.clips[4].tracks.empty());
  EXPECT_TRUE(HasNote(c, "animation 4: 1 channels move no joint"));
  EXPECT_TRUE(HasNote(c, "animation 4 has no name; it is now 'clip 4'"));
}

TEST(GltfImport, TextFileWithDataUri) {
  const GltfBuilder b = MakeQuad();
  static const char* kDigits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string base64;
  for (size_t i = 0; i < b.binary.size(); i += 3) {
    uint32_t group = 0;
    for (size_t k = 0; k < 3; ++k)
      group = group << 8 | (i + k < b.binary.size() ? b.binary[i + k] : 0);
    for (size_t k = 0; k < 4; ++k)
      base64 += i + k <= b.binary.size() ? kDigits[group >> (18 - 6 * k) & 63] : '=';
  }
  const std::string json = b.Json(true, "data:application/octet-stream;base64," + base64);
  ExpectQuad(ImportGltf(std::as_bytes(std::span(json)), "quad.glb"));
}

TEST(GltfImport, FilesWithBuffersBeside) {
  const TestFolder folder;
  const GltfBuilder b = MakeQuad();
  const std::string file = folder.Save("quad.gltf", b.Json(true, "quad.bin"));
  const std::string beside = folder.Save("quad.bin", b.binary);
  const Character c = ImportGltfFile(file);
  ExpectQuad(c);
  EXPECT_EQ(c.name, "quad");
  std::filesystem::remove(beside);
  const std::string error = ErrorFrom([&] { ImportGltfFile(file); });
  EXPECT_NE(error.find("quad.bin"), std::string::npos) << error;
}

TEST(GltfImport, ImagesAreNotLookedAt) {
  GltfBuilder b = MakeQuad();
  b.more = R"(,"images":[{"bufferView":999,"mimeType":"image/png"},{"uri":"nowhere.png"}],)"
           R"("textures":[{"source":0}],"extras":{"a":[1,2]})";
  ExpectQuad(Import(b));
}

// One vertex that no tool could have meant is no reason to refuse the others.
TEST(GltfImport, WhatIsNoNumberIsRepairedWithANote) {
  for (const float bad :
       {std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity()}) {
    GltfBuilder b = MakeQuad({.weights = false});
    std::vector<float> weights = kQuadWeights, normals = {0, 0, 1, 0, 0, 1, 0, 0, 1, 0, 0, 1};
    std::vector<float> uvs = {0, 0, 1, 0, 1, 1, 0, 1};
    weights[4 * 3] = normals[3 * 2 + 1] = uvs[2 * 1] = bad;
    b.Attribute("WEIGHTS_0", b.Floats("VEC4", weights));
    b.Attribute("NORMAL", b.Floats("VEC3", normals));
    b.Attribute("TEXCOORD_0", b.Floats("VEC2", uvs));
    const Character character = ImportGltf(b.Glb(), "odd");
    std::string notes;
    for (const std::string& note : character.notes) notes += note + "\n";
    for (const char* part :
         {"1 vertices had skin weights that are no finite numbers; a neighbour's were taken",
          "1 vertices had a normal that is no finite number", "1 vertices had UVs"})
      EXPECT_NE(notes.find(part), std::string::npos) << part << " is not in: " << notes;
    ASSERT_EQ(character.mesh.position.size(), 4u);
    for (size_t v = 0; v < 4; ++v) {
      EXPECT_EQ(character.mesh.weights[v], glm::vec4(1, 0, 0, 0)) << v;
      EXPECT_NEAR(character.mesh.normal[v].z, 1.0f, 1e-6f) << v;
      EXPECT_TRUE(std::isfinite(character.mesh.uv[v].x)) << v;
    }
  }
}

TEST(GltfImport, AnUnknownRequiredExtensionIsANote) {
  GltfBuilder b = MakeQuad();
  b.more = R"(,"extensionsRequired":["KHR_materials_unlit","ACME_rig"])";
  const Character character = ImportGltf(b.Glb(), "quad");
  std::string notes;
  for (const std::string& note : character.notes) notes += note + "\n";
  EXPECT_NE(notes.find("The file requires ACME_rig, which is not supported"), std::string::npos)
      << notes;
  EXPECT_EQ(notes.find("unlit"), std::string::npos) << notes;
}

}  // namespace
}  // namespace pelt::test
