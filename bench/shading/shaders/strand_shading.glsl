// The terms that hair is lit by, each a function of its own; strand_light.glsl puts them together.
// Directions are unit and point away from the place; lengths are metres, colours linear radiance.
//
// Source: Kajiya & Kay, "Rendering Fur with Three Dimensional Textures", 1989; Scheuermann, "Practical Real-Time
// Hair Rendering and Shading", 2004; Marschner et al., "Light Scattering from Human Hair Fibers", 2003 (what passes
// through); Zinke et al., "Dual Scattering Approximation", 2008 (what is scattered on). The shadow terms are those of
// Once Upon a Monster.

// Of noise along a hair, as pictures have it.
CONST float kNoiseKnots = 3.0f;

FN float Saturate(float x) { return clamp(x, 0.0f, 1.0f); }

// sin(T, L) for unit tangent and direction to the light; 1 across the hair. It has no back face: shadow has to be its own.
FN float HairDiffuse(vec3 tangent, vec3 to_light) {
  float along = dot(tangent, to_light);
  return sqrt(max(0.0f, 1.0f - along * along));
}

// The tangent of the hair's scales: leaning by `shift` along the skin's normal at the root.
FN vec3 ShiftTangent(vec3 tangent, vec3 normal, float shift) {
  return normalize(tangent + shift * normal);
}

// Halfway between two directions; short, but no NaN, where they are opposite.
FN vec3 Halfway(vec3 a, vec3 b) {
  vec3 sum = a + b;
  return sum / max(length(sum), 1e-6f);
}

// A highlight: sin(T, H)^exponent, H halfway between light and eye, none where H looks down the hair.
FN float HairLobe(vec3 tangent, vec3 halfway, float exponent) {
  float along = dot(tangent, halfway);
  float across = max(1.0f - along * along, 1e-12f);  // pow of 0 is not defined everywhere
  return smoothstep(-1.0f, 0.0f, along) * pow(across, 0.5f * exponent);
}

// (n.l + wrap) / (1 + wrap): light that reaches round a rounded thing.
FN float WrapDiffuse(float n_dot_l, float wrap) { return Saturate((n_dot_l + wrap) / (1.0f + wrap)); }

// (1 - |n.v|)^exponent: what glows at the outline.
FN float Rim(vec3 normal, vec3 to_eye, float exponent) {
  return pow(Saturate(1.0f - abs(dot(normal, to_eye))), exponent);
}

// Share of the rim that a place has whose normal is off the rim's axis; `from` 0: all of it everywhere.
FN float RimFrom(vec3 normal, vec3 axis, float from) {
  return mix(1.0f, 0.5f + 0.5f * dot(normal, axis), from);
}

// Light with a rim, which may be negative: it darkens the outline, but light stays 0 or more.
FN vec3 AddRim(vec3 light, vec3 rim) { return max(light + rim, vec3(0.0f)); }

// Light dies away towards the skin: `floor_light` of it is left there, all of it `depth` above. Skin below hair is as
// dark as the floor.
FN float DepthShadow(vec3 position, vec3 root, vec3 normal, float depth, float floor_light) {
  float height = Saturate(dot(position - root, normal) / depth);
  return floor_light + (1.0f - floor_light) * pow(height, 0.8f);
}

// Share of light that gets through what a shadow map has before a place: `behind` is how far the place lies behind
// the nearest thing, `coverage` the sum of what covers the texel (above 1 counts as 1), `falloff` is 1/m.
FN float SelfShadow(float coverage, float behind, float bias, float falloff, float strength) {
  float thick = 1.0f - exp(-falloff * max(0.0f, behind - bias));
  return 1.0f - strength * min(coverage, 1.0f) * thick;
}

// Seen against the light, hair glows: sin(T, L) (-l.v)^exponent.
FN float Backlight(vec3 tangent, vec3 to_light, vec3 to_eye, float exponent) {
  float against = Saturate(-dot(to_light, to_eye));
  return HairDiffuse(tangent, to_light) * pow(against, exponent);
}

// Colour of light that went through a hair, half the way that reflected light goes.
FN vec3 TransmittedColour(vec3 colour) { return sqrt(colour); }

// Colour of light that many hairs passed on: the deeper inside, `occlusion` 0 to 1, the more often it met the
// colour. White stays white.
FN vec3 MultipleScatter(vec3 colour, float occlusion, float k) {
  return pow(colour, vec3(1.0f + k * occlusion));
}

// A hair of this coverage over what is there.
FN vec3 Over(vec3 colour, float coverage, vec3 below) {
  return colour * coverage + below * (1.0f - coverage);
}

// From linear to sRGB, 0 to 1 (IEC 61966-2-1).
FN float SrgbFromLinear(float v) {
  return v <= 0.0031308f ? 12.92f * v : 1.055f * pow(v, 1.0f / 2.4f) - 0.055f;
}

// Even in [0, 1), by whole numbers alone (Wellons' lowbias32): the same on each machine.
FN float HashShare(uint x) {
  x = (x ^ (x >> 16u)) * 0x7feb352du;
  x = (x ^ (x >> 15u)) * 0x846ca68bu;
  return float((x ^ (x >> 16u)) >> 8u) * (1.0f / 16777216.0f);
}

// Noise along a hair, 0 to 1, of `knots` values from root (t 0) to tip (t 1), to break highlights up.
FN float StrandNoise(uint strand, float t, float knots) {
  float at = t * knots, low = floor(at);
  uint place = strand * 64u + uint(low);
  return mix(HashShare(place), HashShare(place + 1u), at - low);
}
