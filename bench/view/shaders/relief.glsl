// The functions of relief.hpp, which says what they are and where they come from.
// GLSL 3.30 core and ES 3.00; the host puts the version line and these files before it:
// After: strand_shading.glsl
precision highp float;
precision highp int;

// A height of the tile of hairs; a host that has other heights defines it before.
#ifndef RELIEF_HEIGHT
precision highp sampler2D;
uniform sampler2D relief_heights;
#define RELIEF_HEIGHT(place) textureLod(relief_heights, place, 0.0).r
#endif

const float kReliefLowest = 0.2;

vec3 ReliefFlow(vec4 texel) {
  vec2 lean = (texel.xy * 255.0 - 128.0) / 127.0;
  return vec3(lean, sqrt(max(1.0 - dot(lean, lean), 0.0)));
}

float ReliefSteps(vec3 flow, vec3 view, float least, float most) {
  return max(least, least + (most - least) * (1.0 - dot(flow, view)));
}

vec2 ReliefShift(vec3 flow, vec3 view, float depth) {
  return (view.xy / max(view.z, kReliefLowest) - flow.xy / max(flow.z, kReliefLowest)) * depth;
}

vec3 ReliefHit(vec2 entry, vec2 shift, float steps) {
  int count = int(ceil(steps));
  float step_size = 1.0 / float(count);
  float last = 1.0 - RELIEF_HEIGHT(entry);
  for (int i = 1; i <= count; ++i) {
    float sunk = float(i) * step_size;
    float above = 1.0 - sunk - RELIEF_HEIGHT(entry - shift * sunk);
    if (above <= 0.0) {
      float met = sunk - step_size * above / min(above - last, -1e-6);
      return vec3(entry - shift * met, 1.0 - met);
    }
    last = above;
  }
  return vec3(entry - shift, 0.0);
}

float ReliefAmbient(float height, float floor_light) {
  return floor_light + (1.0 - floor_light) * height;
}

float ReliefShadow(vec3 hit, vec2 shift, float strength) {
  float most = 0.0;
  for (int i = 1; i <= 4; ++i) {
    float rise = (1.0 - hit.z) * 0.25 * float(i);
    most = max(most, RELIEF_HEIGHT(hit.xy + shift * rise) - hit.z - rise);
  }
  return 1.0 - strength * Saturate(4.0 * most);
}

float SheenCharlie(float n_dot_h, float roughness) {
  float across = max(1.0 - n_dot_h * n_dot_h, 1e-6);
  return (2.0 + 1.0 / roughness) * pow(across, 0.5 / roughness) * 0.15915494;
}

float SheenAshikhmin(float n_dot_h, float roughness) {
  float rough = roughness * roughness, along = n_dot_h * n_dot_h;
  float across = max(1.0 - along, 0.0078125);
  float hollow = 4.0 * exp(-along / (rough * across));
  return (hollow / (across * across) + 1.0) / (3.14159265 * (4.0 * rough + 1.0));
}

float SheenVisibility(float n_dot_v, float n_dot_l) {
  return 1.0 / (4.0 * max(n_dot_l + n_dot_v - n_dot_l * n_dot_v, 1e-4));
}

float Fresnel(float cosine, float at_normal) {
  return at_normal + (1.0 - at_normal) * pow(Saturate(1.0 - cosine), 5.0);
}

float ReliefSheen(vec3 normal, vec3 to_light, vec3 to_eye, float roughness) {
  vec3 halfway = Halfway(to_light, to_eye);
  float n_dot_l = Saturate(dot(normal, to_light));
  float n_dot_v = Saturate(dot(normal, to_eye));
  return SheenCharlie(Saturate(dot(normal, halfway)), roughness) *
         SheenVisibility(n_dot_v, n_dot_l) * Fresnel(n_dot_v, 0.04) *
         n_dot_l * 3.14159265;
}
