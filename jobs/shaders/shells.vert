// Shells (jobs/DRAWING.md): 48 bytes a vertex of the skin, and its place on the skin's texture from a
// buffer of its own that never changes; 16 bytes an instance, a shell.
//   vkCmdDrawIndexed(index_count, shell_count, 0, 0, 0)
#version 450
#extension GL_GOOGLE_include_directive : enable
#include "fur_vertex.glsl"

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

void main() {
  const float height = shell.x;
  skin_normal = OctahedralNormal(normal);
  fur_colour = vec4(HairColour(base_colour, tip_colour, height).rgb, shell.w);
  fur_direction = NormalizeOr(ShellSlope(groom, force, height), skin_normal);
  fur_uv = uv * texture_repeat;
  stencil_threshold = vec2(base_colour.a, shell.z);
  light_left = shell.y;
  gl_Position = world_to_clip * vec4(ShellPosition(position, groom, force, height), 1.0);
}
