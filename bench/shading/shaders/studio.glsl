// What pictures have besides hair and skin: the room round a character, its eyes, and how light becomes a byte.
// After: spherical_harmonics.glsl
// After: strand_shading.glsl
// After: strand_light.glsl

// Colours up to the middle as they are, brighter ones ever closer to white: no edge where light is strong.
FN float Tone(float v) {
  const float kept = 0.5f;
  return v <= kept ? v : 1.0f - (1.0f - kept) * exp((kept - v) / (1.0f - kept));
}

// What Tone shows as v, 0 to 1: for what is to be seen in its own colour. White is at the end of the
// curve, which nothing reaches: it comes out within half of an 8-bit step.
FN float Untone(float v) {
  const float kept = 0.5f, most = 0.9985f;
  float left = (1.0f - min(v, most)) / (1.0f - kept);
  return v <= kept ? v : kept - (1.0f - kept) * log(left);
}

// How far along a unit ray the floor is, at height 0; below 0: nowhere.
FN float FloorDistance(float eye_height, float ray_up) {
  return ray_up >= -1e-3f || eye_height <= 0.0f ? -1.0f : -eye_height / ray_up;
}

// A pale floor that meets a pale wall without an edge; `dark`: the share of the sun kept from the floor there.
FN vec3 StudioColour(vec3 ray, float dark) {
  const vec3 ground = vec3(0.62f, 0.60f, 0.60f), wall = vec3(0.46f, 0.55f, 0.66f);
  const vec3 shade = vec3(0.46f, 0.47f, 0.56f);  // of the floor where no sun is
  float dip = Saturate(-ray.y * 4.0f);
  vec3 colour = mix(wall * (1.0f - 0.5f * max(ray.y, 0.0f)), ground, dip);
  return colour * mix(vec3(1.0f), shade, dark);
}

// A place on an eyeball that looks `forward`.
FN vec3 ShadeEye(LightSet light, HairLook look, vec3 forward, vec3 normal, vec3 to_eye) {
  const vec3 white = vec3(0.90f, 0.88f, 0.82f), iris = vec3(0.75f, 0.36f, 0.03f), pupil = vec3(0.005f);
  float ahead = dot(normal, forward);
  vec3 colour = ahead > 0.945f ? pupil : ahead > 0.85f ? iris : white;
  float glint = pow(max(dot(normal, Halfway(light.to_sun, to_eye)), 1e-6f), 150.0f);
  return ShadeSkin(light, look, colour, normal, to_eye, 1.0f, 0.6f) + vec3(3.0f * glint);
}
