// The functions of film_strip.hpp, which says what they are.
// GLSL 3.30 core and ES 3.00; the host puts the version line and these files before it:
// After: strand_shading.glsl
precision highp float;
precision highp int;

const float kStripFilled = 0.92;

uint StripHairs(uint strip) { return 1u + strip % 8u; }

float StripTip(uint strip, uint hair) {
  return hair == StripHairs(strip) / 2u ? 1.0 : 1.0 - 0.45 * HashShare(strip * 64u + hair);
}

float StripCentre(uint strip, uint hair, float along) {
  float own = 1.0 / float(StripHairs(strip));
  float sway = (HashShare(strip * 64u + hair + 32u) - 0.5) * 0.8 * own;
  return mix((float(hair) + 0.5) * own + sway * along * along, 0.5, 0.25 * along * along);
}

float StripWidth(uint strip, uint hair, float along) {
  float share = along / StripTip(strip, hair);
  return max(kStripFilled / float(StripHairs(strip)) * (1.0 - share * share), 0.0);
}

float StripCoverage(uint strip, float across, float along, float footprint) {
  float sum = 0.0;
  for (uint hair = 0u; hair < StripHairs(strip); ++hair) {
    float centre = StripCentre(strip, hair, along);
    float half_width = 0.5 * StripWidth(strip, hair, along), reach = 0.5 * footprint;
    float overlap = min(across + reach, centre + half_width) - max(across - reach, centre - half_width);
    sum += max(overlap, 0.0) / footprint;
  }
  return min(sum, 1.0);
}

float StripShare(uint strip) {
  float tips = 0.0;
  for (uint hair = 0u; hair < StripHairs(strip); ++hair) tips += StripTip(strip, hair);
  return kStripFilled * 2.0 / 3.0 * tips / float(StripHairs(strip));
}
