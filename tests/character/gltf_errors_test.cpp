// Every way a file can be bad, and the words that say where and why.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "core/character/gltf_import.hpp"
#include "core/error.hpp"
#include "tests/character/gltf_builder.hpp"

namespace pelt::test {
namespace {

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
  ExpectError(cut, {"truncated", "binary chunk"});
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

// What is not ours can be large and deep; what is, is no more than its text.
TEST(GltfErrors, JsonThatWouldHurtAParser) {
  GltfBuilder deep = MakeQuad();
  deep.more = ",\"extras\":" + std::string(100000, '[') + std::string(100000, ']') +
              ",\"cameras\":" + std::string(100000, '[') + std::string(100000, ']');
  EXPECT_EQ(ImportGltf(deep.Glb(), "deep").mesh.triangles.size(), 2u);
  deep.more = ",\"scenes\":" + std::string(100000, '[') + std::string(100000, ']');
  EXPECT_EQ(ImportGltf(deep.Glb(), "deep").mesh.triangles.size(), 2u);
  GltfBuilder many = MakeQuad();
  std::string json = many.Json();
  const size_t at = json.find("\"buffers\":[") + 11;
  std::string more;
  for (int i = 0; i < 1000; ++i) more += ",{\"byteLength\":4}";
  json.insert(json.find(']', at), more);
  EXPECT_EQ(ImportGltf(many.Frame(json), "many").mesh.triangles.size(), 2u);
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
  ExpectError(with_nodes(R"({},{},{"mesh":5,"skin":0})"), {"node 2", "mesh 5"});
  ExpectError(with_nodes(R"({},{},{"mesh":0,"skin":5})"), {"node 2", "skin 5"});
  ExpectError(with_nodes(R"({"translation":[1e20,0,0]},{},{"mesh":0,"skin":0})"), {"rest pose"});
  ExpectError(with_nodes(R"({"scale":[0,0,0],"children":[1]},{},{"mesh":0,"skin":0})"),
              {"rest pose", "no size"});
}

TEST(GltfErrors, Skins) {
  GltfBuilder b = MakeQuad({.skin = false});
  b.skins = R"({"name":"rig","joints":[]})";
  ExpectError(b, {"node 2 'quad'", "skin 0 'rig'", "no joints"});
  b.skins = R"({"name":"rig","joints":[7,"a"]})";
  ExpectError(b, {"skin 0 'rig'", "no joints"});
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
  // Each is used, by a vertex or by the one below.
  std::vector<uint16_t> last(16, 0);
  last[0] = 299;
  GltfBuilder parts = MakeQuad({.joints = false, .skin = false});
  parts.nodes = b.nodes;
  parts.skins = b.skins;
  parts.Attribute("JOINTS_0", parts.Add(kU16, "VEC4", last));
  ExpectError(parts, {"300 joints", "holds 256"});
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
           [](GltfBuilder& b) { return b.Accessor(b.View(kQuadPositions), 5130, 4, "VEC3"); }),
      {place + "POSITION", "5130"});
  ExpectError(with("WEIGHTS_0",
                   [](GltfBuilder& b) { return b.Floats("VEC4", std::vector<float>(12, 0.5f)); }),
              {place + "WEIGHTS_0", "has 3 elements", "POSITION has 4"});
  ExpectError(
      with("POSITION",
           [](GltfBuilder& b) { return b.Accessor(b.View(kQuadPositions), kF32, 5, "VEC3"); }),
      {place + "POSITION", "5 elements", "past the end"});
  ExpectError(with("POSITION",
                   [](GltfBuilder& b) {
                     return b.Accessor(b.View(kQuadPositions), kF32, 1ull << 62, "VEC3");
                   }),
              {place + "POSITION", "past the end"});
  ExpectError(with("POSITION",
                   [](GltfBuilder& b) {
                     return b.Accessor(b.View(kQuadPositions), kF32, 4, "VEC3",
                                       ",\"byteOffset\":18446744073709551600");
                   }),
              {place + "POSITION", "past the end"});
  ExpectError(
      with("POSITION", [](GltfBuilder& b) { return b.Accessor(-1, kF32, 1ull << 60, "VEC3"); }),
      {place + "POSITION", "no data"});
  ExpectError(with("POSITION", [](GltfBuilder& b) { return b.Accessor(77, kF32, 4, "VEC3"); }),
              {place + "POSITION", "bufferView 77"});
  ExpectError(
      with("POSITION",
           [](GltfBuilder& b) { return b.Accessor(b.View(kQuadPositions, 4), kF32, 4, "VEC3"); }),
      {place + "POSITION", "byteStride 4"});
}

