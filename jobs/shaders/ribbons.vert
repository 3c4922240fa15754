// Ribbons (jobs/DRAWING.md): a vertex of 32 bytes, four quads per hair, already turned to the camera.
#version 450
#extension GL_GOOGLE_include_directive : enable
#include "fur_vertex.glsl"

layout(location = 0) in vec3 position;  // offset 0, three floats; m, world
layout(location = 1) in vec3 tangent;   // offset 12, three floats; unit, root to tip
layout(location = 2) in vec4 colour;    // offset 24, four unsigned bytes, normalised; sRGB
layout(location = 3) in uint texture_;  // offset 28, one unsigned 32-bit integer

layout(binding = 0) uniform Frame {
  mat4 world_to_clip;
};

layout(location = 0) out vec4 hair_colour;  // linear; a carries the LOD fade
layout(location = 1) out vec3 hair_tangent;
layout(location = 2) out vec2 across_along;  // u across the hair, v from root to tip
layout(location = 3) flat out uint film_strip;

void main() {
  hair_colour = LinearFromSrgb(colour);
  hair_tangent = tangent;
  across_along = RibbonPlace(texture_);
  film_strip = StripOfRibbon(texture_);
  gl_Position = world_to_clip * vec4(position, 1.0);
}
