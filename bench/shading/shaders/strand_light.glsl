// A hair and the skin below it under a whole set of lights: the terms of strand_shading.glsl put together.
// After: spherical_harmonics.glsl
// After: strand_shading.glsl

// Colours are radiance: what a white Lambert patch that faces the light reflects.
struct LightSet {
  vec3 to_sun, sun;
  vec3 to_rim, rim;  // a light behind what is seen; a negative one darkens outlines
  vec3 sky[16];      // spherical harmonics
};

// How a coat of hair takes light.
struct HairLook {
  vec3 tint;                                             // of the hair's own colour
  float primary, primary_exponent, primary_shift;        // in the light's colour, shifted to the root
  float secondary, secondary_exponent, secondary_shift;  // in the hair's, to the tip
  float noise;                                           // how far noise breaks the secondary one up, 0 to 1
  float wrap;                                            // of light round the body
  float rim, rim_exponent, rim_from;                     // of the light behind: share, and where
  float backlight, backlight_exponent;
  float scatter, scatter_depth;  // share of light kept inside the coat, and how fast it takes on colour
};

// A place on a hair.
struct HairPoint {
  vec3 colour, tangent;
  vec3 normal;  // of the skin at the root
  vec3 to_eye;
  float depth_light;  // DepthShadow
  float sun_share;    // SelfShadow
  float noise;        // StrandNoise
};

// Colour of hair where this share of light comes straight, the rest by way of other hairs.
FN vec3 CoatColour(HairLook look, vec3 colour, float share) {
  float inside = 1.0f - share;
  return colour * share +
         MultipleScatter(colour, inside, look.scatter_depth) * (look.scatter * inside);
}

// Both highlights, without the light's colour.
FN vec3 Highlights(HairLook look, HairPoint p, vec3 to_light) {
  vec3 halfway = Halfway(to_light, p.to_eye);
  vec3 to_root = ShiftTangent(p.tangent, p.normal, look.primary_shift);
  vec3 to_tip = ShiftTangent(p.tangent, p.normal, -look.secondary_shift);
  float first = look.primary * HairLobe(to_root, halfway, look.primary_exponent);
  float second = look.secondary * HairLobe(to_tip, halfway, look.secondary_exponent) *
                 mix(1.0f, 2.0f * p.noise, look.noise);
  return vec3(first) + p.colour * second;
}

// What both highlights add to a hair in the sun.
FN vec3 SunHighlights(LightSet light, HairLook look, HairPoint p) {
  vec3 sun = light.sun * WrapDiffuse(dot(p.normal, light.to_sun), look.wrap);
  return Highlights(look, p, light.to_sun) * sun * (p.sun_share * p.depth_light);
}

// What the light behind adds at the outline, of hair or skin of this colour.
FN vec3 OutlineLight(LightSet light, HairLook look, vec3 colour, vec3 normal, vec3 to_eye) {
  float rim = look.rim * Rim(normal, to_eye, look.rim_exponent) *
              RimFrom(normal, light.to_rim, look.rim_from);
  return light.rim * mix(colour, vec3(1.0f), 0.25f) * rim;
}

FN vec3 ShadeHair(LightSet light, HairLook look, HairPoint p) {
  vec3 deep = CoatColour(look, p.colour, p.depth_light);
  vec3 sunlit = CoatColour(look, p.colour, p.depth_light * p.sun_share);
  vec3 sun = light.sun * WrapDiffuse(dot(p.normal, light.to_sun), look.wrap);
  vec3 through = TransmittedColour(p.colour) * (look.backlight * p.depth_light);
  vec3 sum = sunlit * sun * HairDiffuse(p.tangent, light.to_sun);
  sum += deep * 0.5f *
         (ShLight(light.sky, p.normal, kShLambert) + ShLight(light.sky, p.tangent, kShHair));
  sum += SunHighlights(light, look, p);
  sum += through * light.sun *
         (p.sun_share * Backlight(p.tangent, light.to_sun, p.to_eye, look.backlight_exponent));
  sum += through * max(light.rim, vec3(0.0f)) *
         Backlight(p.tangent, light.to_rim, p.to_eye, look.backlight_exponent);
  return AddRim(sum, OutlineLight(light, look, p.colour, p.normal, p.to_eye) * p.depth_light);
}

// Skin, of its own or below hair that leaves `depth_light` of the light there.
FN vec3 ShadeSkin(LightSet light, HairLook look, vec3 colour, vec3 normal, vec3 to_eye,
               float depth_light, float sun_share) {
  float facing = max(dot(normal, light.to_sun), 0.0f);
  vec3 sum = CoatColour(look, colour, depth_light * sun_share) * light.sun * facing +
             CoatColour(look, colour, depth_light) * ShLight(light.sky, normal, kShLambert);
  return AddRim(sum, OutlineLight(light, look, colour, normal, to_eye) * depth_light);
}
