// What a scene is lit by: its setup's [lights], lights of the user's own, or a studio's.
#pragma once

#include <string>

#include "bench/scenarios/scenarios.hpp"
#include "core/lighting.hpp"

namespace pelt {

// [lights] of a built-in file by name, or of the TOML file at this path; of a whole setup or alone. Throws Error, for
// lights that are all black too.
Lighting LoadLights(const std::string& name_or_path);

// Has every layer lit, by these instead of the scene's own.
void LightAll(Scenario& scenario, const Lighting& lights);

// Where layers are lit and nothing says by what, a studio's lights; a note where there are lights and no lit layer.
void CompleteLights(Scenario& scenario);

}  // namespace pelt
