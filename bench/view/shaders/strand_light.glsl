// The functions of strand_light.hpp, which says what they are.
// GLSL 3.30 core and ES 3.00; the host puts the version line and these files before it:
// After: spherical_harmonics.glsl
// After: strand_shading.glsl
precision highp float;
precision highp int;

struct LightSet {
  vec3 to_sun, sun;
  vec3 to_rim, rim;
  vec3 sky[16];
};

struct HairLook {
  float primary, primary_exponent, primary_shift;
  float secondary, secondary_exponent, secondary_shift;
  float noise;
  float wrap;
  float rim_exponent, rim_from;
  float backlight, backlight_exponent;
  float scatter, scatter_depth;
};

struct HairPoint {
  vec3 colour, tangent;
  vec3 normal;
  vec3 to_eye;
  float depth_light;
  float sun_share;
  float noise;
};

vec3 CoatColour(HairLook look, vec3 colour, float share) {
  float inside = 1.0 - share;
  return colour * share +
         MultipleScatter(colour, inside, look.scatter_depth) * (look.scatter * inside);
}

vec3 Highlights(HairLook look, HairPoint p, vec3 to_light) {
  vec3 halfway = Halfway(to_light, p.to_eye);
  vec3 to_root = ShiftTangent(p.tangent, p.normal, look.primary_shift);
  vec3 to_tip = ShiftTangent(p.tangent, p.normal, -look.secondary_shift);
  float first = look.primary * HairLobe(to_root, halfway, look.primary_exponent);
  float second = look.secondary * HairLobe(to_tip, halfway, look.secondary_exponent) *
                 mix(1.0, 2.0 * p.noise, look.noise);
  return vec3(first) + p.colour * second;
}

vec3 OutlineLight(LightSet light, HairLook look, vec3 colour, vec3 normal, vec3 to_eye) {
  float rim = Rim(normal, to_eye, look.rim_exponent) * RimFrom(normal, light.to_rim, look.rim_from);
  return light.rim * mix(colour, vec3(1.0), 0.25) * rim;
}

vec3 ShadeHair(LightSet light, HairLook look, HairPoint p) {
  vec3 deep = CoatColour(look, p.colour, p.depth_light);
  vec3 sunlit = CoatColour(look, p.colour, p.depth_light * p.sun_share);
  vec3 sun = light.sun * WrapDiffuse(dot(p.normal, light.to_sun), look.wrap);
  vec3 through = TransmittedColour(p.colour) * (look.backlight * p.depth_light);
  vec3 sum = sunlit * sun * HairDiffuse(p.tangent, light.to_sun);
  sum += deep * 0.5 *
         (ShLight(light.sky, p.normal, kShLambert) + ShLight(light.sky, p.tangent, kShHair));
  sum += Highlights(look, p, light.to_sun) * sun * (p.sun_share * p.depth_light);
  sum += through * light.sun *
         (p.sun_share * Backlight(p.tangent, light.to_sun, p.to_eye, look.backlight_exponent));
  sum += through * max(light.rim, vec3(0.0)) *
         Backlight(p.tangent, light.to_rim, p.to_eye, look.backlight_exponent);
  return AddRim(sum, OutlineLight(light, look, p.colour, p.normal, p.to_eye) * p.depth_light);
}

vec3 ShadeSkin(LightSet light, HairLook look, vec3 colour, vec3 normal, vec3 to_eye,
               float depth_light, float sun_share) {
  float facing = max(dot(normal, light.to_sun), 0.0);
  vec3 sum = CoatColour(look, colour, depth_light * sun_share) * light.sun * facing +
             CoatColour(look, colour, depth_light) * ShLight(light.sky, normal, kShLambert);
  return AddRim(sum, OutlineLight(light, look, colour, normal, to_eye) * depth_light);
}
