// Of a layer that others follow: what of it hides them.
// After: strand_shading.glsl
// After: spherical_harmonics.glsl
// After: strand_light.glsl
// After: passes/frame.glsl
// After: passes/strand.glsl
out float coverage;

void main() {
  Knot knot = ReadKnot(ReadStrand().record, gl_VertexID / 2);
  gl_Position = CornerOf(knot, float(gl_VertexID % 2), coverage);
}
