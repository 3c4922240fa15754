// Shells (jobs/DRAWING.md): 48 bytes a vertex of the skin, and its place on the skin's texture from a
// buffer of its own that never changes; 16 bytes an instance, a shell.
//   vkCmdDrawIndexed(index_count, shell_count, 0, 0, 0)
#version 450

layout(location = 0) in vec3 position;     // offset 0, three floats; m, world
layout(location = 1) in vec4 base_colour;  // offset 12, four unsigned bytes, normalised; sRGB, stencil
layout(location = 2) in vec3 groom;        // offset 16, three floats; m
layout(location = 3) in vec4 tip_colour;   // offset 28, four unsigned bytes, normalised; sRGB
layout(location = 4) in vec3 force;        // offset 32, three floats; m
layout(location = 5) in uint normal;       // offset 44, one unsigned 32-bit integer
layout(location = 6) in vec2 uv;           // second buffer: two floats
layout(location = 7) in vec4 shell;        // per instance: height, shadow, threshold, fade

layout(binding = 0) uniform Frame {
  mat4 world_to_clip;
  float texture_repeat;  // the draw's
};

layout(location = 0) out vec4 fur_colour;  // linear; a: fade
layout(location = 1) out vec3 fur_direction;
layout(location = 2) out vec3 skin_normal;
layout(location = 3) out vec2 fur_uv;
layout(location = 4) out vec2 stencil_threshold;  // drawn where texture * x > y
layout(location = 5) out float light_left;

vec3 Linear(vec3 srgb) {
  return mix(srgb / 12.92, pow((srgb + 0.055) / 1.055, vec3(2.4)), greaterThan(srgb, vec3(0.04045)));
}

vec3 NormalizeOr(vec3 a, vec3 otherwise) {
  const float squared = dot(a, a);
  return squared > 1e-20 ? a * inversesqrt(squared) : otherwise;
}

vec3 UnpackNormal(uint packed) {
  const vec2 at = unpackSnorm2x16(packed);
  vec3 n = vec3(at, 1.0 - abs(at.x) - abs(at.y));
  const float fold = max(-n.z, 0.0);
  n.x += n.x >= 0.0 ? -fold : fold;
  n.y += n.y >= 0.0 ? -fold : fold;
  return normalize(n);
}

void main() {
  const float height = shell.x;
  skin_normal = UnpackNormal(normal);
  fur_colour = vec4(mix(Linear(base_colour.rgb), Linear(tip_colour.rgb), height), shell.w);
  fur_direction = NormalizeOr(groom + 2.0 * height * force, skin_normal);
  fur_uv = uv * texture_repeat;
  stencil_threshold = vec2(base_colour.a, shell.z);
  light_left = shell.y;
  gl_Position = world_to_clip * vec4(position + height * (groom + height * force), 1.0);
}
