// After: strand_shading.glsl
// After: spherical_harmonics.glsl
// After: strand_light.glsl
// After: passes/frame.glsl
// After: passes/shadow_maps.glsl
layout(location = 0) in vec3 position;

uniform int character;
uniform float map_side;

out float from_front;
out float covered;

void main() {
  vec3 at = ToMap(position, BallOf(character), map_side);
  from_front = at.z;
  covered = 1.0;
  gl_Position = vec4(at.xy * (2.0 / map_side) - 1.0, 0.0, 1.0);
}
