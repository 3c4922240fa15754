// The functions of paint_shading.hpp, which says what they are.
// GLSL 3.30 core and ES 3.00; the host puts the version line and these files before it:
// After: spherical_harmonics.glsl
// After: strand_shading.glsl
// After: strand_light.glsl
precision highp float;
precision highp int;

struct PaintLook {
  float wet_darken;
  vec3 mud;
  vec3 snow, dust;
};

vec3 TintColour(vec3 colour, float scale, vec3 add) {
  return vec3(LinearFromSrgb(SrgbFromLinear(colour.x) * scale + add.x),
              LinearFromSrgb(SrgbFromLinear(colour.y) * scale + add.y),
              LinearFromSrgb(SrgbFromLinear(colour.z) * scale + add.z));
}

vec3 WetColour(vec3 colour, float wet, float darken) {
  return TintColour(colour, mix(1.0, darken, wet), vec3(0.0));
}

vec3 MudColour(vec3 colour, float mud, vec3 mud_colour) {
  return TintColour(colour, 1.0 - mud, mud_colour * mud);
}

vec3 DustColour(vec3 colour, float dust, vec3 dust_colour) {
  float grey = dot(colour, vec3(0.2126, 0.7152, 0.0722));
  return mix(colour, mix(vec3(grey), dust_colour, 0.5), 0.8 * dust);
}

float Clotted(float amount, float noise) {
  return smoothstep(0.5 * noise, 0.5 * noise + 0.5, amount);
}

float SnowCover(float snow, vec3 normal, float noise) {
  return Clotted(snow * smoothstep(-0.3, 0.5, normal.y), noise);
}

vec4 SeenPaint(vec4 paint, vec3 normal, float noise) {
  return vec4(Clotted(paint.x, noise), SnowCover(paint.y, normal, noise), paint.z, paint.w);
}

vec3 PaintedColour(PaintLook look, vec3 colour, vec4 paint) {
  vec3 wet = WetColour(colour, paint.z, look.wet_darken);
  vec3 dusty = DustColour(wet, paint.w, look.dust);
  return mix(MudColour(dusty, paint.x, look.mud), look.snow, paint.y);
}

HairLook PaintedHair(HairLook hair, vec4 paint) {
  float bare = (1.0 - 0.9 * paint.x) * (1.0 - 0.8 * paint.y);
  float shine = bare * (1.0 - 0.8 * paint.w), wet = paint.z * bare;
  hair.primary *= shine * (1.0 + 3.0 * wet);
  hair.primary_exponent *= 1.0 + wet;
  hair.secondary *= shine * (1.0 + wet);
  hair.secondary_exponent *= 1.0 + wet;
  hair.noise *= 1.0 - 0.8 * wet;
  hair.backlight *= bare;
  hair.scatter = mix(hair.scatter, 1.0, 0.8 * paint.y);
  return hair;
}
