// What of a card of hairs is seen: its silhouettes, in a texture with a layer for each film strip (bench/picture/
// strip_texture.hpp). The host defines CARDS for layers that have any: others do without reading a
// texture for every fragment.

// After: strand_texture.glsl

#ifdef CARDS
uniform sampler2DArray strips;
uniform int strip_meaning;  // of their texels: strand_texture.glsl
uniform vec3 strand_tint;

flat in int strip;  // -1: a hair of its own
flat in vec2 wet_dirty;
in vec3 on_card;  // from its middle and its width, samples; share along it

// Colour of the place, of what the hair sends and the highlights in that; a: what is covered.
vec4 OnCard(vec3 lit, vec3 highlights) {
  if (strip < 0) return vec4(lit, 1.0);
  float across = 0.5 + on_card.x / on_card.y;
  float level = log2(float(textureSize(strips, 0).x) / on_card.y);
  vec4 texel = textureLod(strips, vec3(across, on_card.z, float(strip)), level);
  return vec4(TexelColour(strip_meaning, texel, lit, highlights, strand_tint),
              TexelCover(strip_meaning, texel, wet_dirty));
}
#else
vec4 OnCard(vec3 lit, vec3 highlights) { return vec4(lit, 1.0); }
#endif
