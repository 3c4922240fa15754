// The functions of relief_shading.hpp, which says what they are.
// GLSL 3.30 core and ES 3.00; the host puts the version line and these files before it:
// After: spherical_harmonics.glsl
// After: strand_shading.glsl
// After: strand_light.glsl
// After: relief.glsl
precision highp float;
precision highp int;

const float kReliefDepth = 0.3;
const float kReliefLeastSteps = 4.0, kReliefMostSteps = 16.0;
const float kReliefShadow = 0.75, kReliefRoughness = 0.45;
const float kReliefTileDots = 48.0;

struct ReliefPoint {
  vec3 colour, tip_colour, normal, axis_u, axis_v;
  vec2 uv, repeat;
  vec4 flow;
  float longest, floor_light, sun_share;
  vec3 to_eye;
};

vec3 UnitOr(vec3 v, vec3 otherwise) {
  float size = length(v);
  return size > 1e-12 ? v / size : otherwise;
}

vec2 InTexture(vec3 d, vec3 u, vec3 v) {
  float uu = dot(u, u), uv = dot(u, v), vv = dot(v, v);
  float det = uu * vv - uv * uv;
  if (!(det > 1e-6 * uu * vv)) return vec2(0.0);
  float du = dot(d, u), dv = dot(d, v);
  return vec2(du * vv - dv * uv, dv * uu - du * uv) / det;
}

vec3 ReliefAlong(ReliefPoint p, vec3 flow) {
  vec3 along = p.axis_u * flow.x + p.axis_v * flow.y;
  return UnitOr(along - p.normal * dot(along, p.normal), vec3(0.0));
}

mat3 ReliefFrame(ReliefPoint p, vec3 along) {
  vec3 x = UnitOr(p.axis_u - p.normal * dot(p.axis_u, p.normal), along);
  return mat3(x, cross(p.normal, x), p.normal);
}

vec2 ReliefTileShift(ReliefPoint p, mat3 frame, vec3 hair, vec3 towards, float depth) {
  vec2 m = ReliefShift(hair * frame, towards * frame, depth);
  return InTexture(frame[0] * m.x + frame[1] * m.y, p.axis_u, p.axis_v) * p.repeat;
}

vec3 ShadeRelief(LightSet light, HairLook look, ReliefPoint p) {
  vec3 flow = ReliefFlow(p.flow);
  vec3 along = ReliefAlong(p, flow);
  vec3 hair = UnitOr(along * length(flow.xy) + p.normal * flow.z, p.normal);
  mat3 frame = ReliefFrame(p, along);
  float depth = kReliefDepth * p.flow.b * p.longest * max(flow.z, kReliefLowest);
  float steps = ReliefSteps(hair * frame, p.to_eye * frame, kReliefLeastSteps, kReliefMostSteps);
  vec3 hit = ReliefHit(p.uv * p.repeat, ReliefTileShift(p, frame, hair, p.to_eye, depth), steps);
  vec2 to_sun = ReliefTileShift(p, frame, hair, light.to_sun, depth);

  ivec2 cell = ivec2(floor(hit.xy * kReliefTileDots));
  HairPoint point;
  point.colour = mix(p.colour, p.tip_colour, hit.z);
  point.tangent = hair;
  point.normal = p.normal;
  point.to_eye = p.to_eye;
  point.depth_light = ReliefAmbient(hit.z, p.floor_light);
  point.sun_share = p.sun_share * ReliefShadow(hit, to_sun, kReliefShadow);
  point.noise = HashShare(uint(cell.x) * 7919u + uint(cell.y));
  vec3 sheen = light.sun * mix(point.colour, vec3(1.0), 0.25);
  float shine = ReliefSheen(p.normal, light.to_sun, p.to_eye, kReliefRoughness);
  return ShadeHair(light, look, point) + sheen * (point.sun_share * shine);
}
