// What light does at the skin, for the hair that is seen before it: how much of the sun's, how much
// of the sky's.
// After: spherical_harmonics.glsl
// After: strand_shading.glsl
// After: strand_light.glsl
// After: passes/frame.glsl
// After: passes/shadow_maps.glsl
layout(location = 0) in vec3 position;
layout(location = 1) in vec3 normal;

uniform int character;
uniform float lift;  // out of its own shadow, m

out vec2 sun_and_sky;

void main() {
  const vec3 luminance = vec3(0.2126, 0.7152, 0.0722);
  float mean_sky = dot(light.sky[0], luminance) * 0.282094792;
  float sky = dot(ShLight(light.sky, normal, kShLambert), luminance) / max(mean_sky, 1e-6);
  sun_and_sky = vec2(WrapDiffuse(dot(normal, light.to_sun), look.wrap) *
                         SunShare(position + normal * lift, character),
                     0.5 * sky);
  gl_Position = world_to_clip * vec4(position, 1.0);
}
