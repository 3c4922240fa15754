// Fur as relief under a whole set of lights: the terms of relief.glsl and strand_light.glsl put together for a place on
// the skin.
// After: spherical_harmonics.glsl
// After: strand_shading.glsl
// After: strand_light.glsl
// After: relief.glsl

CONST float kReliefRoughness = 0.45f;
CONST float kReliefTileDots = 48.0f;  // hairs along a side of the tile

// The fur's light at the place; w: ReliefFur's steps.
FN_OF_TILE vec4 ShadeRelief(TILE tile, LightSet light, HairLook look, ReliefMarch march, ReliefPoint p) {
  ReliefFur fur = TraceRelief(tile, march, p, light.to_sun);
  ivec2 cell = ivec2(floor(fur.place * kReliefTileDots));
  HairPoint point;
  point.colour = mix(p.colour, p.tip_colour, fur.height);
  point.tangent = fur.hair;
  point.normal = p.normal;
  point.to_eye = p.to_eye;
  point.depth_light = fur.light;
  point.sun_share = fur.sun_share;
  point.noise = HashShare(uint(cell.x) * 7919u + uint(cell.y));
  vec3 sheen = light.sun * mix(point.colour, vec3(1.0f), 0.25f);
  float shine = ReliefSheen(p.normal, light.to_sun, p.to_eye, kReliefRoughness);
  return vec4(ShadeHair(light, look, point) + sheen * (point.sun_share * shine), fur.steps);
}
