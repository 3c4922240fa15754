// The functions of studio.hpp, which says what they are.
// GLSL 3.30 core and ES 3.00; the host puts the version line and these files before it:
// After: spherical_harmonics.glsl
// After: strand_shading.glsl
// After: strand_light.glsl
precision highp float;
precision highp int;

float Tone(float v) {
  const float kept = 0.5;
  return v <= kept ? v : 1.0 - (1.0 - kept) * exp((kept - v) / (1.0 - kept));
}

float Untone(float v) {
  const float kept = 0.5, most = 0.9985;
  float left = (1.0 - min(v, most)) / (1.0 - kept);
  return v <= kept ? v : kept - (1.0 - kept) * log(left);
}

float FloorDistance(float eye_height, float ray_up) {
  return ray_up >= -1e-3 || eye_height <= 0.0 ? -1.0 : -eye_height / ray_up;
}

vec3 StudioColour(vec3 ray, float dark) {
  const vec3 ground = vec3(0.62, 0.60, 0.60), wall = vec3(0.46, 0.55, 0.66);
  const vec3 shade = vec3(0.46, 0.47, 0.56);
  float dip = Saturate(-ray.y * 4.0);
  vec3 colour = mix(wall * (1.0 - 0.5 * max(ray.y, 0.0)), ground, dip);
  return colour * mix(vec3(1.0), shade, dark);
}

vec3 ShadeEye(LightSet light, HairLook look, vec3 forward, vec3 normal, vec3 to_eye) {
  const vec3 white = vec3(0.90, 0.88, 0.82), iris = vec3(0.75, 0.36, 0.03), pupil = vec3(0.005);
  float ahead = dot(normal, forward);
  vec3 colour = ahead > 0.945 ? pupil : ahead > 0.85 ? iris : white;
  float glint = pow(max(dot(normal, Halfway(light.to_sun, to_eye)), 1e-6), 150.0);
  return ShadeSkin(light, look, colour, normal, to_eye, 1.0, 0.6) + vec3(3.0 * glint);
}
