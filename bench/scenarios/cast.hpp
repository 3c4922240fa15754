// The cast: 17 different characters in rows, 166 layers, over 100,000 strands: all that a game has. The
// setups are written here, as variations of the monster's: no two characters have the same coat, size,
// colours or step.
//
// The stage: six of them at 4 to 5 m, 60 layers, about 36,000 strands, which walk and greet: what is
// on the screen at a time. With level of detail.
#pragma once

#include "bench/scenarios/scenarios.hpp"

namespace pelt {

inline constexpr uint32_t kCastCharacters = 17;
inline constexpr uint32_t kCastLayers = 166;
inline constexpr uint32_t kStageCharacters = 6;

Scenario MakeCast(const ScenarioRequest& request, const LoadProgress& progress);
Scenario MakeStage(const ScenarioRequest& request, const LoadProgress& progress);

}  // namespace pelt
