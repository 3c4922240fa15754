// Premultiplied, over the skin and the layers before; nothing where the layer is bald.
// After: spherical_harmonics.glsl
// After: strand_shading.glsl
// After: strand_light.glsl
// After: passes/frame.glsl
// After: relief.glsl
// After: relief_shading.glsl
uniform sampler2D surface;  // the layer's flow map
uniform sampler2D relief_heights;
uniform vec2 repeat;        // of the tile of hairs
uniform float longest;      // m
uniform float depth_floor;
uniform vec2 relief_steps;   // least, most
uniform float relief_frame;  // of the jitter; below 0: none
uniform vec3 relief_wind;    // ReliefMarch's
uniform vec2 relief_pan;
uniform int relief_shows_steps;  // 1: in false colours
uniform vec2 target_size;        // whose upper row is 0 for the jitter

in vec3 relief_at, relief_normal, relief_root, relief_tip, relief_u, relief_v;
in vec2 relief_uv;
in float relief_sun;
out vec4 colour;

void main() {
  ReliefPoint point;
  point.flow = textureLod(surface, relief_uv, 0.0);
  if (point.flow.a <= 0.0) discard;
  point.colour = relief_root;
  point.tip_colour = relief_tip;
  point.normal = normalize(relief_normal);
  point.axis_u = relief_u;
  point.axis_v = relief_v;
  point.uv = relief_uv;
  point.repeat = repeat;
  point.longest = longest;
  point.floor_light = depth_floor;
  point.sun_share = relief_sun;
  point.to_eye = normalize(eye - relief_at);
  ReliefMarch march;
  march.least = relief_steps.x;
  march.most = relief_steps.y;
  vec2 pixel = floor(vec2(gl_FragCoord.x, target_size.y - gl_FragCoord.y));
  march.jitter = relief_frame < 0.0 ? 0.0 : ReliefJitter(pixel, relief_frame);
  march.wind = relief_wind;
  march.pan = relief_pan;
  vec4 shaded = ShadeRelief(relief_heights, light, look, march, point);
  if (relief_shows_steps != 0) shaded.rgb = ReliefStepColour(shaded.w, march.most);
  colour = vec4(shaded.rgb * point.flow.a, point.flow.a);
}
