// After: spherical_harmonics.glsl
// After: strand_shading.glsl
// After: strand_light.glsl
// After: studio.glsl
// After: passes/frame.glsl
uniform vec4 eyeball;
uniform vec3 eyeball_forward;

in vec3 on_square;
out vec4 colour;

void main() {
  vec3 ray = normalize(on_square - eye), from = eye - eyeball.xyz;
  float along = dot(from, ray);
  float inside = along * along - dot(from, from) + eyeball.w * eyeball.w;
  if (inside < 0.0) discard;
  vec3 at = eye + ray * (-along - sqrt(inside));
  vec4 clip = world_to_clip * vec4(at, 1.0);
  gl_FragDepth = 0.5 + 0.5 * clip.z / clip.w;
  colour = vec4(ShadeEye(light, look, eyeball_forward, (at - eyeball.xyz) / eyeball.w, -ray), 1.0);
}
