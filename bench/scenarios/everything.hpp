// The scene `everything`: a character with every kind of layer, on a course on which everything happens that may.
//
// A ball strikes it, grounds and capsules rub it, it is lit and painted; velocities begin and stop, lights and wind come
// and go, a pose is refused, time stands still. What `pelt verify` adds to a scene, so that nothing is left out that this
// scene has not.
#pragma once

#include "bench/scenarios/scenarios.hpp"

namespace pelt {

Scenario MakeEverything(const ScenarioRequest& request, const LoadProgress& progress);

// Puts its character beside those of another scene, with what acts on it alone: strikes, lights, brushes, velocities.
// Weather, wind, view and time are the scene's, and no pose is refused.
void AddEverything(Scenario& scenario, const glm::vec3& at);

}  // namespace pelt
