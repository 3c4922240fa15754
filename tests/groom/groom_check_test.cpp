// Every rule of FindGroomFault: break it in memory, and see section and reason.
#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "core/error.hpp"
#include "core/groom/groom_file.hpp"
#include "tests/groom/made_groom.hpp"

namespace pelt::test {
namespace {

TEST(GroomCheck, EveryRuleHolds) {
  struct Case {
    const char* section;
    const char* reason;
    std::function<void(Groom&)> spoil;
  };
  const Case cases[] = {
      {"general", "unit scale", [](Groom& g) { g.unit_scale = 0.0f; }},
      {"general", "unit scale", [](Groom& g) { g.unit_scale = NAN; }},
      {"general", "joints", [](Groom& g) { g.joint_count = 0; }},
      {"general", "joints", [](Groom& g) { g.joint_count = 257; }},
      {"joint_names", "names for", [](Groom& g) { g.joint_names.pop_back(); }},
      {"joint_names", "control characters", [](Groom& g) { g.joint_names[1] = "\x1b[2J"; }},
      {"layers", "control characters", [](Groom& g) { g.layers[0].name = "coat\xc2\x9b"; }},
      {"skeleton", "does not come before", [](Groom& g) { g.skeleton.parent[3] = 3; }},
      {"skeleton", "does not come before", [](Groom& g) { g.skeleton.parent[3] = -2; }},
      {"skeleton", "does not come before", [](Groom& g) { g.skeleton.parent[7] = 7; }},
      {"skeleton", "does not come before", [](Groom& g) { g.skeleton.parent[7] = -2; }},
      {"skeleton", "does not come before", [](Groom& g) { g.skeleton.parent[255] = 1 << 30; }},
      {"skeleton", "not finite", [](Groom& g) { g.skeleton.inverse_bind[255][0] = INFINITY; }},
      {"skeleton", "not finite", [](Groom& g) { g.skeleton.inverse_bind[6][11] = NAN; }},
      {"layers", "0 layers", [](Groom& g) { g.layers.clear(); }},
      {"layers", "name", [](Groom& g) { g.layers[1].name = ""; }},
      {"layers", "solver", [](Groom& g) { g.layers[1].params.solver = Solver(3); }},
      {"layers", "bounce", [](Groom& g) { g.layers[1].params.bounce = NAN; }},
      {"layers", "points", [](Groom& g) { g.layers[0].params.points = 5; }},
      {"layers", "points: 4, 5 or 9", [](Groom& g) { g.layers[3].params.points = 6; }},
      {"layers", "points is not between", [](Groom& g) { g.layers[3].params.points = 10; }},
      {"layers", "only solver = \"modal\" has chains of 9",
       [](Groom& g) { g.layers[3].params.solver = Solver::kPbd; }},
      {"layers", "patches begin at", [](Groom& g) { g.layers[1].first_patch = 1; }},
      {"layers", "patches", [](Groom& g) { g.layers[2].patch_count = 0xffffffffu; }},
      {"layers", "chunks begin at", [](Groom& g) { g.layers[1].first_chunk = 1; }},
      {"layers", "chunks", [](Groom& g) { g.layers[2].chunk_count = 0xffffffffu; }},
      {"layers", "strands", [](Groom& g) { g.layers[2].strand_count++; }},
      {"layers", "its longest strand", [](Groom& g) { g.layers[2].length_max = 0.01f; }},
      {"layers", "its longest strand", [](Groom& g) { g.layers[2].length_max = NAN; }},
      {"layer_joints", "where the layers need", [](Groom& g) { g.layer_joints.pop_back(); }},
      {"mesh", "where the layers need", [](Groom& g) { g.mesh.pop_back(); }},
      {"mesh", "where the layers need", [](Groom& g) { g.layers[3].patch_count = 1; }},
      {"halo", "where the layers need", [](Groom& g) { g.halo.pop_back(); }},
      {"vertex_down", "where the layers need", [](Groom& g) { g.vertex_down.pop_back(); }},
      {"vertex_down", "where the layers need",
       [](Groom& g) { g.layers[0].params.sag_free = false; }},
      {"strand_down", "where the layers need", [](Groom& g) { g.strand_down.pop_back(); }},
      {"strand_down", "where the layers need",
       [](Groom& g) { g.layers[3].params.sag_free = false; }},
      {"strand_traits", "where the layers need", [](Groom& g) { g.strand_traits.pop_back(); }},
      {"strand_traits", "where the layers need",
       [](Groom& g) { g.layers[2].params.traits = false; }},
      {"vertex_traits", "where the layers need", [](Groom& g) { g.vertex_traits.emplace_back(); }},
      {"layers", "they have no traits", [](Groom& g) { g.layers[3].params.traits = true; }},
      {"strands", "where the layers need", [](Groom& g) { g.strands.pop_back(); }},
      {"vertex_rest", "where the layers need", [](Groom& g) { g.vertex_rest.pop_back(); }},
      {"strand_rest4", "where the layers need", [](Groom& g) { g.strand_rest4.pop_back(); }},
      {"strand_rest5", "where the layers need", [](Groom& g) { g.strand_rest5.pop_back(); }},
      {"strand_rest9", "where the layers need", [](Groom& g) { g.strand_rest9.pop_back(); }},
      {"strand_uv", "where the layers need", [](Groom& g) { g.strand_uv.pop_back(); }},
      {"layer_joints", "joints", [](Groom& g) { g.layer_joints[1].count = 257; }},
      {"layer_joints", "unknown or named twice", [](Groom& g) { g.layer_joints[1].joint[2] = 7; }},
      {"layer_joints", "unknown or named twice", [](Groom& g) { g.layer_joints[1].joint[2] = 1; }},
      {"layer_joints", "unknown or named twice",
       [](Groom& g) { g.layer_joints[1].joint[255] = 256; }},
      {"layer_joints", "inside out", [](Groom& g) { g.layer_joints[2].low[1][255] = 2.0f; }},
      {"layer_joints", "is missing", [](Groom& g) { g.layer_joints[1].count = 0; }},
      {"layer_joints", "inside out", [](Groom& g) { g.layer_joints[2].low[1][3] = 2.0f; }},
      {"layer_joints", "not a number", [](Groom& g) { g.layer_joints[2].high[1][3] = INFINITY; }},
      {"mesh", "0 vertices", [](Groom& g) { g.mesh[0].vertex_count = 0; }},
      {"mesh", "vertices", [](Groom& g) { g.mesh[0].vertex_count = kVerticesPerChunk + 1; }},
      {"mesh", "not a number", [](Groom& g) { g.mesh[3].position[2][5] = NAN; }},
      {"mesh", "not a number",
       [](Groom& g) { g.mesh[3].position[2][kVerticesPerChunk - 1] = 1e9f; }},
      {"mesh", "not a unit vector", [](Groom& g) { g.mesh[3].normal[2][5] = 0.0f; }},
      {"mesh", "not a unit vector", [](Groom& g) { g.mesh[3].tangent[0][5] = 1.5f; }},
      {"mesh", "not a number", [](Groom& g) { g.mesh[4].weight[0][3] = -0.5f; }},
      {"mesh", "sum to", [](Groom& g) { g.mesh[4].weight[0][3] *= 0.5f; }},
      {"mesh", "rows must ascend",
       [](Groom& g) { g.mesh[4].group_first_row[kVertexGroups] = 999; }},
      {"mesh", "rows must ascend", [](Groom& g) { g.mesh[0].group_first_row[1] = 0xffff; }},
      {"mesh", "sum to", [](Groom& g) { g.mesh[0].group_first_row[1] = 0; }},
      {"mesh", "unknown or out of order", [](Groom& g) { g.mesh[0].row_joint[1] = 7; }},
      {"mesh", "unknown or out of order",
       [](Groom& g) { g.mesh[0].row_joint[1] = g.mesh[0].row_joint[0]; }},
      {"mesh", "unknown or out of order",
       [](Groom& g) { g.mesh[1].row_joint[kInfluenceRows - 1] = 255; }},
      {"strands", "0 strands", [](Groom& g) { g.strands[1].strand_count = 0; }},
      {"strands", "strands", [](Groom& g) { g.strands[1].strand_count = kStrandsPerChunk + 1; }},
      {"strands", "0 vertices", [](Groom& g) { g.strands[1].vertex_count = 0; }},
      {"strands", "vertices", [](Groom& g) { g.strands[1].vertex_count = kVerticesPerChunk + 1; }},
      {"halo", "behind the 23 in use", [](Groom& g) { g.strands[1].vertex_count = 23; }},
      {"halo", "no vertex of the layer", [](Groom& g) { g.strands[1].vertex_count = 25; }},
      // The groom has such a patch, but the layer has not.
      {"halo", "no vertex of the layer",
       [](Groom& g) { g.halo[1].vertex[3] = 2 * kVerticesPerChunk; }},
      {"halo", "no vertex of the layer", [](Groom& g) { g.halo[1].vertex[3] = 0xfffffff0u; }},
      {"halo", "no vertex of the layer", [](Groom& g) { g.halo[1].vertex[3] = ~0u; }},
      // A lane behind those of the patch.
      {"halo", "no vertex of the layer",
       [](Groom& g) { g.halo[1].vertex[3] = kVerticesPerChunk + 16; }},
      {"halo", "no vertex of the layer", [](Groom& g) { g.halo[4].vertex[3] = 40; }},
      {"halo", "behind the 24 in use", [](Groom& g) { g.halo[1].vertex[24] = 7; }},
      {"halo", "behind the 40 in use",
       [](Groom& g) { g.halo[0].vertex[kVerticesPerChunk - 1] = ~0u - 1; }},
      {"strands", "control strands", [](Groom& g) { g.strands[1].control_count = 8; }},
      {"strands", "control strands", [](Groom& g) { g.strands[1].control_count = 48; }},
      {"strands", "is no control strand", [](Groom& g) { g.strands[1].control[4] = 16; }},
      {"strands", "is no control strand",
       [](Groom& g) { g.strands[1].control[kStrandsPerChunk - 1] = 255; }},
      {"strands", "expected", [](Groom& g) { g.strands[1].first_strand = 0; }},
      {"strands", "barycentrics sum", [](Groom& g) { g.strands[1].bary[2][20] += 0.1f; }},
      {"strands", "not a number", [](Groom& g) { g.strands[1].bary[0][3] = -0.5f; }},
      {"strands", "not above 0", [](Groom& g) { g.strands[1].length[20] = 0.0f; }},
      {"strands", "not a number", [](Groom& g) { g.strands[1].length[3] = NAN; }},
      {"strands", "not a number", [](Groom& g) { g.strands[1].width[3] = -1.0f; }},
      {"strands", "no vertex 200", [](Groom& g) { g.strands[1].vertex[2][31] = 200; }},
      {"strands", "no vertex 24", [](Groom& g) { g.strands[1].vertex[1][20] = 24; }},
      {"strands", "no vertex 24",
       [](Groom& g) { g.strands[1].vertex[0][kStrandsPerChunk - 1] = 24; }},
      {"strands", "no joint 31", [](Groom& g) { g.strands[1].joint_mask[0] |= 1u << 31; }},
      {"strands", "is missing", [](Groom& g) { g.strands[1].joint_mask[0] = 0; }},
      // Joints of the second of the patches that the chunk's vertices lie in.
      {"strands", "is missing",
       [](Groom& g) {
         for (MeshBlock* mesh : {&g.mesh[0], &g.mesh[1]})
           for (uint32_t row = 0; row < mesh->group_first_row[kVertexGroups]; ++row)
             mesh->row_joint[row] = uint8_t(row % 2 + (mesh == &g.mesh[0] ? 0 : 5));
         g.strands[0].joint_mask[0] = 3;
         g.strands[1].joint_mask[0] = 3;
       }},
      {"vertex_down", "not a direction of length 1",
       [](Groom& g) { g.vertex_down[1].down[0][15] = 0.5f; }},
      {"vertex_down", "not a number", [](Groom& g) { g.vertex_down[1].down[2][15] = NAN; }},
      {"strand_down", "not a direction of length 1",
       [](Groom& g) { g.strand_down[1].down[1][21] = 0.5f; }},
      {"strand_down", "not a number", [](Groom& g) { g.strand_down[1].down[1][21] = NAN; }},
      {"strand_traits", "not a number", [](Groom& g) { g.strand_traits[1].drag[21] = NAN; }},
      {"strand_traits", "not a number",
       [](Groom& g) { g.strand_traits[2].least_cosine[3] = 1.5f; }},
      {"vertex_rest", "not above 0", [](Groom& g) { g.vertex_rest[1].segment_length[3] = 0.0f; }},
      {"strand_rest4", "not a number", [](Groom& g) { g.strand_rest4[2].strength[3] = 1.5f; }},
      {"strand_rest5", "not a number", [](Groom& g) { g.strand_rest5[1].offset[3][2][1] = NAN; }},
      {"strand_rest9", "not a number", [](Groom& g) { g.strand_rest9[1].offset[7][2][1] = NAN; }},
  };
  const Groom good = MakeGroom();
  ASSERT_EQ(FindGroomFault(good, "g.groom"), "");
  for (const Case& c : cases) {
    Groom bad = good;
    c.spoil(bad);
    const std::string message = FindGroomFault(bad, "g.groom");
    EXPECT_EQ(message.rfind(std::string("groom 'g.groom': section '") + c.section + "', byte ", 0),
              0u)
        << c.section << ", " << c.reason << ": " << message;
    EXPECT_NE(message.find(c.reason), std::string::npos) << c.section << ": " << message;
    EXPECT_THROW(WriteGroom(bad).OrThrow(), Error);
  }
}

}  // namespace
}  // namespace pelt::test
