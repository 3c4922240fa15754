// The cast: 17 different characters in rows, 166 layers, over 100,000 strands. The setups are
// written here, as variations of the monster's: no two characters have the same coat, size, colours
// or step.
#pragma once

#include "bench/scenarios/scenarios.hpp"

namespace pelt {

inline constexpr uint32_t kCastCharacters = 17;
inline constexpr uint32_t kCastLayers = 166;

Scenario MakeCast(const ScenarioRequest& request, const LoadProgress& progress);

}  // namespace pelt
