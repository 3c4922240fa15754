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
layout(location = 4) in vec3 share;  // that fur covers; whether the skin's colour is known; hair for an area of skin
layout(location = 5) in vec2 uv;
layout(location = 6) in vec4 paint;  // of the fur above
// Besides, of up to four layers: hair for an area where they grow as densely as they do, and the sheets that show how
// densely they do. Below 0: the layer cannot grow here; where none can, all is in `share`.
layout(location = 7) in vec2 growth_uv;
layout(location = 8) in vec4 rate;
layout(location = 9) in vec4 sheet;
layout(location = 10) in vec2 cut;  // alpha, times the image's, and below which there is no skin

uniform int character;
uniform float lift;  // out of its own shadow, m

out vec3 skin_at, skin_normal, skin_fur;
out vec3 skin_shares;
out float skin_sun;
out vec4 skin_tint;
out vec2 skin_uv;
out vec4 skin_paint;
out vec2 skin_growth_uv;
out vec4 skin_rate;
flat out vec4 skin_sheet;
out vec2 skin_cut;
invariant gl_Position;  // relief.vert comes there again

void main() {
  skin_at = position;
  skin_normal = normal;
  skin_fur = fur;
  skin_tint = tint;
  skin_shares = share;
  skin_sun = SunShare(position + normal * lift, character);
  skin_uv = uv;
  skin_paint = paint;
  skin_growth_uv = growth_uv;
  skin_rate = rate;
  skin_sheet = sheet;
  skin_cut = cut;
  gl_Position = world_to_clip * vec4(position, 1.0);
}
