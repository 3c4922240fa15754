// Which materials carry no fur by themselves, and that layers hold to it.
#include <gtest/gtest.h>

#include "core/character/gltf_import.hpp"
#include "core/character/gltf_mesh.hpp"
#include "core/character/pose.hpp"
#include "core/groom/growth.hpp"
#include "core/groom/setup_names.hpp"
#include "tests/character/gltf_builder.hpp"

namespace pelt::test {
namespace {

TEST(BareNames, AreFoundByTheirWords) {
  for (const char* name :
       {"eye",       "Eyes_Black",  "leftEye",    "TONGUE.001",  "fox nose",     "Hooves",
        "claw2",     "eye_l",       "UpperTeeth", "Whiskers",    "tusk_L",       "EyeLash",
        "eyelashes", "PawPads.002", "T-Shirt",    "TShirt",      "shirtButtons", "Trousers_M",
        "left_shoe", "Hat",         "glasses",    "belt.buckle", "Belt",         "nose_pad_nose",
        "JacketZip", "antler",      "fur_hat",    "Boots_Low",   "paw pad"})
    EXPECT_TRUE(gltf::IsBareName(name)) << name;
  for (const char* name : {"",           "fur",       "eyebrow",    "EyeBrows",     "eye_lid",
                           "nosering",   "Main",      "mousey",     "cornflower",   "thumbnail",
                           "chatter",    "Hatchling", "shoebill",   "coat",         "undercoat",
                           "beltfish",   "nose_fur",  "noseBridge", "whisker pads", "eyeSockets",
                           "capybara",   "splash",    "tiger",      "dusk",         "hornet",
                           "zippy",      "buttoned",  "address",    "paw",          "lipstick",
                           "clothespeg", "mask",      "suit"})
    EXPECT_FALSE(gltf::IsBareName(name)) << name;
}

// Two meshes of a quad each, with a material each; the second's is `size` wide.
Character TwoQuads(const std::string& materials, const std::string& second_mesh,
                   const std::string& second_node = "body2", int second_material = 1,
                   float size = 0.4f, const std::string& more = "") {
  GltfBuilder b = MakeQuad();
  const std::string primitive = "{\"attributes\":{" + b.attributes + "}" + b.primitive_more;
  const int small = b.Floats("VEC3", {0, 0, 0, size, 0, 0, size, size, 0, 0, size, 0});
  std::string second = primitive;
  second.replace(second.find("\"POSITION\":0"), 12, "\"POSITION\":" + std::to_string(small));
  b.more = more;
  b.meshes = "{\"name\":\"body\",\"primitives\":[" + primitive + ",\"material\":0}]},{\"name\":\"" +
             second_mesh + "\",\"primitives\":[" + second +
             ",\"material\":" + std::to_string(second_material) + "}]}";
  b.nodes += ",{\"name\":\"" + second_node + "\",\"mesh\":1,\"skin\":0}";
  b.materials = materials;
  return ImportGltf(b.Glb(), "quads.glb");
}

const std::string kUnlit = R"(,"extensions":{"KHR_materials_unlit":{}}})";

std::vector<bool> BareOf(const Character& c) {
  std::vector<bool> bare;
  for (const MaterialLook& look : c.mesh.looks) bare.push_back(look.bare);
  return bare;
}

using Bare = std::vector<bool>;

TEST(BareMaterials, AreThoseOfSuchNamesOrUnlitAmongOthers) {
  const std::string coat = R"({"name":"coat"})";
  EXPECT_EQ(BareOf(TwoQuads(coat + R"(,{"name":"Eyes"})", "part")), Bare({false, true}));
  EXPECT_EQ(BareOf(TwoQuads(coat + R"(,{"name":"other"})", "part")), Bare({false, false}));
  EXPECT_EQ(BareOf(TwoQuads(coat + R"(,{"name":"other")" + kUnlit, "part")), Bare({false, true}));
  EXPECT_EQ(BareOf(TwoQuads(R"({"name":"coat")" + kUnlit + R"(,{"name":"other")" + kUnlit, "part")),
            Bare({false, false}))
      << "unlit as a whole";
  EXPECT_EQ(BareOf(TwoQuads(R"({"name":"coat")" + kUnlit + R"(,{"name":"nose")" + kUnlit, "part")),
            Bare({false, true}))
      << "unlit as a whole, but for a name";
  EXPECT_EQ(BareOf(TwoQuads(R"({"name":"horn"},{"name":"claw"})", "part")), Bare({false, false}))
      << "bare as a whole";
}

// What most of it is, is its style; and where an extension says another look, unlit is a fallback.
TEST(BareMaterials, AreUnlitOnlyWhereThatIsASmallPart) {
  const std::string coat = R"({"name":"coat"})", other = R"(,{"name":"other")",
                    toon = R"("extensions":{"KHR_materials_unlit":{},"VRMC_materials_mtoon":{}}})";
  const auto bare_of = [](const std::string& materials, float size, const std::string& more = "") {
    return BareOf(TwoQuads(materials, "part", "body2", 1, size, more));
  };
  EXPECT_EQ(bare_of(coat + other + kUnlit, 0.4f), Bare({false, true}));
  EXPECT_EQ(bare_of(coat + other + kUnlit, 0.8f), Bare({false, false}));
  EXPECT_EQ(bare_of(R"({"name":"body")" + kUnlit + R"(,{"name":"other"})", 0.2f),
            Bare({false, false}));
  EXPECT_EQ(bare_of(coat + other + "," + toon, 0.4f), Bare({false, false}));
  EXPECT_EQ(bare_of(coat + other + kUnlit, 0.4f, R"(,"extensions":{"VRM":{}})"),
            Bare({false, false}));
  EXPECT_EQ(bare_of(coat + R"(,{"name":"Eyes",)" + toon, 0.4f), Bare({false, true})) << "by name";
}

// Of which nothing is seen at all; a character of which that is so is not meant to be so.
TEST(BareMaterials, AreThoseThatAreTransparent) {
  const std::string coat = R"({"name":"coat"},)",
                    clear = R"("pbrMetallicRoughness":{"baseColorFactor":[1,1,1,0.1]}})";
  EXPECT_EQ(BareOf(TwoQuads(coat + R"({"name":"a","alphaMode":"MASK",)" + clear, "part")),
            Bare({false, true}));
  EXPECT_EQ(BareOf(TwoQuads(coat + R"({"name":"a","alphaMode":"BLEND",)" + clear, "part")),
            Bare({false, true}));
  EXPECT_EQ(BareOf(TwoQuads(coat + R"({"name":"a",)" + clear, "part")), Bare({false, false}))
      << "opaque";
  EXPECT_EQ(BareOf(TwoQuads(coat + R"({"name":"a","alphaMode":"MASK","alphaCutoff":0.05,)" + clear,
                            "part")),
            Bare({false, false}));
  const std::string both = R"({"name":"a","alphaMode":"MASK",)" + clear;
  EXPECT_EQ(BareOf(TwoQuads(both + "," + both, "part")), Bare({false, false}));
}

TEST(BareMaterials, AreMeshesAndNodesOfSuchNamesThoughTheyShareAMaterial) {
  const std::string atlas = R"({"name":"atlas"})";
  for (const Character& c :
       {TwoQuads(atlas, "Eyes", "part", 0), TwoQuads(atlas, "x", "eye_l", 0)}) {
    EXPECT_EQ(BareOf(c), Bare({false, true}));
    EXPECT_EQ(c.mesh.materials, std::vector<std::string>({"atlas", "atlas"}));
  }
  EXPECT_EQ(BareOf(TwoQuads(atlas, "part", "part", 0)), Bare({false}));
}

TEST(BareMaterials, GrowFurOnlyWhereALayerNamesThem) {
  const Character c = TwoQuads(R"({"name":"coat"},{"name":"Eyes"})", "part");
  const RestGeometry rest = ComputeRestGeometry(c, 1.0f);
  FurSetup setup;
  setup.layers.resize(1);
  const auto share = [&](uint16_t material) {
    const Growth growth(c, rest, setup, setup.layers[0]);
    for (uint32_t t = 0; t < c.mesh.triangles.size(); ++t)
      if (c.mesh.triangle_material[t] == material)
        return growth.TriangleLimit(t) * growth.Share({t, {0.4f, 0.3f, 0.3f}});
    return -1.0f;
  };
  EXPECT_EQ(share(0), 1.0f);
  EXPECT_EQ(share(1), 0.0f);
  EXPECT_NE(DescribeBare(c.mesh, setup).find("'Eyes'"), std::string::npos);
  setup.layers[0].mask.materials = {"Eyes"};
  EXPECT_EQ(share(0), 0.0f);
  EXPECT_EQ(share(1), 1.0f);
  EXPECT_EQ(DescribeBare(c.mesh, setup), "");
}

}  // namespace
}  // namespace pelt::test
