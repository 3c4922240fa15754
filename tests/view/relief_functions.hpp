// The functions of relief.hpp and film_strip.hpp for shader_values_test.cpp.
#pragma once

#include <cmath>
#include <vector>

#include "bench/view/film_strip.hpp"
#include "bench/view/relief_shading.hpp"
#include "tests/view/shader_function.hpp"

namespace pelt {

// A tile of hairs that both languages have.
inline constexpr const char* kHeightText =
    "#define RELIEF_HEIGHT(place) (0.5 + 0.5 * sin(9.0 * (place).x) * cos(7.0 * (place).y))\n";
inline float HeightOf(const glm::vec2& place) {
  return 0.5f + 0.5f * std::sin(9.0f * place.x) * std::cos(7.0f * place.y);
}

inline std::vector<Function> ListReliefFunctions() {
  using A = const Arguments&;
  const char* file = "relief.glsl";
  return {
      {"ReliefFlow", "vec4(ReliefFlow(vec4(0.3 + 0.4 * u.xy, u.zw)), 0.0)",
       [](A a) {
         return Wide(ReliefFlow({0.3f + 0.4f * a.u.x, 0.3f + 0.4f * a.u.y, a.u.z, a.u.w}));
       },
       file},
      {"ReliefSteps", "vec4(ReliefSteps(d.xyz, e.xyz, 2.0, 16.0), 0.0, 0.0, 0.0)",
       [](A a) { return Wide(ReliefSteps(Unit(a.d), Unit(a.e), 2.0f, 16.0f)); }, file},
      {"ReliefShift", "vec4(ReliefShift(d.xyz, e.xyz, u.x), 0.0, 0.0)",
       [](A a) { return glm::vec4(ReliefShift(Unit(a.d), Unit(a.e), a.u.x), 0.0f, 0.0f); }, file},
      {"ReliefHit", "vec4(ReliefHit(u.xy, 0.3 * v.xy, 3.5 + 8.0 * floor(3.0 * u.z)), 0.0)",
       [](A a) {
         return Wide(ReliefHit(HeightOf, glm::vec2(a.u), 0.3f * glm::vec2(a.v),
                               3.5f + 8.0f * std::floor(3.0f * a.u.z)));
       },
       file},
      {"ReliefAmbient", "vec4(ReliefAmbient(u.x, u.y), 0.0, 0.0, 0.0)",
       [](A a) { return Wide(ReliefAmbient(a.u.x, a.u.y)); }, file},
      {"ReliefShadow", "vec4(ReliefShadow(u.xyz, v.xy, 0.75), 0.0, 0.0, 0.0)",
       [](A a) { return Wide(ReliefShadow(HeightOf, glm::vec3(a.u), glm::vec2(a.v), 0.75f)); },
       file},
      {"SheenCharlie", "vec4(SheenCharlie(u.x, 0.2 + 0.8 * u.y), 0.0, 0.0, 0.0)",
       [](A a) { return Wide(SheenCharlie(a.u.x, 0.2f + 0.8f * a.u.y)); }, file},
      {"SheenAshikhmin", "vec4(SheenAshikhmin(u.x, 0.2 + 0.8 * u.y), 0.0, 0.0, 0.0)",
       [](A a) { return Wide(SheenAshikhmin(a.u.x, 0.2f + 0.8f * a.u.y)); }, file},
      {"SheenVisibility", "vec4(SheenVisibility(u.x, u.y), 0.0, 0.0, 0.0)",
       [](A a) { return Wide(SheenVisibility(a.u.x, a.u.y)); }, file},
      {"Fresnel", "vec4(Fresnel(u.x, 0.2 * u.y), 0.0, 0.0, 0.0)",
       [](A a) { return Wide(Fresnel(a.u.x, 0.2f * a.u.y)); }, file},
      {"ReliefSheen",
       "vec4(ReliefSheen(d.xyz, e.xyz, normalize(d.xyz + v.xyz), 0.45), 0.0, 0.0, 0.0)",
       [](A a) {
         return Wide(
             ReliefSheen(Unit(a.d), Unit(a.e), glm::normalize(Unit(a.d) + glm::vec3(a.v)), 0.45f));
       },
       file},
  };
}

// A place on the skin of both languages; axes are neither square nor of a length.
inline ReliefPoint ReliefPointOf(const Arguments& a) {
  const glm::vec3 u(a.u), v(a.v);
  return {.colour = u,
          .tip_colour = glm::abs(v),
          .normal = Unit(a.d),
          .axis_u = 0.4f * Unit(a.e),
          .axis_v = 0.3f * glm::cross(Unit(a.d), Unit(a.e)) + 0.1f * v,
          .uv = glm::vec2(u),
          .repeat = {3.0f, 5.0f},
          .flow = {0.3f + 0.4f * a.u.z, 0.3f + 0.4f * a.u.w, a.u.x, 1.0f},
          .longest = 0.06f,
          .floor = 0.22f,
          .sun_share = a.u.y,
          .to_eye = glm::normalize(Unit(a.d) + 0.7f * v)};
}
#define PELT_RELIEF_POINT                                                                      \
  "ReliefPoint p = ReliefPoint(u.xyz, abs(v.xyz), d.xyz, 0.4 * e.xyz, 0.3 * cross(d.xyz, "     \
  "e.xyz) + 0.1 * v.xyz, u.xy, vec2(3.0, 5.0), vec4(0.3 + 0.4 * u.zw, u.x, 1.0), 0.06, 0.22, " \
  "u.y, normalize(d.xyz + 0.7 * v.xyz)); "

// `lights` and `look` are those that the shader's text has.
template <class Lights>
std::vector<Function> ListReliefShading(const Lights& lights, const HairLook& look) {
  using A = const Arguments&;
  const char* file = "relief_shading.glsl";
  const auto frame = [](A a) { return ReliefFrame(ReliefPointOf(a), Unit(a.e)); };
  return {
      {"UnitOr", "vec4(UnitOr(v.xyz, d.xyz) + UnitOr(vec3(0.0), e.xyz), 0.0)",
       [](A a) {
         return Wide(UnitOr(glm::vec3(a.v), Unit(a.d)) + UnitOr(glm::vec3(0.0f), Unit(a.e)));
       },
       file},
      {"InTexture",
       "vec4(InTexture(0.1 * v.xyz, d.xyz, cross(d.xyz, e.xyz) + 0.3 * u.xyz), "
       "InTexture(v.xyz, d.xyz, d.xyz))",
       [](A a) {
         const glm::vec3 v(a.v), across = glm::cross(Unit(a.d), Unit(a.e)) + 0.3f * glm::vec3(a.u);
         return glm::vec4(InTexture(0.1f * v, Unit(a.d), across),
                          InTexture(v, Unit(a.d), Unit(a.d)));
       },
       file},
      {"ReliefAlong", PELT_RELIEF_POINT "vec4(ReliefAlong(p, vec3(v.xy, 0.5)), 0.0)",
       [](A a) {
         return Wide(ReliefAlong(ReliefPointOf(a), {a.v.x, a.v.y, 0.5f}));
       },
       file},
      {"ReliefFrame", PELT_RELIEF_POINT "vec4(ReliefFrame(p, e.xyz) * v.xyz, 0.0)",
       [=](A a) { return Wide(frame(a) * glm::vec3(a.v)); }, file},
      {"ReliefTileShift",
       PELT_RELIEF_POINT "vec4(ReliefTileShift(p, ReliefFrame(p, e.xyz), normalize(u.xyz), "
                         "p.to_eye, 0.01), 0.0, 0.0)",
       [=](A a) {
         const ReliefPoint p = ReliefPointOf(a);
         const glm::vec3 hair = glm::normalize(glm::vec3(a.u));
         return glm::vec4(ReliefTileShift(p, frame(a), hair, p.to_eye, 0.01f), 0.0f, 0.0f);
       },
       file},
      {"ShadeRelief", PELT_RELIEF_POINT "LIGHT vec4(ShadeRelief(light, look, p), 0.0)",
       [=](A a) { return Wide(ShadeRelief(HeightOf, lights(a), look, ReliefPointOf(a))); }, file},
  };
}
#undef PELT_RELIEF_POINT

inline std::vector<Function> ListStripFunctions() {
  using A = const Arguments&;
  const char* file = "film_strip.glsl";
  const auto strip = [](A a) { return uint32_t(32.0f * a.u.x); };
  const auto hair = [](A a) { return uint32_t(8.0f * a.u.y); };
  return {
      {"StripHairs", "vec4(float(StripHairs(uint(32.0 * u.x))), 0.0, 0.0, 0.0)",
       [=](A a) { return Wide(float(StripHairs(strip(a)))); }, file},
      {"StripTip", "vec4(StripTip(uint(32.0 * u.x), uint(8.0 * u.y)), 0.0, 0.0, 0.0)",
       [=](A a) { return Wide(StripTip(strip(a), hair(a))); }, file},
      {"StripCentre", "vec4(StripCentre(uint(32.0 * u.x), uint(8.0 * u.y), u.z), 0.0, 0.0, 0.0)",
       [=](A a) { return Wide(StripCentre(strip(a), hair(a), a.u.z)); }, file},
      {"StripWidth", "vec4(StripWidth(uint(32.0 * u.x), uint(8.0 * u.y), u.z), 0.0, 0.0, 0.0)",
       [=](A a) { return Wide(StripWidth(strip(a), hair(a), a.u.z)); }, file},
      {"StripCoverage",
       "vec4(StripCoverage(uint(32.0 * u.x), u.y, u.z, 0.02 + 0.5 * u.w), 0.0, 0.0, 0.0)",
       [=](A a) { return Wide(StripCoverage(strip(a), a.u.y, a.u.z, 0.02f + 0.5f * a.u.w)); },
       file},
      {"StripShare", "vec4(StripShare(uint(32.0 * u.x)), 0.0, 0.0, 0.0)",
       [=](A a) { return Wide(StripShare(strip(a))); }, file},
  };
}

}  // namespace pelt
