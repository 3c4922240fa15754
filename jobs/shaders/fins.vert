// Fins (jobs/DRAWING.md): a strip of four quads along the fur for each edge of the skin that is seen from
// the side. 12 bytes an instance, of WriteFins; the shells' vertices and their places on the skin's
// texture are read as storage buffers.
//   vkCmdDraw(10, fin_count, 0, 0), glDrawArraysInstanced with GL_TRIANGLE_STRIP
#version 450
#extension GL_GOOGLE_include_directive : enable
#include "fur_vertex.glsl"

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

void main() {
  const uint end = VERTEX % 2 == 0 ? fin.x : fin.y;
  const Vertex at = vertices[end];
  const float height = float(VERTEX / 2) / 4.0;
  const vec4 base = Unorm8x4(at.base_colour), tip = Unorm8x4(at.tip_colour);
  skin_normal = OctahedralNormal(at.normal);
  fur_colour = vec4(HairColour(base, tip, height).rgb, float(fin.z) / 255.0);
  fur_direction = NormalizeOr(ShellSlope(at.groom, at.force, height), skin_normal);
  fur_uv = uvs[end] * texture_repeat;
  stencil_threshold = vec2(base.a, height);
  light_left = mix(shadow, 1.0, height);
  const vec3 place = ShellPosition(at.position, at.groom, at.force, height);
  gl_Position = world_to_clip * vec4(place, 1.0);
}
