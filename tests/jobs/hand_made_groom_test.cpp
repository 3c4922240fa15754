// A groom that no file was read for is held to the rules of one that was, with the same words: no
// kernel follows an index that was not checked, no memory is asked for by a wild count.
#include <gtest/gtest.h>

#include <cmath>

#include "core/groom/groom_file.hpp"
#include "jobs/scene.hpp"
#include "tests/jobs/tiny_scene.hpp"

namespace pelt::testing {
namespace {

struct Spoilt {
  const char* says;
  void (*spoil)(Groom&);
};
const Spoilt kSpoilt[] = {
    {"does not come before it", [](Groom& g) { g.skeleton.parent[255] = 1 << 20; }},
    {"joints; 1 to 256", [](Groom& g) { g.joint_count = 300; }},
    {"unknown or out of order", [](Groom& g) { g.mesh[0].row_joint[kInfluenceRows - 1] = 255; }},
    {"is no control strand", [](Groom& g) { g.strands[0].control[kStrandsPerChunk - 1] = 255; }},
    {"item 0, vertex[", [](Groom& g) { g.strands[0].vertex[2][kStrandsPerChunk - 1] = 255; }},
    {"no vertex of the layer", [](Groom& g) { g.halo[0].vertex[0] = 1u << 20; }},
    {"no vertex of the layer", [](Groom& g) { g.halo[0].vertex[1] = ~0u; }},
    {"behind the", [](Groom& g) { g.halo[0].vertex[kVerticesPerChunk - 1] = 0; }},
    {"section 'halo'", [](Groom& g) { g.halo.pop_back(); }},
    {"unknown or named twice", [](Groom& g) { g.layer_joints[0].joint[255] = ~0u; }},
    {"4294967295 chunks", [](Groom& g) { g.layers.back().chunk_count = ~0u; }},
    {"4294967295 patches", [](Groom& g) { g.layers.back().patch_count = ~0u; }},
    {"patches begin at", [](Groom& g) { g.layers.back().first_patch += 1; }},
    {"strand_rest5", [](Groom& g) { g.strand_rest5.clear(); }},
    {"not a number", [](Groom& g) { g.vertex_rest[0].offset[0][0][0] = std::nanf(""); }},
    {"points is not between", [](Groom& g) { g.layers[0].params.points = 10; }},
    {"points: 4, 5 or 9", [](Groom& g) { g.layers[0].params.points = 7; }},
};

TEST(HandMadeGroom, IsRefusedAsAFileWouldBe) {
  const Scenario scenario = TinyScenario();
  const Groom& good = scenario.grooms[0];
  for (const Spoilt& spoilt : kSpoilt) {
    Groom bad = good;
    spoilt.spoil(bad);
    const std::string fault = FindGroomFault(bad, "of character 1");
    EXPECT_NE(fault.find(spoilt.says), std::string::npos) << fault;
    const Groom* grooms[] = {&good, &bad, &bad};
    EXPECT_EQ(MeasureScene(grooms, {}).error(), fault);
    EXPECT_EQ(FurScene::Create(grooms).error(), fault);
  }
}

}  // namespace
}  // namespace pelt::testing
