// How the numbers of vertices are read (jobs/DRAWING.md): one text that is GLSL, HLSL (fur_vertex.hlsl) and C++
// (bench/shading/shading.hpp).
#ifndef FN
#define FN
#endif

// From sRGB to linear, 0 to 1 (IEC 61966-2-1); of a colour, alpha stays.
FN float LinearFromSrgb(float v) {
  return v <= 0.04045f ? v / 12.92f : pow((v + 0.055f) / 1.055f, 2.4f);
}
FN vec4 LinearFromSrgb(vec4 c) {
  return vec4(LinearFromSrgb(c.x), LinearFromSrgb(c.y), LinearFromSrgb(c.z), c.w);
}

// Linear, at t from base, 0, to tip, 1.
FN vec4 HairColour(vec4 base, vec4 tip, float t) {
  return mix(LinearFromSrgb(base), LinearFromSrgb(tip), t);
}

// Four unsigned bytes, normalised.
FN vec4 Unorm8x4(uint word) {
  return vec4(float(word & 255u), float(word >> 8u & 255u), float(word >> 16u & 255u),
              float(word >> 24u)) / 255.0f;
}

// Signed normalised: the low half of a word; both halves, the low one first.
FN float Snorm16(uint word) { return max(float(int(word << 16u) >> 16) / 32767.0f, -1.0f); }
FN vec2 Snorm16x2(uint word) { return vec2(Snorm16(word), Snorm16(word >> 16u)); }

FN vec3 NormalizeOr(vec3 a, vec3 otherwise) {
  float squared = dot(a, a);
  return squared > 1e-20f ? a * inversesqrt(squared) : otherwise;
}

// A unit vector from ShellVertex::normal or LookRecord::normal.
FN vec3 OctahedralNormal(vec2 at) {
  float z = 1.0f - abs(at.x) - abs(at.y), fold = max(-z, 0.0f);
  return normalize(vec3(at.x >= 0.0f ? at.x - fold : at.x + fold,
                        at.y >= 0.0f ? at.y - fold : at.y + fold, z));
}
FN vec3 OctahedralNormal(uint word) { return OctahedralNormal(Snorm16x2(word)); }

// Instances: a cubic from the record's first 48 bytes, t from 0 at the root to 1 at the tip.
struct Curve {
  vec3 c0, c1, c2, c3;
};
FN Curve UnpackCurve(vec4 a, vec4 b, vec4 c) {
  Curve curve;
  curve.c0 = vec3(a.x, a.y, a.z);
  curve.c1 = vec3(a.w, b.x, b.y);
  curve.c2 = vec3(b.z, b.w, c.x);
  curve.c3 = vec3(c.y, c.z, c.w);
  return curve;
}
FN vec3 CurvePoint(Curve c, float t) { return c.c0 + t * (c.c1 + t * (c.c2 + t * c.c3)); }
FN vec3 CurveTangent(Curve c, float t) {
  return NormalizeOr(c.c1 + t * (2.0f * c.c2 + t * 3.0f * c.c3), vec3(0.0f, 1.0f, 0.0f));
}
// Whole, m, from that at the root and the draw's tip_width.
FN float CurveWidth(float width, float tip_width, float t) {
  return width * (1.0f + (tip_width - 1.0f) * t);
}

// Lines: tangent, and v from root to tip. Of instances as well: the film strip.
FN vec4 LineTangent(uvec2 tangent_v) {
  return vec4(Snorm16x2(tangent_v.x), Snorm16x2(tangent_v.y));
}
FN uint StripOfTag(uint tag) { return tag >> 24u; }

// Ribbons, from the last word: u across the hair and v from root to tip; the film strip.
FN vec2 RibbonPlace(uint word) {
  return vec2(float(word & 255u) / 255.0f, float(word >> 16u) / 65535.0f);
}
FN uint StripOfRibbon(uint word) { return word >> 8u & 255u; }

// Strips that face the eye: the unit vector across a hair as it is seen, and a corner, on side 0 or 1.
FN vec3 AcrossView(vec3 tangent, vec3 to_eye) {
  return NormalizeOr(cross(tangent, to_eye), vec3(1.0f, 0.0f, 0.0f));
}
FN vec3 StripCorner(vec3 at, vec3 tangent, float width, vec3 eye, float side) {
  return at + AcrossView(tangent, eye - at) * (0.5f * width * (2.0f * side - 1.0f));
}

// Shells and fins: where a vertex is at a height of 0, the skin, to 1, the tips; and its derivative, along the hairs.
FN vec3 ShellPosition(vec3 position, vec3 groom, vec3 force, float height) {
  return position + height * (groom + height * force);
}
FN vec3 ShellSlope(vec3 groom, vec3 force, float height) { return groom + 2.0f * height * force; }

// The published wind at a place, m/s: its mean and two waves, each a strength, turns a metre, and turns at 0
// (pelt_wind_waves).
FN float WindWave(vec3 wave, float at) {
  float turns = wave.y * at + wave.z;
  return wave.x * sin(6.28318531f * (turns - floor(turns)));
}
FN vec3 PublishedWind(vec3 place, vec3 mean, vec3 along_x, vec3 along_z) {
  return mean + vec3(WindWave(along_x, place.x), 0.0f, WindWave(along_z, place.z));
}

// How far fur of such a length, m, is bent by an acceleration, m/s^2; stiffness and cone, of the exact kind, are the
// setup's.
FN vec3 ShellBend(vec3 acceleration, vec3 normal, float stiffness, float cone, float fur_length) {
  vec3 force = acceleration * ((1.0f - stiffness) / 9.80665f);
  float size = length(force);
  force = force / max(size, 1.0f);
  size = min(size, 1.0f);
  float lean = dot(force, normal);
  if (lean < cone * size) {
    vec3 axis = abs(normal.x) < 0.6f ? vec3(1.0f, 0.0f, 0.0f) : vec3(0.0f, 1.0f, 0.0f);
    vec3 side = NormalizeOr(force - normal * lean, normalize(cross(normal, axis)));
    force = (normal * cone + side * sqrt(1.0f - cone * cone)) * size;
  }
  return force * fur_length;
}
