#include "bench/scenarios/scene_lights.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <span>

#include "bench/scenarios/embedded_files.hpp"
#include "core/error.hpp"

namespace pelt {
namespace {

constexpr std::string_view kStudioLights = "lamps";

bool IsBlack(const float (&rgb)[3]) { return !(rgb[0] || rgb[1] || rgb[2]); }

bool IsDark(const Lighting& in) {
  const std::span lights(in.light, in.light_count);
  const std::span samples(in.sample, in.sample_count);
  return IsBlack(in.sun_rgb) && IsBlack(in.rim_rgb) &&
         std::ranges::all_of(lights, [](const SphereLight& l) { return IsBlack(l.rgb); }) &&
         std::ranges::all_of(samples, [](const IrradianceSample& s) {
           return IsBlack(s.sky) && IsBlack(s.ground);
         });
}

bool HasLitLayer(const Groom& groom) {
  return std::ranges::any_of(groom.layers, [](const GroomLayer& l) { return l.params.lit; });
}

}  // namespace

Lighting LoadLights(const std::string& name_or_path) {
  const EmbeddedFile* found = NamedOrPath(EmbeddedLights(), "lights", name_or_path);
  const Lighting lights = MakeLighting(found ? ReadLights(found->text, name_or_path + ".toml")
                                             : ReadLightsFile(name_or_path));
  if (IsDark(lights)) throw Error(fmt::format("{}: all of its [lights] are black", name_or_path));
  return lights;
}

void LightAll(Scenario& scenario, const Lighting& lights) {
  scenario.base.lighting = lights;
  for (Groom& groom : scenario.grooms)
    for (GroomLayer& layer : groom.layers) layer.params.lit = true;
}

void CompleteLights(Scenario& scenario) {
  const bool is_lit = std::ranges::any_of(scenario.grooms, HasLitLayer);
  const bool is_dark = IsDark(scenario.base.lighting);
  if (is_lit && is_dark) scenario.base.lighting = LoadLights(std::string(kStudioLights));
  if (!is_lit && !is_dark)
    scenario.notes.push_back("[lights] light no layer: none of the setup has lit = true");
}

}  // namespace pelt
