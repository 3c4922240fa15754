// A fin: a strip along the hairs on an edge of the skin, one for each instance, lit at its rows' ends.
// After: spherical_harmonics.glsl
// After: strand_shading.glsl
// After: strand_light.glsl
// After: shell_shading.glsl
// After: passes/frame.glsl
// After: passes/shadow_maps.glsl
layout(location = 0) in vec3 from_position;
layout(location = 1) in vec3 from_groom;
layout(location = 2) in vec3 from_force;
layout(location = 3) in vec3 from_normal;
layout(location = 4) in vec3 from_base_colour;  // linear
layout(location = 5) in vec3 from_tip_colour;
layout(location = 6) in vec4 from_place;  // on the texture, and the stencil (passes/stencil.glsl)
layout(location = 7) in vec3 to_position;
layout(location = 8) in vec3 to_groom;
layout(location = 9) in vec3 to_force;
layout(location = 10) in vec3 to_normal;
layout(location = 11) in vec3 to_base_colour;
layout(location = 12) in vec3 to_tip_colour;
layout(location = 13) in vec4 to_place;
layout(location = 14) in float fade;

uniform float fur_shadow;  // light left at the skin
uniform float steps;       // quads in the strip
uniform int character;
uniform float lift;  // out of its own shadow, m

out vec3 fin_lit;
out vec4 fin_place;
out vec2 fin_height_fade;

void main() {
  float height = float(gl_VertexID / 2) / steps;
  bool is_from = gl_VertexID % 2 == 0;
  vec3 position = is_from ? from_position : to_position;
  vec3 groom = is_from ? from_groom : to_groom;
  vec3 force = is_from ? from_force : to_force;
  vec3 normal = is_from ? from_normal : to_normal;
  HairPoint point;
  vec3 at = ShellPosition(position, groom, force, height);
  point.colour = is_from ? mix(from_base_colour, from_tip_colour, height)
                         : mix(to_base_colour, to_tip_colour, height);
  point.colour *= look.tint;
  point.tangent = ShellDirection(groom, force, height);
  point.normal = normal;
  point.to_eye = normalize(eye - at);
  point.depth_light = mix(fur_shadow, 1.0, height);
  point.sun_share = SunShare(at + normal * lift, character);
  point.noise = 0.5;
  fin_lit = ShadeHair(light, look, point);
  fin_place = is_from ? from_place : to_place;
  fin_height_fade = vec2(height, fade);
  gl_Position = world_to_clip * vec4(at, 1.0);
}
