// A shell in the sun's map: what ends between it and the next one that casts a shadow
// (bench/picture/shadows.hpp).
// After: strand_shading.glsl
// After: spherical_harmonics.glsl
// After: strand_light.glsl
// After: passes/frame.glsl
// After: passes/shadow_maps.glsl
layout(location = 0) in vec3 position;
layout(location = 1) in vec3 groom;
layout(location = 2) in vec3 force;
layout(location = 6) in vec3 place;  // z: the stencil

uniform sampler2D covers;  // a row for each of these shells: share of a place, by stencil
uniform int row;
uniform float height;
uniform int character;
uniform float map_side;  // texels

out float from_front;
out float covered;

void main() {
  vec3 at = ToMap(ShellPosition(position, groom, force, height), BallOf(character), map_side);
  from_front = at.z;
  covered = texelFetch(covers, ivec2(int(place.z * 255.0 + 0.5), row), 0).r;
  gl_Position = vec4(at.xy * (2.0 / map_side) - 1.0, 0.0, 1.0);
}
