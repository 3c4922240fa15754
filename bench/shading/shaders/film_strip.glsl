// Hairs on a card: a wide ribbon shows the silhouettes of several hairs, so that one strand stands for up to eight. The
// silhouettes lie side by side in a texture, the film strip, and each strand has the number of its own
// (`film_strips` of a setup): numbers 0 to 7 have 1 to 8 hairs, 8 to 15 others of as many, and so on.
//
// A place on a card is its share across, left to right, and along, root to tip. Coverage is that of a footprint across
// the card, so the sum over a card is the same however coarsely it is looked at: from afar hairs blend, and do not vanish.
// After: strand_shading.glsl

CONST float kStripFilled = 0.92f;  // of the card's width at the root

FN uint StripHairs(uint strip) { return 1u + strip % 8u; }

// Where along the card a hair ends; the one in the middle at its end.
FN float StripTip(uint strip, uint hair) {
  return hair == StripHairs(strip) / 2u ? 1.0f : 1.0f - 0.45f * HashShare(strip * 64u + hair);
}

// The middle of a hair across the card. Hairs sway, and lean to each other towards their tips.
FN float StripCentre(uint strip, uint hair, float along) {
  float own = 1.0f / float(StripHairs(strip));
  float sway = (HashShare(strip * 64u + hair + 32u) - 0.5f) * 0.8f * own;
  return mix((float(hair) + 0.5f) * own + sway * along * along, 0.5f, 0.25f * along * along);
}

// A hair's width at a place along the card: whole at the root, none at its tip.
FN float StripWidth(uint strip, uint hair, float along) {
  float share = along / StripTip(strip, hair);
  return max(kStripFilled / float(StripHairs(strip)) * (1.0f - share * share), 0.0f);
}

// What hairs cover of `footprint`, a share of the card's width, round a place.
FN float StripCoverage(uint strip, float across, float along, float footprint) {
  float sum = 0.0f;
  for (uint hair = 0u; hair < StripHairs(strip); ++hair) {
    float centre = StripCentre(strip, hair, along);
    float half_width = 0.5f * StripWidth(strip, hair, along), reach = 0.5f * footprint;
    float overlap = min(across + reach, centre + half_width) - max(across - reach, centre - half_width);
    sum += max(overlap, 0.0f) / footprint;
  }
  return min(sum, 1.0f);
}

// What hairs cover of the whole card, where none lies over another.
FN float StripShare(uint strip) {
  float tips = 0.0f;
  for (uint hair = 0u; hair < StripHairs(strip); ++hair) tips += StripTip(strip, hair);
  return kStripFilled * 2.0f / 3.0f * tips / float(StripHairs(strip));
}
