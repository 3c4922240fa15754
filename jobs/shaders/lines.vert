// Lines (jobs/DRAWING.md): five points of 32 bytes per strand, widened here into a strip of four quads
// that faces the camera. No vertex buffer and no index buffer: points are read as a storage buffer.
//   vkCmdDraw(10, strand_count, 0, 0), glDrawArraysInstanced with GL_TRIANGLE_STRIP
#version 450
#extension GL_GOOGLE_include_directive : enable
#include "fur_vertex.glsl"

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

void main() {
  const uint strand = in_strand_order != 0 ? order[INSTANCE] : uint(INSTANCE);
  const Point at = points[strand * 5u + uint(VERTEX / 2)];
  const float side = float(VERTEX % 2);
  const vec4 place = at.position_width, tangent_v = LineTangent(at.tangent_v);
  hair_colour = LinearFromSrgb(Unorm8x4(at.colour));
  hair_tangent = tangent_v.xyz;
  across_along = vec2(side, tangent_v.w);
  film_strip = StripOfTag(at.tag);
  gl_Position = world_to_clip * vec4(StripCorner(place.xyz, tangent_v.xyz, place.w, eye, side), 1.0);
}
