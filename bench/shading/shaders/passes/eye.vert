// A square that the eyeball fills.
// After: spherical_harmonics.glsl
// After: strand_shading.glsl
// After: strand_light.glsl
// After: passes/frame.glsl
uniform vec4 eyeball;  // centre, radius

out vec3 on_square;

void main() {
  vec3 ahead = normalize(eyeball.xyz - eye);
  vec3 right =
      normalize(cross(ahead, abs(ahead.y) < 0.9 ? vec3(0.0, 1.0, 0.0) : vec3(1.0, 0.0, 0.0)));
  vec2 corner = vec2(gl_VertexID % 2, gl_VertexID / 2) * 2.0 - 1.0;
  on_square = eyeball.xyz + (right * corner.x + cross(right, ahead) * corner.y) * (1.2 * eyeball.w);
  gl_Position = world_to_clip * vec4(on_square, 1.0);
}
