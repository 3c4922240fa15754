// The scene that a verification runs: the user's, with what its checks need to have something to
// look at.
//
// A scene of one character gets a second beside it, which differs in everything that a kernel could
// take from the wrong one: other layers in another order, other skeleton, pose, place and weather.
// And values that a thread which flushes denormals would change: strands too thin to be normal
// numbers, and a joint as little out of place.
//
// Invariant: characters that were there are what they were, bit for bit, but for the denormals in
// the last one of a scene that had several.
#pragma once

#include "bench/scenarios/scenarios.hpp"

namespace pelt {

Scenario MakeVerifiedScene(const Scenario& scenario);

// That, and the character of `everything`, on whose course there is what the scene has not
// (bench/scenarios/made_scenes.hpp); where it is about as large as what is in the scene's view.
Scenario WithEverything(const Scenario& verified);
bool HasRoomForEverything(const Scenario& scenario);

}  // namespace pelt
