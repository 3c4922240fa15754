// Two characters of the scene `tiny` that differ in place and moment, for tests of what one may do
// to the other.
#pragma once

#include "tests/jobs/tiny_scene.hpp"
#include "traces/digest.hpp"

namespace pelt::testing {

inline Scenario PairScenario() {
  Scenario scenario = TinyScenario();
  scenario.actors[0].teleport_frame = -1;
  scenario.actors.push_back(scenario.actors[0]);
  scenario.actors[1].phase_s += 0.31;
  scenario.actors[1].placement[3] += glm::vec4(0.4f, 0.0f, 0.1f, 0.0f);
  return scenario;
}

// Digest of all value streams of one character, lane by lane.
inline uint64_t DigestCharacter(const FurScene& scene, uint32_t character) {
  const SceneShape& shape = scene.shape();
  Digest digest;
  for (uint32_t s = 0; s < kStreamCount; ++s) {
    const StreamDesc& desc = DescribeStream(Stream(s));
    if (desc.role != Role::kValue || desc.domain == Domain::kScene) continue;
    for (uint32_t i = 0; i < shape.ItemCount(desc.domain); ++i) {
      const uint32_t owner = desc.domain == Domain::kCharacter
                                 ? i
                                 : shape.layer_character[shape.LayerOf(desc.domain, i)];
      const std::byte* block = scene.memory().Block(Stream(s), i);
      if (owner != character || !block) continue;
      AddBlock(digest, desc, block, scene.LiveLanes(Stream(s), i));
    }
  }
  return digest.Value();
}

}  // namespace pelt::testing