TEST(GltfErrors, BufferViewsOutsideTheirBuffer) {
  for (const char* view : {R"({"buffer":0,"byteOffset":100000,"byteLength":48})",
                           R"({"buffer":0,"byteOffset":18446744073709551615,"byteLength":48})",
                           R"({"buffer":0,"byteOffset":-8,"byteLength":48})"}) {
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
    const int base = b.View(kQuadPositions);
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
    std::vector<float> p = kQuadPositions;
    p[7] = bad;
    position.Attribute("POSITION", position.Floats("VEC3", p));
    ExpectError(position, {"attribute POSITION", "element 2", "finite"});
  }
  GltfBuilder far = MakeQuad({.position = false});
  far.Attribute("POSITION", far.Floats("VEC3", std::vector<float>(12, 1e30f)));
  ExpectError(far, {"attribute POSITION", "beyond"});
}

TEST(GltfErrors, Primitives) {
  GltfBuilder mode = MakeQuad();
  mode.primitive_more += ",\"mode\":7";
  ExpectError(mode, {"mesh 0 'fox' primitive 0", "mode 7"});
  for (const char* missing : {"POSITION", "JOINTS_0", "WEIGHTS_0"}) {
    const std::string name = missing;
    ExpectError(MakeQuad({name != "POSITION", name != "JOINTS_0", name != "WEIGHTS_0", true, true}),
                {"primitive 0", missing, "missing"});
  }
  GltfBuilder range = MakeQuad({.indices = false});
  range.Indices(range.Add(kU16, "SCALAR", std::vector<uint16_t>{0, 1, 9}));
  ExpectError(range, {"primitive 0 indices", "index 9", "out of range"});
  GltfBuilder flat = MakeQuad({.position = false});
  flat.Attribute("POSITION", flat.Floats("VEC3", std::vector<float>(12, 1)));
  ExpectError(flat, {"no triangle with area"});
}

