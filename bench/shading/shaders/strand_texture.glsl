// What a strand shows of a texel of its film strip: rgba, linear, 0 to 1. The texel lies at u = (strip + across) / strips
// and v = along, of a layer's strand texture (jobs/DRAWING.md).
//
// `meaning`: 0: coverage in r, as of Pelt's own strip; an artist's has 1 + StrandChannels
// (core/groom/strand_texture.hpp): 1 "look", 2 "weather".

// How wet and how dirty a strand is, by the amounts of its LookRecord.
FN vec2 WetAndDirty(vec4 amounts) { return vec2(amounts.z, amounts.x); }

// What of the place is covered.
FN float TexelCover(int meaning, vec4 texel, vec2 wet_dirty) {
  if (meaning == 0) return texel.x;
  if (meaning == 1) return texel.w;
  return mix(mix(texel.x, texel.y, wet_dirty.x), texel.z, wet_dirty.y);
}

// The light that it sends to the eye, of what the strand would send without a texture and of the highlights in that.
FN vec3 TexelColour(int meaning, vec4 texel, vec3 lit, vec3 highlights, vec3 tint) {
  if (meaning != 1) return lit;
  return (lit * mix(vec3(1.0f), tint, texel.x) + highlights * texel.y) * (1.0f - texel.z);
}
