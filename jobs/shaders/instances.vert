// Instances (jobs/DRAWING.md): 64 bytes per strand. A strand is drawn as a triangle strip of two
// vertices at each of `knots` places along its curve; no index buffer and no vertex buffer.
//   vkCmdDraw(2 * knots, strand_count, 0, 0), glDrawArraysInstanced
#version 450
#extension GL_GOOGLE_include_directive : enable
#include "fur_vertex.glsl"

// Each steps once per instance.
layout(location = 0) in vec4 curve_a;  // offset 0, four floats: c0, and c1.x
layout(location = 1) in vec4 curve_b;  // offset 16: c1.yz, c2.xy
layout(location = 2) in vec4 curve_c;  // offset 32: c2.z, c3
layout(location = 3) in vec4 base_colour;  // offset 48, four unsigned bytes, normalised; sRGB
layout(location = 4) in vec4 tip_colour;   // offset 52, the same
layout(location = 5) in float width;       // offset 56; m, whole, at the root
layout(location = 6) in uint tag;          // offset 60, one unsigned 32-bit integer

layout(binding = 0) uniform Frame {
  mat4 world_to_clip;
  vec3 eye;         // m, world
  float tip_width;  // the draw's: over the width at the root
  int knots;        // 2 or more
};
#ifdef VULKAN
#define VERTEX gl_VertexIndex
#else
#define VERTEX gl_VertexID
#endif

layout(location = 0) out vec4 hair_colour;  // linear; a carries the LOD fade
layout(location = 1) out vec3 hair_tangent;
layout(location = 2) out vec2 across_along;  // u across the hair, v from root to tip
layout(location = 3) flat out uint film_strip;

void main() {
  const Curve curve = UnpackCurve(curve_a, curve_b, curve_c);
  const float t = float(VERTEX / 2) / float(knots - 1);
  const float side = float(VERTEX % 2);
  const float wide = CurveWidth(width, tip_width, t);
  hair_colour = HairColour(base_colour, tip_colour, t);
  hair_tangent = CurveTangent(curve, t);
  across_along = vec2(side, t);
  film_strip = StripOfTag(tag);
  const vec3 corner = StripCorner(CurvePoint(curve, t), hair_tangent, wide, eye, side);
  gl_Position = world_to_clip * vec4(corner, 1.0);
}
