// Instances (jobs/DRAWING.md): 64 bytes per strand. A strand is drawn as a triangle strip of two
// vertices at each of `knots` places along its curve; no index buffer and no vertex buffer.
//   vkCmdDraw(2 * knots, strand_count, 0, 0), glDrawArraysInstanced
#version 450

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

vec3 Linear(vec3 srgb) {
  return mix(srgb / 12.92, pow((srgb + 0.055) / 1.055, vec3(2.4)), greaterThan(srgb, vec3(0.04045)));
}

vec3 NormalizeOr(vec3 a, vec3 otherwise) {
  const float squared = dot(a, a);
  return squared > 1e-20 ? a * inversesqrt(squared) : otherwise;
}

void main() {
  const vec3 c0 = curve_a.xyz, c1 = vec3(curve_a.w, curve_b.xy), c2 = vec3(curve_b.zw, curve_c.x),
             c3 = curve_c.yzw;
  const float t = float(VERTEX / 2) / float(knots - 1);
  const float side = float(VERTEX % 2);
  const vec3 point = c0 + t * (c1 + t * (c2 + t * c3));
  const vec3 tangent = NormalizeOr(c1 + t * (2.0 * c2 + t * 3.0 * c3), vec3(0.0, 1.0, 0.0));
  const vec3 across = NormalizeOr(cross(tangent, eye - point), vec3(1.0, 0.0, 0.0));
  const float half_width = 0.5 * width * mix(1.0, tip_width, t);
  hair_colour = mix(vec4(Linear(base_colour.rgb), base_colour.a),
                    vec4(Linear(tip_colour.rgb), tip_colour.a), t);
  hair_tangent = tangent;
  across_along = vec2(side, t);
  film_strip = tag >> 24;
  gl_Position = world_to_clip * vec4(point + across * (half_width * (2.0 * side - 1.0)), 1.0);
}
