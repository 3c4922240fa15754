// The lights of a fur setup: the keys of its [lights], and the form that a frame takes them in.
#include "core/float_environment.hpp"
#include "core/float_rules.hpp"
#include "core/groom/setup_entries.hpp"

namespace pelt {
namespace {

using setup_entries::kReachLimit;
using setup_entries::Number;
using setup_entries::Plain;
using setup_entries::Required;
using setup_entries::Text;

constexpr double kBrightest = 1000.0;  // of a light's colour

// A place or a direction; a colour, linear.
template <auto kMember>
auto Place(Text key, Text doc) {
  return Plain<kMember>(key, "[x, y, z]", doc, -kReachLimit, kReachLimit);
}
template <auto kMember>
auto LinearColour(Text key, Text doc, double low = 0.0) {
  return Plain<kMember>(key, "[r, g, b]", doc, low, kBrightest);
}

}  // namespace

template <>
std::span<const KeyEntry<LightsSetup>> Schema() {
  using S = LightsSetup;
  static const KeyEntry<S> kEntries[] = {
      Plain<&S::lights>("light", "tables", "points and balls that shine", 0,
                        double(kLightsPerScene)),
      Plain<&S::samples>("sample", "tables", "the surroundings as seen from places", 0,
                         double(kIrradianceSamplesPerScene)),
      Plain<&S::sun>("sun", "table", "light from one side"),
      Plain<&S::rim>("rim", "table", "light at the outline"),
  };
  return kEntries;
}

template <>
std::span<const KeyEntry<LightsSetup::Light>> Schema() {
  using S = LightsSetup::Light;
  static const KeyEntry<S> kEntries[] = {
      Required(Place<&S::position>("position", "m, world")),
      Number<&S::radius>("radius", "m", 0, kReachLimit, "of a ball; 0: a point"),
      LinearColour<&S::colour>("colour", "linear; irradiance of what faces it, at 1 m"),
      Number<&S::range>("range", "m", 0, kReachLimit, "it falls to 0 there; 0: nowhere"),
  };
  return kEntries;
}

template <>
std::span<const KeyEntry<LightsSetup::Sample>> Schema() {
  using S = LightsSetup::Sample;
  static const KeyEntry<S> kEntries[] = {
      Required(Place<&S::position>("position", "m, world")),
      Number<&S::falloff>("falloff", "m", 1e-3, kReachLimit, "its weight falls to 0 there"),
      LinearColour<&S::sky>("sky", "linear radiance from above"),
      LinearColour<&S::ground>("ground", "and from below"),
      Place<&S::up>("up", "any length but 0"),
  };
  return kEntries;
}

template <>
std::span<const KeyEntry<LightsSetup::Sun>> Schema() {
  using S = LightsSetup::Sun;
  static const KeyEntry<S> kEntries[] = {
      Place<&S::direction>("direction", "towards it; any length but 0"),
      Required(LinearColour<&S::colour>("colour", "linear; what white that faces it reflects")),
  };
  return kEntries;
}

template <>
std::span<const KeyEntry<LightsSetup::Rim>> Schema() {
  using S = LightsSetup::Rim;
  static const KeyEntry<S> kEntries[] = {
      Place<&S::direction>("direction", "the side that has it; any length but 0"),
      Required(LinearColour<&S::colour>("colour", "linear; below 0: darkens", -kBrightest)),
      Number<&S::exponent>("exponent", "", 0, kBrightest, "of 1 - |normal . view|"),
  };
  return kEntries;
}

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
