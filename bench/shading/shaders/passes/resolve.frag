// Samples to pixels of sRGB, over the room that is behind them. Row 0 is the picture's upper one.
// After: spherical_harmonics.glsl
// After: strand_shading.glsl
// After: strand_light.glsl
// After: studio.glsl
// After: passes/frame.glsl
// After: passes/shadow_maps.glsl
uniform sampler2D drawn;  // premultiplied
uniform int samples;
uniform vec3 ray_ahead;
uniform vec3 ray_right, ray_up;    // from the middle to the picture's right and upper edges
uniform sampler2DArray soft_maps;  // a: coverage, softened
uniform int character_count;
uniform vec3 room_light;  // of a studio's
out vec4 colour;

float SoftAt(ivec2 at, int map) {
  int side = textureSize(soft_maps, 0).x;
  return IsOnMap(at, side) ? texelFetch(soft_maps, ivec3(at, map), 0).a : 0.0;
}

// How much of the sun is kept from the floor.
float DarkAt(vec3 world) {
  float passed = 1.0;
  for (int map = 0; map < character_count; ++map) {
    vec3 at = ToMap(world, BallOf(map), float(textureSize(soft_maps, 0).x));
    vec2 low = floor(at.xy - 0.5), part = at.xy - 0.5 - low;
    ivec2 i = ivec2(low);
    float blocked =
        mix(mix(SoftAt(i, map), SoftAt(i + ivec2(1, 0), map), part.x),
            mix(SoftAt(i + ivec2(0, 1), map), SoftAt(i + ivec2(1, 1), map), part.x), part.y);
    if (at.z > 0.0) passed *= 1.0 - blocked;
  }
  return 1.0 - passed;
}

void main() {
  ivec2 pixel = ivec2(gl_FragCoord.xy), size = textureSize(drawn, 0) / samples;
  vec4 sum = vec4(0.0);
  for (int y = 0; y < samples; ++y)
    for (int x = 0; x < samples; ++x)
      sum += texelFetch(drawn, ivec2(pixel.x, size.y - 1 - pixel.y) * samples + ivec2(x, y), 0);
  sum /= float(samples * samples);
  vec2 at = gl_FragCoord.xy / vec2(size) * 2.0 - 1.0;
  vec3 ray = normalize(ray_ahead + ray_right * at.x - ray_up * at.y);
  float far = FloorDistance(eye.y, ray.y);
  vec3 room = room_light * StudioColour(ray, far < 0.0 ? 0.0 : DarkAt(eye + ray * far));
  vec3 shown = max(sum.rgb + room * (1.0 - sum.a), vec3(0.0));
  colour = vec4(SrgbFromLinear(Tone(shown.r)), SrgbFromLinear(Tone(shown.g)),
                SrgbFromLinear(Tone(shown.b)), 1.0);
}
