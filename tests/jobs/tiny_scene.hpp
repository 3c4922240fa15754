// The scene `tiny` for tests of whole frames: every solver and chain in under a thousand
// strands. Baked once a program.
#pragma once

#include <gtest/gtest.h>

#include <functional>
#include <string>
#include <vector>

#include "bench/scenarios/scenarios.hpp"
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

// `tiny` with every other layer of ribbons as lines, so that there are layers of every output, and
// every other layer lit; the scene itself has none, as its digests are kept.
inline Scenario EveryOutputScenario() {
  Scenario scenario = TinyScenario();
  scenario.base.lighting = TinyLighting();
  uint32_t ribbons = 0, layers = 0;
  for (Groom& groom : scenario.grooms)
    for (GroomLayer& layer : groom.layers) {
      layer.params.lit = layers++ % 2 == 0;
      if (layer.params.output == Output::kRibbons && ribbons++ % 2 == 0)
        layer.params.output = Output::kLines;
    }
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
