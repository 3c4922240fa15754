// Skin, the sun's share found at its corners.
// After: spherical_harmonics.glsl
// After: strand_shading.glsl
// After: strand_light.glsl
// After: passes/frame.glsl
// After: passes/shadow_maps.glsl
layout(location = 0) in vec3 position;
layout(location = 1) in vec3 normal;
layout(location = 2) in vec3 fur;    // colour of what grows there, linear
layout(location = 3) in vec4 tint;   // of the skin, times its image; 1: unlit, 0: lit
layout(location = 4) in vec2 share;  // of the fur's colour; of light, that fur leaves
layout(location = 5) in vec2 uv;
layout(location = 6) in vec4 paint;  // of the fur above

uniform int character;
uniform float lift;  // out of its own shadow, m

out vec3 skin_at, skin_normal, skin_fur;
out vec3 skin_shares;  // the two, and the sun's
out vec4 skin_tint;
out vec2 skin_uv;
out vec4 skin_paint;
invariant gl_Position;  // relief.vert comes there again

void main() {
  skin_at = position;
  skin_normal = normal;
  skin_fur = fur;
  skin_tint = tint;
  skin_shares = vec3(share, SunShare(position + normal * lift, character));
  skin_uv = uv;
  skin_paint = paint;
  gl_Position = world_to_clip * vec4(position, 1.0);
}
