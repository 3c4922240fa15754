// The sun's maps, one for each character (bench/picture/gl_parts.hpp): r, g, b the distance of
// the nearest thing from the front, m, kept by MIN; a the sum of what covers the texel, of 255,
// kept by ADD.
uniform sampler2DArray shadow_maps;
// A row for each character: the ball that its map covers (centre, radius); how many maps may shade
// it; which.
uniform sampler2D characters;
uniform mat3 sun_axes;     // columns: along the map's x and y, to the sun
uniform vec3 shadow_look;  // bias, falloff, strength

vec4 BallOf(int character) { return texelFetch(characters, ivec2(0, character), 0); }

// Texels, and m from the front.
vec3 ToMap(vec3 world, vec4 ball, float side) {
  vec3 p = (world - ball.xyz) * sun_axes;
  return vec3(p.xy * (0.5 * side / ball.w) + 0.5 * side, ball.w - p.z);
}

bool IsOnMap(ivec2 at, int side) {
  return all(greaterThanEqual(at, ivec2(0))) && all(lessThan(at, ivec2(side)));
}

float TexelShare(ivec2 at, int map, float depth) {
  int side = textureSize(shadow_maps, 0).x;
  vec4 texel = texelFetch(shadow_maps, ivec3(clamp(at, ivec2(0), ivec2(side - 1)), map), 0);
  float share =
      SelfShadow(texel.a / 255.0, depth - texel.r, shadow_look.x, shadow_look.y, shadow_look.z);
  return IsOnMap(at, side) ? share : 1.0;
}

float MapShare(vec3 world, int map) {
  vec3 at = ToMap(world, BallOf(map), float(textureSize(shadow_maps, 0).x));
  vec2 low = floor(at.xy - 0.5), part = at.xy - 0.5 - low;
  ivec2 i = ivec2(low);
  return mix(
      mix(TexelShare(i, map, at.z), TexelShare(i + ivec2(1, 0), map, at.z), part.x),
      mix(TexelShare(i + ivec2(0, 1), map, at.z), TexelShare(i + ivec2(1, 1), map, at.z), part.x),
      part.y);
}

// Share of the sun that reaches a place on a character.
float SunShare(vec3 world, int character) {
  int maps = int(texelFetch(characters, ivec2(1, character), 0).x);
  float share = 1.0;
  for (int i = 0; i < maps; ++i)
    share *= MapShare(world, int(texelFetch(characters, ivec2(2 + i, character), 0).x));
  return share;
}
