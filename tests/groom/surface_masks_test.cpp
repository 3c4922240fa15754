// Where a character's own images leave no fur, and that maps lie where they lie.
#include <gtest/gtest.h>

#include "core/character/gltf_import.hpp"
#include "core/character/pose.hpp"
#include "core/error.hpp"
#include "core/groom/attributes.hpp"
#include "core/groom/bake.hpp"
#include "core/groom/flow_map.hpp"
#include "core/groom/growth.hpp"
#include "core/groom/surface_colour.hpp"
#include "tests/character/gltf_builder.hpp"
#include "tests/groom/png.hpp"

namespace pelt::test {
namespace {

// What a test says of the quad's one material, its texture and its coordinates.
struct Look {
  std::string material = R"("pbrMetallicRoughness":{"baseColorTexture":{"index":0}})";
  std::vector<uint8_t> png = {};
  std::string sampler = "{}";
  std::vector<float> uvs = {0, 0, 1, 0, 1, 1, 0, 1};
  std::vector<float> colours = {};
};

Character MakeCharacter(const Look& look) {
  GltfBuilder b = MakeQuad();
  b.Attribute("TEXCOORD_0", b.Floats("VEC2", {0, 0, 1, 0, 1, 1, 0, 1}));
  b.Attribute("TEXCOORD_1", b.Floats("VEC2", look.uvs));
  if (!look.colours.empty()) b.Attribute("COLOR_0", b.Floats("VEC4", look.colours));
  b.primitive_more += ",\"material\":0";
  b.materials = R"({"name":"coat",)" + look.material + "}";
  if (!look.png.empty())
    b.more = R"(,"textures":[{"source":0,"sampler":0}],"samplers":[)" + look.sampler +
             R"(],"images":[{"bufferView":)" + std::to_string(b.View(look.png)) + "}]";
  return ImportGltf(b.Glb(), "quad.glb");
}

// Left half, right half; eight texels wide, so that what lies between them is narrow.
std::vector<uint8_t> Halves(const std::vector<uint8_t>& left, const std::vector<uint8_t>& right) {
  std::vector<uint8_t> pixels;
  for (int x = 0; x < 8; ++x)
    pixels.insert(pixels.end(), x < 4 ? left.begin() : right.begin(),
                  x < 4 ? left.end() : right.end());
  return MakePng(8, 1, int(left.size()), pixels);
}

// "1" where fur grows, "0" where none does: at four places across the quad, from its left to its right.
std::string Grows(const Character& character, const LayerSetup& layer) {
  const RestGeometry rest = ComputeRestGeometry(character, 1.0f);
  FurSetup setup;
  setup.layers = {layer};
  const Growth growth(character, rest, setup, layer);
  std::string grows;
  // The first triangle has the corners (0, 0), (1, 0) and (1, 1).
  for (const float x : {0.15f, 0.4f, 0.6f, 0.85f}) {
    const float share = growth.Share({0, {1.0f - x, 0.5f * x, 0.5f * x}});
    grows += share == 0.0f ? '0' : share == 1.0f ? '1' : '?';
  }
  return grows;
}

TEST(SurfaceMasks, NoFurGrowsInHoles) {
  const std::string texture = R"("pbrMetallicRoughness":{"baseColorTexture":{"index":0})",
                    mask = R"("alphaMode":"MASK",)";
  const std::vector<uint8_t> clear_left = Halves({9, 9, 9, 100}, {9, 9, 9, 250});
  const struct {
    std::string material, grows;
    std::vector<float> colours = {};
  } kCases[] = {
      {texture + "}", "1111"},
      {R"("alphaMode":"OPAQUE","alphaCutoff":0.5,)" + texture + "}", "1111"},
      {mask + texture + "}", "0011"},
      {mask + R"("alphaCutoff":0.2,)" + texture + "}", "1111"},
      {mask + R"("alphaCutoff":0,)" + texture + "}", "1111"},
      {mask + R"("alphaCutoff":0.99,)" + texture + "}", "0000"},
      {mask + R"("alphaCutoff":"x",)" + texture + "}", "0011"},
      {R"("alphaMode":"BLEND",)" + texture + "}", "0011"},
      {mask + texture + R"(,"baseColorFactor":[1,1,1,0.5]})", "0000"},
      {mask + R"("alphaCutoff":0.3,)" + texture + R"(,"baseColorFactor":[1,1,1,0.6]})", "0011"},
      {mask +
           R"("extensions":{"KHR_materials_pbrSpecularGlossiness":{"diffuseTexture":{"index":0}}})",
       "0011"},
      {mask + R"("emissiveFactor":[1,1,1],"emissiveTexture":{"index":0},)" + texture +
           R"(,"baseColorFactor":[0,0,0,1]})",
       "0011"},
      // Alpha of vertices counts too: none at the left corner.
      {mask + R"("pbrMetallicRoughness":{})",
       "0011",
       {1, 1, 1, 0, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1}},
  };
  for (const auto& test : kCases) {
    Look look{.material = test.material, .colours = test.colours};
    if (test.colours.empty()) look.png = clear_left;
    EXPECT_EQ(Grows(MakeCharacter(look), LayerSetup{}), test.grows) << test.material;
  }
}

TEST(SurfaceMasks, HolesAreToldAndKeptInPictures) {
  const Character c = MakeCharacter(
      {.material = R"("alphaMode":"MASK","pbrMetallicRoughness":{"baseColorTexture":{"index":0}})",
       .png = Halves({9, 9, 9, 0}, {9, 9, 9, 255})});
  EXPECT_EQ(c.notes.back(), "No fur grows where alpha leaves holes in 'coat'.");
  FurSetup setup;
  setup.layers.resize(1);
  setup.layers[0].density = 4000.0f;
  const RestGeometry rest = ComputeRestGeometry(c, 1.0f);
  const GrowthMap map = MakeGrowthMap(c, rest, setup, setup.layers[0], 64);
  EXPECT_EQ(map.share[32 * 64 + 16], 0);
  EXPECT_EQ(map.share[32 * 64 + 48], 255);
  std::vector<std::string> notes;
  const Groom groom = BakeGroom(c, rest, setup, 1.0f, nullptr, nullptr, nullptr, &notes);
  EXPECT_NEAR(double(groom.layers[0].strand_count), 2000.0, 250.0);
  EXPECT_TRUE(notes.empty());
}

// Exporters state BLEND and MASK for images that have no alpha as well.
TEST(SurfaceMasks, WhatHasNoAlphaHasNoHoles) {
  const Character c = MakeCharacter(
      {.material = R"("alphaMode":"BLEND","pbrMetallicRoughness":{"baseColorTexture":{"index":0}})",
       .png = Halves({9, 9, 9}, {99, 99, 99})});
  EXPECT_FALSE(c.mesh.looks.at(0).IsCut());
  for (const std::string& note : c.notes) EXPECT_EQ(note.find("alpha"), note.npos) << note;
}

TEST(SurfaceMasks, DamagedImagesAreToldByTheBake) {
  std::vector<uint8_t> png = Halves({9, 9, 9}, {99, 99, 99});
  png.resize(png.size() / 2);
  const Character c = MakeCharacter({.png = png});
  FurSetup setup;
  setup.layers.resize(1);
  setup.layers[0].density = 400.0f;
  std::vector<std::string> notes;
  BakeGroom(c, ComputeRestGeometry(c, 1.0f), setup, 1.0f, nullptr, nullptr, nullptr, &notes);
  ASSERT_EQ(notes.size(), 1u);
  EXPECT_NE(notes[0].find("damaged"), std::string::npos);
  setup.layers[0].base_colour = setup.layers[0].tip_colour = 0xff112233u;
  notes.clear();
  BakeGroom(c, ComputeRestGeometry(c, 1.0f), setup, 1.0f, nullptr, nullptr, nullptr, &notes);
  EXPECT_TRUE(notes.empty()) << "nothing read it";
}

LayerSetup WithColours(const std::vector<uint32_t>& colours, float tolerance) {
  LayerSetup layer;
  layer.mask.colours = colours;
  layer.mask.colour_tolerance = tolerance;
  return layer;
}

TEST(SurfaceMasks, NoFurGrowsOnColours) {
  const Character c = MakeCharacter({.png = Halves({20, 20, 22}, {200, 120, 60})});
  EXPECT_EQ(Grows(c, WithColours({0xff000000u | 22 << 16 | 20 << 8 | 20}, 0.0f)), "0011");
  EXPECT_EQ(Grows(c, WithColours({0xff000000u}, 0.06f)), "1111");
  EXPECT_EQ(Grows(c, WithColours({0xff000000u}, 0.09f)), "0011");
  EXPECT_EQ(Grows(c, WithColours({0xffffffffu, 0xff000000u | 60 << 16 | 120 << 8 | 200}, 0.01f)),
            "1100");
  EXPECT_EQ(Grows(c, WithColours({0xff000000u | 60 << 16 | 60 << 8 | 200}, 0.2f)), "1111")
      << "each channel is to be near";
}

// Of what has no image the colour that is seen: 0.5 linear is 188 in sRGB.
TEST(SurfaceMasks, ColoursMayBeThoseOfMaterialsAndVertices) {
  const Character factor =
      MakeCharacter({.material = R"("pbrMetallicRoughness":{"baseColorFactor":[0.5,0.5,0.5,1]})"});
  EXPECT_EQ(Grows(factor, WithColours({0xffbcbcbcu}, 0.01f)), "0000");
  EXPECT_EQ(Grows(factor, WithColours({0xff808080u}, 0.01f)), "1111");
  const Character vertices =
      MakeCharacter({.material = R"("pbrMetallicRoughness":{})",
                     .colours = {0, 0, 0, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1}});
  EXPECT_EQ(Grows(vertices, WithColours({0xffffffffu}, 0.25f)), "1100");
  const Character nothing = MakeCharacter({.material = R"("pbrMetallicRoughness":{})"});
  try {
    Grows(nothing, WithColours({0xffffffffu}, 0.25f));
    FAIL();
  } catch (const Error& error) {
    EXPECT_NE(std::string(error.what()).find("mask.colours"), std::string::npos) << error.what();
  }
}

std::shared_ptr<const ControlMap> BaldLeft() {
  return std::make_shared<const ControlMap>(
      ReadControlMap(Halves({255, 255, 255}, {0, 0, 0}), "bald.png"));
}

// The map is painted over the image: however that is laid, both are seen at one place.
TEST(SurfaceMasks, MapsLieWhereTheImageLies) {
  const auto texture = [](const std::string& more) {
    return R"("pbrMetallicRoughness":{"baseColorTexture":{"index":0)" + more + "}}";
  };
  const std::string moved = R"(,"extensions":{"KHR_texture_transform":)";
  const std::vector<float> swapped = {1, 0, 0, 0, 0, 1, 1, 1}, doubled = {0, 0, 2, 0, 2, 1, 0, 1};
  const struct {
    std::string material, sampler, grows;
    std::vector<float> uvs;
  } kCases[] = {
      {texture(""), "{}", "0011", swapped},
      {texture(R"(,"texCoord":1)"), "{}", "1100", swapped},
      {texture(moved + R"({"texCoord":1}})"), "{}", "1100", swapped},
      {texture(moved + R"({"offset":[0.5,0]}})"), "{}", "1100", swapped},
      {texture(moved + R"({"scale":[-1,1]}})"), "{}", "1100", swapped},
      {texture(moved + R"({"scale":[0.5,1]}})"), "{}", "0000", swapped},
      {texture(R"(,"texCoord":1)"), "{}", "0101", doubled},
      {texture(R"(,"texCoord":1)"), R"({"wrapS":33648})", "0110", doubled},
      {texture(R"(,"texCoord":1)"), R"({"wrapS":33071})", "0111", doubled},
      {texture(R"(,"texCoord":1)"), R"({"wrapT":33071})", "0101", doubled},
  };
  for (const auto& test : kCases) {
    const Character c = MakeCharacter({.material = test.material,
                                       .png = Halves({255, 255, 255}, {0, 0, 0}),
                                       .sampler = test.sampler,
                                       .uvs = test.uvs});
    LayerSetup bald, stencil;
    bald.mask.bald.map = BaldLeft();
    const std::string what = test.material + test.sampler;
    EXPECT_EQ(Grows(c, bald), test.grows) << what;
    // The same picture as the image: white where it is bald.
    EXPECT_EQ(Grows(c, WithColours({0xffffffffu}, 0.5f)), test.grows) << what;
    // Attributes go by the same places.
    LayerSetup lengths;
    lengths.length.map.map = BaldLeft();
    FurSetup setup;
    const RestGeometry rest = ComputeRestGeometry(c, 1.0f);
    const AttributeMaker maker(c, rest, setup, lengths);
    const StrandLie lie = maker.MeanLie({0, {0.15f, 0.425f, 0.425f}});
    EXPECT_EQ(lie.length > 0.02, test.grows[3] == '0') << what;
  }
}

}  // namespace
}  // namespace pelt::test
