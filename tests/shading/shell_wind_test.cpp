// What a vertex shader makes of the published wind, read as C++, against the force that the frame's kernels hand it.
#include <gtest/gtest.h>

#include "bench/shading/shading.hpp"
#include "core/kernels/shell_force.hpp"
#include "core/kernels/wind.hpp"
#include "tests/kernels/run_kernel.hpp"

namespace pelt::test {
namespace {

using Ref = ArrayVec<4>;

glm::vec3 Vector(const float (&v)[3]) { return {v[0], v[1], v[2]}; }
glm::vec3 Wave(const WindSine& sine) { return {sine.strength, sine.turns_per_m, sine.phase}; }

// Straight fur, 5 cm long.
TEST(ShellWind, TheShadersForceIsTheKernels) {
  LayerBlock layer{};
  ShellLayerBlock shells{};
  RestBlock<4> rest{};
  ShellSkinBlock skin{};
  RootBlock anchors{};
  WindBlock air{};
  ChunkStateBlock state{};
  layer.flags = kLayerSimulate | kLayerWind;
  layer.link.stiffness = 0.25f, layer.wind_response = 1.5f;
  layer.gravity[1] = -9.81f;
  layer.scale = layer.darken = 1.0f;
  shells.cone = 0.2f;
  state.live_vertices = state.live_chains = kVerticesPerChunk;
  std::mt19937 random(11);
  for (uint32_t v = 0; v < kVerticesPerChunk; ++v) {
    const Double3 normal = RandomUnit(random), tangent = Unit(Cross(normal, RandomUnit(random)));
    SetAt(anchors.position, v, RandomUnit(random) * 2.0);
    SetAt(anchors.normal, v, normal);
    SetAt(anchors.tangent, v, tangent);
    SetAt(rest.offset[2], v, Double3{0.03, 0.0, 0.04});
    rest.segment_length[v] = 0.05f / 3.0f;
    rest.strength[v] = 1.0f;
  }
  const WindSetup setup{{2.0f, 0.0f, -3.0f}, 0.5f, 4.0f, 4.0f, 0.7f, 1};
  for (const double time_s : {0.0, 1.3, 20.0}) {
    const WindParams wind = MakeWindParams(setup, time_s);
    RunOnBlocks<Wind<Ref, true>>(&wind, state, layer, anchors, air);
    const ShellVertexBlock out = OutputOf<ShellForce<Ref>, ShellVertexBlock>(
        nullptr, layer, shells, rest, skin, anchors, air, state);
    for (uint32_t v = 0; v < kVerticesPerChunk; ++v) {
      const ShellVertex& vertex = out.vertex[v];
      const glm::vec3 blown = PublishedWind(Vector(vertex.position), Vector(wind.direction_speed),
                                            Wave(wind.sine[0]), Wave(wind.sine[1]));
      const glm::vec3 force =
          ShellBend(Vector(layer.gravity) + 1.5f * blown, shading::OctahedralNormal(vertex.normal),
                    0.25f, 0.2f, glm::length(Vector(vertex.groom)));
      for (int k = 0; k < 3; ++k) EXPECT_NEAR(force[k], vertex.force[k], 1e-4f) << v << " " << k;
    }
  }
}

}  // namespace
}  // namespace pelt::test
