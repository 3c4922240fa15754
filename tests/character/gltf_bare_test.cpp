// Which materials carry no fur by themselves, and that layers hold to it.
#include "core/character/gltf_bare.hpp"

#include <gtest/gtest.h>

#include "core/character/gltf_import.hpp"
#include "core/character/pose.hpp"
#include "core/groom/growth.hpp"
#include "core/groom/setup_names.hpp"
#include "tests/character/gltf_builder.hpp"

namespace pelt {
namespace {

using test::GltfBuilder;

TEST(BareNames, AreFoundByTheirWords) {
  for (const char* name : {"eye", "Eyes_Black", "leftEye", "TONGUE.001", "fox nose", "Hooves",
                           "claw2", "eye_l", "UpperTeeth"})
    EXPECT_TRUE(gltf::IsBareName(name)) << name;
  for (const char* name : {"", "fur", "eyebrow", "EyeBrows", "eye_lid", "nosering", "Main",
                           "mousey", "cornflower", "thumbnail"})
    EXPECT_FALSE(gltf::IsBareName(name)) << name;
}

// Two meshes of a quad each, with a material each.
Character TwoQuads(const std::string& materials, const std::string& second_mesh,
                   const std::string& second_node = "body2", int second_material = 1) {
  GltfBuilder b = test::MakeQuad();
  const std::string primitive = "{\"attributes\":{" + b.attributes + "}" + b.primitive_more;
  b.meshes = "{\"name\":\"body\",\"primitives\":[" + primitive + ",\"material\":0}]},{\"name\":\"" +
             second_mesh + "\",\"primitives\":[" + primitive +
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
}  // namespace pelt
