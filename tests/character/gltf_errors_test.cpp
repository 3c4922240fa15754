// Every way a file can be bad, and the words that say where and why.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "core/character/gltf_import.hpp"
#include "core/error.hpp"
#include "tests/character/gltf_builder.hpp"

namespace pelt {
namespace {

using test::GltfBuilder;
using test::kF32;
using test::kU16;
using test::kU32;
using test::kU8;
using test::MakeQuad;
using test::QuadParts;

void ExpectError(const std::vector<std::byte>& bytes, const std::vector<std::string>& parts) {
  try {
    ImportGltf(bytes, "bad.glb");
    FAIL() << "imported; expected: " << parts[0];
  } catch (const Error& e) {
    const std::string text = e.what();
    EXPECT_EQ(text.rfind("bad.glb: ", 0), 0u) << text;
    for (const std::string& part : parts)
      EXPECT_NE(text.find(part), std::string::npos) << "no '" << part << "' in: " << text;
  }
}
void ExpectError(const GltfBuilder& b, const std::vector<std::string>& parts) {
  ExpectError(b.Glb(), parts);
}
void ExpectError(const std::string& text, const std::vector<std::string>& parts) {
  const auto bytes = std::as_bytes(std::span(text));
  ExpectError(std::vector<std::byte>(bytes.begin(), bytes.end()), parts);
}

TEST(GltfErrors, Container) {
  ExpectError(std::string(), {"empty"});
  ExpectError(std::string("glTF\2"), {"truncated", "5"});
  ExpectError(std::string("no glTF at all"), {"not readable as glTF"});
  ExpectError(std::string("[]  "), {"not readable as glTF"});
  ExpectError(std::string("{} "), {"not readable as glTF"});
  ExpectError(std::string(R"({"asset":{"version":"1.0"}})"), {"asset.version", "1.0"});
  std::vector<std::byte> glb = MakeQuad().Glb();
  std::vector<std::byte> cut(glb.begin(), glb.end() - 10);
  ExpectError(cut, {"truncated", std::to_string(glb.size()), std::to_string(cut.size())});
  std::vector<std::byte> version = glb;
  version[4] = std::byte(1);
  ExpectError(version, {"byte 4", "version 1"});
  std::vector<std::byte> chunk = glb;
  chunk[15] = std::byte(0x7f);
  ExpectError(chunk, {"byte 12", "past the end"});
  std::vector<std::byte> kind = glb;
  kind[16] = std::byte('X');
  ExpectError(kind, {"byte 16", "not JSON"});
}

TEST(GltfErrors, JsonThatWouldHurtTheParser) {
  GltfBuilder deep = MakeQuad();
  deep.more = ",\"extras\":" + std::string(100000, '[') + std::string(100000, ']');
  ExpectError(deep, {"JSON byte", "nested too deep"});
  GltfBuilder many = MakeQuad();
  many.more = ",\"buffers\":[";
  for (int i = 0; i < 1000; ++i) many.more += std::string(i ? "," : "") + "{\"byteLength\":4}";
  many.more += "]";
  ExpectError(many, {"JSON byte", "second buffer without a uri"});
  GltfBuilder blank = MakeQuad();
  blank.more = R"(,"buffers":[{"byteLength":4,"uri":"a"},{"byteLength":4,"uri":"a","uri":""},{}])";
  ExpectError(blank, {"second buffer without a uri"});
  GltfBuilder escaped = MakeQuad();
  escaped.more = R"(,"\u0062uffers":[{"byteLength":4},{"byteLength":4}])";
  ExpectError(escaped, {"escaped member name"});
  GltfBuilder broken = MakeQuad();
  broken.more = ",\"a\":";
  ExpectError(broken, {"not readable as glTF", "parse error"});
}

TEST(GltfErrors, Buffers) {
  GltfBuilder b = MakeQuad();
  std::string json = b.Json(true, "other.bin");
  ExpectError(json, {"other.bin"});
  ExpectError(b.Json(true, "../../other.bin"), {"other.bin"});
  ExpectError(b.Frame(b.Json(false)), {"buffer 0 does not exist"});
  GltfBuilder large = MakeQuad();
  std::string text = large.Json();
  text.replace(text.rfind("byteLength\":"), 12, "byteLength\":9");
  ExpectError(large.Frame(text), {"byteLength"});
}

TEST(GltfErrors, NoSkin) {
  GltfBuilder b = MakeQuad({.skin = false});
  b.nodes = R"({"mesh":0})";
  ExpectError(b, {"no skin"});
  GltfBuilder unused = MakeQuad();
  unused.nodes = R"({"name":"base","children":[1]},{},{"mesh":0})";
  ExpectError(unused, {"no node has both"});
}

TEST(GltfErrors, Nodes) {
  auto with_nodes = [](const std::string& nodes) {
    GltfBuilder b = MakeQuad();
    b.nodes = nodes;
    return b;
  };
  ExpectError(with_nodes(R"({"name":"base","children":[1]},{"children":[0]},{"mesh":0,"skin":0})"),
              {"node 0 'base'", "own ancestor"});
  ExpectError(with_nodes(R"({"children":[0]},{"name":"t"},{"mesh":0,"skin":0})"),
              {"node 0", "own ancestor"});
  ExpectError(with_nodes(R"({"children":[1]},{"name":"t"},{"children":[1],"mesh":0,"skin":0})"),
              {"node 1 't'", "two parents"});
  ExpectError(with_nodes(R"({"children":[99]},{},{"mesh":0,"skin":0})"), {"node 0", "child 99"});
  ExpectError(with_nodes(R"({},{},{"mesh":5,"skin":0})"), {"node 2", "mesh 5"});
  ExpectError(with_nodes(R"({},{},{"mesh":0,"skin":5})"), {"node 2", "skin 5"});
  ExpectError(with_nodes(R"({"rotation":[0,0,0,0]},{},{"mesh":0,"skin":0})"),
              {"node 0", "rotation is zero"});
  ExpectError(with_nodes(R"({"rotation":[0,0,1]},{},{"mesh":0,"skin":0})"),
              {"node 0", "rotation has 3 numbers"});
  ExpectError(with_nodes(R"({"translation":[1e300,0,0]},{},{"mesh":0,"skin":0})"),
              {"node 0", "translation"});
  ExpectError(with_nodes(R"({"translation":[1e20,0,0]},{},{"mesh":0,"skin":0})"), {"rest pose"});
  ExpectError(with_nodes(R"({"matrix":[0,0,0,0,0,0,0,0,0,0,0,0,0,0,0,1]},{},{"mesh":0,"skin":0})"),
              {"node 0", "singular"});
}

TEST(GltfErrors, Skins) {
  GltfBuilder b = MakeQuad({.skin = false});
  b.skins = R"({"name":"rig","joints":[0,7]})";
  ExpectError(b, {"skin 0 'rig'", "node 7"});
  b.skins = R"({"name":"rig","joints":[]})";
  ExpectError(b, {"skin 0 'rig'", "no joints"});
  b.skins = R"({"name":"rig","joints":[0,0]})";
  ExpectError(b, {"skin 0 'rig'", "repeats"});
  const int one = b.Floats("MAT4", std::vector<float>(16, 0.5f));
  b.skins = "{\"joints\":[0,1],\"inverseBindMatrices\":" + std::to_string(one) + "}";
  ExpectError(b, {"skin 0 inverseBindMatrices", "1 matrices for 2 joints"});
  b.skins = R"({"joints":[0,1],"inverseBindMatrices":0})";
  ExpectError(b, {"inverseBindMatrices", "MAT4"});
}

TEST(GltfErrors, TooManyJoints) {
  GltfBuilder b = MakeQuad({.skin = false});
  b.nodes = "";
  std::string joints;
  for (int j = 0; j < 300; ++j) {
    b.nodes += "{\"children\":[" + std::to_string(j + 1) + "]},";
    joints += (j ? "," : "") + std::to_string(j);
  }
  b.nodes += "{},{\"mesh\":0,\"skin\":0}";
  b.skins = "{\"joints\":[" + joints + "]}";
  ExpectError(b, {"more than 256"});
}

TEST(GltfErrors, Accessors) {
  auto with = [](const char* attribute, auto add) {
    QuadParts parts;
    const std::string name = attribute;
    if (name == "POSITION") parts.position = false;
    if (name == "JOINTS_0") parts.joints = false;
    if (name == "WEIGHTS_0") parts.weights = false;
    GltfBuilder b = MakeQuad(parts);
    b.Attribute(attribute, add(b));
    return b;
  };
  const std::string place = "mesh 0 'fox' primitive 0 attribute ";
  ExpectError(with("POSITION", [](GltfBuilder&) { return 99; }),
              {place + "POSITION", "accessor 99 does not exist"});
  ExpectError(
      with("POSITION", [](GltfBuilder& b) { return b.Floats("VEC4", std::vector<float>(16, 0)); }),
      {place + "POSITION", "not VEC3"});
  ExpectError(
      with("POSITION",
           [](GltfBuilder& b) { return b.Add(kU32, "VEC3", std::vector<uint32_t>(12, 0)); }),
      {place + "POSITION", "unsigned int"});
  ExpectError(with("POSITION",
                   [](GltfBuilder& b) {
                     return b.Accessor(b.View(test::kQuadPositions), 5130, 4, "VEC3");
                   }),
              {place + "POSITION", "5130"});
  ExpectError(
      with("WEIGHTS_0",
           [](GltfBuilder& b) { return b.Add(test::kI16, "VEC4", std::vector<int16_t>(16, 1)); }),
      {place + "WEIGHTS_0", "short"});
  ExpectError(with("JOINTS_0", [](GltfBuilder& b) { return b.Floats("VEC4", test::kQuadWeights); }),
              {place + "JOINTS_0", "float"});
  ExpectError(with("WEIGHTS_0",
                   [](GltfBuilder& b) { return b.Floats("VEC4", std::vector<float>(12, 0.5f)); }),
              {place + "WEIGHTS_0", "has 3 elements", "POSITION has 4"});
  ExpectError(with("POSITION",
                   [](GltfBuilder& b) {
                     return b.Accessor(b.View(test::kQuadPositions), kF32, 5, "VEC3");
                   }),
              {place + "POSITION", "5 elements", "past the end"});
  ExpectError(with("POSITION",
                   [](GltfBuilder& b) {
                     return b.Accessor(b.View(test::kQuadPositions), kF32, 1ull << 62, "VEC3");
                   }),
              {place + "POSITION", "past the end"});
  ExpectError(with("POSITION",
                   [](GltfBuilder& b) {
                     return b.Accessor(b.View(test::kQuadPositions), kF32, 4, "VEC3",
                                       ",\"byteOffset\":18446744073709551600");
                   }),
              {place + "POSITION", "past the end"});
  ExpectError(
      with("POSITION", [](GltfBuilder& b) { return b.Accessor(-1, kF32, 1ull << 60, "VEC3"); }),
      {place + "POSITION", "no data"});
  ExpectError(with("POSITION", [](GltfBuilder& b) { return b.Accessor(77, kF32, 4, "VEC3"); }),
              {place + "POSITION", "bufferView 77"});
  ExpectError(with("POSITION",
                   [](GltfBuilder& b) {
                     return b.Accessor(b.View(test::kQuadPositions, 4), kF32, 4, "VEC3");
                   }),
              {place + "POSITION", "byteStride 4"});
}

TEST(GltfErrors, BufferViewsOutsideTheirBuffer) {
  for (const char* view : {R"({"buffer":0,"byteOffset":100000,"byteLength":48})",
                           R"({"buffer":0,"byteOffset":18446744073709551615,"byteLength":48})",
                           R"({"buffer":0,"byteOffset":8,"byteLength":18446744073709551612})"}) {
    GltfBuilder b = MakeQuad({.position = false});
    b.views += "," + std::string(view);
    b.Attribute("POSITION", b.Accessor(b.view_count, kF32, 4, "VEC3"));
    ExpectError(b, {"attribute POSITION", "past the end of buffer 0"});
  }
  GltfBuilder b = MakeQuad({.position = false});
  b.views += R"(,{"buffer":3,"byteLength":48})";
  b.Attribute("POSITION", b.Accessor(b.view_count, kF32, 4, "VEC3"));
  ExpectError(b, {"attribute POSITION", "buffer 3 does not exist"});
}

TEST(GltfErrors, Sparse) {
  auto with = [](const std::vector<uint16_t>& index, int count, int component = 5123) {
    GltfBuilder b = MakeQuad({.position = false});
    const int base = b.View(test::kQuadPositions);
    const int indices = b.View(index);
    const int values = b.View(std::vector<float>{1, 0, 0});
    b.Attribute("POSITION",
                b.Accessor(base, kF32, 4, "VEC3",
                           ",\"sparse\":{\"count\":" + std::to_string(count) +
                               ",\"indices\":{\"bufferView\":" + std::to_string(indices) +
                               ",\"componentType\":" + std::to_string(component) +
                               "},\"values\":{\"bufferView\":" + std::to_string(values) + "}}"));
    return b;
  };
  EXPECT_EQ(ImportGltf(with({1}, 1).Glb(), "good").mesh.position.size(), 4u);
  ExpectError(with({4}, 1), {"attribute POSITION", "sparse index 4", "out of range"});
  ExpectError(with({1, 2}, 2), {"attribute POSITION", "past the end"});
  ExpectError(with({1}, 9), {"attribute POSITION", "9 sparse elements of 4"});
  ExpectError(with({1}, -1), {"attribute POSITION", "sparse"});
  ExpectError(with({1}, 1, kF32), {"attribute POSITION", "sparse indices", "float"});
}

TEST(GltfErrors, NotFinite) {
  for (float bad :
       {std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity()}) {
    GltfBuilder position = MakeQuad({.position = false});
    std::vector<float> p = test::kQuadPositions;
    p[7] = bad;
    position.Attribute("POSITION", position.Floats("VEC3", p));
    ExpectError(position, {"attribute POSITION", "element 2", "finite"});
    GltfBuilder bind = MakeQuad({.skin = false});
    bind.skins = "{\"joints\":[0,1],\"inverseBindMatrices\":" +
                 std::to_string(bind.Floats("MAT4", std::vector<float>(32, bad))) + "}";
    ExpectError(bind, {"inverseBindMatrices", "finite"});
  }
  GltfBuilder far = MakeQuad({.position = false});
  far.Attribute("POSITION", far.Floats("VEC3", std::vector<float>(12, 1e30f)));
  ExpectError(far, {"attribute POSITION", "beyond"});
}

TEST(GltfErrors, Primitives) {
  GltfBuilder mode = MakeQuad();
  mode.primitive_more += ",\"mode\":5";
  ExpectError(mode, {"mesh 0 'fox' primitive 0", "mode 5"});
  for (const char* missing : {"POSITION", "JOINTS_0", "WEIGHTS_0"}) {
    const std::string name = missing;
    ExpectError(MakeQuad({name != "POSITION", name != "JOINTS_0", name != "WEIGHTS_0", true, true}),
                {"primitive 0", missing, "missing"});
  }
  GltfBuilder range = MakeQuad({.indices = false});
  range.Indices(range.Add(kU16, "SCALAR", std::vector<uint16_t>{0, 1, 9}));
  ExpectError(range, {"primitive 0 indices", "index 9", "out of range"});
  GltfBuilder partial = MakeQuad({.indices = false});
  partial.Indices(partial.Add(kU16, "SCALAR", std::vector<uint16_t>{0, 1, 2, 3}));
  ExpectError(partial, {"primitive 0 indices", "whole triangles"});
  GltfBuilder flat = MakeQuad({.position = false});
  flat.Attribute("POSITION", flat.Floats("VEC3", std::vector<float>(12, 1)));
  ExpectError(flat, {"no triangle with area"});
  GltfBuilder joint = MakeQuad({.joints = false});
  std::vector<uint8_t> joints = test::kQuadJoints;
  joints[8] = 2;
  joint.Attribute("JOINTS_0", joint.Add(kU8, "VEC4", joints));
  ExpectError(joint, {"attribute JOINTS_0", "vertex 2", "joint 2", "out of range"});
}

// Compressed files have accessors without content, which the library stumbles over first.
TEST(GltfErrors, ExtensionsThatAreNeededAreNamed) {
  for (const std::string extension :
       {"KHR_draco_mesh_compression", "EXT_meshopt_compression", "KHR_meshopt_compression"}) {
    GltfBuilder whole = MakeQuad();
    whole.more = ",\"extensionsRequired\":[\"" + extension + "\"]";
    ExpectError(whole, {"extensionsRequired: " + extension, "export without compression"});
    GltfBuilder empty = MakeQuad({.indices = false});
    empty.Indices(empty.Accessor(-1, kU16, 6, "SCALAR"));
    empty.more = whole.more;
    ExpectError(empty, {"extensionsRequired: " + extension, "export without compression"});
    empty.more = ",\"extensionsUsed\":[\"" + extension + "\"]";
    ExpectError(empty, {"extensionsUsed: " + extension});
  }
  GltfBuilder other = MakeQuad({.indices = false});
  other.Indices(other.Accessor(-1, kU16, 6, "SCALAR"));
  other.more = R"(,"extensionsRequired":["ACME_\u001b[2Jmesh"])";
  ExpectError(other,
              {"invalid bufferView", "it requires ACME_\\x1b[2Jmesh, which is not supported"});
}

// A name is quoted in errors: what it would do to a terminal, it must not do.
TEST(GltfErrors, NamesHaveNoControlCharacters) {
  GltfBuilder b = MakeQuad();
  b.nodes =
      R"({"name":"base\u001b[31m","children":[1]},{"name":"t\u009b2Jip"},{"mesh":0,"skin":0})";
  b.materials = R"({"name":"fur\n\u202e"})";
  b.primitive_more += ",\"material\":0";
  const Character character = ImportGltf(b.Glb(), "names");
  EXPECT_EQ(character.skeleton.name[0], "base\\x1b[31m");
  EXPECT_EQ(character.skeleton.name[1], "t\\u009b2Jip");
  EXPECT_EQ(character.mesh.materials[0], "fur\\x0a\\u202e");
}

TEST(GltfErrors, TheSameDataAgainAndAgain) {
  std::vector<float> position(3 * 4096, 0.0f);
  GltfBuilder b = MakeQuad({false, false, false, false, true});
  b.Attribute("POSITION", b.Floats("VEC3", position));
  b.Attribute("JOINTS_0", b.Add(kU8, "VEC4", std::vector<uint8_t>(4 * 4096, 0)));
  b.Attribute("WEIGHTS_0", b.Add(kU8, "VEC4", std::vector<uint8_t>(4 * 4096, 255)));
  b.Indices(b.Add(kU16, "SCALAR", test::kQuadIndices));
  const std::string primitive = "{\"attributes\":{" + b.attributes + "}" + b.primitive_more + "}";
  b.meshes = "{\"primitives\":[" + primitive;
  for (int i = 0; i < 1100; ++i) b.meshes += "," + primitive;
  b.meshes += "]}";
  ExpectError(b, {"primitive 1024", "4194304 vertices"});
}

GltfBuilder Animated(const std::vector<float>& times, int values, const std::string& type,
                     const std::string& how, const std::string& path, float value = 1.0f) {
  GltfBuilder b = MakeQuad();
  const int input = b.Floats("SCALAR", times);
  const int output =
      b.Floats(type, std::vector<float>(size_t(values) * GltfBuilder::Numbers(type), value));
  b.animations = "{\"name\":\"run\",\"samplers\":[{\"input\":" + std::to_string(input) +
                 ",\"output\":" + std::to_string(output) + ",\"interpolation\":\"" + how +
                 "\"}],\"channels\":[{\"sampler\":0,\"target\":{\"node\":1,\"path\":\"" + path +
                 "\"}}]}";
  return b;
}

TEST(GltfErrors, Animations) {
  const std::string place = "animation 0 'run' channel 0";
  EXPECT_EQ(
      ImportGltf(Animated({0, 1}, 2, "VEC3", "LINEAR", "translation").Glb(), "good").clips.size(),
      1u);
  ExpectError(Animated({0, 1, 1}, 3, "VEC3", "LINEAR", "translation"),
              {place, "input", "key 2", "ascend"});
  ExpectError(Animated({-1, 1}, 2, "VEC3", "LINEAR", "translation"), {place, "input", "key 0"});
  ExpectError(Animated({0, NAN}, 2, "VEC3", "LINEAR", "translation"), {place, "input", "finite"});
  ExpectError(Animated({0, 1}, 3, "VEC3", "LINEAR", "translation"),
              {place, "output", "3 elements for 2 keys"});
  ExpectError(Animated({0, 1}, 2, "VEC3", "CUBICSPLINE", "translation"),
              {place, "output", "6 are needed"});
  ExpectError(Animated({0, 1}, 2, "VEC3", "LINEAR", "rotation"), {place, "output", "VEC4"});
  ExpectError(Animated({0, 1}, 2, "VEC4", "LINEAR", "rotation", 0.0f),
              {place, "output", "zero quaternion"});
  ExpectError(Animated({0, 1}, 2, "VEC3", "LINEAR", "translation", INFINITY),
              {place, "output", "finite"});
  ExpectError(Animated({0, 1}, 2, "VEC3", "CUBIC", "translation"), {place, "CUBIC"});
  ExpectError(Animated({0, 1}, 2, "VEC3", "LINEAR", "wobble"), {place, "wobble"});
  ExpectError(Animated({}, 0, "VEC3", "LINEAR", "translation"), {place, "input"});
  GltfBuilder sampler = Animated({0, 1}, 2, "VEC3", "LINEAR", "translation");
  sampler.animations.replace(sampler.animations.find("\"sampler\":0"), 11, "\"sampler\":4");
  ExpectError(sampler, {place, "sampler 4"});
  GltfBuilder node = Animated({0, 1}, 2, "VEC3", "LINEAR", "translation");
  node.animations.replace(node.animations.find("\"node\":1"), 8, "\"node\":9");
  ExpectError(node, {place, "node 9"});
}

TEST(GltfErrors, NoSuchFile) {
  EXPECT_THROW(ImportGltfFile("no such file.glb"), Error);
  EXPECT_THROW(ImportGltfFile("."), Error);
}

}  // namespace
}  // namespace pelt
