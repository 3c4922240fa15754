// What files of the field have and other readers drop or repair: each case is the skinned quad with
// one thing done to it, what must still be there, and the note that must say so.
#include <gtest/gtest.h>

#include <clocale>
#include <cmath>
#include <functional>
#include <limits>

#include "core/character/gltf_import.hpp"
#include "core/character/pose.hpp"
#include "tests/character/gltf_builder.hpp"
#include "tests/character/whole_character.hpp"
#include "tests/error_from.hpp"

namespace pelt::test {
namespace {

std::string Join(const std::vector<std::string>& notes) {
  std::string all;
  for (const std::string& note : notes) all += note + "\n";
  return all;
}

void ExpectShort(const std::vector<std::string>& messages) {
  for (const std::string& message : messages) EXPECT_LE(message.size(), 300u) << message;
}

std::string Primitive(const std::string& attributes, const std::string& more) {
  return "{\"attributes\":{" + attributes + "}" + more + "}";
}
void SetPrimitives(GltfBuilder& b, const std::string& primitives) {
  b.meshes = "{\"name\":\"fox\",\"primitives\":[" + primitives + "]}";
}
std::string Number(int n) { return std::to_string(n); }

// The quad's triangles by another topology.
GltfBuilder WithIndices(const std::vector<uint16_t>& indices, int mode) {
  GltfBuilder b = MakeQuad({.indices = false});
  b.Indices(b.Add(kU16, "SCALAR", indices));
  b.primitive_more += ",\"mode\":" + Number(mode);
  return b;
}

// Beside the quad a primitive of `more`, with the same vertices.
GltfBuilder WithBeside(const std::string& more) {
  GltfBuilder b = MakeQuad();
  SetPrimitives(b, Primitive(b.attributes, b.primitive_more) + "," + Primitive(b.attributes, more));
  return b;
}

// Beside the quad a primitive without joints, of a mesh that hangs on the tip, or on nothing.
GltfBuilder WithoutJoints(bool held) {
  GltfBuilder b = MakeQuad();
  const std::string position = b.attributes.substr(0, b.attributes.find(','));
  SetPrimitives(
      b, Primitive(b.attributes, b.primitive_more) + "," + Primitive(position, b.primitive_more));
  if (held)
    b.nodes =
        R"({"name":"base","children":[1]},{"name":"tip","translation":[0,1,0],"children":[2]},)"
        R"({"name":"quad","mesh":0,"skin":0,"translation":[0,0,5]})";
  return b;
}

GltfBuilder WithNodes(const std::string& nodes) {
  GltfBuilder b = MakeQuad();
  b.nodes = nodes;
  return b;
}
GltfBuilder WithMore(const std::string& more) {
  GltfBuilder b = MakeQuad();
  b.more = more;
  return b;
}

// A second mesh, moved away, on node 3; then what says which node is there.
GltfBuilder WithSecond(const std::string& node_more, const std::string& more) {
  GltfBuilder b = MakeQuad();
  const std::string mesh = "{\"primitives\":[" + Primitive(b.attributes, b.primitive_more) + "]}";
  b.meshes = mesh + "," + mesh;
  b.nodes = R"({"name":"base","children":[1]},{"name":"tip","translation":[0,1,0]},)"
            R"({"name":"quad","mesh":0,"skin":0)" +
            node_more + R"(},{"name":"other","mesh":1,"skin":0})";
  b.more = more;
  return b;
}

GltfBuilder WithAttribute(const std::string& name, const std::function<int(GltfBuilder&)>& add) {
  GltfBuilder b =
      MakeQuad({name != "POSITION", name != "JOINTS_0", name != "WEIGHTS_0", true, true});
  b.Attribute(name, add(b));
  return b;
}

template <class T>
GltfBuilder WithData(const std::string& name, int component, const std::string& type,
                     const std::vector<T>& data, const std::string& more = "") {
  return WithAttribute(name, [&](GltfBuilder& b) { return b.Add(component, type, data, more); });
}

GltfBuilder WithClips(const std::string& channels, const std::vector<std::string>& names) {
  GltfBuilder b = MakeQuad();
  const int input = b.Floats("SCALAR", {0, 1});
  const int output = b.Floats("VEC3", {0, 1, 0, 0, 2, 0});
  for (const std::string& name : names)
    b.animations += (b.animations.empty() ? "{" : ",{") +
                    (name.empty() ? "" : "\"name\":\"" + name + "\",") +
                    "\"samplers\":[{\"input\":" + Number(input) + ",\"output\":" + Number(output) +
                    "}],\"channels\":[" + channels + "]}";
  return b;
}
const std::string kMoveTip = R"({"sampler":0,"target":{"node":1,"path":"translation"}})";

struct Case {
  const char* name;
  size_t triangles;
  const char* note;  // empty: none of it
  GltfBuilder builder;
  size_t clips = 0;
  size_t joints = 2;
};

std::vector<Case> Cases() {
  const float nan = std::numeric_limits<float>::quiet_NaN();
  std::vector<Case> cases = {
      {"Strip", 2, "", WithIndices({0, 1, 3, 2}, 5)},
      {"StripThatTurnsBack", 2, "", WithIndices({0, 1, 3, 3, 2, 2, 1, 3}, 5)},
      {"StripThatBeginsAnew", 2, "", WithIndices({0, 1, 3, 0xffff, 1, 2, 3}, 5)},
      {"ListThatBeginsAnew", 2, "", WithIndices({0, 1, 2, 0xffff, 0, 2, 3}, 4)},
      {"Fan", 2, "", WithIndices({0, 1, 2, 3}, 6)},
      {"FanTooShort", 0, "", WithIndices({0, 1}, 6)},
      {"CornersLeftOver", 2, "1 corners were left over", WithIndices({0, 1, 2, 0, 2, 3, 1}, 4)},
      {"VertexThatIsNot", 2, "1 triangles had vertices that do not exist",
       WithIndices({0, 1, 2, 0, 2, 3, 1, 2, 9}, 4)},
      {"LinesBeside", 2, "1 primitives of points or lines", WithBeside(",\"mode\":1")},
      {"LineStripBeside", 2, "1 primitives of points or lines", WithBeside(",\"mode\":3")},
      {"PointsBeside", 2, "1 primitives of points or lines", WithBeside(",\"mode\":0")},
      {"ModeThatIsNot", 2, "mode 9 is none; the primitive was left out", WithBeside(",\"mode\":9")},
      {"IndicesThatAreNot", 2, "accessor 99 does not exist", WithBeside(",\"indices\":99")},
      {"MaterialThatIsNot", 4, "1 primitives name a material that is not there",
       WithBeside(",\"indices\":3,\"material\":7")},
      {"NoJointsAndNoHolder", 2, "hangs on no joint; the primitive was left", WithoutJoints(false)},
      {"NoJointsOnTheTip", 4, "1 primitives have no joints", WithoutJoints(true)},
      {"ChildThatIsNot", 2, "1 children of nodes do not exist",
       WithNodes(R"({"children":[1,99]},{"translation":[0,1,0]},{"mesh":0,"skin":0})")},
      {"TwoParents", 2, "1 nodes have two parents",
       WithNodes(R"({"children":[1]},{"translation":[0,1,0]},{"children":[1],"mesh":0,"skin":0})")},
      {"OwnAncestor", 2, "is its own ancestor",
       WithNodes(R"({"children":[1]},{"children":[0],"translation":[0,1,0]},{"mesh":0,"skin":0})")},
      {"BrokenNodesBeside", 2, "mesh 5 does not exist",
       WithNodes(R"({"children":[1]},{"translation":[0,1,0]},{"mesh":0,"skin":0},)"
                 R"({"mesh":5,"skin":0},{"mesh":0,"skin":5},{"mesh":"x"},{"rotation":"x"})")},
      {"RotationZero", 2, "rotation is zero",
       WithNodes(
           R"({"children":[1],"rotation":[0,0,0,0]},{"translation":[0,1,0]},{"mesh":0,"skin":0})")},
      {"RotationShort", 2, "rotation is not 4 numbers",
       WithNodes(
           R"({"children":[1],"rotation":[0,0,1]},{"translation":[0,1,0]},{"mesh":0,"skin":0})")},
      {"TranslationFarOut", 2, "translation is not 3 numbers below 1e30",
       WithNodes(R"({"children":[1]},{"translation":[1e300,1,0]},{"mesh":0,"skin":0})")},
      {"MatrixOfZeros", 2, "",
       WithNodes(R"({"children":[1]},{"matrix":[0,0,0,0,0,0,0,0,0,0,0,0,0,0,0,1]},)"
                 R"({"mesh":0,"skin":0})")},
      {"MatrixFlat", 2, "",
       WithNodes(R"({"children":[1]},{"matrix":[1,0,0,0,0,1,0,0,0,0,0,0,0,1,0,1]},)"
                 R"({"mesh":0,"skin":0})")},
      {"OtherScene", 2, "1 mesh nodes outside of it were left out",
       WithSecond("", R"(,"scene":0,"scenes":[{"nodes":[0,2]},{"nodes":[3]}])")},
      {"SecondSceneIsActive", 4, "",
       WithSecond("", R"(,"scene":1,"scenes":[{"nodes":[0]},{"nodes":[0,2,3]}])")},
      {"FirstSceneIsActive", 2, "scene 0 was read",
       WithSecond("", R"(,"scenes":[{"nodes":[0,2]},{"nodes":[3]}])")},
      {"SceneThatIsNot", 4, "", WithSecond("", R"(,"scene":8,"scenes":[{"nodes":[0,2,3,77]}])")},
      {"ActiveSceneHasNoSkin", 2, "scene 1 was read: the active one has no skinned mesh",
       WithSecond("", R"(,"scene":0,"scenes":[{"nodes":[0]},{"nodes":[2]}])")},
      {"NoSceneHasASkin", 4, "No scene has a skinned mesh",
       WithSecond("", R"(,"scenes":[{"nodes":[0]}])")},
      {"JointsOutsideTheScene", 4, "", WithSecond("", R"(,"scene":0,"scenes":[{"nodes":[2,3]}])")},
      {"StandInFarAway", 2, "1 mesh nodes are hidden, or stand-ins",
       WithSecond(R"(,"extensions":{"MSFT_lod":{"ids":[3]}})", "")},
      {"StandInInTheScene", 2, "1 mesh nodes are hidden, or stand-ins",
       WithSecond(R"(,"extensions":{"MSFT_lod":{"ids":[3,2,99]}})",
                  R"(,"scenes":[{"nodes":[0,2,3]}])")},
      {"Hidden", 2, "1 mesh nodes are hidden",
       WithSecond(R"(,"extensions":{"KHR_node_visibility":{"visible":false}})", "")},
      {"MeshWithoutSkinBeside", 2, "", WithSecond("", R"(,"scenes":[{"nodes":[0,2]}])")},
      {"ChannelWithoutNode", 2, "1 channels move no joint",
       WithClips(kMoveTip + R"(,{"sampler":0,"target":{"path":"rotation"}})", {"go"}), 1},
      {"ChannelOfNodeThatIsNot", 2, "1 channels move no joint",
       WithClips(kMoveTip + R"(,{"sampler":0,"target":{"node":99,"path":"scale"}})", {"go"}), 1},
      {"ChannelOfPointer", 2, "1 channels move no joint",
       WithClips(kMoveTip + R"(,{"sampler":9,"target":{"path":"pointer","extensions":)"
                            R"({"KHR_animation_pointer":{"pointer":"/materials/0"}}}})",
                 {"go"}),
       1},
      {"ChannelOfWeights", 2, "1 channels move no joint",
       WithClips(kMoveTip + R"(,{"sampler":0,"target":{"node":2,"path":"weights"}})", {"go"}), 1},
      {"ChannelWithoutTarget", 2, "1 channels move no joint",
       WithClips(kMoveTip + R"(,{"sampler":0})", {"go"}), 1},
      {"ChannelTwice", 2, "repeat an earlier one", WithClips(kMoveTip + "," + kMoveTip, {"go"}), 1},
      {"ClipsOfOneName", 2, "two clips are called 'go'; the second is now 'go 3'",
       WithClips(kMoveTip, {"go", "go", "go"}), 3},
      {"ClipsOfNoName", 2, "two clips are called 'clip 0'; the second is now 'clip 0 2'",
       WithClips(kMoveTip, {"", "clip 0"}), 2},
      {"NormalsThatAreTooFew", 2,
       "attribute NORMAL: has 1 elements, POSITION has 4; the attribute was left out",
       WithData<float>("NORMAL", kF32, "VEC3", {0, 0, 1})},
      {"UvsOfAnotherType", 2, "the attribute was left out",
       WithData("TEXCOORD_0", kF32, "VEC3", std::vector<float>(12, 0))},
      {"StrideBackwards", 2, "byteStride is no size; the attribute was left out",
       WithAttribute("NORMAL",
                     [](GltfBuilder& b) {
                       const int view = b.View(std::vector<float>(12, 1.0f));
                       b.views.insert(b.views.size() - 1, ",\"byteStride\":-12");
                       return b.Accessor(view, kF32, 4, "VEC3");
                     })},
      {"TangentThatIsNot", 2, "(the file has 5); the attribute was left out",
       WithAttribute("TANGENT", [](GltfBuilder&) { return 99; })},
      {"JointsAsFloats", 2, "",
       WithData<float>("JOINTS_0", kF32, "VEC4", {0, 0, 0, 0, 0, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0})},
      {"JointsAsWords", 2, "",
       WithData<uint32_t>("JOINTS_0", kU32, "VEC4",
                          {0, 0, 0, 0, 0, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0})},
      {"WeightsAsShorts", 2, "",
       WithData<int16_t>("WEIGHTS_0", kI16, "VEC4",
                         {32767, 0, 0, 0, 32767, 0, 0, 0, 32767, 0, 0, 0, 32767, 0, 0, 0},
                         ",\"normalized\":true")},
      {"JointThatIsNot", 2, "1 skin weights are on joints that do not exist",
       WithData<uint8_t>("JOINTS_0", kU8, "VEC4",
                         {0, 0, 0, 0, 0, 0, 0, 0, 9, 0, 0, 0, 1, 0, 0, 0})},
      {"PositionThatIsNoNumber", 1, "1 triangles had vertices that are no finite numbers",
       WithData<float>("POSITION", kF32, "VEC3", {0, 0, 0, 1, 0, 0, 1, 1, 0, nan, 1, 0})},
      {"WeightsWithoutJoints", 2, "WEIGHTS_1 has no JOINTS_1",
       WithData("WEIGHTS_1", kF32, "VEC4", kQuadWeights)},
      {"SpareElements", 2, "",
       WithData<float>("WEIGHTS_0", kF32, "VEC4",
                       {1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0})},
      {"BrokenThingsThatNobodyUses", 2, "",
       WithMore(R"(,"images":[{"bufferView":999}],"cameras":5,"textures":{},"extras":[1,{"a":[]}],)"
                R"("extensionsUsed":["ACME_x","KHR_lights_punctual"],"samplers":[[]])")},
      {"UnknownRequired", 2, "The file requires ACME_rig",
       WithMore(R"(,"extensionsRequired":["ACME_rig","MSFT_lod"])")},
  };
  // Accessors and the like that nothing uses.
  GltfBuilder unused = MakeQuad();
  unused.Accessor(999, 1, 7, "VEC9");
  unused.Floats("VEC3", {nan, nan, nan});
  unused.Accessor(-1, kF32, 1ull << 60, "VEC3");
  unused.views += R"(,{"buffer":77,"byteOffset":-5},{},5)";
  unused.animations = R"({},{"samplers":[{}],"channels":[]},7)";
  unused.materials = R"({},{"pbrMetallicRoughness":5},"x")";
  cases.push_back({"UnusedParts", 2, "has no name", unused, 3});
  GltfBuilder empty = MakeQuad();
  SetPrimitives(empty,
                Primitive(empty.attributes, empty.primitive_more) + ",{},{\"attributes\":5}");
  cases.push_back({"EmptyPrimitives", 2, "attribute POSITION is missing", empty});
  GltfBuilder no_mesh = MakeQuad();
  SetPrimitives(no_mesh, Primitive(no_mesh.attributes, no_mesh.primitive_more));
  no_mesh.meshes += R"(,{"name":"none"})";
  no_mesh.nodes += R"(,{"mesh":1,"skin":0})";
  cases.push_back({"MeshWithoutPrimitives", 2, "", no_mesh});
  const auto with_skin = [](const std::string& skin) {
    GltfBuilder b = MakeQuad();
    b.skins = skin;
    return b;
  };
  const std::string bind = R"("inverseBindMatrices":4)";
  cases.push_back({"JointTwice", 2, "", with_skin(R"({"joints":[0,1,1]})")});
  cases.push_back(
      {"JointNodeThatIsNot", 2, "1 joints do not exist", with_skin(R"({"joints":[0,7]})"), 0, 1});
  cases.push_back({"SkeletonRootThatIsNot", 2, "",
                   with_skin(R"({"joints":[0,1],"skeleton":99,)" + bind + "}")});
  cases.push_back({"TooFewBinds", 2, "1 inverse bind matrices are missing",
                   with_skin(R"({"joints":[0,1,0],)" + bind + "}")});
  cases.push_back({"BindsOfAnotherType", 2, "2 inverse bind matrices are missing",
                   with_skin(R"({"joints":[0,1],"inverseBindMatrices":0})")});
  GltfBuilder odd = MakeQuad({.skin = false});
  odd.skins = "{\"joints\":[0,1],\"inverseBindMatrices\":" +
              Number(odd.Floats("MAT4", std::vector<float>(32, nan))) + "}";
  cases.push_back({"BindsThatAreNoNumbers", 2, "2 inverse bind matrices are missing", odd});
  return cases;
}

class GltfField : public testing::TestWithParam<Case> {};

TEST_P(GltfField, IsReadWithANote) {
  const Case& want = GetParam();
  if (want.triangles == 0) {
    EXPECT_THROW(ImportGltf(want.builder.Glb(), "quad"), Error);
    return;
  }
  const Character c = ImportGltf(want.builder.Glb(), "quad");
  ExpectWhole(c);
  EXPECT_EQ(c.mesh.triangles.size(), want.triangles);
  EXPECT_EQ(c.clips.size(), want.clips);
  EXPECT_EQ(c.skeleton.name.size(), want.joints);
  const std::string notes = Join(c.notes);
  EXPECT_NE(notes.find(want.note), std::string::npos) << want.note << " is not in: " << notes;
  ExpectShort(c.notes);
  // All triangles look the same way.
  for (const glm::vec3& normal : c.mesh.normal) EXPECT_GT(normal.z, 0.99f);
}

INSTANTIATE_TEST_SUITE_P(All, GltfField, testing::ValuesIn(Cases()),
                         [](const auto& info) { return info.param.name; });

// Where it stands by the transform of its node, at rest and turned.
TEST(GltfField, APrimitiveWithoutJointsIsRigid) {
  const Character c = ImportGltf(WithoutJoints(true).Glb(), "quad");
  const RestGeometry rest = ComputeRestGeometry(c, 1.0f);
  ASSERT_EQ(rest.position.size(), 8u);
  for (size_t v = 0; v < 4; ++v) {
    const glm::vec3 at(kQuadPositions[3 * v], kQuadPositions[3 * v + 1], 0.0f);
    EXPECT_EQ(rest.position[v + 4], at + glm::vec3(0, 1, 5));
    EXPECT_EQ(c.skeleton.name[c.mesh.joints[v + 4][0]], "tip");
  }
}

TEST(GltfField, OnlyJointsThatAreUsedCount) {
  GltfBuilder b = MakeQuad({.skin = false});
  b.nodes = R"({"name":"base","children":[1]},{"name":"tip","translation":[0,1,0]},)"
            R"({"name":"quad","mesh":0,"skin":0})";
  std::string joints = "0,1";
  for (int j = 3; j < 3000; ++j) {
    b.nodes += ",{\"name\":\"spare\"}";
    joints += "," + Number(j);
  }
  b.skins = "{\"joints\":[" + joints + "]}";
  const Character c = ImportGltf(b.Glb(), "quad");
  ExpectWhole(c);
  EXPECT_EQ(c.skeleton.name, (std::vector<std::string>{"base", "tip"}));
  EXPECT_EQ(c.mesh.joints[2][0], 1);
  EXPECT_NE(Join(c.notes).find("2997 of 2999 joints move no vertex"), std::string::npos)
      << Join(c.notes);
}

// 500 materials over one vertex buffer of 4,000 vertices, each by accessors of its own: two million
// vertices, were they not shared.
TEST(GltfField, PrimitivesOfOneBufferShareTheirVertices) {
  constexpr size_t kCount = 4000, kPrimitives = 500;
  std::vector<float> position, weights;
  for (size_t v = 0; v < kCount; ++v) {
    for (const float c : {float(v % 50), float(v / 50), 0.0f}) position.push_back(c);
    for (const float w : {2.0f, 0.0f, 0.0f, 0.0f}) weights.push_back(w);
  }
  GltfBuilder b = MakeQuad({false, false, false, false, true});
  const int position_view = b.View(position), weights_view = b.View(weights);
  const int joints_view = b.View(std::vector<uint8_t>(4 * kCount, 0));
  std::string primitives;
  for (uint16_t p = 0; p < kPrimitives; ++p) {
    const int at = b.Accessor(position_view, kF32, kCount, "VEC3");
    const int joints = b.Accessor(joints_view, kU8, kCount, "VEC4");
    const int weight = b.Accessor(weights_view, kF32, kCount, "VEC4");
    const uint16_t first = uint16_t(p % 49);
    const int indices = b.Add(
        kU16, "SCALAR", std::vector<uint16_t>{first, uint16_t(first + 1), uint16_t(first + 50)});
    primitives += (p ? "," : "") +
                  Primitive("\"POSITION\":" + Number(at) + ",\"JOINTS_0\":" + Number(joints) +
                                ",\"WEIGHTS_0\":" + Number(weight),
                            ",\"indices\":" + Number(indices));
  }
  SetPrimitives(b, primitives);
  const Character c = ImportGltf(b.Glb(), "quad");
  EXPECT_EQ(c.mesh.triangles.size(), kPrimitives);
  EXPECT_LE(c.mesh.position.size(), 100u);
  EXPECT_NE(Join(c.notes).find("4000 vertices had skin weights that did not sum to 1"),
            std::string::npos)
      << Join(c.notes);
}

// Two materials over one buffer of vertices, or each over one of its own: one mesh.
TEST(GltfField, SharedVerticesAreNumberedAsTheirOwn) {
  const auto import = [](bool own) {
    GltfBuilder b = MakeQuad({.indices = false});
    const std::string first = b.attributes;
    if (own) {
      b.attributes.clear();
      b.Attribute("POSITION", b.Floats("VEC3", kQuadPositions));
      b.Attribute("JOINTS_0", b.Add(kU8, "VEC4", kQuadJoints));
      b.Attribute("WEIGHTS_0", b.Floats("VEC4", kQuadWeights));
    }
    const int a = b.Add(kU16, "SCALAR", std::vector<uint16_t>{1, 2, 3});
    const int c = b.Add(kU16, "SCALAR", std::vector<uint16_t>{0, 1, 3});
    SetPrimitives(b, Primitive(first, ",\"indices\":" + Number(a)) + "," +
                         Primitive(b.attributes, ",\"indices\":" + Number(c)));
    return ImportGltf(b.Glb(), "quad").mesh;
  };
  const Mesh shared = import(false), own = import(true);
  EXPECT_EQ(shared.position, own.position);
  EXPECT_EQ(shared.triangles, own.triangles);
  EXPECT_EQ(shared.joints, own.joints);
  EXPECT_EQ(shared.position[0], glm::vec3(1, 0, 0));
}

// In millimetres the numbers of one matrix differ by more than a 100,000th of a metre.
TEST(GltfField, BindMatricesAreComparedByTheirSize) {
  for (const float unit : {0.001f, 1.0f, 1000.0f}) {
    GltfBuilder b = MakeQuad({.skin = false});
    const auto bind = [&](float noise) {
      const float t = 2.0f * unit, n = noise * unit;
      return Number(b.Floats("MAT4", {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, n, t,  0, 1,
                                      1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, -t, n, 1}));
    };
    b.skins = "{\"joints\":[0,1],\"inverseBindMatrices\":" + bind(0.0f) +
              "},{\"joints\":[0,1],\"inverseBindMatrices\":" + bind(5e-5f) +
              "},{\"joints\":[0,1],\"inverseBindMatrices\":" + bind(0.01f) + "}";
    b.nodes += R"(,{"mesh":0,"skin":1})";
    EXPECT_EQ(ImportGltf(b.Glb(), "quad").skeleton.name.size(), 2u) << unit;
    b.nodes += R"(,{"mesh":0,"skin":2})";
    EXPECT_EQ(ImportGltf(b.Glb(), "quad").skeleton.name.size(), 4u) << unit;
  }
}

// Normals stand on the skin where joints are scaled unevenly in the rest pose.
TEST(GltfField, NormalsFitTheRestPose) {
  GltfBuilder b = MakeQuad();
  // A slope, 45 degrees in the file, scaled by 4 along x.
  b = MakeQuad({.position = false});
  b.Attribute("POSITION", b.Floats("VEC3", {0, 0, 0, 1, 0, 1, 1, 1, 1, 0, 1, 0}));
  b.nodes = R"({"scale":[4,1,1],"children":[1]},{"translation":[0,1,0]},{"mesh":0,"skin":0})";
  const Character c = ImportGltf(b.Glb(), "quad");
  ExpectWhole(c);
  const RestGeometry rest = ComputeRestGeometry(c, 1.0f);
  for (size_t v = 0; v < rest.normal.size(); ++v) {
    const glm::vec3 along = rest.position[1] - rest.position[0];
    EXPECT_NEAR(glm::dot(rest.normal[v], along) / glm::length(along), 0.0f, 1e-6f) << v;
  }
  EXPECT_NE(Join(c.notes).find("stretch the skin unevenly"), std::string::npos);
}

TEST(GltfField, NoMessageIsLong) {
  const std::string name(10000, 'n');
  GltfBuilder b = MakeQuad();
  b.nodes = "{\"name\":\"" + name + "\",\"children\":[1]},{\"name\":\"" + name +
            "\"},{\"mesh\":0,\"skin\":0}";
  ExpectShort(ImportGltf(b.Glb(), "quad").notes);
  b.nodes = "{},{},{\"name\":\"" + name + "\",\"mesh\":7,\"skin\":0}";
  const std::string error = ErrorFrom([&] { ImportGltf(b.Glb(), "quad"); });
  ExpectShort({error});
  EXPECT_NE(error.find("mesh 7 does not exist"), std::string::npos) << error;
}

// A point stands in numbers wherever the user lives.
TEST(GltfField, NumbersHaveAPointInEveryLocale) {
  const std::string before = std::setlocale(LC_ALL, nullptr);
  const char* other = nullptr;
  for (const char* name : {"de_DE.UTF-8", "de_DE.utf8", "fr_FR.UTF-8", "de_DE"})
    if (!other) other = std::setlocale(LC_ALL, name);
  const Character c = ImportGltf(WithClips(kMoveTip, {"go"}).Glb(), "quad");
  std::string sentence = DefaultUnitScale(c).sentence;
  GltfBuilder bad = MakeQuad();
  const int input = bad.Floats("SCALAR", {-1.5f, 1.0f});
  bad.animations = "{\"samplers\":[{\"input\":" + Number(input) + ",\"output\":" + Number(input) +
                   "}],\"channels\":[" + kMoveTip + "]}";
  const std::string notes = Join(ImportGltf(bad.Glb(), "quad").notes);
  std::setlocale(LC_ALL, before.c_str());
  EXPECT_EQ(sentence.find(','), sentence.find(", worked out")) << sentence;
  EXPECT_NE(notes.find("time -1.5 s"), std::string::npos) << notes;
  if (!other) GTEST_SKIP() << "no locale with a decimal comma is installed";
}

}  // namespace
}  // namespace pelt::test
