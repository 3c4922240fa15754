// The scene `tiny` for tests of whole frames: every solver and chain in under a thousand
// strands. Baked once a program.
#pragma once

#include <gtest/gtest.h>

#include <functional>
#include <string>
#include <vector>

#include "bench/scenarios/scenarios.hpp"
#include "core/character/pose.hpp"
#include "core/groom/bake.hpp"
#include "jobs/frame.hpp"

namespace pelt::testing {

// A copy of the scenario that a test may change.
inline Scenario TinyScenario() {
  static const Scenario kBaked = LoadScenario("tiny");
  return kBaked;
}

// One of each kind, near `tiny`.
inline Lighting TinyLighting() {
  Lighting lighting;
  lighting.light_count = 2;
  lighting.light[0] = {{1.0f, 1.5f, 0.5f}, 0.2f, {2.0f, 1.5f, 1.0f}, 6.0f};
  lighting.light[1] = {{-1.0f, 0.5f, 1.0f}, 0.0f, {0.2f, 0.3f, 0.8f}, 0.0f};
  lighting.sample_count = 2;
  lighting.sample[0] = {{0, 1, 0}, 4.0f, {0.4f, 0.5f, 0.7f}, {0.2f, 0.15f, 0.1f}, {0, 1, 0}};
  lighting.sample[1] = {{3, 1, 0}, 4.0f, {0.1f, 0.1f, 0.2f}, {0.1f, 0.1f, 0.1f}, {0, 1, 0}};
  for (float& colour : lighting.sun_rgb) colour = 1.5f;
  return lighting;
}

// A layer of shells on the character's head, behind the layers that there are.
inline void AddShells(Scenario& scenario) {
  const FurSetup setup = ReadFurSetup(
      "[[layer]]\n"
      "name = 'shells'\n"
      "output = 'shells'\n"
      "length = { value = 0.03, randomise = 0.3 }\n"
      "shells = 12\n"
      "fur_texture_size = 32\n"
      "fins = true\n"
      "mask.range = { low = [0.0, 0.5, 0.0], high = [1.0, 1.0, 1.0] }\n",
      "shells", ".");
  Groom& groom = scenario.grooms[scenario.actors[0].groom];
  const Character& character = scenario.characters[scenario.actors[0].character];
  const Groom shells = BakeGroom(character, ComputeRestGeometry(character, groom.unit_scale), setup,
                                 groom.unit_scale);
  const auto append = [](auto& to, const auto& from) {
    to.insert(to.end(), from.begin(), from.end());
  };
  groom.layers.push_back(shells.layers[0]);
  groom.layers.back().first_chunk = uint32_t(groom.mesh.size());
  append(groom.layer_joints, shells.layer_joints);
  append(groom.mesh, shells.mesh);
  append(groom.strands, shells.strands);
  append(groom.strand_uv, shells.strand_uv);
  append(groom.vertex_rest, shells.vertex_rest);
  append(groom.shell_skin, shells.shell_skin);
  append(groom.fin_edges, shells.fin_edges);
}

// A sponge on the head, mud that reaches further, and what wipes some of it off.
inline std::vector<PaintBrush> TinyBrushes() {
  const auto brush = [](PaintChannel channel, float height, float radius, float amount) {
    return PaintBrush{{0.1f, height, 0.1f}, radius, 0.5f, uint32_t(channel), amount};
  };
  return {brush(PaintChannel::kWet, 1.0f, 0.3f, 0.05f), brush(PaintChannel::kMud, 0.5f, 0.5f, 0.1f),
          brush(PaintChannel::kMud, 0.6f, 0.2f, -0.04f)};
}

// `tiny` with every other layer lit, every other one of these painted; the scene itself has none, as
// its digests are kept.
inline Scenario LitScenario() {
  Scenario scenario = TinyScenario();
  scenario.base.lighting = TinyLighting();
  for (const PaintBrush& brush : TinyBrushes())
    scenario.base.brush[scenario.base.brush_count++] = brush;
  uint32_t layers = 0;
  for (Groom& groom : scenario.grooms)
    for (GroomLayer& layer : groom.layers) {
      layer.params.painted = layers % 4 == 0;
      layer.params.lit = layers++ % 2 == 0;
    }
  return scenario;
}

// Besides, every other layer of ribbons as lines, and a lit layer of shells: layers of every output.
inline Scenario EveryOutputScenario() {
  Scenario scenario = LitScenario();
  uint32_t ribbons = 0;
  for (Groom& groom : scenario.grooms)
    for (GroomLayer& layer : groom.layers)
      if (layer.params.output == Output::kRibbons && ribbons++ % 2 == 0)
        layer.params.output = Output::kLines;
  AddShells(scenario);
  scenario.grooms[0].layers.back().params.lit = true;
  return scenario;
}

// `tiny` on its own course until `frame`, then at rest: no teleport, no wind, nothing moves.
inline Scenario RestingScenario(uint32_t frame) {
  Scenario scenario = TinyScenario();
  scenario.actors[0].teleport_frame = -1;
  scenario.rest_from_frame = frame;
  return scenario;
}

inline SceneOptions OptionsFor(Isa isa) {
  SceneOptions options;
  options.isa = isa;
  return options;
}

// Why the frame was refused; empty when it was not.
inline std::string BeginError(FurScene& scene, const FrameInput& input) {
  const char* fault = scene.BeginFrame(input);
  return fault ? fault : "";
}

// The digest of every frame.
inline std::vector<uint64_t> RunDigests(Scenario& scenario, const SceneOptions& options,
                                        Executor& executor, uint32_t frames,
                                        const SkipSettings& skip = {},
                                        const LodSettings& lod = {}) {
  RunningScenario running(scenario, options);
  std::vector<uint64_t> digests;
  for (uint32_t f = 0; f < frames; ++f) {
    running.Begin(f, skip, lod);
    executor.Run(running.scene().CurrentFrame());
    digests.push_back(running.scene().DigestFrame());
  }
  return digests;
}

// Says in which frame two courses part.
inline void ExpectSameFrames(const std::vector<uint64_t>& expected,
                             const std::vector<uint64_t>& found, const std::string& what) {
  ASSERT_EQ(expected.size(), found.size()) << what;
  for (size_t f = 0; f < expected.size(); ++f)
    ASSERT_EQ(expected[f], found[f]) << what << ": frame " << f;
}

// Chunks of the scene whose flags have all of `set` and none of `clear`.
inline uint32_t CountChunks(const FurScene& scene, uint32_t set, uint32_t clear = 0) {
  uint32_t count = 0;
  for (uint32_t c = 0; c < scene.shape().chunk_count; ++c) {
    const uint32_t flags = scene.memory().Of<&Streams::chunk_state>(c)->flags;
    count += (flags & set) == set && (flags & clear) == 0;
  }
  return count;
}
inline uint32_t CountAsleep(const FurScene& scene) {
  return CountChunks(scene, kChunkVisible, kChunkSimulate);
}

}  // namespace pelt::testing
