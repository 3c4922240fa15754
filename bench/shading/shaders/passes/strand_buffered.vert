// A strand lit by the lighting buffer: what is the hair's own is found here, what is the light's
// where it is seen.
// After: spherical_harmonics.glsl
// After: strand_shading.glsl
// After: strand_light.glsl
// After: passes/frame.glsl
// After: paint_shading.glsl
// After: passes/painted.glsl
// After: strand_texture.glsl
// After: passes/strand.glsl
uniform float depth_floor;

out vec3 sunlit, skylit, rimlit;  // times the buffer's coefficients
out float coverage;
out vec3 on_card;
flat out int strip;
flat out vec2 wet_dirty;

void main() {
  Strand strand = ReadStrand();
  int k = gl_VertexID / 2;
  float along = float(k) / float(knots - 1);
  Knot knot = ReadKnot(strand.record, k);
  float depth_light = DepthShadow(knot.at, strand.root, strand.normal, strand.depth, depth_floor);
  HairLook hair = look;
  knot.colour.rgb *= look.tint;
  float noise = StrandNoise(strand.number, along, kNoiseKnots);
  PaintHair(strand.paint, strand.normal, noise, knot.colour.rgb, hair);
  vec3 coat = CoatColour(hair, knot.colour.rgb, depth_light);
  sunlit = coat * light.sun * HairDiffuse(knot.tangent, light.to_sun);
  skylit = coat * light.sky[0] * (2.0 * 0.282094792);
  float from = look.rim * RimFrom(strand.normal, light.to_rim, look.rim_from);
  rimlit = light.rim * mix(knot.colour.rgb, vec3(1.0), 0.25) * (from * depth_light);
  strip = strand.strip;
  wet_dirty = WetAndDirty(strand.paint);
  gl_Position = CornerOf(knot, float(gl_VertexID % 2), along, coverage, on_card);
}
