// What mud, snow, water and dust do to hair and skin: to the colour that is lit, and to how it takes light.
// Amounts are 0 to 1; a vec4 of them is mud, snow, wet, dust, as a LookRecord has them.
//
// Wetness and mud tint sRGB values, as Pelt tints the colours of a layer that is not painted: both kinds of layer
// look alike in one weather.
// After: spherical_harmonics.glsl
// After: strand_shading.glsl
// After: strand_light.glsl

struct PaintLook {
  float wet_darken;  // share of the brightness left of what is soaked; sRGB
  vec3 mud;          // sRGB
  vec3 snow, dust;
};

// colour * scale + add, in sRGB.
FN vec3 TintColour(vec3 colour, float scale, vec3 add) {
  return vec3(LinearFromSrgb(SrgbFromLinear(colour.x) * scale + add.x),
              LinearFromSrgb(SrgbFromLinear(colour.y) * scale + add.y),
              LinearFromSrgb(SrgbFromLinear(colour.z) * scale + add.z));
}

FN vec3 WetColour(vec3 colour, float wet, float darken) {
  return TintColour(colour, mix(1.0f, darken, wet), vec3(0.0f));
}

FN vec3 MudColour(vec3 colour, float mud, vec3 mud_colour) {
  return TintColour(colour, 1.0f - mud, mud_colour * mud);
}

// Paler, and as grey as the dust.
FN vec3 DustColour(vec3 colour, float dust, vec3 dust_colour) {
  float grey = dot(colour, vec3(0.2126f, 0.7152f, 0.0722f));
  return mix(colour, mix(vec3(grey), dust_colour, 0.5f), 0.8f * dust);
}

// An amount in clots: where the noise is low all of it is there early, where it is high late. None stays none, and all
// is all.
FN float Clotted(float amount, float noise) {
  return smoothstep(0.5f * noise, 0.5f * noise + 0.5f, amount);
}

// Snow lies where the skin faces up.
FN float SnowCover(float snow, vec3 normal, float noise) {
  return Clotted(snow * smoothstep(-0.3f, 0.5f, normal.y), noise);
}

// The amounts that are seen at a place: `noise` as StrandNoise.
FN vec4 SeenPaint(vec4 paint, vec3 normal, float noise) {
  return vec4(Clotted(paint.x, noise), SnowCover(paint.y, normal, noise), paint.z, paint.w);
}

// Water soaks in, dust lies on it, mud on both, snow on all. `paint` as SeenPaint.
FN vec3 PaintedColour(PaintLook look, vec3 colour, vec4 paint) {
  vec3 wet = WetColour(colour, paint.z, look.wet_darken);
  vec3 dusty = DustColour(wet, paint.w, look.dust);
  return mix(MudColour(dusty, paint.x, look.mud), look.snow, paint.y);
}

// What lies on hair takes its shine, and snow scatters light on; water sharpens the highlights and joins hairs, so that
// noise breaks them up no more.
FN HairLook PaintedHair(HairLook hair, vec4 paint) {
  float bare = (1.0f - 0.9f * paint.x) * (1.0f - 0.8f * paint.y);
  float shine = bare * (1.0f - 0.8f * paint.w), wet = paint.z * bare;
  hair.primary = hair.primary * shine * (1.0f + 3.0f * wet);
  hair.primary_exponent *= 1.0f + wet;
  hair.secondary = hair.secondary * shine * (1.0f + wet);
  hair.secondary_exponent *= 1.0f + wet;
  hair.noise *= 1.0f - 0.8f * wet;
  hair.backlight *= bare;
  hair.scatter = mix(hair.scatter, 1.0f, 0.8f * paint.y);
  return hair;
}
