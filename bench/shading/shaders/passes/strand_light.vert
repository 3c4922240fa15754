// A strand as a strip of two corners at each knot, lit there.
// After: spherical_harmonics.glsl
// After: strand_shading.glsl
// After: strand_light.glsl
// After: passes/frame.glsl
// After: passes/shadow_maps.glsl
// After: paint_shading.glsl
// After: passes/painted.glsl
// After: strand_texture.glsl
// After: passes/strand.glsl
uniform int character;
uniform float depth_floor;

out vec3 lit, highlights;
out float coverage;
out vec3 on_card;
flat out int strip;
flat out vec2 wet_dirty;

void main() {
  Strand strand = ReadStrand();
  int k = gl_VertexID / 2;
  float along = float(k) / float(knots - 1);
  Knot knot = ReadKnot(strand.record, k);
  HairPoint point;
  point.colour = knot.colour.rgb * look.tint;
  point.tangent = knot.tangent;
  point.normal = strand.normal;
  point.to_eye = normalize(eye - knot.at);
  point.depth_light = DepthShadow(knot.at, strand.root, strand.normal, strand.depth, depth_floor);
  point.sun_share = SunShare(knot.at, character);
  point.noise = StrandNoise(strand.number, along, kNoiseKnots);
  HairLook hair = look;
  PaintHair(strand.paint, strand.normal, point.noise, point.colour, hair);
  lit = ShadeHair(light, hair, point);
  highlights = SunHighlights(light, hair, point);
  strip = strand.strip;
  wet_dirty = WetAndDirty(strand.paint);
  gl_Position = CornerOf(knot, float(gl_VertexID % 2), along, coverage, on_card);
}
