// The functions of strand_shading.hpp, which says what they are and where they come from.
// GLSL 3.30 core and ES 3.00; the host puts the version line.
precision highp float;
precision highp int;

const float kNoiseKnots = 3.0;

float Saturate(float x) { return clamp(x, 0.0, 1.0); }

float HairDiffuse(vec3 tangent, vec3 to_light) {
  float along = dot(tangent, to_light);
  return sqrt(max(0.0, 1.0 - along * along));
}

vec3 ShiftTangent(vec3 tangent, vec3 normal, float shift) {
  return normalize(tangent + shift * normal);
}

vec3 Halfway(vec3 a, vec3 b) {
  vec3 sum = a + b;
  return sum / max(length(sum), 1e-6);
}

float HairLobe(vec3 tangent, vec3 halfway, float exponent) {
  float along = dot(tangent, halfway);
  float across = max(1.0 - along * along, 1e-12);  // pow of 0 is not defined everywhere
  return smoothstep(-1.0, 0.0, along) * pow(across, 0.5 * exponent);
}

float WrapDiffuse(float n_dot_l, float wrap) { return Saturate((n_dot_l + wrap) / (1.0 + wrap)); }

float Rim(vec3 normal, vec3 to_eye, float exponent) {
  return pow(Saturate(1.0 - abs(dot(normal, to_eye))), exponent);
}

float RimFrom(vec3 normal, vec3 axis, float from) {
  return mix(1.0, 0.5 + 0.5 * dot(normal, axis), from);
}

vec3 AddRim(vec3 light, vec3 rim) { return max(light + rim, vec3(0.0)); }

float DepthShadow(vec3 position, vec3 root, vec3 normal, float depth, float floor_light) {
  float height = Saturate(dot(position - root, normal) / depth);
  return floor_light + (1.0 - floor_light) * pow(height, 0.8);
}

float SelfShadow(float coverage, float behind, float bias, float falloff, float strength) {
  float thick = 1.0 - exp(-falloff * max(0.0, behind - bias));
  return 1.0 - strength * min(coverage, 1.0) * thick;
}

float Backlight(vec3 tangent, vec3 to_light, vec3 to_eye, float exponent) {
  float against = Saturate(-dot(to_light, to_eye));
  return HairDiffuse(tangent, to_light) * pow(against, exponent);
}

vec3 TransmittedColour(vec3 colour) { return sqrt(colour); }

vec3 MultipleScatter(vec3 colour, float occlusion, float k) {
  return pow(colour, vec3(1.0 + k * occlusion));
}

vec3 Over(vec3 colour, float coverage, vec3 below) {
  return colour * coverage + below * (1.0 - coverage);
}

float LinearFromSrgb(float v) {
  return v <= 0.04045 ? v / 12.92 : pow((v + 0.055) / 1.055, 2.4);
}
float SrgbFromLinear(float v) {
  return v <= 0.0031308 ? 12.92 * v : 1.055 * pow(v, 1.0 / 2.4) - 0.055;
}

float Snorm16(uint word) { return max(float(int(word << 16u) >> 16) / 32767.0, -1.0); }

vec3 OctahedralNormal(uint packed_normal) {
  float x = Snorm16(packed_normal), y = Snorm16(packed_normal >> 16u);
  float z = 1.0 - abs(x) - abs(y), fold = max(-z, 0.0);
  return normalize(vec3(x >= 0.0 ? x - fold : x + fold, y >= 0.0 ? y - fold : y + fold, z));
}

float HashShare(uint x) {
  x = (x ^ (x >> 16u)) * 0x7feb352du;
  x = (x ^ (x >> 15u)) * 0x846ca68bu;
  return float((x ^ (x >> 16u)) >> 8u) * (1.0 / 16777216.0);
}

float StrandNoise(uint strand, float t, float knots) {
  float at = t * knots, low = floor(at);
  uint place = strand * 64u + uint(low);
  return mix(HashShare(place), HashShare(place + 1u), at - low);
}
