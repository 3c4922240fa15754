// Lines (jobs/DRAWING.md): five points of 32 bytes per strand, widened here into a strip of four quads
// that faces the camera. No vertex buffer and no index buffer: points are read as a storage buffer.
//   vkCmdDraw(10, strand_count, 0, 0), glDrawArraysInstanced with GL_TRIANGLE_STRIP
#version 450

struct Point {
  vec4 position_width;  // m, world; whole width
  uvec2 tangent_v;      // 16 bits each, signed normalised: tangent (unit, root to tip), v
  uint colour;          // four unsigned bytes, normalised; sRGB
  uint tag;
};
layout(std430, binding = 1) readonly buffer Points { Point points[]; };
layout(std430, binding = 2) readonly buffer Order { uint order[]; };  // the draw's; kIndexBuffer

layout(binding = 0) uniform Frame {
  mat4 world_to_clip;
  vec3 eye;             // m, world
  int in_strand_order;  // 1 with kIndexBuffer
};
#ifdef VULKAN
#define VERTEX gl_VertexIndex
#define INSTANCE gl_InstanceIndex
#else
#define VERTEX gl_VertexID
#define INSTANCE gl_InstanceID
#endif

layout(location = 0) out vec4 hair_colour;  // linear; a carries the LOD fade
layout(location = 1) out vec3 hair_tangent;
layout(location = 2) out vec2 across_along;  // u across the hair, v from root to tip
layout(location = 3) flat out uint film_strip;

vec3 Linear(vec3 srgb) {
  return mix(srgb / 12.92, pow((srgb + 0.055) / 1.055, vec3(2.4)), greaterThan(srgb, vec3(0.04045)));
}

vec3 NormalizeOr(vec3 a, vec3 otherwise) {
  const float squared = dot(a, a);
  return squared > 1e-20 ? a * inversesqrt(squared) : otherwise;
}

void main() {
  const uint strand = in_strand_order != 0 ? order[INSTANCE] : uint(INSTANCE);
  const Point at = points[strand * 5u + uint(VERTEX / 2)];
  const float side = float(VERTEX % 2);
  const vec3 position = at.position_width.xyz;
  const vec2 xy = unpackSnorm2x16(at.tangent_v.x), zv = unpackSnorm2x16(at.tangent_v.y);
  const vec3 tangent = vec3(xy, zv.x);
  const vec3 across = NormalizeOr(cross(tangent, eye - position), vec3(1.0, 0.0, 0.0));
  const float half_width = 0.5 * at.position_width.w;
  const vec4 colour = unpackUnorm4x8(at.colour);
  hair_colour = vec4(Linear(colour.rgb), colour.a);
  hair_tangent = tangent;
  across_along = vec2(side, zv.y);
  film_strip = at.tag >> 24;
  gl_Position = world_to_clip * vec4(position + across * (half_width * (2.0 * side - 1.0)), 1.0);
}
