// What of a card of hairs is seen: its silhouettes, in a texture with a layer for each film strip (bench/picture/
// strip_texture.hpp). The host defines CARDS for layers that have any: others do without reading a
// texture for every fragment.

#ifdef CARDS
uniform sampler2DArray strips;

flat in int strip;  // -1: a hair of its own
in vec3 on_card;    // from its middle and its width, samples; share along it

float CardCover() {
  if (strip < 0) return 1.0;
  float across = 0.5 + on_card.x / on_card.y;
  float level = log2(float(textureSize(strips, 0).x) / on_card.y);
  return textureLod(strips, vec3(across, on_card.z, float(strip)), level).r;
}
#else
float CardCover() { return 1.0; }
#endif
