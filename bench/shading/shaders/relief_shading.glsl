// Fur as relief under a whole set of lights: the terms of relief.glsl and strand_light.glsl put together for a place on
// the skin.
// After: spherical_harmonics.glsl
// After: strand_shading.glsl
// After: strand_light.glsl
// After: relief.glsl

CONST float kReliefDepth = 0.3f;  // of the fur's height, that a flat skin can show
CONST float kReliefLeastSteps = 4.0f, kReliefMostSteps = 16.0f;
CONST float kReliefShadow = 0.75f, kReliefRoughness = 0.45f;
CONST float kReliefTileDots = 48.0f;  // hairs along a side of the tile

// A place on the skin, and the fur that grows there.
struct ReliefPoint {
  vec3 colour, tip_colour;  // of the hairs' two ends, linear
  vec3 normal;              // unit
  vec3 axis_u, axis_v;      // metres that the skin goes along for one unit of u and of v
  vec2 uv;
  vec2 repeat;        // how often the tile of hairs goes along u and v
  vec4 flow;          // the flow map's texel, channels 0 to 1
  float longest;      // of the flow map, m
  float floor_light;  // share of light that reaches the skin
  float sun_share;
  vec3 to_eye;  // unit
};

FN vec3 UnitOr(vec3 v, vec3 otherwise) {
  float size = length(v);
  return size > 1e-12f ? v / size : otherwise;
}

// The steps along u and v that make up the step `d`, as well as they can.
FN vec2 InTexture(vec3 d, vec3 u, vec3 v) {
  float uu = dot(u, u), uv = dot(u, v), vv = dot(v, v);
  float det = uu * vv - uv * uv;
  if (!(det > 1e-6f * uu * vv)) return vec2(0.0f);
  float du = dot(d, u), dv = dot(d, v);
  return vec2(du * vv - dv * uv, dv * uu - du * uv) / det;
}

// Which way along the skin hairs of this flow go; zero where they stand up.
FN vec3 ReliefAlong(ReliefPoint p, vec3 flow) {
  vec3 along = p.axis_u * flow.x + p.axis_v * flow.y;
  return UnitOr(along - p.normal * dot(along, p.normal), vec3(0.0f));
}

// Columns: along u on the skin, across it, the normal. `along` is what there is without u.
FN mat3 ReliefFrame(ReliefPoint p, vec3 along) {
  vec3 x = UnitOr(p.axis_u - p.normal * dot(p.axis_u, p.normal), along);
  return mat3(x, cross(p.normal, x), p.normal);
}

// ReliefShift in the tile's coordinates, of directions in the world.
FN vec2 ReliefTileShift(ReliefPoint p, mat3 frame, vec3 hair, vec3 towards, float depth) {
  vec2 m = ReliefShift(hair * frame, towards * frame, depth);
  return InTexture(frame[0] * m.x + frame[1] * m.y, p.axis_u, p.axis_v) * p.repeat;
}

// The fur's light at the place.
FN_OF_TILE vec3 ShadeRelief(TILE tile, LightSet light, HairLook look, ReliefPoint p) {
  vec3 flow = ReliefFlow(p.flow);
  vec3 along = ReliefAlong(p, flow);
  vec3 hair = UnitOr(along * length(vec2(flow)) + p.normal * flow.z, p.normal);
  mat3 frame = ReliefFrame(p, along);
  float depth = kReliefDepth * p.flow.b * p.longest * max(flow.z, kReliefLowest);
  float steps = ReliefSteps(hair * frame, p.to_eye * frame, kReliefLeastSteps, kReliefMostSteps);
  vec3 hit = ReliefHit(tile, p.uv * p.repeat, ReliefTileShift(p, frame, hair, p.to_eye, depth), steps);
  vec2 to_sun = ReliefTileShift(p, frame, hair, light.to_sun, depth);

  ivec2 cell = ivec2(floor(vec2(hit) * kReliefTileDots));
  HairPoint point;
  point.colour = mix(p.colour, p.tip_colour, hit.z);
  point.tangent = hair;
  point.normal = p.normal;
  point.to_eye = p.to_eye;
  point.depth_light = ReliefAmbient(hit.z, p.floor_light);
  point.sun_share = p.sun_share * ReliefShadow(tile, hit, to_sun, kReliefShadow);
  point.noise = HashShare(uint(cell.x) * 7919u + uint(cell.y));
  vec3 sheen = light.sun * mix(point.colour, vec3(1.0f), 0.25f);
  float shine = ReliefSheen(p.normal, light.to_sun, p.to_eye, kReliefRoughness);
  return ShadeHair(light, look, point) + sheen * (point.sun_share * shine);
}
