// Skin that fur is drawn on as relief, the sun's share found at its corners.
// After: spherical_harmonics.glsl
// After: strand_shading.glsl
// After: strand_light.glsl
// After: passes/frame.glsl
// After: passes/shadow_maps.glsl
layout(location = 0) in vec3 position;
layout(location = 1) in vec3 normal;
layout(location = 2) in vec3 root_colour;  // of the fur, linear
layout(location = 3) in vec3 tip_colour;
layout(location = 4) in vec3 axis_u;  // m for one unit of u
layout(location = 5) in vec3 axis_v;
layout(location = 6) in vec2 uv;

uniform int character;
uniform float lift;  // out of its own shadow, m

out vec3 relief_at, relief_normal, relief_root, relief_tip, relief_u, relief_v;
out vec2 relief_uv;
out float relief_sun;
invariant gl_Position;  // drawn where body.vert put the skin

void main() {
  relief_at = position;
  relief_normal = normal;
  relief_root = root_colour;
  relief_tip = tip_colour;
  relief_u = axis_u;
  relief_v = axis_v;
  relief_uv = uv;
  relief_sun = SunShare(position + normal * lift, character);
  gl_Position = world_to_clip * vec4(position, 1.0);
}
