// A scene and its course, drawn from a seed: setups within the bounds of the schema's entries, and inputs of every kind
// that a frame takes.
//
// A key that gets an entry (layer_params.hpp, fur_setup.hpp) is drawn from then on. Most values are usual ones or about
// them, so that fur moves as fur does; some are at a bound or anywhere between.
//
// Invariant: the same seed gives the same bits on every machine (core/random.hpp, no libm).
#pragma once

#include <cstdint>
#include <string>

#include "bench/scenarios/scenarios.hpp"

namespace pelt {

inline constexpr uint32_t kDrawnFrames = 60;

struct RandomScene {
  Scenario scenario;
  LodSettings lod;
  SkipSettings skip;  // what changes the picture: culling, LOD
  std::string text;   // "3 layers, 412 strands, velocities"
};

RandomScene DrawScene(uint64_t seed);

// The layer's keys that are not what they are when unsaid, as a setup has them: what a finding is about.
std::string DescribeDrawn(const LayerParams& params);

}  // namespace pelt
