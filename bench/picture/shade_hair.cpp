#include "bench/picture/shade_hair.hpp"

#include <algorithm>

namespace pelt {

HairEnd ShadeKnot(const Hair& hair, uint32_t k, const LightSet& light, const HairLook& look,
                  float depth_light, float sun_share, const Projection& projection) {
  const float t = float(k) / float(hair.knots - 1);
  const glm::vec3 at = hair.knot[k].at;
  const glm::vec3 along =
      hair.knot[std::min(k + 1, hair.knots - 1)].at - hair.knot[k ? k - 1 : 0].at;
  HairPoint point{
      .colour = glm::mix(LinearColour(hair.base_colour), LinearColour(hair.tip_colour), t),
      .tangent = along / std::max(glm::length(along), 1e-9f),
      .normal = hair.normal,
      .to_eye = glm::normalize(projection.eye() - at),
      .depth_light = depth_light,
      .sun_share = sun_share,
      .noise = StrandNoise(hair.number, t, kNoiseKnots)};
  HairLook painted = look;
  if (hair.paint != glm::vec4(0.0f)) {
    const glm::vec4 seen = SeenPaint(hair.paint, hair.normal, point.noise);
    point.colour = PaintedColour(hair.paint_look, point.colour, seen);
    painted = PaintedHair(look, seen);
  }
  const glm::vec3 screen = projection.Project(at);
  return {screen, ShadeHair(light, painted, point),
          hair.knot[k].width * projection.SamplesPerMetre(screen.z)};
}

}  // namespace pelt
