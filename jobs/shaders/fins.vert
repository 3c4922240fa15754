// Fins (jobs/DRAWING.md): a strip of four quads along the fur for each edge of the skin that is seen from
// the side. 12 bytes an instance, of WriteFins; the shells' vertices and their places on the skin's
// texture are read as storage buffers.
//   vkCmdDraw(10, fin_count, 0, 0), glDrawArraysInstanced with GL_TRIANGLE_STRIP
#version 450

layout(location = 0) in uvec3 fin;  // offset 0, three unsigned 32-bit integers: from, to, fade of 255

struct Vertex {
  vec3 position;  // m, world
  uint base_colour;  // four unsigned bytes, normalised; sRGB, stencil
  vec3 groom;     // m
  uint tip_colour;
  vec3 force;     // m
  uint normal;
};
layout(std430, binding = 1) readonly buffer Vertices { Vertex vertices[]; };
layout(std430, binding = 2) readonly buffer Places { vec2 uvs[]; };

layout(binding = 0) uniform Frame {
  mat4 world_to_clip;
  float texture_repeat;  // the draw's
  float shadow;
};
#ifdef VULKAN
#define VERTEX gl_VertexIndex
#else
#define VERTEX gl_VertexID
#endif

layout(location = 0) out vec4 fur_colour;  // linear; a: fade, which the colour is to be multiplied with too
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
  const uint end = VERTEX % 2 == 0 ? fin.x : fin.y;
  const Vertex at = vertices[end];
  const float height = float(VERTEX / 2) / 4.0;
  const vec4 base = unpackUnorm4x8(at.base_colour), tip = unpackUnorm4x8(at.tip_colour);
  skin_normal = UnpackNormal(at.normal);
  fur_colour = vec4(mix(Linear(base.rgb), Linear(tip.rgb), height), float(fin.z) / 255.0);
  fur_direction = NormalizeOr(at.groom + 2.0 * height * at.force, skin_normal);
  fur_uv = uvs[end] * texture_repeat;
  stencil_threshold = vec2(base.a, height);
  light_left = mix(shadow, 1.0, height);
  gl_Position = world_to_clip * vec4(at.position + height * (at.groom + height * at.force), 1.0);
}
