// The terms that hair is lit by, each a function of its own; strand_light.hpp puts them together.
// Directions are unit and point away from the place; lengths are metres, colours linear radiance.
// shaders/strand_shading.glsl has the same functions, by the same names.
//
// Source: Kajiya & Kay, "Rendering Fur with Three Dimensional Textures", 1989; Scheuermann, "Practical Real-Time
// Hair Rendering and Shading", 2004; Marschner et al., "Light Scattering from Human Hair Fibers", 2003 (what passes
// through); Zinke et al., "Dual Scattering Approximation", 2008 (what is scattered on). The shadow terms are those of
// Once Upon a Monster.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <glm/glm.hpp>

namespace pelt {

inline float Saturate(float x) { return std::clamp(x, 0.0f, 1.0f); }

// sin(T, L) for unit tangent and direction to the light; 1 across the hair. It has no back face: shadow has to be its own.
inline float HairDiffuse(const glm::vec3& tangent, const glm::vec3& to_light) {
  const float along = glm::dot(tangent, to_light);
  return std::sqrt(std::max(0.0f, 1.0f - along * along));
}

// The tangent of the hair's scales: leaning by `shift` along the skin's normal at the root.
inline glm::vec3 ShiftTangent(const glm::vec3& tangent, const glm::vec3& normal, float shift) {
  return glm::normalize(tangent + shift * normal);
}

// Halfway between two directions; short, but no NaN, where they are opposite.
inline glm::vec3 Halfway(const glm::vec3& a, const glm::vec3& b) {
  const glm::vec3 sum = a + b;
  return sum / std::max(glm::length(sum), 1e-6f);
}

// A highlight: sin(T, H)^exponent, H halfway between light and eye, none where H looks down the hair.
inline float HairLobe(const glm::vec3& tangent, const glm::vec3& halfway, float exponent) {
  const float along = glm::dot(tangent, halfway);
  const float across = std::max(1.0f - along * along, 1e-12f);
  return glm::smoothstep(-1.0f, 0.0f, along) * std::pow(across, 0.5f * exponent);
}

// (n.l + wrap) / (1 + wrap): light that reaches round a rounded thing.
inline float WrapDiffuse(float n_dot_l, float wrap) {
  return Saturate((n_dot_l + wrap) / (1.0f + wrap));
}

// (1 - |n.v|)^exponent: what glows at the outline.
inline float Rim(const glm::vec3& normal, const glm::vec3& to_eye, float exponent) {
  return std::pow(Saturate(1.0f - std::abs(glm::dot(normal, to_eye))), exponent);
}

// Share of the rim that a place has whose normal is off the rim's axis; `from` 0: all of it everywhere.
inline float RimFrom(const glm::vec3& normal, const glm::vec3& axis, float from) {
  return glm::mix(1.0f, 0.5f + 0.5f * glm::dot(normal, axis), from);
}

// Light with a rim, which may be negative: it darkens the outline, but light stays 0 or more.
inline glm::vec3 AddRim(const glm::vec3& light, const glm::vec3& rim) {
  return glm::max(light + rim, glm::vec3(0.0f));
}

// Light dies away towards the skin: `floor` of it is left there, all of it `depth` above. Skin below hair is as
// dark as the floor.
inline float DepthShadow(const glm::vec3& position, const glm::vec3& root, const glm::vec3& normal,
                         float depth, float floor) {
  const float height = Saturate(glm::dot(position - root, normal) / depth);
  return floor + (1.0f - floor) * std::pow(height, 0.8f);
}

// Share of light that gets through what a shadow map has before a place: `behind` is how far the place lies behind
// the nearest thing, `coverage` the sum of what covers the texel (above 1 counts as 1), `falloff` is 1/m.
inline float SelfShadow(float coverage, float behind, float bias, float falloff, float strength) {
  const float thick = 1.0f - std::exp(-falloff * std::max(0.0f, behind - bias));
  return 1.0f - strength * std::min(coverage, 1.0f) * thick;
}

// Seen against the light, hair glows: sin(T, L) (-l.v)^exponent.
inline float Backlight(const glm::vec3& tangent, const glm::vec3& to_light, const glm::vec3& to_eye,
                       float exponent) {
  const float against = Saturate(-glm::dot(to_light, to_eye));
  return HairDiffuse(tangent, to_light) * std::pow(against, exponent);
}

// Colour of light that went through a hair, half the way that reflected light goes.
inline glm::vec3 TransmittedColour(const glm::vec3& colour) { return glm::sqrt(colour); }

// Colour of light that many hairs passed on: the deeper inside, `occlusion` 0 to 1, the more often it met the
// colour. White stays white.
inline glm::vec3 MultipleScatter(const glm::vec3& colour, float occlusion, float k) {
  return glm::pow(colour, glm::vec3(1.0f + k * occlusion));
}

// A hair of this coverage over what is there.
inline glm::vec3 Over(const glm::vec3& colour, float coverage, const glm::vec3& below) {
  return colour * coverage + below * (1.0f - coverage);
}

// Between sRGB and linear, 0 to 1 (IEC 61966-2-1).
inline float LinearFromSrgb(float v) {
  return v <= 0.04045f ? v / 12.92f : std::pow((v + 0.055f) / 1.055f, 2.4f);
}
inline float SrgbFromLinear(float v) {
  return v <= 0.0031308f ? 12.92f * v : 1.055f * std::pow(v, 1.0f / 2.4f) - 0.055f;
}

// Signed normalised: the low half of a word.
inline float Snorm16(uint32_t word) {
  return std::max(float(int16_t(word & 0xffffu)) / 32767.0f, -1.0f);
}

// A unit vector from LookRecord::normal.
inline glm::vec3 OctahedralNormal(uint32_t packed) {
  const float x = Snorm16(packed), y = Snorm16(packed >> 16u);
  const float z = 1.0f - std::abs(x) - std::abs(y), fold = std::max(-z, 0.0f);
  return glm::normalize(
      glm::vec3(x >= 0.0f ? x - fold : x + fold, y >= 0.0f ? y - fold : y + fold, z));
}

// Even in [0, 1), by whole numbers alone (Wellons' lowbias32): the same on each machine.
inline float HashShare(uint32_t x) {
  x = (x ^ x >> 16u) * 0x7feb352du;
  x = (x ^ x >> 15u) * 0x846ca68bu;
  return float((x ^ x >> 16u) >> 8u) * (1.0f / 16777216.0f);
}

// Of noise along a hair, as pictures have it.
inline constexpr float kNoiseKnots = 3.0f;
// Noise along a hair, 0 to 1, of `knots` values from root (t 0) to tip (t 1), to break highlights up.
inline float StrandNoise(uint32_t strand, float t, float knots) {
  const float at = t * knots, low = std::floor(at);
  const uint32_t place = strand * 64u + uint32_t(low);
  return glm::mix(HashShare(place), HashShare(place + 1u), at - low);
}

}  // namespace pelt
