// What a glTF says of its colours, and that nothing of it can refuse a file.
#include <gtest/gtest.h>

#include <algorithm>
#include <limits>

#include "core/groom/surface_colour.hpp"
#include "tests/character/gltf_builder.hpp"
#include "tests/groom/png.hpp"
#include "tests/test_folder.hpp"

namespace pelt::test {
namespace {

constexpr float kNear = 1e-5f;
const std::string kPlainImage = R"(,"textures":[{"source":0}],"images":[)";

void ExpectNear(const glm::vec3& got, const glm::vec3& wanted) {
  for (int c = 0; c < 3; ++c) EXPECT_NEAR(got[c], wanted[c], kNear) << "rgb"[c];
}

std::string Material(const std::string& members) {
  return R"({"name":"coat","pbrMetallicRoughness":{)" + members + "}}";
}

// A quad of one material.
GltfBuilder MakeLook(const std::string& material, const std::string& more = "",
                     const std::vector<float>& uvs = {0, 0, 1, 0, 1, 1, 0, 1}) {
  GltfBuilder b = MakeQuad();
  b.Attribute("TEXCOORD_0", b.Floats("VEC2", uvs));
  b.primitive_more += ",\"material\":0";
  b.materials = material;
  b.more = more;
  return b;
}

TEST(GltfLook, FactorIsTheColour) {
  const Character c = Import(MakeLook(Material(R"("baseColorFactor":[0.5,0.25,2,1])")));
  ASSERT_EQ(c.mesh.looks.size(), 1u);
  EXPECT_TRUE(c.mesh.looks[0].stated);
  ExpectNear(c.mesh.looks[0].base_colour, {0.5f, 0.25f, 1.0f});
  EXPECT_EQ(c.mesh.looks[0].image, -1);
  ExpectNear(SurfaceColour(c).At({0, {1.0f, 0.0f, 0.0f}}), {0.5f, 0.25f, 1.0f});
}

TEST(GltfLook, UvSetsAreCounted) {
  EXPECT_EQ(Import(MakeQuad()).mesh.uv_sets, 0u);
  GltfBuilder b = MakeLook(Material(""));
  EXPECT_EQ(Import(b).mesh.uv_sets, 1u);
  b.Attribute("TEXCOORD_1", b.Floats("VEC2", {0, 0, 1, 0, 1, 1, 0, 1}));
  EXPECT_EQ(Import(b).mesh.uv_sets, 2u);
}

TEST(GltfLook, WhatSaysNothingIsNotKnown) {
  for (const std::string& material : {std::string(R"({"name":"coat"})"), Material("")}) {
    const Character c = Import(MakeLook(material));
    EXPECT_FALSE(SurfaceColour(c).Knows(0)) << material;
    EXPECT_FALSE(c.mesh.looks.at(0).stated) << material;
  }
  const Character plain = Import(MakeQuad());
  EXPECT_FALSE(SurfaceColour(plain).Knows(0));
}

// 2 x 1 texels, the left one grey, the right one green.
std::vector<uint8_t> TwoTexels() { return MakePng(2, 1, 3, {128, 128, 128, 0, 255, 0}); }

TEST(GltfLook, ImageIsMultipliedWithTheFactor) {
  GltfBuilder b =
      MakeLook(Material(R"("baseColorTexture":{"index":0},"baseColorFactor":[1,0.5,1,1])"));
  const int view = b.View(TwoTexels());
  b.more = kPlainImage + R"({"bufferView":)" + std::to_string(view) + "}]";
  const Character c = Import(b);
  ASSERT_EQ(c.images.size(), 1u);
  EXPECT_EQ(c.images[0].size(), TwoTexels().size());
  const SurfaceColour surface(c);
  EXPECT_TRUE(surface.Knows(0));
  EXPECT_TRUE(surface.HasImage(0));
  EXPECT_TRUE(surface.faults().empty());
  // The first triangle's corners have u 0, 1 and 1; texels have their middles at 1/4 and 3/4.
  ExpectNear(surface.At({0, {0.75f, 0.25f, 0.0f}}), {0.215861f, 0.5f * 0.215861f, 0.215861f});
  ExpectNear(surface.At({0, {0.25f, 0.75f, 0.0f}}), {0.0f, 0.5f, 0.0f});
}

TEST(GltfLook, ImagesWithinTheTextAreRead) {
  const std::string uri = "data:image/png;base64," + Base64(TwoTexels());
  // The two materials have one image.
  const std::string material = Material(R"("baseColorTexture":{"index":0})");
  const Character c =
      Import(MakeLook(material + "," + material, kPlainImage + R"({"uri":")" + uri + R"("}])"));
  ASSERT_EQ(c.images.size(), 1u);
  const std::vector<uint8_t> wanted = TwoTexels();
  ASSERT_EQ(c.images[0].size(), wanted.size());
  for (size_t i = 0; i < wanted.size(); ++i) EXPECT_EQ(uint8_t(c.images[0][i]), wanted[i]);
  ExpectNear(SurfaceColour(c).At({0, {0.25f, 0.75f, 0.0f}}), {0.0f, 1.0f, 0.0f});
}

// The place in the image, of TwoTexels, by how green it is: u from 1/4 to 3/4.
float PlaceInImage(const Character& c, const SurfacePoint& at) {
  return 0.25f +
         0.5f * float(ExactSrgb(double(SurfaceColour(c).At(at).g)) * 255.0 - 128.0) / 127.0f;
}

TEST(GltfLook, ImagesAreLaidByOtherCoordinates) {
  for (const bool by_transform : {false, true}) {
    const std::string set =
        by_transform ? R"("texCoord":5,"extensions":{"KHR_texture_transform":{"texCoord":2}})"
                     : R"("texCoord":2)";
    GltfBuilder b = MakeLook(Material(R"("baseColorTexture":{"index":0,)" + set + "}"));
    b.Attribute("TEXCOORD_2", b.Floats("VEC2", {0.3f, 0, 0.4f, 0, 0.7f, 0, 0.6f, 0}));
    const int view = b.View(TwoTexels());
    b.more = kPlainImage + R"({"bufferView":)" + std::to_string(view) + "}]";
    const Character c = Import(b);
    EXPECT_NEAR(PlaceInImage(c, {0, {1.0f, 0.0f, 0.0f}}), 0.3f, 5e-3f);
    EXPECT_NEAR(PlaceInImage(c, {0, {0.0f, 0.5f, 0.5f}}), 0.55f, 5e-3f);
    EXPECT_NEAR(PlaceInImage(c, {1, {0.0f, 0.0f, 1.0f}}), 0.6f, 5e-3f);
    EXPECT_EQ(c.mesh.uv[2].x, 0.7f) << "maps lie where the image lies";
  }
}

TEST(GltfLook, CoordinatesThatAPrimitiveLacksAreTold) {
  GltfBuilder b = MakeLook(Material(R"("baseColorTexture":{"index":0,"texCoord":1})"));
  const int view = b.View(TwoTexels());
  b.more = kPlainImage + R"({"bufferView":)" + std::to_string(view) + "}]";
  const Character c = Import(b);
  EXPECT_EQ(c.mesh.uv[2], glm::vec2(1.0f));
  EXPECT_TRUE(std::ranges::any_of(c.notes, [](const std::string& note) {
    return note ==
           "1 primitives lack the UVs that their image is laid by; the first ones were taken.";
  }));
  ExpectNear(SurfaceColour(c).At({0, {0.25f, 0.75f, 0.0f}}), {0.0f, 1.0f, 0.0f});
}

// Scaled, then turned, then moved; the turn is against the clock as the image is seen, whose v points down.
TEST(GltfLook, ImagesAreMovedTurnedAndScaled) {
  const struct {
    std::string transform;
    glm::vec2 from, to;
  } kCases[] = {{R"("offset":[0.25,-0.5])", {0.5f, 0.5f}, {0.75f, 0.0f}},
                {R"("scale":[2,0.5])", {0.25f, 0.5f}, {0.5f, 0.25f}},
                {R"("rotation":1.5707963267948966)", {0.5f, 0.25f}, {0.25f, -0.5f}},
                {R"("rotation":0.5235987755982988)", {1.0f, 0.0f}, {0.866025f, -0.5f}},
                {R"("offset":[1,2],"rotation":1.5707963267948966,"scale":[3,4])",
                 {0.1f, 0.2f},
                 {1.0f + 0.8f, 2.0f - 0.3f}}};
  for (const auto& test : kCases) {
    // Of the image of the colour, or where there is none of another.
    for (const std::string texture : {"normalTexture", "baseColorTexture"}) {
      const std::string laid = "\"" + texture +
                               R"(":{"index":0,"extensions":{"KHR_texture_transform":{)" +
                               test.transform + "}}}";
      GltfBuilder b = MakeLook(texture[0] == 'b' ? Material(laid) : "{" + laid + "}", "",
                               {test.from.x, test.from.y, 1, 0, 1, 1, 0, 1});
      const int view = b.View(TwoTexels());
      b.more = kPlainImage + R"({"bufferView":)" + std::to_string(view) + "}]";
      const glm::vec2 uv = Import(b).mesh.uv.at(0);
      EXPECT_NEAR(uv.x, test.to.x, kNear) << texture << test.transform;
      EXPECT_NEAR(uv.y, test.to.y, kNear) << texture << test.transform;
    }
  }
  GltfBuilder b = MakeLook(Material(
      R"("baseColorTexture":{"index":0,"extensions":{"KHR_texture_transform":{"offset":[0.25,0],"scale":[0.5,1]}}})"));
  const int view = b.View(TwoTexels());
  b.more = kPlainImage + R"({"bufferView":)" + std::to_string(view) + "}]";
  const Character c = Import(b);
  EXPECT_NEAR(PlaceInImage(c, {0, {0.5f, 0.5f, 0.0f}}), 0.5f, 5e-3f);
  EXPECT_NEAR(PlaceInImage(c, {0, {0.8f, 0.2f, 0.0f}}), 0.35f, 5e-3f);
}

TEST(GltfLook, CornersHaveColours) {
  GltfBuilder b = MakeQuad();
  const float nan = std::numeric_limits<float>::quiet_NaN();
  b.Attribute("COLOR_0", b.Floats("VEC3", {1, 0, 0, 0, 1, 0, 0, 0, 0.5f, nan, 7, -1}));
  const Character c = Import(b);
  ASSERT_EQ(c.mesh.corner_colour.size(), 2u);
  EXPECT_EQ(c.mesh.position.size(), 4u);
  const SurfaceColour surface(c);
  EXPECT_TRUE(surface.Knows(1));
  ExpectNear(surface.At({0, {0.5f, 0.5f, 0.0f}}), {0.5f, 0.5f, 0.0f});
  ExpectNear(surface.At({0, {0.0f, 0.0f, 1.0f}}), {0.0f, 0.0f, 0.5f});
  ExpectNear(surface.At({1, {0.0f, 0.0f, 1.0f}}), {1.0f, 1.0f, 0.0f});  // what is no number: white
  GltfBuilder bytes = MakeQuad();
  bytes.Attribute("COLOR_0", bytes.Add(kU8, "VEC4",
                                       std::vector<uint8_t>{255, 0, 51, 255, 255, 0, 51, 255, 255,
                                                            0, 51, 255, 255, 0, 51, 255},
                                       ",\"normalized\":true"));
  const Character c8 = Import(bytes);
  ExpectNear(SurfaceColour(c8).At({1, {0.2f, 0.3f, 0.5f}}), {1.0f, 0.0f, 0.2f});
}

TEST(GltfLook, ColoursDoNotPartVertices) {
  GltfBuilder plain = MakeQuad(), coloured = MakeQuad();
  coloured.Attribute("COLOR_0", coloured.Floats("VEC3", {1, 0, 0, 0, 1, 0, 0, 0, 1, 1, 1, 1}));
  const Character a = Import(plain), b = Import(coloured);
  EXPECT_EQ(a.mesh.position, b.mesh.position);
  EXPECT_EQ(a.mesh.triangles, b.mesh.triangles);
}

// Integers are what the accessor says: shares of their range, or themselves (KHR_mesh_quantization).
TEST(GltfLook, CoordinatesMayBeIntegersOfEachKind) {
  const auto expect = [](auto of, int component, bool normalised, float scale) {
    using T = decltype(of);
    GltfBuilder b = MakeQuad();
    b.Attribute("TEXCOORD_0", b.Add(component, "VEC2", std::vector<T>{0, 0, 100, 0, 100, 50, 0, 50},
                                    normalised ? ",\"normalized\":true" : ""));
    const Character c = Import(b);
    EXPECT_FLOAT_EQ(c.mesh.uv.at(2).x, 100.0f * scale) << component << normalised;
    EXPECT_FLOAT_EQ(c.mesh.uv.at(2).y, 50.0f * scale) << component << normalised;
  };
  expect(int8_t(), kI8, false, 1.0f);
  expect(int8_t(), kI8, true, 1.0f / 127.0f);
  expect(uint8_t(), kU8, false, 1.0f);
  expect(uint8_t(), kU8, true, 1.0f / 255.0f);
  expect(int16_t(), kI16, false, 1.0f);
  expect(int16_t(), kI16, true, 1.0f / 32767.0f);
  expect(uint16_t(), kU16, false, 1.0f);
  expect(uint16_t(), kU16, true, 1.0f / 65535.0f);
}

// What a primitive can do without does not cost the character.
TEST(GltfLook, AttributesThatCannotBeReadAreLeftOut) {
  for (const char* attribute : {"NORMAL", "TANGENT", "TEXCOORD_0", "COLOR_0"}) {
    for (const bool is_short : {false, true}) {
      GltfBuilder b = MakeQuad();
      b.Attribute(attribute, is_short ? b.Floats("VEC4", {0, 0, 1, 1}) : 99);
      const Character c = Import(b);
      EXPECT_EQ(c.mesh.triangles.size(), 2u);
      ASSERT_FALSE(c.notes.empty()) << attribute;
      EXPECT_NE(c.notes[0].find(attribute), std::string::npos) << c.notes[0];
      EXPECT_EQ(c.notes[0].find("quad.glb"), std::string::npos) << c.notes[0];
    }
  }
}

TEST(GltfLook, MaterialsThatAreNotThereAreNone) {
  GltfBuilder b = MakeQuad();
  b.primitive_more += ",\"material\":3";
  const Character c = Import(b);
  EXPECT_EQ(c.mesh.materials, std::vector<std::string>{"default"});
  EXPECT_EQ(c.notes.at(0), "1 primitives name a material that is not there; they have none.");
}

TEST(GltfLook, OtherModelsSayTheColourToo) {
  const std::string black = R"("pbrMetallicRoughness":{"baseColorFactor":[0,0,0,1]})";
  const std::string gloss = R"("KHR_materials_pbrSpecularGlossiness":)";
  const struct {
    std::string material;
    glm::vec3 colour;
  } kCases[] = {
      {R"("extensions":{)" + gloss + R"({"diffuseFactor":[0.8,0.1,0.05,1]}})", {0.8f, 0.1f, 0.05f}},
      // It is what the other is a fallback for.
      {black + R"(,"extensions":{)" + gloss + R"({"diffuseFactor":[0.8,0.1,0.05,1]}})",
       {0.8f, 0.1f, 0.05f}},
      {R"("pbrMetallicRoughness":{"baseColorFactor":[0,1,0,1]},"extensions":{)" + gloss +
           R"({"glossinessFactor":0.5}})",
       {0, 1, 0}},
      {black + R"(,"emissiveFactor":[0.5,0.25,0])", {0.5f, 0.25f, 0.0f}},
      {R"("emissiveFactor":[0.5,0.25,0])", {0.5f, 0.25f, 0.0f}},
      {R"("emissiveFactor":[0.5,0.25,0],"extensions":{"KHR_materials_emissive_strength":)"
       R"({"emissiveStrength":3}})",
       {1.0f, 0.75f, 0.0f}},
      {R"("emissiveFactor":[0.5,0.25,0],"extensions":{)" + gloss +
           R"({"diffuseFactor":[0,0,0,1]}})",
       {0.5f, 0.25f, 0.0f}},
      {R"("pbrMetallicRoughness":{"baseColorFactor":[0,1,0,1]},"emissiveFactor":[0.5,0.25,0])",
       {0, 1, 0}},
      {black + R"(,"emissiveFactor":[0,0,0])", {0, 0, 0}},
      {black + R"(,"emissiveFactor":"red")", {0, 0, 0}},
  };
  for (const auto& test : kCases) {
    const Character c = Import(MakeLook("{" + test.material + "}"));
    EXPECT_TRUE(c.mesh.looks.at(0).stated) << test.material;
    ExpectNear(c.mesh.looks.at(0).base_colour, test.colour);
  }
}

TEST(GltfLook, ImagesOfOtherModelsAreRead) {
  for (const std::string material :
       {R"("extensions":{"KHR_materials_pbrSpecularGlossiness":{"diffuseTexture":{"index":0}}})",
        R"("emissiveFactor":[1,1,1],"emissiveTexture":{"index":0})",
        R"("pbrMetallicRoughness":{"baseColorFactor":[0,0,0,1],"baseColorTexture":{"index":0}},)"
        R"("emissiveFactor":[1,1,1],"emissiveTexture":{"index":0})"}) {
    GltfBuilder b = MakeLook("{" + material + "}");
    const int view = b.View(TwoTexels());
    b.more = kPlainImage + R"({"bufferView":)" + std::to_string(view) + "}]";
    const Character c = Import(b);
    EXPECT_EQ(c.images.size(), 1u) << material;
    ExpectNear(SurfaceColour(c).At({0, {0.25f, 0.75f, 0.0f}}), {0.0f, 1.0f, 0.0f});
  }
}

TEST(GltfLook, WhatIsWrongIsSaidAndLeftOut) {
  const std::string texture = R"("baseColorTexture":{"index":0})";
  const struct {
    std::string material, more, reason;
  } kCases[] = {
      {texture, "", "no such image"},
      {R"("baseColorTexture":{"index":-1})", kPlainImage + R"({"bufferView":0}])", "no such image"},
      {R"("baseColorTexture":{"index":0,"texCoord":16})", kPlainImage + R"({"bufferView":0}])",
       "texCoord is none of 0 to 15"},
      {R"("baseColorTexture":{"index":0,"texCoord":-1})", kPlainImage + R"({"bufferView":0}])",
       "texCoord is none of 0 to 15"},
      {R"("baseColorTexture":{"index":0,"extensions":{"KHR_texture_transform":{"scale":[1]}}})",
       kPlainImage + R"({"bufferView":0}])", "not made of finite numbers"},
      {R"("baseColorTexture":{"index":0,"extensions":{"KHR_texture_transform":{"rotation":1e9}}})",
       kPlainImage + R"({"bufferView":0}])", "not made of finite numbers"},
      {texture, R"(,"textures":[{"source":9}],"images":[{"bufferView":0}])", "no such image"},
      {texture, R"(,"textures":[7],"images":[{"bufferView":0}])", "no such image"},
      {texture, kPlainImage + R"({"bufferView":999}])", "bufferView does not exist"},
      {texture, kPlainImage + R"({"bufferView":-5}])", "bufferView does not exist"},
      {texture, kPlainImage + R"({"uri":"data:image/webp;base64,!!!!"}])",
       "'data:image/webp;base64,!!!!': not in base64"},
      {texture, kPlainImage + R"({"uri":"a.png"}])", "'a.png': no folder"},
  };
  for (const auto& test : kCases) {
    const Character c = Import(MakeLook(Material(test.material), test.more));
    EXPECT_EQ(c.mesh.looks.at(0).image, -1) << test.reason;
    ASSERT_FALSE(c.notes.empty()) << test.reason;
    EXPECT_NE(c.notes[0].find("material 0 'coat'"), std::string::npos) << c.notes[0];
    EXPECT_NE(c.notes[0].find(test.reason), std::string::npos) << c.notes[0];
  }
}

TEST(GltfLook, DamagedImagesCountAsWhite) {
  GltfBuilder b = MakeLook(Material(R"("baseColorTexture":{"index":0})"));
  std::vector<uint8_t> png = TwoTexels();
  png.resize(png.size() / 2);
  const int view = b.View(png);
  b.more = kPlainImage + R"({"bufferView":)" + std::to_string(view) + "}]";
  const Character c = Import(b);
  const SurfaceColour surface(c);
  EXPECT_EQ(surface.faults().size(), 1u);
}

TEST(GltfLook, ImagesBesideTheFileAreReadAndNoneElsewhere) {
  const TestFolder folder;
  const std::vector<uint8_t> png = TwoTexels();
  for (const char* file : {"a.png", "inside/a.png"}) folder.Save(file, png);
  const auto import = [&](const std::string& uri) {
    GltfBuilder b = MakeLook(Material(R"("baseColorTexture":{"index":0})"),
                             kPlainImage + R"({"uri":")" + uri + R"("}])");
    folder.Save("inside/quad.bin", b.binary);
    return ImportGltfFile(folder.Save("inside/quad.gltf", b.Json(true, "quad.bin")));
  };
  const Character c = import("a.png");
  EXPECT_EQ(c.images.size(), 1u);
  EXPECT_EQ(c.files_read.size(), 2u);  // what is read must not be written over
  EXPECT_TRUE(import("../a.png").images.empty());
  EXPECT_TRUE(import(folder / "a.png").images.empty());
  EXPECT_TRUE(import("none.png").images.empty());
  // As they are named in other places.
  for (const char* name : {"my fur.png", "maps/a..b.png", "100%25.png", "f\xc3\xbcr.png"})
    folder.Save(std::string("inside/") + name, png);
  for (const char* uri : {"my%20fur.png", "my fur.png", "maps/a..b.png", "./maps/a..b.png",
                          "maps\\\\a..b.png", "100%25.png", "100%2525.png", "f%C3%BCr.png"})
    EXPECT_EQ(import(uri).images.size(), 1u) << uri;
  for (const char* uri : {"%2e%2e/a.png", "maps/../../a.png", "..\\\\a.png", "%2Ftmp/a.png",
                          "https://example.org/a.png", "a.png%00"})
    EXPECT_TRUE(import(uri).images.empty()) << uri;
}

TEST(GltfLook, SrgbIsTheStandardsCurve) {
  EXPECT_NEAR(ExactLinear(128.0 / 255.0), 0.215861, 1e-6);
  for (int byte = 0; byte < 256; ++byte)
    EXPECT_NEAR(ExactSrgb(ExactLinear(byte / 255.0)), byte / 255.0, 1e-6) << byte;
}

}  // namespace
}  // namespace pelt::test
