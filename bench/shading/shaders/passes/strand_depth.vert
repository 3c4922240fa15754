// Of a layer that others follow: what of it hides them.
// After: strand_shading.glsl
// After: spherical_harmonics.glsl
// After: strand_light.glsl
// After: passes/frame.glsl
// After: strand_texture.glsl
// After: passes/strand.glsl
out float coverage;
out vec3 on_card;
flat out int strip;
flat out vec2 wet_dirty;

void main() {
  Strand strand = ReadStrand();
  int k = gl_VertexID / 2;
  Knot knot = ReadKnot(strand.record, k);
  strip = strand.strip;
  wet_dirty = WetAndDirty(strand.paint);
  float along = float(k) / float(knots - 1);
  gl_Position = CornerOf(knot, float(gl_VertexID % 2), along, coverage, on_card);
}