// Compressed files have accessors without content, which the library stumbles over first.
TEST(GltfErrors, ExtensionsThatAreNeededAreNamed) {
  for (const std::string extension :
       {"KHR_draco_mesh_compression", "EXT_meshopt_compression", "KHR_meshopt_compression"}) {
    GltfBuilder whole = MakeQuad();
    whole.more = ",\"extensionsRequired\":[\"" + extension + "\"]";
    ExpectError(whole, {"extensionsRequired: " + extension, "gltf-transform cp in.glb out.glb"});
    GltfBuilder empty = MakeQuad({.indices = false});
    empty.Indices(empty.Accessor(-1, kU16, 6, "SCALAR"));
    empty.primitive_more += ",\"extensions\":{\"" + extension + "\":{}}";
    empty.more = whole.more;
    ExpectError(empty, {"extensionsRequired: " + extension, "gltf-transform cp in.glb out.glb"});
    empty.more = ",\"extensionsUsed\":[\"" + extension + "\"]";
    ExpectError(empty, {"extensionsUsed: " + extension});
    // The plain bytes are there too.
    GltfBuilder both = MakeQuad();
    both.primitive_more += ",\"extensions\":{\"" + extension + "\":{}}";
    both.more = empty.more;
    EXPECT_EQ(ImportGltf(both.Glb(), "both").mesh.triangles.size(), 2u);
  }
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

// Accessors without bytes, each of another count, in a file of 400 KB: 100 million vertices.
TEST(GltfErrors, TheSameDataAgainAndAgain) {
  GltfBuilder b = MakeQuad();
  const std::string good = "{\"attributes\":{" + b.attributes + "}" + b.primitive_more + "}";
  std::string primitives = good;
  for (size_t i = 0; i < 1000; ++i) {
    const size_t count = 100000 - i;
    const int position = b.Accessor(-1, kF32, count, "VEC3");
    const int joints = b.Accessor(-1, kU8, count, "VEC4");
    const int weights = b.Accessor(-1, kF32, count, "VEC4");
    primitives += ",{\"attributes\":{\"POSITION\":" + std::to_string(position) +
                  ",\"JOINTS_0\":" + std::to_string(joints) +
                  ",\"WEIGHTS_0\":" + std::to_string(weights) + "}}";
  }
  b.meshes = "{\"primitives\":[" + primitives + "]}";
  const Character c = ImportGltf(b.Glb(), "again");
  EXPECT_EQ(c.mesh.triangles.size(), 2u);
  std::string notes;
  for (const std::string& note : c.notes) notes += note + "\n";
  EXPECT_NE(notes.find("brings the file above"), std::string::npos) << notes;
  EXPECT_LE(c.notes.size(), 64u);
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

// The clip is left out, the character stays.
TEST(GltfErrors, Animations) {
  const std::string place = "animation 0 'run' channel 0";
  const auto expect_left_out = [](const GltfBuilder& b, const std::vector<std::string>& parts) {
    const Character c = ImportGltf(b.Glb(), "good");
    EXPECT_TRUE(c.clips.empty()) << parts[1];
    EXPECT_EQ(c.mesh.triangles.size(), 2u);
    std::string notes;
    for (const std::string& note : c.notes) notes += note + "\n";
    for (const std::string& part : parts)
      EXPECT_NE(notes.find(part), std::string::npos) << part << " is not in: " << notes;
    EXPECT_NE(notes.find("the clip was left out"), std::string::npos) << notes;
  };
  EXPECT_EQ(
      ImportGltf(Animated({0, 1}, 2, "VEC3", "LINEAR", "translation").Glb(), "good").clips.size(),
      1u);
  expect_left_out(Animated({0, 1, 1}, 3, "VEC3", "LINEAR", "translation"),
                  {place, "input", "key 2", "ascend"});
  expect_left_out(Animated({1, 0}, 2, "VEC3", "LINEAR", "translation"),
                  {place, "input", "key 1", "ascend"});
  expect_left_out(Animated({-1, 1}, 2, "VEC3", "LINEAR", "translation"), {place, "input", "key 0"});
  expect_left_out(Animated({0, NAN}, 2, "VEC3", "LINEAR", "translation"),
                  {place, "input", "finite"});
  expect_left_out(Animated({0, 1}, 3, "VEC3", "LINEAR", "translation"),
                  {place, "output", "3 elements for 2 keys"});
  expect_left_out(Animated({0, 1}, 2, "VEC3", "CUBICSPLINE", "translation"),
                  {place, "output", "6 are needed"});
  expect_left_out(Animated({0, 1}, 2, "VEC3", "LINEAR", "rotation"), {place, "output", "VEC4"});
  expect_left_out(Animated({0, 1}, 2, "VEC4", "LINEAR", "rotation", 0.0f),
                  {place, "output", "zero quaternion"});
  expect_left_out(Animated({0, 1}, 2, "VEC3", "LINEAR", "translation", INFINITY),
                  {place, "output", "finite"});
  expect_left_out(Animated({0, 1}, 2, "VEC3", "CUBIC", "translation"), {place, "CUBIC"});
  expect_left_out(Animated({}, 0, "VEC3", "LINEAR", "translation"), {place, "input"});
  GltfBuilder sampler = Animated({0, 1}, 2, "VEC3", "LINEAR", "translation");
  sampler.animations.replace(sampler.animations.find("\"sampler\":0"), 11, "\"sampler\":4");
  expect_left_out(sampler, {place, "sampler 4"});
}

TEST(GltfErrors, NoSuchFile) {
  EXPECT_THROW(ImportGltfFile("no such file.glb"), Error);
  EXPECT_THROW(ImportGltfFile("."), Error);
}

}  // namespace
}  // namespace pelt::test
