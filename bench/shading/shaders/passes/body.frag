// After: spherical_harmonics.glsl
// After: strand_shading.glsl
// After: strand_light.glsl
// After: studio.glsl
// After: passes/frame.glsl
// After: paint_shading.glsl
// After: passes/painted.glsl
in vec3 skin_at, skin_normal, skin_fur;
in vec3 skin_shares;
in float skin_sun;
in vec4 skin_tint;
in vec2 skin_uv;
in vec4 skin_paint;
in vec2 skin_growth_uv;
in vec4 skin_rate;
flat in vec4 skin_sheet;
in vec2 skin_cut;
out vec4 colour;

uniform sampler2D surface;      // sRGB
uniform sampler2DArray growth;  // how densely layers grow
uniform float depth_floor;      // light left where nothing but fur is

float HairOf(float rate, float sheet) {
  return sheet < 0.0 ? 0.0 : rate * textureLod(growth, vec3(skin_growth_uv, sheet), 0.0).r;
}

// By fur.
float Covered() {
  if (all(lessThan(skin_sheet, vec4(0.0)))) return skin_shares.x;
  float hair = skin_shares.z + HairOf(skin_rate.x, skin_sheet.x) + HairOf(skin_rate.y, skin_sheet.y) +
               HairOf(skin_rate.z, skin_sheet.z) + HairOf(skin_rate.w, skin_sheet.w);
  return 1.0 - exp(-hair);
}

void main() {
  vec4 image = texture(surface, skin_uv);
  if (skin_cut.x * image.a < skin_cut.y) discard;
  vec3 own = skin_tint.rgb * LinearFromSrgb(image).rgb;
  float covered = Covered();
  bool unlit = skin_tint.a > 0.5;
  vec3 skin = unlit || skin_shares.y < 0.5 ? skin_fur : mix(own, skin_fur, covered);
  if (covered > 0.0 && skin_paint != vec4(0.0))
    skin = PaintedColour(LookOfPaint(), skin, skin_paint);
  vec3 shaded = ShadeSkin(light, look, skin, normalize(skin_normal), normalize(eye - skin_at),
                          mix(1.0, depth_floor, covered), skin_sun);
  if (unlit) shaded = mix(vec3(Untone(own.r), Untone(own.g), Untone(own.b)), shaded, covered);
  colour = vec4(shaded, 1.0);
}
