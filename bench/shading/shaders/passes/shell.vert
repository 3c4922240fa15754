// A shell: a copy of the skin, lit at its corners.
// After: spherical_harmonics.glsl
// After: strand_shading.glsl
// After: strand_light.glsl
// After: shell_shading.glsl
// After: passes/frame.glsl
// After: passes/shadow_maps.glsl
layout(location = 0) in vec3 position;
layout(location = 1) in vec3 groom;
layout(location = 2) in vec3 force;
layout(location = 3) in vec3 normal;
layout(location = 4) in vec3 base_colour;  // linear
layout(location = 5) in vec3 tip_colour;
layout(location = 6) in vec4 place;  // on the texture, and the stencil (passes/stencil.glsl)
layout(location = 7) in vec4 shell;  // of an instance: height, shadow, threshold, fade

uniform int character;
uniform float lift;  // out of its own shadow, m

out vec3 shell_lit;
out vec4 shell_place;
flat out vec2 shell_cut;  // threshold, fade

void main() {
  HairPoint point;
  vec3 at = ShellPosition(position, groom, force, shell.x);
  point.colour = mix(base_colour, tip_colour, shell.x) * look.tint;
  point.tangent = ShellDirection(groom, force, shell.x);
  point.normal = normal;
  point.to_eye = normalize(eye - at);
  point.depth_light = shell.y;
  point.sun_share = SunShare(at + normal * lift, character);
  point.noise = 0.5;
  shell_lit = ShadeHair(light, look, point);
  shell_place = place;
  shell_cut = shell.zw;
  gl_Position = world_to_clip * vec4(at, 1.0);
}
