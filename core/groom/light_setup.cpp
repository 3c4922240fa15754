#include "core/groom/light_setup.hpp"

#include "core/float_environment.hpp"
#include "core/float_rules.hpp"

namespace pelt {
namespace {

void Copy(const glm::vec3& from, float (&to)[3]) {
  for (int k = 0; k < 3; ++k) to[k] = from[k];
}
// Of a direction that is not 0, which the reader sees to.
void CopyUnit(const glm::vec3& from, float (&to)[3]) {
  const glm::dvec3 wide(from);
  Copy(glm::vec3(wide / glm::length(wide)), to);
}

}  // namespace

Lighting MakeLighting(const LightsSetup& setup) {
  const FloatEnvironment guard;
  Lighting out;
  for (const LightsSetup::Light& light : setup.lights) {
    SphereLight& to = out.light[out.light_count++];
    Copy(light.position, to.position);
    to.radius = light.radius;
    Copy(light.colour, to.rgb);
    to.range = light.range;
  }
  for (const LightsSetup::Sample& sample : setup.samples) {
    IrradianceSample& to = out.sample[out.sample_count++];
    Copy(sample.position, to.position);
    to.falloff = sample.falloff;
    Copy(sample.sky, to.sky);
    Copy(sample.ground, to.ground);
    CopyUnit(sample.up, to.up);
  }
  CopyUnit(setup.sun.direction, out.sun_direction);
  Copy(setup.sun.colour, out.sun_rgb);
  CopyUnit(setup.rim.direction, out.rim_direction);
  Copy(setup.rim.colour, out.rim_rgb);
  out.rim_exponent = setup.rim.exponent;
  return out;
}

}  // namespace pelt
