// Scenes that are made by rules.
#pragma once

#include "bench/scenarios/scenarios.hpp"

namespace pelt {

// The cast: 17 different characters in rows, 166 layers, over 100,000 strands: all that a game has. The
// setups are written here, as variations of the monster's: no two characters have the same coat, size,
// colours or step.
inline constexpr uint32_t kCastCharacters = 17;
inline constexpr uint32_t kCastLayers = 166;
Scenario MakeCast(const ScenarioRequest& request, const LoadProgress& progress);

// The stage: six of them at 4 to 5 m, 60 layers, about 36,000 strands, which walk and greet: what is
// on the screen at a time. With level of detail.
inline constexpr uint32_t kStageCharacters = 6;
Scenario MakeStage(const ScenarioRequest& request, const LoadProgress& progress);

// The scene `everything`: a character with every kind of layer, on a course on which everything happens that may.
//
// A ball strikes it, grounds and capsules rub it, it is lit and painted; velocities begin and stop, lights and wind
// come and go, a pose is refused, time stands still. What `pelt verify` adds to a scene, so that nothing is left out
// that this scene has not.
Scenario MakeEverything(const ScenarioRequest& request, const LoadProgress& progress);

// Puts its character beside those of another scene, with what acts on it alone: strikes, lights, brushes, velocities.
// Weather, wind, view and time are the scene's, and no pose is refused.
void AddEverything(Scenario& scenario, const glm::vec3& at);

}  // namespace pelt
