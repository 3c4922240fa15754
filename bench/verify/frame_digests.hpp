// The digests of a scene after a frame, one for each stream: values, and the bookkeeping of what
// ran.
#pragma once

#include <array>
#include <vector>

#include "jobs/scene.hpp"

namespace pelt {

using StreamDigests = std::array<uint64_t, kStreamCount>;
using Course = std::vector<StreamDigests>;  // by frame

StreamDigests DigestsOf(const FurScene& scene);

// Which streams two scenes must agree on.
struct Agreement {
  bool vertices = true;     // their layout depends on the vertex order
  bool bookkeeping = true;  // depends on what is skipped, not on what runs it
};
bool SameDigests(const StreamDigests& a, const StreamDigests& b, const Agreement& agreement);

// Of one layer's part of every value stream of layers and chunks; without what brushes have left on a
// painted layer, which outlasts a time out of view as nothing else does.
enum class LayerPart : uint8_t { kAll, kWithoutPaint };
uint64_t DigestLayer(const FurScene& scene, uint32_t layer, LayerPart part = LayerPart::kAll);

}  // namespace pelt
